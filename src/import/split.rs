//! A net rate as the difference of a forward and a backward rate, both zero or more.

use super::math::{Math, Operation};
use super::polynomial::Meaning;

/// What is known of the sign of a formula for every amount that can occur.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sign {
    /// Zero or more.
    Plus,
    /// Zero or less.
    Minus,
    Unknown,
}

impl Sign {
    fn times(self, other: Sign) -> Sign {
        match (self, other) {
            (Sign::Unknown, _) | (_, Sign::Unknown) => Sign::Unknown,
            (a, b) if a == b => Sign::Plus,
            _ => Sign::Minus,
        }
    }

    fn turned(self) -> Sign {
        self.times(Sign::Minus)
    }
}

/// The sign of a formula, from the signs of its parts; amounts are never negative.
pub(super) fn sign(math: &Math, meaning: &impl Meaning) -> Sign {
    if meaning.is_constant(math) {
        return match meaning.value(math) {
            Some(value) if value >= 0.0 => Sign::Plus,
            Some(value) if value < 0.0 => Sign::Minus,
            _ => Sign::Unknown,
        };
    }
    let Math::Apply(operation, arguments) = math else { return Sign::Plus };
    let all = |wanted: Sign| arguments.iter().all(|a| sign(a, meaning) == wanted);
    let agreed = || match (all(Sign::Plus), all(Sign::Minus)) {
        (true, _) => Sign::Plus,
        (_, true) => Sign::Minus,
        _ => Sign::Unknown,
    };
    match (operation, arguments.as_slice()) {
        (Operation::Add | Operation::Min, _) => agreed(),
        (Operation::Max, parts) if parts.iter().any(|a| sign(a, meaning) == Sign::Plus) => Sign::Plus,
        (Operation::Max, _) => agreed(),
        (Operation::Subtract, [a, b]) => match (sign(a, meaning), sign(b, meaning).turned()) {
            (a, b) if a == b => a,
            _ => Sign::Unknown,
        },
        (Operation::Negate, [a]) => sign(a, meaning).turned(),
        (Operation::Multiply | Operation::Divide, parts) => {
            parts.iter().map(|a| sign(a, meaning)).fold(Sign::Plus, Sign::times)
        }
        (Operation::Power, [a, b]) => {
            let even = meaning.is_constant(b) && meaning.value(b).is_some_and(|power| power % 2.0 == 0.0);
            if even || sign(a, meaning) == Sign::Plus { Sign::Plus } else { Sign::Unknown }
        }
        (Operation::If, [_, a, b]) => match (sign(a, meaning), sign(b, meaning)) {
            (a, b) if a == b => a,
            _ => Sign::Unknown,
        },
        (
            Operation::Exp
            | Operation::Sqrt
            | Operation::Abs
            | Operation::Factorial
            | Operation::Less
            | Operation::LessOrEqual
            | Operation::Greater
            | Operation::GreaterOrEqual
            | Operation::Equal
            | Operation::Unequal
            | Operation::And
            | Operation::Or
            | Operation::Not,
            _,
        ) => Sign::Plus,
        (Operation::Floor | Operation::Ceiling | Operation::Tanh | Operation::Arctan, [a])
            if sign(a, meaning) == Sign::Plus =>
        {
            Sign::Plus
        }
        _ => Sign::Unknown,
    }
}

/// Longer sums are left as they are.
const MOST_TERMS: usize = 256;

/// Forward and backward rate of a law; `None` where the sign of some part is unknown.
pub(super) fn split(law: &Math, meaning: &impl Meaning) -> Option<(Vec<Math>, Vec<Math>)> {
    let (mut forward, mut backward) = (Vec::new(), Vec::new());
    for (subtracted, term) in terms(law, meaning)? {
        let turned = if subtracted { Sign::Minus } else { Sign::Plus };
        match (sign(&term, meaning), turned) {
            (Sign::Unknown, _) => return None,
            (Sign::Plus, Sign::Plus) => forward.push(term),
            (Sign::Plus, _) => backward.push(term),
            (_, Sign::Plus) => backward.push(term.negative()),
            _ => forward.push(term.negative()),
        }
    }
    Some((forward, backward))
}

/// The terms of a sum, each with whether it is subtracted; products over sums of unknown sign are
/// multiplied out.
fn terms(math: &Math, meaning: &impl Meaning) -> Option<Vec<(bool, Math)>> {
    let whole = vec![(false, math.clone())];
    let Math::Apply(operation, arguments) = math else { return Some(whole) };
    if sign(math, meaning) != Sign::Unknown {
        return Some(whole);
    }
    let mut all: Vec<(bool, Math)> = Vec::new();
    match (operation, arguments.as_slice()) {
        (Operation::Add, parts) => {
            for part in parts {
                all.extend(terms(part, meaning)?);
            }
        }
        (Operation::Subtract, [a, b]) => {
            all.extend(terms(a, meaning)?);
            all.extend(terms(b, meaning)?.into_iter().map(|(minus, term)| (!minus, term)));
        }
        (Operation::Negate, [a]) => {
            all.extend(terms(a, meaning)?.into_iter().map(|(minus, term)| (!minus, term)));
        }
        (Operation::Multiply, parts) => {
            all.push((false, Math::Number(1.0)));
            for part in parts {
                let factors = terms(part, meaning)?;
                if all.len() * factors.len() > MOST_TERMS {
                    return None;
                }
                let join = |(minus, a): &(bool, Math), (turned, b): &(bool, Math)| {
                    let product = match a {
                        Math::Number(one) if *one == 1.0 => b.clone(),
                        _ => Math::two(Operation::Multiply, a.clone(), b.clone()),
                    };
                    (minus != turned, product)
                };
                all = all.iter().flat_map(|a| factors.iter().map(move |b| join(a, b))).collect();
            }
        }
        (Operation::Divide, [a, b]) => {
            let over = |(minus, term)| (minus, Math::two(Operation::Divide, term, b.clone()));
            all = terms(a, meaning)?.into_iter().map(over).collect();
        }
        _ => return Some(whole),
    }
    (all.len() <= MOST_TERMS).then_some(all)
}

/// One formula from the terms of a sum.
pub(super) fn sum(mut terms: Vec<Math>) -> Option<Math> {
    if terms.len() > 1 { Some(Math::Apply(Operation::Add, terms)) } else { terms.pop() }
}
