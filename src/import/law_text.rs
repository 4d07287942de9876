//! Formulas as texts of this program's rate expressions.

use super::math::{Math, Operation};

/// A formula that the language of rate laws has no word for.
#[derive(Debug, PartialEq)]
pub(super) struct NoWord(pub &'static str);

/// How tightly a text holds together; looser ones get parentheses inside tighter ones.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Grip {
    Comparison,
    Sum,
    Product,
    Negative,
    Power,
    Atom,
}

/// Writes a formula; `symbol` gives a text for each symbol and whether it is a product.
pub(super) fn text(math: &Math, symbol: &impl Fn(&str) -> (String, bool)) -> Result<String, NoWord> {
    Ok(write(math, symbol)?.0)
}

/// A number as the reader of expressions takes it: digits with at most one exponent.
pub(super) fn number(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || (1e-3..1e6).contains(&size) { format!("{value}") } else { format!("{value:e}") }
}

/// Without the last digits where those are what the arithmetic of a unit left: 0.0010000000000000002 is 0.001.
pub(super) fn tidy(value: f64) -> f64 {
    const ROUNDED: f64 = 4e-15;
    let short = format!("{value:.13e}").parse().unwrap_or(value);
    let shorter = format!("{short:e}").len() + 3 < format!("{value:e}").len();
    if shorter && (short - value).abs() <= ROUNDED * value.abs() { short } else { value }
}

fn write(math: &Math, symbol: &impl Fn(&str) -> (String, bool)) -> Result<(String, Grip), NoWord> {
    use Operation as Op;
    let (operation, arguments) = match math {
        Math::Number(value) if *value < 0.0 => return Ok((number(*value), Grip::Negative)),
        Math::Number(value) => return Ok((number(*value), Grip::Atom)),
        Math::Symbol(name) => {
            let (text, product) = symbol(name);
            return Ok((text, if product { Grip::Product } else { Grip::Atom }));
        }
        Math::Apply(operation, arguments) => (operation, arguments.as_slice()),
    };
    let at_least = |part: &Math, grip: Grip| -> Result<String, NoWord> {
        let (text, found) = write(part, symbol)?;
        Ok(if found < grip { format!("({text})") } else { text })
    };
    let joined = |sign: &str, first: Grip, rest: Grip| -> Result<String, NoWord> {
        let mut text = String::new();
        for (k, part) in arguments.iter().enumerate() {
            if k > 0 {
                text.push_str(sign);
            }
            text.push_str(&at_least(part, if k == 0 { first } else { rest })?);
        }
        Ok(text)
    };
    let call = |name: &str| -> Result<(String, Grip), NoWord> {
        let inner: Result<Vec<String>, NoWord> = arguments.iter().map(|a| Ok(write(a, symbol)?.0)).collect();
        Ok((format!("{name}({})", inner?.join(", ")), Grip::Atom))
    };
    let compared = |sign: &str| Ok((joined(sign, Grip::Sum, Grip::Sum)?, Grip::Comparison));
    match operation {
        Op::Add => Ok((joined(" + ", Grip::Sum, Grip::Product)?, Grip::Sum)),
        Op::Subtract => Ok((joined(" - ", Grip::Sum, Grip::Product)?, Grip::Sum)),
        Op::Multiply => Ok((joined(" * ", Grip::Product, Grip::Product)?, Grip::Product)),
        Op::Divide => Ok((joined(" / ", Grip::Product, Grip::Negative)?, Grip::Product)),
        Op::Power => Ok((joined("^", Grip::Atom, Grip::Power)?, Grip::Power)),
        Op::Negate => Ok((format!("-{}", joined("", Grip::Power, Grip::Power)?), Grip::Negative)),
        Op::Less => compared(" < "),
        Op::LessOrEqual => compared(" <= "),
        Op::Greater => compared(" > "),
        Op::GreaterOrEqual => compared(" >= "),
        Op::Equal => compared(" == "),
        Op::Unequal => compared(" != "),
        // Truth is 1 or 0.
        Op::And => Ok((joined(" * ", Grip::Power, Grip::Power)?, Grip::Product)),
        Op::Or => call("max"),
        Op::Not => Ok((format!("1 - {}", joined("", Grip::Product, Grip::Product)?), Grip::Sum)),
        Op::If => call("if"),
        Op::Min | Op::Max if arguments.len() == 1 => write(&arguments[0], symbol),
        Op::Min => call("min"),
        Op::Max => call("max"),
        Op::Exp => call("exp"),
        Op::Ln => call("ln"),
        Op::Log10 => call("log10"),
        Op::Sqrt => call("sqrt"),
        Op::Abs => call("abs"),
        Op::Sin => call("sin"),
        Op::Cos => call("cos"),
        Op::Tanh => call("tanh"),
        Op::Floor => Err(NoWord("floor")),
        Op::Ceiling => Err(NoWord("ceiling")),
        Op::Factorial => Err(NoWord("factorial")),
        Op::Arcsin => Err(NoWord("arcsin")),
        Op::Arccos => Err(NoWord("arccos")),
        Op::Arctan => Err(NoWord("arctan")),
        Op::Call(_) => Err(NoWord("a function of the file")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn symbol(name: &str) -> Math {
        Math::Symbol(name.to_string())
    }

    fn plain(math: &Math) -> String {
        text(math, &|name| (name.to_string(), false)).unwrap()
    }

    #[test]
    fn parentheses_stand_where_they_are_needed() {
        use Operation::{Add, Divide, Multiply, Power, Subtract};
        let (a, b, c) = (symbol("a"), symbol("b"), symbol("c"));
        let sum = Math::two(Add, a.clone(), b.clone());
        assert_eq!(plain(&Math::two(Multiply, sum.clone(), c.clone())), "(a + b) * c");
        assert_eq!(plain(&Math::two(Subtract, c.clone(), sum.clone())), "c - (a + b)");
        let product = Math::two(Multiply, a.clone(), b.clone());
        assert_eq!(plain(&Math::two(Divide, c.clone(), product.clone())), "c / (a * b)");
        assert_eq!(plain(&Math::two(Divide, product, c.clone())), "a * b / c");
        let power = Math::two(Power, a.clone(), b.clone());
        assert_eq!(plain(&Math::two(Power, power, c.clone())), "(a^b)^c");
        assert_eq!(plain(&Math::two(Power, Math::Number(-2.0), c.clone())), "(-2)^c");
        assert_eq!(plain(&sum.negative()), "-(a + b)");
        let scaled = |name: &str| (format!("0.001 * {name}"), true);
        assert_eq!(text(&Math::two(Power, a, Math::Number(2.0)), &scaled).unwrap(), "(0.001 * a)^2");
    }

    #[test]
    fn numbers_lose_no_digit() {
        for value in [0.1 + 0.2, 1e-7, 6.022_140_76e23, 12_345.678, 1.0 / 3.0] {
            assert_eq!(number(value).parse::<f64>().unwrap(), value);
        }
        assert_eq!(number(tidy(0.001_000_000_000_000_000_2)), "0.001");
    }
}
