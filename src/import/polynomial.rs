//! Rate laws as polynomials in the species, with coefficients made of constants.

use super::math::{Math, Operation};
use std::collections::BTreeMap;

/// Exponents of species by name.
pub(super) type Powers = BTreeMap<String, u32>;

/// One term: coefficient times Π species^power.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Term {
    pub powers: Powers,
    /// The coefficient's value.
    pub value: f64,
    /// The coefficient as it is written.
    pub constant: Math,
}

/// More terms are taken for a law that is no mass action.
const MOST_TERMS: usize = 64;

/// Powers beyond this are no collision of molecules.
const HIGHEST_POWER: u32 = 3;

/// Coefficients this small beside the largest one are what rounding leaves of zero.
const ROUNDING: f64 = 1e-12;

/// Tells species apart from constants.
pub(super) trait Meaning {
    /// Whether a symbol is a species that reactions change.
    fn varies(&self, symbol: &str) -> bool;
    /// The value of any other symbol.
    fn constant(&self, symbol: &str) -> Option<f64>;

    fn is_constant(&self, math: &Math) -> bool {
        !math.mentions(&|symbol| self.varies(symbol))
    }

    fn value(&self, math: &Math) -> Option<f64> {
        math.value(&mut |symbol| self.constant(symbol))
    }
}

/// Multiplies a formula out; `None` if it is no polynomial in the species, or one too long.
pub(super) fn expand(math: &Math, meaning: &impl Meaning) -> Option<Vec<Term>> {
    if meaning.is_constant(math) {
        return Some(vec![Term {
            powers: Powers::new(),
            value: meaning.value(math)?,
            constant: math.clone(),
        }]);
    }
    let terms = match math {
        Math::Number(_) => return None,
        Math::Symbol(name) => {
            vec![Term { powers: Powers::from([(name.clone(), 1)]), value: 1.0, constant: Math::Number(1.0) }]
        }
        Math::Apply(operation, arguments) => match (operation, arguments.as_slice()) {
            (Operation::Add, parts) => {
                let mut all = Vec::new();
                for part in parts {
                    all.extend(expand(part, meaning)?);
                }
                all
            }
            (Operation::Subtract, [a, b]) => {
                let mut all = expand(a, meaning)?;
                all.extend(expand(b, meaning)?.into_iter().map(negative));
                all
            }
            (Operation::Negate, [a]) => expand(a, meaning)?.into_iter().map(negative).collect(),
            (Operation::Multiply, parts) => {
                let mut all = expand(parts.first()?, meaning)?;
                for part in &parts[1..] {
                    all = product(&all, &expand(part, meaning)?)?;
                }
                all
            }
            (Operation::Divide, [a, b]) if meaning.is_constant(b) => {
                let divisor = meaning.value(b)?;
                let over = |term: Term| Term {
                    value: term.value / divisor,
                    constant: Math::two(Operation::Divide, term.constant, b.clone()),
                    ..term
                };
                expand(a, meaning)?.into_iter().map(over).collect()
            }
            (Operation::Power, [a, b]) if meaning.is_constant(b) => {
                let power = meaning.value(b)?;
                if power.fract() != 0.0 || !(1.0..=f64::from(HIGHEST_POWER)).contains(&power) {
                    return None;
                }
                let base = expand(a, meaning)?;
                let mut all = base.clone();
                for _ in 1..power as u32 {
                    all = product(&all, &base)?;
                }
                all
            }
            _ => return None,
        },
    };
    collect(terms)
}

fn negative(term: Term) -> Term {
    Term { value: -term.value, constant: term.constant.negative(), ..term }
}

fn product(a: &[Term], b: &[Term]) -> Option<Vec<Term>> {
    if a.len() * b.len() > MOST_TERMS {
        return None;
    }
    let mut all = Vec::new();
    for (s, t) in a.iter().flat_map(|s| b.iter().map(move |t| (s, t))) {
        let mut powers = s.powers.clone();
        for (name, power) in &t.powers {
            *powers.entry(name.clone()).or_insert(0) += power;
        }
        let constant = match (&s.constant, &t.constant) {
            (Math::Number(x), y) | (y, Math::Number(x)) if *x == 1.0 => y.clone(),
            (x, y) => Math::two(Operation::Multiply, x.clone(), y.clone()),
        };
        all.push(Term { powers, value: s.value * t.value, constant });
    }
    Some(all)
}

/// Adds up terms of equal powers.
fn collect(terms: Vec<Term>) -> Option<Vec<Term>> {
    let mut all: Vec<Term> = Vec::new();
    for term in terms {
        match all.iter_mut().find(|t| t.powers == term.powers) {
            Some(same) => {
                same.value += term.value;
                same.constant = Math::two(Operation::Add, same.constant.clone(), term.constant);
            }
            None => all.push(term),
        }
    }
    let fine = all.len() <= MOST_TERMS && all.iter().all(|t| t.value.is_finite());
    fine.then_some(all)
}

/// Drops terms that are zero but for rounding, if others are not.
pub(super) fn significant(mut terms: Vec<Term>) -> Vec<Term> {
    let largest = terms.iter().map(|t| t.value.abs()).fold(0.0, f64::max);
    if largest > 0.0 {
        terms.retain(|t| t.value.abs() > ROUNDING * largest);
    } else {
        terms.truncate(1);
    }
    terms
}

/// A polynomial in counts as one falling product c Π X … (X-ν+1), if it is one: exponents and c.
///
/// `count_value` is what one molecule adds to the number that a species' symbol stands for.
pub(super) fn falling(terms: &[Term], count_value: &impl Fn(&str) -> f64) -> Option<(Powers, f64)> {
    // x = x₁, x² = x₂ + x₁, x³ = x₃ + 3 x₂ + x₁ with falling powers x_k: Stirling numbers of the second kind.
    const STIRLING: [[f64; 4]; 4] =
        [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 1.0, 1.0, 0.0], [0.0, 1.0, 3.0, 1.0]];
    let mut sums: BTreeMap<Powers, f64> = BTreeMap::new();
    for term in terms {
        let mut parts: Vec<(Powers, f64)> = vec![(Powers::new(), term.value)];
        for (name, &power) in &term.powers {
            let row = STIRLING.get(power as usize)?;
            let unit = count_value(name).powi(power as i32);
            let mut next = Vec::new();
            for (powers, value) in &parts {
                for (falling, weight) in row.iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
                    let mut powers = powers.clone();
                    powers.insert(name.clone(), falling as u32);
                    next.push((powers, value * weight * unit));
                }
            }
            parts = next;
        }
        for (powers, value) in parts {
            *sums.entry(powers).or_insert(0.0) += value;
        }
    }
    let largest = sums.values().map(|v| v.abs()).fold(0.0, f64::max);
    // Sums of numbers with 16 digits that cancel leave less than this.
    sums.retain(|_, value| value.abs() > 1e-9 * largest);
    let (powers, value) = sums.pop_first()?;
    (sums.is_empty()).then_some((powers, value))
}
