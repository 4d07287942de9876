//! Dimensions of the parts of an expression. Bare numbers fit any dimension.

use super::compile::{Names, constant_value};
use super::parser::{Kind, Tree};
use super::program::Operation;
use crate::quantity::{Dimension, TextFault};

/// Powers of the base units, real because a Hill exponent may be 2.5; `None` fits anything.
type Powers = Option<[f64; 5]>;

const PURE: Powers = Some([0.0; 5]);

/// Every fault of dimension; the whole must have the dimension `expected`.
pub(super) fn check(tree: &Tree, names: &Names, expected: Dimension) -> Vec<TextFault> {
    let mut faults = Vec::new();
    let found = infer(tree, names, &mut faults);
    if faults.is_empty() && !same(found, powers(expected)) {
        faults.push(TextFault::new(
            tree.offset,
            tree.width,
            format!("the expression is {}, expected {expected}", words(found)),
            "check the units of the parameters in it",
        ));
    }
    faults
}

fn infer(tree: &Tree, names: &Names, faults: &mut Vec<TextFault>) -> Powers {
    match &tree.kind {
        Kind::Number(quantity, words) => {
            if words.is_empty() {
                None
            } else {
                powers(quantity.dimension)
            }
        }
        Kind::Name(name) => match (names.variable(name), names.constant(name)) {
            (Some(index), _) => powers(names.variables[index].1),
            (None, Some(quantity)) if !quantity.dimension.is_none() => powers(quantity.dimension),
            _ => None,
        },
        Kind::Apply(operation, arguments) => {
            let found: Vec<Powers> = arguments.iter().map(|a| infer(a, names, faults)).collect();
            apply(*operation, tree, arguments, &found, names, faults)
        }
    }
}

fn apply(
    operation: Operation,
    tree: &Tree,
    arguments: &[Tree],
    found: &[Powers],
    names: &Names,
    faults: &mut Vec<TextFault>,
) -> Powers {
    let pure = |k: usize, what: &str, faults: &mut Vec<TextFault>| {
        if !same(found[k], PURE) {
            let reason = format!("{what} needs a pure number, found {}", words(found[k]));
            let remedy = "divide by a quantity of the same dimension";
            faults.push(TextFault::new(arguments[k].offset, arguments[k].width, reason, remedy));
        }
    };
    let alike = |what: &str, faults: &mut Vec<TextFault>| {
        let (a, b) = (found[found.len() - 2], found[found.len() - 1]);
        if !same(a, b) {
            let reason = format!("{what} {} and {}", words(a), words(b));
            faults.push(TextFault::new(tree.offset, tree.width, reason, "both must have the same dimension"));
        }
        a.or(b)
    };
    // Beside constants alone, as in `2 * k_on` or `1 mm/s * 4`, a written number only scales; beside variables it may
    // be a rate constant in SI, as in `0.5 * S`.
    let factor = |k: usize| match (&arguments[k].kind, found[k]) {
        (Kind::Number(..), None) if found[1 - k].is_some() && is_constant(&arguments[1 - k], names) => PURE,
        _ => found[k],
    };
    match operation {
        Operation::Add => alike("this adds", faults),
        Operation::Subtract => alike("this subtracts", faults),
        Operation::Min | Operation::Max => alike("this compares", faults),
        Operation::Less
        | Operation::LessOrEqual
        | Operation::Greater
        | Operation::GreaterOrEqual
        | Operation::Equal
        | Operation::Unequal => {
            alike("this compares", faults);
            PURE
        }
        Operation::If => {
            pure(0, "the condition of if", faults);
            alike("if chooses between", faults)
        }
        Operation::Multiply => combine(factor(0), factor(1), |a, b| a + b),
        Operation::Divide => combine(factor(0), factor(1), |a, b| a - b),
        Operation::Negate | Operation::Abs => found[0],
        Operation::Sqrt => found[0].map(|p| p.map(|k| 0.5 * k)),
        Operation::Step => PURE,
        Operation::Power => {
            pure(1, "an exponent", faults);
            match (found[0], constant_value(&arguments[1], names)) {
                (None, _) => None,
                (Some(base), Some(exponent)) => Some(base.map(|k| k * exponent)),
                (Some(_), None) => {
                    pure(0, "the base of an exponent that varies", faults);
                    PURE
                }
            }
        }
        Operation::Exp
        | Operation::Ln
        | Operation::Log10
        | Operation::Tanh
        | Operation::Sin
        | Operation::Cos => {
            pure(0, function_word(operation), faults);
            PURE
        }
    }
}

/// Whether no variable is in a part.
fn is_constant(tree: &Tree, names: &Names) -> bool {
    let mut constant = true;
    tree.visit(&mut |part| {
        if let Kind::Name(name) = &part.kind {
            constant &= names.variable(name).is_none();
        }
    });
    constant
}

fn function_word(operation: Operation) -> &'static str {
    match operation {
        Operation::Exp => "exp",
        Operation::Ln => "ln",
        Operation::Log10 => "log10",
        Operation::Tanh => "tanh",
        Operation::Sin => "sin",
        _ => "cos",
    }
}

fn powers(dimension: Dimension) -> Powers {
    Some(dimension.0.map(f64::from))
}

fn combine(a: Powers, b: Powers, join: impl Fn(f64, f64) -> f64) -> Powers {
    let (a, b) = (a?, b?);
    Some(std::array::from_fn(|k| join(a[k], b[k])))
}

fn same(a: Powers, b: Powers) -> bool {
    match (a, b) {
        // Exponents are sums of a few products of written numbers: rounding stays far below this.
        (Some(a), Some(b)) => a.iter().zip(&b).all(|(x, y)| (x - y).abs() < 1e-9),
        _ => true,
    }
}

fn words(powers: Powers) -> String {
    let Some(powers) = powers else { return "a bare number".to_string() };
    if powers.iter().all(|k| (k - k.round()).abs() < 1e-9 && k.abs() < 120.0) {
        return Dimension(powers.map(|k| k.round() as i8)).to_string();
    }
    let units = ["m", "kg", "s", "K", "mol"];
    let parts: Vec<String> =
        units.iter().zip(powers).filter(|(_, k)| *k != 0.0).map(|(unit, k)| format!("{unit}^{k}")).collect();
    parts.join(" ")
}
