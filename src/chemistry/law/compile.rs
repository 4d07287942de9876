//! Tree -> program: names are resolved, constant parts are folded.

use super::parser::{Kind, Tree};
use super::program::{Operation, Program, STACK, Step, run};
use crate::quantity::{Dimension, Quantity, TextFault, did_you_mean};

/// The names an expression may use.
pub(super) struct Names<'a> {
    pub variables: &'a [(&'a str, Dimension)],
    pub constants: &'a [(String, Quantity)],
}

impl Names<'_> {
    pub fn variable(&self, name: &str) -> Option<usize> {
        self.variables.iter().position(|(n, _)| *n == name)
    }

    pub fn constant(&self, name: &str) -> Option<Quantity> {
        let declared = self.constants.iter().find(|(n, _)| n == name).map(|(_, quantity)| *quantity);
        declared.or_else(|| (name == "pi").then(|| Quantity::bare(std::f64::consts::PI)))
    }

    fn all(&self) -> impl Iterator<Item = &str> + Clone {
        self.variables
            .iter()
            .map(|(name, _)| *name)
            .chain(self.constants.iter().map(|(name, _)| name.as_str()))
    }
}

/// One fault for each unknown name, and for each unit that could as well be a name.
pub(super) fn names(tree: &Tree, names: &Names) -> Vec<TextFault> {
    let mut faults = Vec::new();
    tree.visit(&mut |part| match &part.kind {
        Kind::Name(name) if names.variable(name).is_none() && names.constant(name).is_none() => {
            let near = did_you_mean(name, names.all());
            let known: Vec<&str> = names.all().collect();
            let remedy = match (near.is_empty(), known.is_empty()) {
                (false, _) => near,
                (true, true) => "no parameters are declared here".to_string(),
                (true, false) => format!("known here: {}", known.join(", ")),
            };
            faults.push(TextFault::new(part.offset, part.width, format!("unknown name \"{name}\""), remedy));
        }
        Kind::Number(_, words) => {
            for word in words.iter().filter(|w| names.all().any(|name| name == w.word)) {
                let name = &word.word;
                faults.push(TextFault::new(
                    word.offset,
                    name.chars().count(),
                    format!("\"{name}\" may be the unit or the declared name"),
                    format!("write spaces round the operator, * {name} or / {name}, for the name"),
                ));
            }
        }
        _ => {}
    });
    faults
}

/// Compiles a tree whose names are known.
pub(super) fn program(tree: &Tree, names: &Names, text: &str) -> Result<Program, Vec<TextFault>> {
    let mut steps = Vec::new();
    emit(tree, names, &mut steps).map_err(|fault| vec![fault])?;
    Program::new(steps, text).map_err(|depth| {
        let reason = format!("the expression needs {depth} intermediate values, at most {STACK} are kept");
        vec![TextFault::new(tree.offset, tree.width, reason, "reorder it, or split it into parameters")]
    })
}

/// The value of a part that depends on constants only.
pub(super) fn constant_value(tree: &Tree, names: &Names) -> Option<f64> {
    let mut steps = Vec::new();
    emit(tree, names, &mut steps).ok()?;
    if let [Step::Constant(value)] = steps[..] { Some(value) } else { None }
}

fn emit(tree: &Tree, names: &Names, steps: &mut Vec<Step>) -> Result<(), TextFault> {
    match &tree.kind {
        Kind::Number(quantity, _) => steps.push(Step::Constant(quantity.value)),
        Kind::Name(name) => match (names.variable(name), names.constant(name)) {
            (Some(index), _) => steps.push(Step::Variable(index as u32)),
            (None, Some(quantity)) => steps.push(Step::Constant(quantity.value)),
            (None, None) => {
                return Err(TextFault::new(tree.offset, tree.width, format!("unknown name \"{name}\""), ""));
            }
        },
        Kind::Apply(operation, arguments) => {
            let start = steps.len();
            for argument in arguments {
                emit(argument, names, steps)?;
            }
            let constants = steps[start..].iter().all(|step| matches!(step, Step::Constant(_)))
                && steps.len() - start == operation.arguments();
            match steps.last() {
                Some(&Step::Constant(power))
                    if *operation == Operation::Power && power.fract() == 0.0 && power.abs() <= 16.0 =>
                {
                    steps.pop();
                    steps.push(Step::WholePower(power as i32));
                }
                _ => steps.push(Step::Apply(*operation)),
            }
            if constants {
                let value = run(&steps[start..], &[], &mut [0.0; STACK]);
                steps.truncate(start);
                if !value.is_finite() {
                    let reason = "this constant part is not a finite number";
                    return Err(TextFault::new(
                        tree.offset,
                        tree.width,
                        reason,
                        "look for a division by zero",
                    ));
                }
                steps.push(Step::Constant(value));
            }
        }
    }
    Ok(())
}
