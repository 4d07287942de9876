//! Text of an expression -> tokens with their places.

use crate::quantity::{
    Quantity, TextFault, find_unit, is_unit_letter, number_length, parse_number, unit_suggestion,
};

/// What a token is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Symbol {
    /// A number; with the unit words it is written with, if it has a unit.
    Number(Quantity, Vec<UnitWord>),
    Name(String),
    Operator(&'static str),
    Open,
    Close,
    Comma,
}

/// A word read as a unit.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct UnitWord {
    pub word: String,
    pub offset: usize,
}

/// A token and its place in characters.
#[derive(Clone, Debug)]
pub(super) struct Token {
    pub symbol: Symbol,
    pub offset: usize,
    pub width: usize,
}

/// Longer operators first.
const OPERATORS: [&str; 12] = ["<=", ">=", "==", "!=", "**", "<", ">", "+", "-", "*", "/", "^"];

pub(super) fn tokens(text: &str) -> Result<Vec<Token>, TextFault> {
    let characters: Vec<char> = text.chars().collect();
    let mut out = Vec::new();
    let mut at = 0;
    while let Some(&c) = characters.get(at) {
        if c.is_whitespace() {
            at += 1;
            continue;
        }
        let offset = at;
        let symbol = if c.is_ascii_digit() || c == '.' {
            number(&characters, &mut at)?
        } else if c.is_alphabetic() || c == '_' {
            while characters.get(at).is_some_and(|c| c.is_alphanumeric() || *c == '_') {
                at += 1;
            }
            Symbol::Name(characters[offset..at].iter().collect())
        } else {
            at += 1;
            match c {
                '(' => Symbol::Open,
                ')' => Symbol::Close,
                ',' => Symbol::Comma,
                '·' | '×' => Symbol::Operator("*"),
                '\u{2212}' => Symbol::Operator("-"),
                '≤' => Symbol::Operator("<="),
                '≥' => Symbol::Operator(">="),
                _ => {
                    let rest: String = characters[offset..].iter().take(2).collect();
                    let Some(operator) = OPERATORS.iter().find(|operator| rest.starts_with(**operator))
                    else {
                        return Err(unexpected(c, offset));
                    };
                    at = offset + operator.len();
                    if *operator == "**" {
                        return Err(TextFault::new(
                            offset,
                            2,
                            "\"**\" is no operator here",
                            "write powers as S^2",
                        ));
                    }
                    Symbol::Operator(operator)
                }
            }
        };
        out.push(Token { symbol, offset, width: at - offset });
    }
    Ok(out)
}

fn unexpected(c: char, offset: usize) -> TextFault {
    let remedy = match c {
        '=' => "comparisons are written ==, <, <=, >, >=, !=",
        '[' | ']' => "species stand for their concentrations (or counts) without brackets",
        '&' | '|' => "combine conditions by products: (A > 1) * (B > 1)",
        _ => "an expression has numbers, names, + - * / ^, comparisons and parentheses",
    };
    TextFault::new(offset, 1, format!("unexpected \"{c}\" in an expression"), remedy)
}

/// A number and, after it, a unit: a word with `^2`, then `/word` or `*word` without spaces.
fn number(characters: &[char], at: &mut usize) -> Result<Symbol, TextFault> {
    let start = *at;
    let length = number_length(&characters[start..]);
    if length == 0 {
        return Err(unexpected(characters[start], start));
    }
    let digits: String = characters[start..start + length].iter().collect();
    let value = parse_number(&digits).map_err(|fault| TextFault { offset: start, ..fault })?;
    *at = start + length;
    if characters.get(*at) == Some(&'_') || characters.get(*at) == Some(&'.') {
        let width =
            characters[start..].iter().take_while(|c| c.is_alphanumeric() || "_.".contains(**c)).count();
        let word: String = characters[start..start + width].iter().collect();
        return Err(TextFault::new(
            start,
            width,
            format!("\"{word}\" is not a number"),
            "digits have no separators",
        ));
    }
    let mut unit_at = *at;
    while characters.get(unit_at).is_some_and(|c| c.is_whitespace()) {
        unit_at += 1;
    }
    if characters.get(unit_at).is_some_and(char::is_ascii_digit) {
        return Err(TextFault::new(
            unit_at,
            1,
            "an operator is missing between two numbers",
            "a unit like 1/s is written s^-1 in an expression",
        ));
    }
    let Some((first, mut end)) = unit_word(characters, unit_at) else {
        return Ok(Symbol::Number(Quantity::bare(value), Vec::new()));
    };
    let tail = characters[end..].iter().take_while(|c| c.is_alphanumeric() || **c == '_').count();
    if find_unit(&first.word).is_none() || tail > 0 {
        let word: String =
            characters[unit_at..(unit_at + first.word.chars().count() + tail)].iter().collect();
        let width = word.chars().count();
        return Err(TextFault::new(
            unit_at,
            width,
            format!("\"{word}\" after a number is read as a unit, and no unit is called that"),
            format!("write {digits} * {word} for a product; {}", unit_suggestion(&first.word)),
        ));
    }
    let mut words = vec![first];
    while matches!(characters.get(end), Some('/' | '*' | '·')) {
        let Some((word, next)) = unit_word(characters, end + 1) else { break };
        let longer = characters.get(next).is_some_and(|c| c.is_alphanumeric() || "_(".contains(*c));
        if find_unit(&word.word).is_none() || longer {
            break;
        }
        words.push(word);
        end = next;
    }
    let text: String = characters[start..end].iter().collect();
    let quantity =
        Quantity::parse(&text).map_err(|fault| TextFault { offset: start + fault.offset, ..fault })?;
    *at = end;
    Ok(Symbol::Number(quantity, words))
}

/// A word of unit letters with its exponent, and where it ends.
fn unit_word(characters: &[char], at: usize) -> Option<(UnitWord, usize)> {
    let letters = characters.get(at..)?.iter().take_while(|c| is_unit_letter(**c)).count();
    if letters == 0 {
        return None;
    }
    let word: String = characters[at..at + letters].iter().collect();
    let mut end = at + letters;
    if characters.get(end) == Some(&'^') {
        let sign = usize::from(characters.get(end + 1) == Some(&'-'));
        let digits = characters[end + 1 + sign..].iter().take_while(|c| c.is_ascii_digit()).count();
        if digits > 0 {
            end += 1 + sign + digits;
        }
    } else {
        // m3, m², s⁻¹
        end += characters[end..]
            .iter()
            .take_while(|c| c.is_ascii_digit() || "⁻⁰¹²³⁴⁵⁶⁷⁸⁹".contains(**c))
            .count();
    }
    Some((UnitWord { word, offset: at }, end))
}
