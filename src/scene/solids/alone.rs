//! An elastic solid that no fluid moves.

use super::of_solid;
use crate::error::RunError;
use crate::model::solids::Form;
use crate::plan::SolidPlan;
use crate::solid::{Body, Elastic, ElasticState, Jaumann, JaumannState, StepLimit};
use serde::{Deserialize, Serialize};

/// Steps after which the longest stable one is found again: what is stretched swings faster.
const RENEWED: u64 = 2000;

/// An elastic solid of a scene.
pub struct SolidBody<const D: usize> {
    /// Its number among the solids of the plan.
    pub number: usize,
    pub group: u8,
    /// Number of its first particle; the others follow.
    pub first: usize,
    solid: Alone<D>,
    /// Of the start.
    pub limit: StepLimit,
    pub pace: Pace,
}

/// The solid itself, by its equations.
enum Alone<const D: usize> {
    TotalLagrangian(Box<Elastic<D>>),
    Jaumann(Box<Jaumann<D>>),
}

/// How a solid steps, and the most it was stretched so far.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Pace {
    /// The longest step, s.
    longest: f64,
    /// Steps until it is found again.
    left: u64,
    pub largest_stretch: f64,
    pub steps: u64,
}

/// What must be kept of a solid to go on with it later.
#[derive(Serialize, Deserialize)]
pub struct SolidImage<'a, const D: usize> {
    solid: State<'a, D>,
    pace: Pace,
}

#[derive(Serialize, Deserialize)]
enum State<'a, const D: usize> {
    TotalLagrangian(ElasticState<'a, D>),
    Jaumann(JaumannState<'a, D>),
}

impl<const D: usize> SolidBody<D> {
    /// The solid of a plan at t = 0.
    ///
    /// # Errors
    /// A solid that cannot be built.
    pub fn new(plan: &SolidPlan<D>, number: usize) -> Result<SolidBody<D>, RunError> {
        let (solid, limit) = match plan.form {
            Form::TotalLagrangian => {
                let mut solid = plan.elastic()?;
                let limit = solid.limit()?;
                (Alone::TotalLagrangian(Box::new(solid)), limit)
            }
            Form::Jaumann(form) => {
                let solid = plan.jaumann(form)?;
                let limit = solid.limit();
                (Alone::Jaumann(Box::new(solid)), limit)
            }
        };
        let pace = Pace { longest: limit.seconds, left: RENEWED, largest_stretch: 1.0, steps: 0 };
        Ok(SolidBody { number, group: plan.group, first: plan.first, solid, limit, pace })
    }

    /// What it shows.
    #[must_use]
    pub fn solid(&self) -> &dyn Body<D> {
        match &self.solid {
            Alone::TotalLagrangian(solid) => &**solid,
            Alone::Jaumann(solid) => &**solid,
        }
    }

    /// The solid, if it knows its place at rest.
    pub fn elastic_mut(&mut self) -> Option<&mut Elastic<D>> {
        match &mut self.solid {
            Alone::TotalLagrangian(solid) => Some(solid),
            Alone::Jaumann(_) => None,
        }
    }

    /// What must be kept to go on later.
    #[must_use]
    pub fn image(&self) -> SolidImage<'_, D> {
        let solid = match &self.solid {
            Alone::TotalLagrangian(solid) => State::TotalLagrangian(solid.image()),
            Alone::Jaumann(solid) => State::Jaumann(solid.image()),
        };
        SolidImage { solid, pace: self.pace }
    }

    /// Goes back to an image; `None` if it belongs to another solid.
    #[must_use]
    pub fn restore(&mut self, image: SolidImage<D>) -> Option<()> {
        self.pace = image.pace;
        match (&mut self.solid, image.solid) {
            (Alone::TotalLagrangian(solid), State::TotalLagrangian(state)) => solid.restore(state),
            (Alone::Jaumann(solid), State::Jaumann(state)) => solid.restore(state),
            _ => None,
        }
    }

    /// Advances by `duration` (s) in equal steps.
    pub(super) fn advance(&mut self, duration: f64) -> Result<(), RunError> {
        let steps = (duration / self.pace.longest * (1.0 - 1e-9)).ceil().max(1.0);
        let longest = duration / steps * (1.0 + 1e-12);
        match &mut self.solid {
            Alone::TotalLagrangian(solid) => solid.advance(duration, longest)?,
            Alone::Jaumann(solid) => solid.advance(duration, longest)?,
        }
        self.pace.steps += steps as u64;
        if steps as u64 >= self.pace.left {
            self.pace.longest = match &mut self.solid {
                Alone::TotalLagrangian(solid) => solid.step_limit()?,
                Alone::Jaumann(solid) => solid.step_limit(),
            };
            self.pace.left = RENEWED;
        } else {
            self.pace.left -= steps as u64;
        }
        self.pace.largest_stretch = self.pace.largest_stretch.max(self.solid().largest_stretch());
        Ok(())
    }

    /// An error of this solid, told of the plan's particles.
    pub(super) fn named(&self, error: RunError, name: &str) -> RunError {
        of_solid(error, None, self.first, name)
    }
}
