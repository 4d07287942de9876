//! Why a relaxation did not come to an equilibrium, in words.

use crate::error::RunError;
use crate::solid::elastic::Elastic;
use crate::solid::relax::Relaxation;
use crate::space::matrix::determinant;

/// How a relaxation was lost.
#[derive(Debug)]
pub(super) enum Lost {
    /// A particle was turned inside out when the loads had risen to this part of themselves.
    Inverted { error: Box<RunError>, risen: f64 },
    /// The forces left over grew beyond reason, likewise.
    Runaway { risen: f64 },
    /// It was stretched further than can be.
    Wide,
    /// Forces did not fall to the tolerance: the least ever left over the loads, and the largest stretch half way.
    Restless { lowest: f64, halfway: f64 },
}

/// Forces over loads that are balanced for every purpose but a tolerance that is smaller.
const BALANCED: f64 = 1e-6;
/// Growth of the largest stretch over half of the rounds that is no coming to rest.
const GIVING: f64 = 1.01;

impl Lost {
    /// Whether less load tells the reason.
    pub(super) fn asks_for_less(&self) -> bool {
        match self {
            Lost::Wide => false,
            Lost::Inverted { risen, .. } | Lost::Runaway { risen } => *risen >= 1.0,
            Lost::Restless { lowest, .. } => *lowest > BALANCED,
        }
    }
}

impl<const D: usize> Elastic<D> {
    /// The particle that is stretched most and is not turned inside out, and its stretch.
    pub(super) fn widest(&self) -> (usize, f64) {
        let whole = |i: &usize| determinant(&self.strains[*i].f) > 0.0;
        let stretches = (0..self.len()).filter(whole).map(|i| (i, self.stretch(i)));
        stretches.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 1.0))
    }

    /// The error of a lost relaxation; `eases`: with less load there is an equilibrium.
    pub(super) fn unbalanced(&self, lost: Lost, eases: bool, relaxation: &Relaxation) -> RunError {
        match lost {
            Lost::Wide => self.gives_way(""),
            // While the loads rose it had not yet all of them.
            Lost::Inverted { risen, .. } | Lost::Runaway { risen } if risen < 1.0 => self.gives_way(""),
            _ if eases => self.gives_way("; under a quarter of it it comes to rest"),
            Lost::Inverted { error, .. } => *error,
            Lost::Runaway { .. } => self.restless(f64::INFINITY, relaxation),
            Lost::Restless { lowest, halfway } if lowest > BALANCED && self.widest().1 > GIVING * halfway => {
                self.gives_way("")
            }
            Lost::Restless { lowest, .. } => self.restless(lowest, relaxation),
        }
    }

    fn gives_way(&self, how_far: &str) -> RunError {
        let (widest, stretch) = self.widest();
        self.no_equilibrium(
            widest,
            format!("the wall gives way to its load{how_far}; largest stretch of the solid"),
            stretch,
            "a wall too soft for its load balloons: less turgor, less softening, a thicker wall, or a turgor with \
             stiffness (a fixed amount of liquid)",
        )
    }

    fn restless(&self, lowest: f64, relaxation: &Relaxation) -> RunError {
        let (widest, _) = self.widest();
        let asked = relaxation.tolerance;
        let what = format!("forces left over the loads, of which {asked:.1e} are tolerated,");
        let remedy = if lowest <= BALANCED {
            format!(
                "all but balanced: such a tolerance is out of reach, of rounding or of {} rounds; set mechanics.tolerance: {:.0e} or more",
                relaxation.rounds,
                (10.0 * lowest).max(1e-12)
            )
        } else {
            "it does not come to rest: a wall that folds or slides from one shape to another; make softening or growth \
             even over a few spacings, or the spacing finer"
                .into()
        };
        self.no_equilibrium(widest, what, lowest, &remedy)
    }

    fn no_equilibrium(&self, particle: usize, what: String, value: f64, remedy: &str) -> RunError {
        let at: Vec<String> = self.position(particle).iter().map(|x| format!("{x:.4e}")).collect();
        RunError::BlowUp {
            step: self.steps,
            time: self.time,
            particle,
            quantity: format!(
                "no equilibrium: stretched {:.2} times at ({}) m; {what}",
                self.stretch(particle),
                at.join(", ")
            ),
            value,
            remedy: remedy.into(),
        }
    }
}
