//! Formulas of an SBML file, and their values.

/// A formula. Sums and products may have any number of parts.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Math {
    Number(f64),
    Symbol(String),
    Apply(Operation, Vec<Math>),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Operation {
    Add,
    Subtract,
    Negate,
    Multiply,
    Divide,
    Power,
    Exp,
    Ln,
    Log10,
    Sqrt,
    Abs,
    Floor,
    Ceiling,
    Factorial,
    Sin,
    Cos,
    Tanh,
    Arcsin,
    Arccos,
    Arctan,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    Unequal,
    And,
    Or,
    Not,
    Min,
    Max,
    /// Condition, value if it holds, value if not.
    If,
    /// A function the file defines.
    Call(String),
}

/// Formulas with more parts than this are refused: functions that call functions can grow without bound.
pub(super) const LARGEST: usize = 20_000;

impl Math {
    pub fn apply(operation: Operation, arguments: Vec<Math>) -> Math {
        Math::Apply(operation, arguments)
    }

    pub fn two(operation: Operation, a: Math, b: Math) -> Math {
        Math::Apply(operation, vec![a, b])
    }

    pub fn negative(self) -> Math {
        match self {
            Math::Number(value) => Math::Number(-value),
            Math::Apply(Operation::Negate, mut inner) if inner.len() == 1 => inner.remove(0),
            other => Math::Apply(Operation::Negate, vec![other]),
        }
    }

    /// Number of parts.
    pub fn size(&self) -> usize {
        match self {
            Math::Apply(_, arguments) => 1 + arguments.iter().map(Math::size).sum::<usize>(),
            _ => 1,
        }
    }

    /// Calls `see` with every symbol, each as often as it stands there.
    pub fn symbols<'a>(&'a self, see: &mut impl FnMut(&'a str)) {
        match self {
            Math::Number(_) => {}
            Math::Symbol(name) => see(name),
            Math::Apply(_, arguments) => arguments.iter().for_each(|a| a.symbols(see)),
        }
    }

    /// Whether some symbol fulfils a condition.
    pub fn mentions(&self, which: &impl Fn(&str) -> bool) -> bool {
        match self {
            Math::Number(_) => false,
            Math::Symbol(name) => which(name),
            Math::Apply(_, arguments) => arguments.iter().any(|a| a.mentions(which)),
        }
    }

    /// The formula with symbols replaced where `other` has something else for them.
    pub fn replaced(&self, other: &impl Fn(&str) -> Option<Math>) -> Math {
        match self {
            Math::Number(value) => Math::Number(*value),
            Math::Symbol(name) => other(name).unwrap_or_else(|| self.clone()),
            Math::Apply(operation, arguments) => {
                Math::Apply(operation.clone(), arguments.iter().map(|a| a.replaced(other)).collect())
            }
        }
    }

    /// The value, with that of every symbol given; `None` if one has none, or a function is still to be
    /// put in. May be infinite or NaN.
    pub fn value(&self, of: &mut impl FnMut(&str) -> Option<f64>) -> Option<f64> {
        match self {
            Math::Number(value) => Some(*value),
            Math::Symbol(name) => of(name),
            Math::Apply(operation, arguments) => {
                let mut values = Vec::with_capacity(arguments.len());
                for argument in arguments {
                    values.push(argument.value(of)?);
                }
                evaluate(operation, &values)
            }
        }
    }
}

fn evaluate(operation: &Operation, values: &[f64]) -> Option<f64> {
    let truth = |condition: bool| if condition { 1.0 } else { 0.0 };
    let a = values.first().copied();
    let b = values.get(1).copied();
    Some(match operation {
        Operation::Add => values.iter().sum(),
        Operation::Multiply => values.iter().product(),
        Operation::Subtract => a? - b?,
        Operation::Negate => -a?,
        Operation::Divide => a? / b?,
        Operation::Power => a?.powf(b?),
        Operation::Exp => a?.exp(),
        Operation::Ln => a?.ln(),
        Operation::Log10 => a?.log10(),
        Operation::Sqrt => a?.sqrt(),
        Operation::Abs => a?.abs(),
        Operation::Floor => a?.floor(),
        Operation::Ceiling => a?.ceil(),
        Operation::Factorial => factorial(a?)?,
        Operation::Sin => a?.sin(),
        Operation::Cos => a?.cos(),
        Operation::Tanh => a?.tanh(),
        Operation::Arcsin => a?.asin(),
        Operation::Arccos => a?.acos(),
        Operation::Arctan => a?.atan(),
        Operation::Less => truth(a? < b?),
        Operation::LessOrEqual => truth(a? <= b?),
        Operation::Greater => truth(a? > b?),
        Operation::GreaterOrEqual => truth(a? >= b?),
        Operation::Equal => truth(a? == b?),
        Operation::Unequal => truth(a? != b?),
        Operation::And => truth(values.iter().all(|v| *v != 0.0)),
        Operation::Or => truth(values.iter().any(|v| *v != 0.0)),
        Operation::Not => truth(a? == 0.0),
        Operation::Min => values.iter().copied().reduce(f64::min)?,
        Operation::Max => values.iter().copied().reduce(f64::max)?,
        Operation::If => {
            if a? != 0.0 {
                b?
            } else {
                *values.get(2)?
            }
        }
        Operation::Call(_) => return None,
    })
}

fn factorial(n: f64) -> Option<f64> {
    // 171! is beyond double precision.
    (n >= 0.0 && n.fract() == 0.0 && n <= 170.0).then(|| (1..=n as u32).map(f64::from).product())
}
