//! The compiled form: a flat program for a small stack.

/// What a part of an expression does with its arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Operation {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Negate,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    Unequal,
    Min,
    Max,
    Exp,
    Ln,
    Log10,
    Sqrt,
    Abs,
    Tanh,
    Sin,
    Cos,
    /// 0 below zero, 1 from zero on.
    Step,
    /// The second argument where the first is not zero, else the third.
    If,
}

impl Operation {
    pub(super) fn arguments(self) -> usize {
        match self {
            Operation::If => 3,
            Operation::Negate
            | Operation::Exp
            | Operation::Ln
            | Operation::Log10
            | Operation::Sqrt
            | Operation::Abs
            | Operation::Tanh
            | Operation::Sin
            | Operation::Cos
            | Operation::Step => 1,
            _ => 2,
        }
    }

    /// The value for one, two or three arguments; the unused ones are ignored.
    #[inline]
    fn value(self, a: f64, b: f64, c: f64) -> f64 {
        let truth = |condition: bool| if condition { 1.0 } else { 0.0 };
        match self {
            Operation::Add => a + b,
            Operation::Subtract => a - b,
            Operation::Multiply => a * b,
            Operation::Divide => a / b,
            Operation::Power => a.powf(b),
            Operation::Negate => -a,
            Operation::Less => truth(a < b),
            Operation::LessOrEqual => truth(a <= b),
            Operation::Greater => truth(a > b),
            Operation::GreaterOrEqual => truth(a >= b),
            Operation::Equal => truth(a == b),
            Operation::Unequal => truth(a != b),
            Operation::Min => a.min(b),
            Operation::Max => a.max(b),
            Operation::Exp => a.exp(),
            Operation::Ln => a.ln(),
            Operation::Log10 => a.log10(),
            Operation::Sqrt => a.sqrt(),
            Operation::Abs => a.abs(),
            Operation::Tanh => a.tanh(),
            Operation::Sin => a.sin(),
            Operation::Cos => a.cos(),
            Operation::Step => truth(a >= 0.0),
            Operation::If => {
                if a != 0.0 {
                    b
                } else {
                    c
                }
            }
        }
    }
}

/// One step of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Step {
    Constant(f64),
    Variable(u32),
    /// A whole power: exact for the squares and cubes of laws, and faster than `powf`.
    WholePower(i32),
    Apply(Operation),
}

/// Values the stack holds; expressions that need more are refused when compiled.
pub(super) const STACK: usize = 16;

/// A compiled expression: a stack program over numbered variables.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    steps: Vec<Step>,
    /// As it was written.
    text: String,
}

impl Program {
    /// A program that always gives this value.
    #[must_use]
    pub fn constant_of(value: f64) -> Program {
        Program { steps: vec![Step::Constant(value)], text: value.to_string() }
    }

    /// The program of these steps, or the depth it would need if that is too deep.
    pub(super) fn new(steps: Vec<Step>, text: &str) -> Result<Program, usize> {
        let (mut depth, mut deepest) = (0_usize, 0);
        for step in &steps {
            match step {
                Step::Constant(_) | Step::Variable(_) => depth += 1,
                Step::WholePower(_) => {}
                Step::Apply(operation) => depth -= operation.arguments() - 1,
            }
            deepest = deepest.max(depth);
        }
        if deepest <= STACK { Ok(Program { steps, text: text.to_string() }) } else { Err(deepest) }
    }

    /// Its value; `variables` holds one value for each variable it was compiled for.
    ///
    /// Does not allocate. Both branches of an `if` are computed, the unused one without effect.
    #[inline]
    #[must_use]
    pub fn eval(&self, variables: &[f64]) -> f64 {
        let mut stack = [0.0; STACK];
        run(&self.steps, variables, &mut stack)
    }

    /// The expression as it was written, for messages.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Indices of the variables it uses, rising, each once.
    #[must_use]
    pub fn uses(&self) -> Vec<usize> {
        let mut used: Vec<usize> = self
            .steps
            .iter()
            .filter_map(|step| if let Step::Variable(index) = step { Some(*index as usize) } else { None })
            .collect();
        used.sort_unstable();
        used.dedup();
        used
    }

    /// The value, if it depends on no variable.
    #[must_use]
    pub fn constant(&self) -> Option<f64> {
        if let [Step::Constant(value)] = self.steps[..] { Some(value) } else { None }
    }
}

/// Runs steps that are known to fit the stack.
pub(super) fn run(steps: &[Step], variables: &[f64], stack: &mut [f64; STACK]) -> f64 {
    let mut top = 0;
    for step in steps {
        match *step {
            Step::Constant(value) => {
                stack[top] = value;
                top += 1;
            }
            Step::Variable(index) => {
                stack[top] = variables[index as usize];
                top += 1;
            }
            Step::WholePower(power) => stack[top - 1] = stack[top - 1].powi(power),
            Step::Apply(operation) => {
                let count = operation.arguments();
                top -= count;
                let b = if count > 1 { stack[top + 1] } else { 0.0 };
                let c = if count > 2 { stack[top + 2] } else { 0.0 };
                stack[top] = operation.value(stack[top], b, c);
                top += 1;
            }
        }
    }
    stack[0]
}
