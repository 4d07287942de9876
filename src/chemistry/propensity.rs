//! Flat compiled propensity tables.
//!
//! `kinetics: concentration`: v = k Π [S]^ν, a = k (N_A V)^(1-n) Π X … (X-ν+1), n the order.
//! `kinetics: molecules`: a = c Π binomial(X, ν), Gillespie (1977); the volume does not enter.
//! Continuous species stand with plain powers in place of falling factorials.

use crate::chemistry::AVOGADRO;
use crate::chemistry::law::Program;
use crate::chemistry::network::{Kinetics, Network, Rate};

/// How large a voxel is, in the two forms that propensities need.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// N_A V, m³/mol: molecules per (mol/m³).
    pub molar: f64,
    /// 1/(N_A V).
    pub inverse: f64,
}

impl Scale {
    /// Of a volume in m³.
    #[must_use]
    pub fn of(volume: f64) -> Scale {
        let molar = AVOGADRO * volume;
        Scale { molar, inverse: molar.recip() }
    }
}

/// The shape of the product of amounts; the common ones are spelled out because they are evaluated most.
#[derive(Clone, Copy, Debug)]
enum Form {
    Zeroth,
    First(u32),
    /// X Y.
    Pair(u32, u32),
    /// X (X - 1).
    Twice(u32),
    General,
    /// Index into the list of rate laws.
    Law(u32),
}

#[derive(Clone, Copy, Debug)]
struct Compiled {
    form: Form,
    /// k, or c / Π ν!.
    rate: f64,
    /// Exponent of N_A V.
    exponent: i32,
    /// An event must be checked to leave no amount below zero: rate laws and continuous reactants.
    guarded: bool,
    stochastic: bool,
}

/// Rows of different length in one array.
#[derive(Clone, Debug)]
pub(in crate::chemistry) struct Rows<T> {
    offsets: Vec<u32>,
    entries: Vec<T>,
}

impl<T> Rows<T> {
    pub fn collect(rows: impl Iterator<Item = Vec<T>>) -> Rows<T> {
        let mut all = Rows { offsets: vec![0], entries: Vec::new() };
        for row in rows {
            all.entries.extend(row);
            all.offsets.push(all.entries.len() as u32);
        }
        all
    }

    #[inline]
    pub fn row(&self, index: usize) -> &[T] {
        &self.entries[self.offsets[index] as usize..self.offsets[index + 1] as usize]
    }
}

/// Compiled propensities of a network: one entry per reaction, in the order of the network.
#[derive(Clone, Debug)]
pub struct Propensities {
    kinetics: Kinetics,
    discrete: Vec<bool>,
    compiled: Vec<Compiled>,
    laws: Vec<Program>,
    reactants: Rows<(u32, u32)>,
    changes: Rows<(u32, f64)>,
    inputs: Rows<u32>,
    affected: Rows<u32>,
}

impl Propensities {
    /// Compiles a checked network; `discrete[s]` says whether species s is carried as whole molecules.
    #[must_use]
    pub fn compile(network: &Network, discrete: &[bool]) -> Propensities {
        let reactions = &network.reactions;
        let changes: Vec<Vec<(u32, f64)>> = reactions
            .iter()
            .map(|r| r.change().into_iter().map(|(s, c)| (s as u32, f64::from(c))).collect())
            .collect();
        let mut laws = Vec::new();
        let mut inputs: Vec<Vec<u32>> = Vec::new();
        let mut compiled = Vec::new();
        for (reaction, change) in reactions.iter().zip(&changes) {
            let mut reads: Vec<u32> = reaction.reactants.iter().map(|&(s, _)| s as u32).collect();
            let (form, rate, exponent) = match &reaction.rate {
                Rate::MassAction(k) => {
                    let order = reaction.order() as i32;
                    let (rate, exponent) = match network.kinetics {
                        Kinetics::Concentration => (*k, 1 - order),
                        Kinetics::Molecules => {
                            let ways: f64 = reaction.reactants.iter().map(|&(_, nu)| factorial(nu)).product();
                            (k / ways, 0)
                        }
                    };
                    (mass_action_form(&reaction.reactants), rate, exponent)
                }
                // The whole of the factor is the voxel's weight.
                Rate::Surface(_) => (mass_action_form(&reaction.reactants), 1.0, 0),
                Rate::Law(program) => {
                    reads.extend(program.uses().into_iter().map(|s| s as u32));
                    laws.push(program.clone());
                    (Form::Law(laws.len() as u32 - 1), 1.0, 0)
                }
            };
            reads.sort_unstable();
            reads.dedup();
            let of_molecules = |s: u32| discrete[s as usize];
            let stochastic =
                reads.iter().any(|&s| of_molecules(s)) || change.iter().any(|&(s, _)| of_molecules(s));
            let takes_continuous = change.iter().any(|&(s, c)| c < 0.0 && !of_molecules(s));
            let guarded = matches!(form, Form::Law(_)) || takes_continuous;
            compiled.push(Compiled { form, rate, exponent, guarded, stochastic });
            inputs.push(reads);
        }
        let affected = changes.iter().map(|change| {
            let touched = |reads: &Vec<u32>| change.iter().any(|&(s, _)| reads.contains(&s));
            (0..inputs.len() as u32).filter(|&q| touched(&inputs[q as usize])).collect()
        });
        Propensities {
            kinetics: network.kinetics,
            discrete: discrete.to_vec(),
            laws,
            reactants: Rows::collect(
                reactions.iter().map(|r| r.reactants.iter().map(|&(s, nu)| (s as u32, nu)).collect()),
            ),
            affected: Rows::collect(affected),
            changes: Rows::collect(changes.iter().cloned()),
            inputs: Rows::collect(inputs.iter().cloned()),
            compiled,
        }
    }

    /// Number of reactions.
    #[must_use]
    pub fn len(&self) -> usize {
        self.compiled.len()
    }

    /// Number of species.
    #[must_use]
    pub fn species(&self) -> usize {
        self.discrete.len()
    }

    /// Whether species `s` is taken as whole molecules.
    #[must_use]
    pub fn whole(&self, s: usize) -> bool {
        self.discrete[s]
    }

    /// Whether there is no reaction.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.compiled.is_empty()
    }

    /// Whether reaction `r` is sampled: any participant (reactant, product or species its law reads) is
    /// discrete. The others belong to the rate equations.
    #[inline]
    #[must_use]
    pub fn stochastic(&self, r: usize) -> bool {
        self.compiled[r].stochastic
    }

    /// Net change of each species that one event of reaction `r` changes, molecules.
    #[inline]
    #[must_use]
    pub fn changes(&self, r: usize) -> &[(u32, f64)] {
        self.changes.row(r)
    }

    /// Species whose amounts enter the propensity of reaction `r`.
    #[must_use]
    pub fn inputs(&self, r: usize) -> &[u32] {
        self.inputs.row(r)
    }

    /// Reactions whose propensity may differ after an event of reaction `r` (the dependency graph of
    /// Gibson & Bruck 2000).
    #[inline]
    #[must_use]
    pub fn affected(&self, r: usize) -> &[u32] {
        self.affected.row(r)
    }

    /// Propensity of reaction `r`, 1/s, in a voxel of `volume` m³ holding `amounts` (molecules).
    ///
    /// Zero where an event would take more than there is of a continuous species or, under a rate law, of
    /// any species. Not checked for being finite and positive: a rate law can return anything.
    #[inline]
    #[must_use]
    pub fn propensity(&self, r: usize, amounts: &[f64], volume: f64) -> f64 {
        self.propensity_at(r, amounts, Scale::of(volume))
    }

    /// [`Propensities::propensity`] with the voxel's scale at hand.
    #[inline]
    #[must_use]
    pub fn propensity_at(&self, r: usize, amounts: &[f64], scale: Scale) -> f64 {
        self.propensity_beside(r, amounts, scale, &[])
    }

    /// [`Propensities::propensity_at`] where some species are `held` (one flag per species, or none at all): an
    /// event takes nothing from those, so that less than a molecule of them is enough.
    #[inline]
    #[must_use]
    pub fn propensity_beside(&self, r: usize, amounts: &[f64], scale: Scale, held: &[bool]) -> f64 {
        let reaction = &self.compiled[r];
        let held = |s: u32| held.get(s as usize).copied().unwrap_or(false);
        let short = |&(s, c): &(u32, f64)| amounts[s as usize] + c < 0.0 && !held(s);
        if reaction.guarded && self.changes(r).iter().any(short) {
            return 0.0;
        }
        let product = match reaction.form {
            Form::Zeroth => 1.0,
            Form::First(s) => amounts[s as usize],
            Form::Pair(s, t) => amounts[s as usize] * amounts[t as usize],
            Form::Twice(s) => {
                let x = amounts[s as usize];
                if self.discrete[s as usize] { x * (x - 1.0) } else { x * x }
            }
            Form::General => self.falling_product(r, amounts),
            Form::Law(law) => return self.law(law, amounts, scale),
        };
        factor(reaction, scale) * product
    }

    /// Reaction `r` as rate · Π (X_s - less), at most three factors, in a voxel of this scale; the same value
    /// as [`Propensities::propensity_at`] to rounding. `None` for rate laws and wherever a reactant is
    /// continuous.
    #[must_use]
    pub fn product(&self, r: usize, scale: Scale) -> Option<(f64, Vec<(u32, f64)>)> {
        let reaction = &self.compiled[r];
        let reactants = self.reactants.row(r);
        if reaction.guarded || reactants.iter().any(|&(s, _)| !self.discrete[s as usize]) {
            return None;
        }
        let factors: Vec<(u32, f64)> =
            reactants.iter().flat_map(|&(s, nu)| (0..nu).map(move |k| (s, f64::from(k)))).collect();
        (factors.len() <= 3).then(|| (factor(reaction, scale), factors))
    }

    /// Mean propensity of reaction `r` where the species that `is_mean` picks are held Poisson numbers of which
    /// `amounts` holds the means: E[X … (X-ν+1)] = mean^ν, and for a rate law the sum over the numbers.
    #[must_use]
    pub fn mean_at(&self, r: usize, amounts: &[f64], scale: Scale, is_mean: impl Fn(usize) -> bool) -> f64 {
        let reaction = &self.compiled[r];
        if matches!(reaction.form, Form::Law(_)) {
            let held: Vec<bool> = (0..amounts.len()).map(&is_mean).collect();
            let dealt: Vec<u32> = self.inputs(r).iter().copied().filter(|&s| held[s as usize]).collect();
            return self.expected_law(r, &mut amounts.to_vec(), scale, (&held, &dealt));
        }
        let mut product = factor(reaction, scale);
        for &(s, nu) in self.reactants.row(r) {
            let (x, s) = (amounts[s as usize], s as usize);
            product *= if is_mean(s) || !self.discrete[s] {
                x.powi(nu as i32)
            } else {
                (0..nu).map(|k| (x - f64::from(k)).max(0.0)).product::<f64>()
            };
        }
        product
    }

    /// Expectation of a rate law over Poisson numbers of the species `dealt`, whose means stand in `amounts`.
    fn expected_law(
        &self,
        r: usize,
        amounts: &mut Vec<f64>,
        scale: Scale,
        (held, dealt): (&[bool], &[u32]),
    ) -> f64 {
        /// Above this mean three points stand for the law, exact up to the fifth power of the deviation.
        const MANY: f64 = 400.0;
        let Some((&s, rest)) = dealt.split_first() else {
            return self.propensity_beside(r, amounts, scale, held);
        };
        let s = s as usize;
        let mean = amounts[s];
        let mut sum = 0.0;
        let mut add = |count: f64, weight: f64, amounts: &mut Vec<f64>| {
            amounts[s] = count;
            sum += weight * self.expected_law(r, amounts, scale, (held, rest));
        };
        if mean > MANY {
            let off = (3.0 * mean).sqrt();
            for (count, weight) in [(mean - off, 1.0 / 6.0), (mean, 2.0 / 3.0), (mean + off, 1.0 / 6.0)] {
                add(count, weight, amounts);
            }
        } else {
            let mut mass = (-mean).exp();
            let last = (mean + 12.0 * mean.sqrt() + 20.0) as u32;
            for k in 0..=last {
                add(f64::from(k), mass, amounts);
                mass *= mean / f64::from(k + 1);
            }
        }
        amounts[s] = mean;
        sum
    }

    /// Deterministic rate of reaction `r`, events per s: every amount with plain powers.
    #[inline]
    #[must_use]
    pub fn flux(&self, r: usize, amounts: &[f64], volume: f64) -> f64 {
        self.flux_at(r, amounts, Scale::of(volume))
    }

    /// [`Propensities::flux`] with the voxel's scale at hand.
    #[inline]
    #[must_use]
    pub fn flux_at(&self, r: usize, amounts: &[f64], scale: Scale) -> f64 {
        let reaction = &self.compiled[r];
        let product = match reaction.form {
            Form::Zeroth => 1.0,
            Form::First(s) => amounts[s as usize],
            Form::Pair(s, t) => amounts[s as usize] * amounts[t as usize],
            Form::Twice(s) => amounts[s as usize] * amounts[s as usize],
            Form::General => {
                self.reactants.row(r).iter().map(|&(s, nu)| amounts[s as usize].powi(nu as i32)).product()
            }
            Form::Law(law) => return self.law(law, amounts, scale),
        };
        factor(reaction, scale) * product
    }

    /// Π X … (X-ν+1) over discrete reactants, Π X^ν over continuous ones.
    fn falling_product(&self, r: usize, amounts: &[f64]) -> f64 {
        let mut product = 1.0;
        for &(s, nu) in self.reactants.row(r) {
            let x = amounts[s as usize];
            if self.discrete[s as usize] {
                product *= (0..nu).map(|k| (x - f64::from(k)).max(0.0)).product::<f64>();
            } else {
                product *= x.powi(nu as i32);
            }
        }
        product
    }

    /// Events per s of a rate law: counts go in as they are under `molecules`, as concentrations in mol/m³
    /// under `concentration`, whose result in mol/m³/s is brought back by N_A V.
    fn law(&self, law: u32, amounts: &[f64], scale: Scale) -> f64 {
        const ON_STACK: usize = 32;
        let program = &self.laws[law as usize];
        match self.kinetics {
            Kinetics::Molecules => program.eval(amounts),
            Kinetics::Concentration if amounts.len() <= ON_STACK => {
                let mut concentrations = [0.0; ON_STACK];
                for (c, n) in concentrations.iter_mut().zip(amounts) {
                    *c = n * scale.inverse;
                }
                program.eval(&concentrations[..amounts.len()]) * scale.molar
            }
            Kinetics::Concentration => {
                let concentrations: Vec<f64> = amounts.iter().map(|n| n * scale.inverse).collect();
                program.eval(&concentrations) * scale.molar
            }
        }
    }
}

/// k (N_A V)^(1-n).
#[inline]
fn factor(reaction: &Compiled, scale: Scale) -> f64 {
    match reaction.exponent {
        0 => reaction.rate,
        -1 => reaction.rate * scale.inverse,
        1 => reaction.rate * scale.molar,
        exponent => reaction.rate * scale.inverse.powi(-exponent),
    }
}

fn mass_action_form(reactants: &[(usize, u32)]) -> Form {
    match *reactants {
        [] => Form::Zeroth,
        [(s, 1)] => Form::First(s as u32),
        [(s, 2)] => Form::Twice(s as u32),
        [(s, 1), (t, 1)] if s != t => Form::Pair(s as u32, t as u32),
        _ => Form::General,
    }
}

fn factorial(nu: u32) -> f64 {
    (1..=nu).map(f64::from).product()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chemistry::reactor::example::{Equation, network};

    /// A volume in which one mol/m³ is one molecule.
    const UNIT: f64 = 1.0 / AVOGADRO;

    #[test]
    fn conventions_of_both_kinetics() {
        // 2 A -> B: k X (X-1) / (N_A V) and c X (X-1) / 2; 3 A -> 0: k X (X-1)(X-2) / (N_A V)² and c (X choose 3).
        let reactions: [Equation; 5] = [
            (&[(0, 2)], &[(1, 1)], 0.5),
            (&[(0, 3)], &[], 0.5),
            (&[], &[(0, 1)], 0.5),
            (&[(0, 1), (1, 1)], &[], 0.5),
            (&[(0, 2), (1, 1)], &[], 0.5),
        ];
        let amounts = [5.0, 3.0];
        let both = [true, true];
        let p = Propensities::compile(&network(Kinetics::Concentration, 2, &reactions), &both);
        let expected = [0.5 * 20.0 / 2.0, 0.5 * 60.0 / 4.0, 0.5 * 2.0, 0.5 * 15.0 / 2.0, 0.5 * 60.0 / 4.0];
        for (r, value) in expected.into_iter().enumerate() {
            // Rounding of N_A V only.
            assert!((p.propensity(r, &amounts, 2.0 * UNIT) / value - 1.0).abs() < 1e-14, "{r}");
        }
        assert_eq!(p.changes(0), &[(0, -2.0), (1, 1.0)]);
        let flux = [0.5 * 25.0 / 2.0, 0.5 * 125.0 / 4.0, 1.0, 0.5 * 15.0 / 2.0, 0.5 * 75.0 / 4.0];
        for (r, value) in flux.into_iter().enumerate() {
            assert!((p.flux(r, &amounts, 2.0 * UNIT) / value - 1.0).abs() < 1e-14, "{r}");
        }
        let p = Propensities::compile(&network(Kinetics::Molecules, 2, &reactions), &both);
        let expected = [0.5 * 10.0, 0.5 * 10.0, 0.5, 0.5 * 15.0, 0.5 * 30.0];
        for (r, value) in expected.into_iter().enumerate() {
            assert!((p.propensity(r, &amounts, 7.0) - value).abs() < 1e-13, "{r}");
        }
    }

    #[test]
    fn too_few_molecules_give_zero() {
        let reactions: [Equation; 3] =
            [(&[(0, 2)], &[], 1.0), (&[(0, 3)], &[], 1.0), (&[(0, 2), (1, 1)], &[], 1.0)];
        let p = Propensities::compile(&network(Kinetics::Molecules, 2, &reactions), &[true, true]);
        for r in 0..3 {
            for x in [0.0, 1.0] {
                assert_eq!(p.propensity(r, &[x, 4.0], 1.0), 0.0);
            }
        }
        assert_eq!(p.propensity(1, &[2.0, 4.0], 1.0), 0.0);
    }

    #[test]
    fn continuous_reactant_must_suffice() {
        let reactions: [Equation; 2] = [(&[(0, 1)], &[(1, 1)], 1.0), (&[(0, 1), (1, 1)], &[(0, 1)], 1.0)];
        let p = Propensities::compile(&network(Kinetics::Molecules, 2, &reactions), &[false, true]);
        assert!(p.stochastic(0) && p.stochastic(1));
        assert_eq!(p.propensity(0, &[0.5, 0.0], 1.0), 0.0);
        assert_eq!(p.propensity(0, &[1.5, 0.0], 1.0), 1.5);
        // A catalyst is not consumed, so half a molecule of it acts.
        assert_eq!(p.propensity(1, &[0.5, 3.0], 1.0), 1.5);
        let p = Propensities::compile(&network(Kinetics::Molecules, 2, &reactions), &[false, false]);
        assert!(!p.stochastic(0) && !p.stochastic(1));
    }

    #[test]
    fn dependency_graph() {
        let reactions: [Equation; 3] = [
            (&[(0, 1), (1, 1)], &[(2, 1)], 1.0),
            (&[(2, 1)], &[(0, 1), (1, 1)], 1.0),
            (&[(1, 1)], &[(1, 2)], 1.0),
        ];
        let p = Propensities::compile(&network(Kinetics::Molecules, 3, &reactions), &[true; 3]);
        assert_eq!(p.affected(0), &[0, 1, 2]);
        assert_eq!(p.affected(2), &[0, 2]);
    }
}
