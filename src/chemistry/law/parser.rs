//! Tokens -> tree, by recursive descent.

use super::lexer::{Symbol, Token, UnitWord, tokens};
use super::program::Operation;
use crate::quantity::{Quantity, TextFault, did_you_mean};

/// A part of an expression and its place in characters.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    pub kind: Kind,
    pub offset: usize,
    pub width: usize,
}

#[derive(Clone, Debug)]
pub(super) enum Kind {
    Number(Quantity, Vec<UnitWord>),
    Name(String),
    Apply(Operation, Vec<Tree>),
}

impl Tree {
    /// Calls `see` on every part, outer ones first.
    pub fn visit<'a>(&'a self, see: &mut impl FnMut(&'a Tree)) {
        see(self);
        if let Kind::Apply(_, arguments) = &self.kind {
            for argument in arguments {
                argument.visit(see);
            }
        }
    }
}

/// A function as it is written.
pub(super) struct Function {
    pub name: &'static str,
    pub operation: Operation,
    pub arguments: usize,
}

const fn function(name: &'static str, operation: Operation, arguments: usize) -> Function {
    Function { name, operation, arguments }
}

pub(super) const FUNCTIONS: &[Function] = &[
    function("min", Operation::Min, 2),
    function("max", Operation::Max, 2),
    function("exp", Operation::Exp, 1),
    function("ln", Operation::Ln, 1),
    function("log10", Operation::Log10, 1),
    function("sqrt", Operation::Sqrt, 1),
    function("abs", Operation::Abs, 1),
    function("tanh", Operation::Tanh, 1),
    function("sin", Operation::Sin, 1),
    function("cos", Operation::Cos, 1),
    function("pow", Operation::Power, 2),
    function("step", Operation::Step, 1),
    function("heaviside", Operation::Step, 1),
    function("if", Operation::If, 3),
];

/// Nesting beyond this is refused; laws of the field nest less than ten deep.
const DEEPEST: usize = 60;

/// Longer chains of operators are refused, so that walking the tree stays within the thread's stack.
const LONGEST: usize = 1000;

pub(super) fn parse(text: &str) -> Result<Tree, TextFault> {
    let tokens = tokens(text)?;
    let end = text.chars().count();
    if tokens.is_empty() {
        return Err(TextFault::new(0, end, "the expression is empty", "write e.g. \"vmax * S / (km + S)\""));
    }
    if tokens.len() > LONGEST {
        let reason = format!("the expression has {} parts, at most {LONGEST} are read", tokens.len());
        return Err(TextFault::new(0, end, reason, "split it into parameters"));
    }
    let mut parser = Parser { tokens, at: 0, end, depth: 0 };
    let tree = parser.comparison()?;
    match parser.tokens.get(parser.at) {
        None => Ok(tree),
        Some(token) => Err(match &token.symbol {
            Symbol::Close => TextFault::new(
                token.offset,
                1,
                "this parenthesis was never opened",
                "remove it, or open it before",
            ),
            Symbol::Comma => {
                TextFault::new(token.offset, 1, "a comma outside a function", "decimals have a point")
            }
            _ => TextFault::new(
                token.offset,
                token.width,
                "an operator is missing before this",
                "write * for products",
            ),
        }),
    }
}

struct Parser {
    tokens: Vec<Token>,
    at: usize,
    /// Length of the text, characters.
    end: usize,
    depth: usize,
}

impl Parser {
    fn operator(&self, among: &[(&str, Operation)]) -> Option<Operation> {
        match self.tokens.get(self.at)?.symbol {
            Symbol::Operator(found) => among.iter().find(|(text, _)| *text == found).map(|&(_, op)| op),
            _ => None,
        }
    }

    fn next_is(&mut self, symbol: &Symbol) -> bool {
        let found = self.tokens.get(self.at).is_some_and(|token| token.symbol == *symbol);
        self.at += usize::from(found);
        found
    }

    fn deeper(&mut self) -> Result<(), TextFault> {
        self.depth += 1;
        if self.depth <= DEEPEST {
            return Ok(());
        }
        let offset = self.tokens.get(self.at).map_or(0, |token| token.offset);
        Err(TextFault::new(offset, 1, "the expression nests too deep", "split it into parameters"))
    }

    fn comparison(&mut self) -> Result<Tree, TextFault> {
        const AMONG: &[(&str, Operation)] = &[
            ("<", Operation::Less),
            ("<=", Operation::LessOrEqual),
            (">", Operation::Greater),
            (">=", Operation::GreaterOrEqual),
            ("==", Operation::Equal),
            ("!=", Operation::Unequal),
        ];
        self.deeper()?;
        let mut left = self.sum()?;
        if let Some(operation) = self.operator(AMONG) {
            self.at += 1;
            left = join(operation, left, self.sum()?);
            if self.operator(AMONG).is_some() {
                let token = &self.tokens[self.at];
                let reason = "comparisons do not chain";
                return Err(TextFault::new(token.offset, token.width, reason, "write (a < b) * (b < c)"));
            }
        }
        self.depth -= 1;
        Ok(left)
    }

    fn sum(&mut self) -> Result<Tree, TextFault> {
        let mut left = self.product()?;
        while let Some(operation) = self.operator(&[("+", Operation::Add), ("-", Operation::Subtract)]) {
            self.at += 1;
            left = join(operation, left, self.product()?);
        }
        Ok(left)
    }

    fn product(&mut self) -> Result<Tree, TextFault> {
        let mut left = self.unary()?;
        while let Some(operation) = self.operator(&[("*", Operation::Multiply), ("/", Operation::Divide)]) {
            self.at += 1;
            left = join(operation, left, self.unary()?);
        }
        Ok(left)
    }

    fn unary(&mut self) -> Result<Tree, TextFault> {
        let Some(sign) = self.operator(&[("-", Operation::Negate), ("+", Operation::Abs)]) else {
            return self.power();
        };
        let offset = self.tokens[self.at].offset;
        self.at += 1;
        self.deeper()?;
        let inner = self.unary()?;
        self.depth -= 1;
        if sign != Operation::Negate {
            return Ok(inner);
        }
        let width = inner.offset + inner.width - offset;
        Ok(Tree { kind: Kind::Apply(Operation::Negate, vec![inner]), offset, width })
    }

    fn power(&mut self) -> Result<Tree, TextFault> {
        let base = self.atom()?;
        if self.operator(&[("^", Operation::Power)]).is_none() {
            return Ok(base);
        }
        self.at += 1;
        self.deeper()?;
        let exponent = self.unary()?;
        self.depth -= 1;
        Ok(join(Operation::Power, base, exponent))
    }

    fn atom(&mut self) -> Result<Tree, TextFault> {
        let Some(token) = self.tokens.get(self.at).cloned() else {
            let reason = "the expression ends where a value is expected";
            let remedy = "add a number, a name or a parenthesis";
            return Err(TextFault::new(self.end.saturating_sub(1), 1, reason, remedy));
        };
        self.at += 1;
        let Token { symbol, offset, width } = token;
        match symbol {
            Symbol::Number(quantity, words) => {
                Ok(Tree { kind: Kind::Number(quantity, words), offset, width })
            }
            Symbol::Name(name) if self.next_is(&Symbol::Open) => self.call(&name, offset, width),
            Symbol::Name(name) if FUNCTIONS.iter().any(|f| f.name == name) => Err(TextFault::new(
                offset,
                width,
                format!("{name} is a function"),
                format!("write {name}(…)"),
            )),
            Symbol::Name(name) => Ok(Tree { kind: Kind::Name(name), offset, width }),
            Symbol::Open => {
                let mut inner = self.comparison()?;
                let end = self.close(offset)?;
                (inner.offset, inner.width) = (offset, end - offset);
                Ok(inner)
            }
            Symbol::Operator(_) | Symbol::Close | Symbol::Comma => {
                let reason = "expected a number, a name or a parenthesis";
                Err(TextFault::new(offset, width, reason, "add it before this"))
            }
        }
    }

    /// The closing parenthesis of the one at `open`; gives where it ends.
    fn close(&mut self, open: usize) -> Result<usize, TextFault> {
        match self.tokens.get(self.at) {
            Some(token) if token.symbol == Symbol::Close => {
                self.at += 1;
                Ok(token.offset + 1)
            }
            Some(token) => {
                let reason = "expected an operator or \")\"";
                Err(TextFault::new(token.offset, token.width, reason, "write * for products"))
            }
            None => Err(TextFault::new(open, 1, "this parenthesis is not closed", "add \")\"")),
        }
    }

    fn call(&mut self, name: &str, offset: usize, width: usize) -> Result<Tree, TextFault> {
        let Some(function) = FUNCTIONS.iter().find(|f| f.name == name) else {
            let near = match name {
                "log" => "did you mean \"ln\" (base e) or \"log10\"?".to_string(),
                _ => did_you_mean(name, FUNCTIONS.iter().map(|f| f.name)),
            };
            let known: Vec<&str> = FUNCTIONS.iter().map(|f| f.name).collect();
            let remedy = if near.is_empty() { format!("functions are {}", known.join(", ")) } else { near };
            return Err(TextFault::new(offset, width, format!("unknown function \"{name}\""), remedy));
        };
        let mut arguments = Vec::new();
        if self.tokens.get(self.at).is_none_or(|token| token.symbol != Symbol::Close) {
            arguments.push(self.comparison()?);
            while self.next_is(&Symbol::Comma) {
                arguments.push(self.comparison()?);
            }
        }
        let end = self.close(offset + width)?;
        // min and max take any number of values.
        let many = matches!(function.operation, Operation::Min | Operation::Max) && arguments.len() > 2;
        if arguments.len() != function.arguments && !many {
            let (wanted, found) = (function.arguments, arguments.len());
            let reason =
                format!("{name} takes {wanted} value{}, found {found}", if wanted == 1 { "" } else { "s" });
            return Err(TextFault::new(offset, end - offset, reason, ""));
        }
        if many {
            let folded = arguments.into_iter().reduce(|a, b| join(function.operation, a, b));
            return folded.ok_or_else(|| TextFault::new(offset, width, "a value is missing", ""));
        }
        Ok(Tree { kind: Kind::Apply(function.operation, arguments), offset, width: end - offset })
    }
}

fn join(operation: Operation, left: Tree, right: Tree) -> Tree {
    let (offset, end) = (left.offset, right.offset + right.width);
    Tree { kind: Kind::Apply(operation, vec![left, right]), offset, width: end - offset }
}
