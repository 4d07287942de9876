//! MathML -> [`Math`]. Forms that are shorthand (`sec`, `root`, `implies`, …) are written out here.

use super::log::{Log, Spot};
use super::math::{Math, Operation};
use crate::chemistry::AVOGADRO;
use roxmltree::Node;

/// Deeper formulas are refused, so that walking them stays within the thread's stack.
const DEEPEST: usize = 200;

/// Reads the `<math>` inside an element; a fault if there is none.
pub(super) fn of(parent: Node, log: &mut Log) -> Option<Math> {
    let Some(math) = parent.children().find(|n| n.has_tag_name_local("math")) else {
        log.fault(Spot::of(parent), "there is no <math> in here", "add the formula in MathML");
        return None;
    };
    read(content(math, log)?, log, 0)
}

/// Reads a `<lambda>`: names of the arguments, and the body.
pub(super) fn lambda(parent: Node, log: &mut Log) -> Option<(Vec<String>, Math)> {
    let found = parent.descendants().find(|n| n.has_tag_name_local("lambda"));
    let Some(lambda) = found else {
        log.fault(Spot::of(parent), "a function definition without <lambda>", "add it in MathML");
        return None;
    };
    let arguments = elements(lambda).filter(|n| n.has_tag_name_local("bvar"));
    let names = arguments.filter_map(|bvar| elements(bvar).next()).map(words).collect();
    let Some(body) = elements(lambda).find(|n| !n.has_tag_name_local("bvar")) else {
        log.fault(Spot::of(lambda), "a function without a body", "add its formula");
        return None;
    };
    Some((names, read(body, log, 0)?))
}

/// Comparison of names without their namespace: files give MathML with and without a prefix.
pub(super) trait LocalName {
    fn has_tag_name_local(&self, name: &str) -> bool;
}

impl LocalName for Node<'_, '_> {
    fn has_tag_name_local(&self, name: &str) -> bool {
        self.is_element() && self.tag_name().name() == name
    }
}

fn elements<'a, 'i>(node: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(Node::is_element)
}

fn words(node: Node) -> String {
    node.text().unwrap_or("").trim().to_string()
}

/// The one formula inside `<math>` or `<semantics>`.
fn content<'a, 'i>(math: Node<'a, 'i>, log: &mut Log) -> Option<Node<'a, 'i>> {
    let first = elements(math).next();
    if first.is_none() {
        log.fault(Spot::of(math), "an empty formula", "add its content in MathML");
    }
    first
}

fn read(node: Node, log: &mut Log, depth: usize) -> Option<Math> {
    if depth > DEEPEST {
        log.fault(Spot::of(node), "this formula nests too deep", "split it into parameters with rules");
        return None;
    }
    match node.tag_name().name() {
        "cn" => number(node, log),
        "ci" => Some(Math::Symbol(words(node))),
        "csymbol" => csymbol(node, log),
        "pi" => Some(Math::Number(std::f64::consts::PI)),
        "exponentiale" => Some(Math::Number(std::f64::consts::E)),
        "true" => Some(Math::Number(1.0)),
        "false" => Some(Math::Number(0.0)),
        "semantics" => read(content(node, log)?, log, depth + 1),
        "piecewise" => piecewise(node, log, depth),
        "apply" => application(node, log, depth),
        other => {
            let remedy = "write the formula with numbers, names and the operators of SBML";
            log.fault(Spot::of(node), format!("<{other}> cannot be part of a formula here"), remedy);
            None
        }
    }
}

fn number(node: Node, log: &mut Log) -> Option<Math> {
    let parts: Vec<&str> =
        node.children().filter_map(|n| if n.is_text() { n.text() } else { None }).collect();
    let part = |k: usize| parts.get(k).and_then(|text| text.trim().parse::<f64>().ok());
    let value = match node.attribute("type") {
        // Through the text, so that 1 and -6 give the double nearest to 1e-6.
        Some("e-notation") => {
            (|| format!("{}e{}", parts.first()?.trim(), parts.get(1)?.trim()).parse::<f64>().ok())()
        }
        Some("rational") => part(0).zip(part(1)).map(|(a, b)| a / b),
        _ => part(0),
    };
    match value.filter(|v| v.is_finite()) {
        Some(value) => Some(Math::Number(value)),
        None => {
            let shown = parts.join(" ");
            log.fault(Spot::of(node), format!("\"{}\" is not a finite number", shown.trim()), "correct it");
            None
        }
    }
}

fn csymbol(node: Node, log: &mut Log) -> Option<Math> {
    let url = node.attribute("definitionURL").unwrap_or("");
    let what = url.rsplit('/').next().unwrap_or("").trim();
    let (reason, remedy) = match what {
        "avogadro" => return Some(Math::Number(AVOGADRO)),
        "time" => (
            "a formula that depends on the time is not supported".to_string(),
            "rates here depend on amounts alone: put in the value that holds for the stretch of time you study",
        ),
        "delay" => (
            "a delay is not supported".to_string(),
            "write the delayed step as a chain of reactions with the same mean time",
        ),
        "rateOf" => ("a rate of change in a formula is not supported".to_string(), "write the rate out"),
        _ => (format!("unknown symbol \"{url}\""), "only avogadro is supported"),
    };
    log.fault(Spot::of(node), reason, remedy);
    None
}

fn piecewise(node: Node, log: &mut Log, depth: usize) -> Option<Math> {
    let mut pieces = Vec::new();
    let mut otherwise = None;
    for part in elements(node) {
        let values: Vec<Math> = elements(part).map_while(|n| read(n, log, depth + 1)).collect();
        match (part.tag_name().name(), <[Math; 2]>::try_from(values.clone())) {
            ("piece", Ok([value, condition])) => pieces.push((value, condition)),
            ("otherwise", Err(_)) if values.len() == 1 => otherwise = values.into_iter().next(),
            _ => {
                if log.faults.is_empty() {
                    log.fault(Spot::of(part), "a piece has a value and a condition", "correct it");
                }
                return None;
            }
        }
    }
    let Some(last) = otherwise else {
        log.fault(Spot::of(node), "a piecewise formula without <otherwise>", "say what holds elsewhere");
        return None;
    };
    Some(
        pieces
            .into_iter()
            .rev()
            .fold(last, |rest, (value, condition)| Math::apply(Operation::If, vec![condition, value, rest])),
    )
}

fn application(node: Node, log: &mut Log, depth: usize) -> Option<Math> {
    let mut parts = elements(node);
    let Some(head) = parts.next() else {
        log.fault(Spot::of(node), "an empty <apply>", "add an operator and its arguments");
        return None;
    };
    let mut qualifier = None;
    let mut arguments = Vec::new();
    for part in parts {
        if matches!(part.tag_name().name(), "degree" | "logbase") {
            qualifier = Some(read(content(part, log)?, log, depth + 1)?);
        } else {
            arguments.push(read(part, log, depth + 1)?);
        }
    }
    let name = head.tag_name().name();
    if name == "ci" {
        return Some(Math::apply(Operation::Call(words(head)), arguments));
    }
    if name == "csymbol" {
        return csymbol(head, log);
    }
    let count = arguments.len();
    let built = build(name, arguments, qualifier);
    if built.is_none() {
        let (reason, remedy) = if known(name) {
            (format!("<{name}> cannot have {count} arguments"), "correct the formula")
        } else {
            (
                format!("the function <{name}> is not supported"),
                "write it with exp, ln, powers and sin or cos",
            )
        };
        log.fault(Spot::of(head), reason, remedy);
    }
    built
}

fn known(name: &str) -> bool {
    let two = vec![Math::Number(1.0), Math::Number(1.0)];
    build(name, two.clone(), None).is_some() || build(name, two[..1].to_vec(), None).is_some()
}

fn build(name: &str, mut arguments: Vec<Math>, qualifier: Option<Math>) -> Option<Math> {
    use Operation as Op;
    let many = match name {
        "plus" => Some((Op::Add, 0.0)),
        "times" => Some((Op::Multiply, 1.0)),
        "and" => Some((Op::And, 1.0)),
        "or" => Some((Op::Or, 0.0)),
        _ => None,
    };
    if let Some((operation, empty)) = many {
        return match arguments.len() {
            0 => Some(Math::Number(empty)),
            1 => arguments.pop(),
            _ => Some(Math::apply(operation, arguments)),
        };
    }
    if let "min" | "max" = name {
        let operation = if name == "min" { Op::Min } else { Op::Max };
        return (!arguments.is_empty()).then(|| Math::apply(operation, arguments));
    }
    let comparison = match name {
        "lt" => Some(Op::Less),
        "leq" => Some(Op::LessOrEqual),
        "gt" => Some(Op::Greater),
        "geq" => Some(Op::GreaterOrEqual),
        "eq" => Some(Op::Equal),
        "neq" => Some(Op::Unequal),
        _ => None,
    };
    if let Some(operation) = comparison {
        let mut links: Vec<Math> =
            arguments.windows(2).map(|pair| Math::apply(operation.clone(), pair.to_vec())).collect();
        return if links.len() > 1 { Some(Math::apply(Op::And, links)) } else { links.pop() };
    }
    let one = |operation: Op, a: Math| Math::apply(operation, vec![a]);
    if arguments.len() == 2 {
        let (b, a) = (arguments.pop()?, arguments.pop()?);
        let operation = match name {
            "minus" => Op::Subtract,
            "divide" => Op::Divide,
            "power" => Op::Power,
            "xor" => Op::Unequal,
            "implies" => return Some(Math::two(Op::Or, one(Op::Not, a), b)),
            "quotient" => return Some(one(Op::Floor, Math::two(Op::Divide, a, b))),
            "rem" => {
                let whole = one(Op::Floor, Math::two(Op::Divide, a.clone(), b.clone()));
                return Some(Math::two(Op::Subtract, a, Math::two(Op::Multiply, b, whole)));
            }
            _ => return None,
        };
        return Some(Math::two(operation, a, b));
    }
    if arguments.len() != 1 {
        return None;
    }
    let a = arguments.pop()?;
    let inverse = |x: Math| Math::two(Op::Divide, Math::Number(1.0), x);
    let over = |x: Math, y: Math| Math::two(Op::Divide, x, y);
    let (up, down) = (one(Op::Exp, a.clone()), one(Op::Exp, a.clone().negative()));
    let (sine, cosine) = (one(Op::Sin, a.clone()), one(Op::Cos, a.clone()));
    let half = |x: Math| Math::two(Op::Divide, x, Math::Number(2.0));
    Some(match name {
        "minus" => a.negative(),
        "exp" => up,
        "ln" => one(Op::Ln, a),
        "log" => match qualifier {
            None => one(Op::Log10, a),
            Some(Math::Number(10.0)) => one(Op::Log10, a),
            Some(base) => over(one(Op::Ln, a), one(Op::Ln, base)),
        },
        "root" => match qualifier {
            None => one(Op::Sqrt, a),
            Some(Math::Number(2.0)) => one(Op::Sqrt, a),
            Some(degree) => Math::two(Op::Power, a, inverse(degree)),
        },
        "abs" => one(Op::Abs, a),
        "floor" => one(Op::Floor, a),
        "ceiling" => one(Op::Ceiling, a),
        "factorial" => one(Op::Factorial, a),
        "not" => one(Op::Not, a),
        "sin" => sine,
        "cos" => cosine,
        "tan" => over(sine, cosine),
        "sec" => inverse(cosine),
        "csc" => inverse(sine),
        "cot" => over(cosine, sine),
        "sinh" => half(Math::two(Op::Subtract, up, down)),
        "cosh" => half(Math::two(Op::Add, up, down)),
        "tanh" => one(Op::Tanh, a),
        "sech" => inverse(half(Math::two(Op::Add, up, down))),
        "csch" => inverse(half(Math::two(Op::Subtract, up, down))),
        "coth" => inverse(one(Op::Tanh, a)),
        "arcsin" => one(Op::Arcsin, a),
        "arccos" => one(Op::Arccos, a),
        "arctan" => one(Op::Arctan, a),
        _ => return None,
    })
}
