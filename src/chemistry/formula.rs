//! Reaction equations: `A + 2 B -> C`, `R + L <-> RL`, `0 -> L`.

use crate::quantity::TextFault;

/// One side's species: name, multiplicity, and where it stands in the text (characters).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Term {
    pub name: String,
    pub multiplicity: u32,
    pub offset: usize,
    pub width: usize,
}

/// A parsed equation; terms of one species are added up at the place of the first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Formula {
    pub left: Vec<Term>,
    pub right: Vec<Term>,
    /// Written with `<->`.
    pub reversible: bool,
}

/// Largest multiplicity that is taken for a number of molecules rather than a slip.
const LARGEST_MULTIPLICITY: u32 = 1000;

impl Formula {
    /// Reads an equation. `2 A` and `2*A` are two of A, `A + A` likewise, `0` and `∅` are nothing.
    ///
    /// # Errors
    /// A fault with its place in the text: no arrow, a missing or broken term.
    pub fn parse(text: &str) -> Result<Formula, TextFault> {
        let characters: Vec<char> = text.chars().collect();
        let (at, width, reversible) = arrow(&characters)?;
        Ok(Formula {
            left: side(&characters, 0, at, "before")?,
            right: side(&characters, at + width, characters.len(), "after")?,
            reversible,
        })
    }
}

/// Words of one direction: `R + 2 L -> RL`.
#[must_use]
pub fn equation_words(left: &[(&str, u32)], right: &[(&str, u32)]) -> String {
    format!("{} -> {}", side_words(left), side_words(right))
}

fn side_words(side: &[(&str, u32)]) -> String {
    if side.is_empty() {
        return "0".to_string();
    }
    let terms: Vec<String> = side
        .iter()
        .map(|&(name, nu)| if nu == 1 { name.to_string() } else { format!("{nu} {name}") })
        .collect();
    terms.join(" + ")
}

/// Place and width of the one arrow, and whether it points both ways.
fn arrow(characters: &[char]) -> Result<(usize, usize, bool), TextFault> {
    const ARROWS: [(&str, bool); 11] = [
        ("<-->", true),
        ("<->", true),
        ("<=>", true),
        ("⇌", true),
        ("↔", true),
        ("⇄", true),
        ("-->", false),
        ("->", false),
        ("=>", false),
        ("→", false),
        ("⟶", false),
    ];
    let mut found: Option<(usize, usize, bool)> = None;
    let mut at = 0;
    while at < characters.len() {
        let here = ARROWS
            .iter()
            .find(|(arrow, _)| arrow.chars().enumerate().all(|(k, c)| characters.get(at + k) == Some(&c)));
        let Some(&(arrow, reversible)) = here else {
            at += 1;
            continue;
        };
        let width = arrow.chars().count();
        if found.is_some() {
            return Err(TextFault::new(at, width, "a second arrow", "write one reaction for each step"));
        }
        found = Some((at, width, reversible));
        at += width;
    }
    found.ok_or_else(|| {
        let backward = characters.windows(2).position(|w| w == ['<', '-']);
        match backward {
            Some(at) => TextFault::new(at, 2, "an arrow to the left", "swap the sides and write \"->\""),
            None => TextFault::new(
                0,
                characters.len(),
                "an equation needs an arrow",
                "write \"A + B -> C\", or \"<->\" for a pair, with 0 for nothing",
            ),
        }
    })
}

/// The terms between two places.
fn side(characters: &[char], start: usize, end: usize, word: &str) -> Result<Vec<Term>, TextFault> {
    let plain: String = characters[start..end].iter().collect();
    let first = start + plain.chars().take_while(|c| c.is_whitespace()).count();
    if plain.trim().is_empty() {
        let at = first.min(characters.len().saturating_sub(1));
        return Err(TextFault::new(at, 1, format!("nothing stands {word} the arrow"), "write 0 for nothing"));
    }
    if matches!(plain.trim(), "0" | "∅" | "Ø" | "ø") {
        return Ok(Vec::new());
    }
    let mut terms: Vec<Term> = Vec::new();
    let mut from = start;
    for piece in plain.split('+') {
        let to = from + piece.chars().count();
        let new = term(characters, from, to)?;
        match terms.iter_mut().find(|t| t.name == new.name) {
            Some(same) => same.multiplicity = same.multiplicity.saturating_add(new.multiplicity),
            None => terms.push(new),
        }
        from = to + 1;
    }
    Ok(terms)
}

/// One term, `A`, `2 A` or `2*A`.
fn term(characters: &[char], start: usize, end: usize) -> Result<Term, TextFault> {
    let mut at = start;
    let mut end = end;
    while at < end && characters[at].is_whitespace() {
        at += 1;
    }
    while end > at && characters[end - 1].is_whitespace() {
        end -= 1;
    }
    let offset = at;
    if at == end {
        let at = at.min(characters.len().saturating_sub(1));
        return Err(TextFault::new(
            at,
            1,
            "a species is missing beside \"+\"",
            "name it, or remove the \"+\"",
        ));
    }
    let digits: String = characters[at..end].iter().take_while(|c| c.is_ascii_digit()).collect();
    let mut multiplicity = 1;
    if !digits.is_empty() {
        at += digits.len();
        let after_number = at;
        while at < end && characters[at].is_whitespace() {
            at += 1;
        }
        let star = characters.get(at).filter(|_| at < end).is_some_and(|c| matches!(c, '*' | '·'));
        if star {
            at += 1;
            while at < end && characters[at].is_whitespace() {
                at += 1;
            }
        }
        let word: String = characters[offset..end].iter().collect();
        let rest: String = characters[at..end].iter().collect();
        if rest.is_empty() {
            let remedy =
                if digits == "0" { "0 stands alone on its side" } else { "write the species after it" };
            return Err(TextFault::new(offset, end - offset, format!("\"{word}\" is no species"), remedy));
        }
        if at == after_number {
            return Err(TextFault::new(
                offset,
                end - offset,
                format!("\"{word}\" is no name of a species: names do not start with a digit"),
                format!("for {digits} of {rest} write \"{digits} {rest}\""),
            ));
        }
        multiplicity = digits.parse::<u32>().unwrap_or(u32::MAX);
        if multiplicity == 0 || multiplicity > LARGEST_MULTIPLICITY {
            return Err(TextFault::new(
                offset,
                digits.len(),
                format!("{digits} is no number of molecules between 1 and {LARGEST_MULTIPLICITY}"),
                "",
            ));
        }
    }
    let name: String = characters[at..end].iter().collect();
    let legal = |c: char, first: bool| c == '_' || c.is_alphabetic() || !first && c.is_alphanumeric();
    if let Some(bad) = name.chars().enumerate().position(|(k, c)| !legal(c, k == 0)) {
        let (reason, remedy) = if name.chars().any(char::is_whitespace) {
            (format!("\"{name}\" is not one species"), "join species by \"+\"")
        } else {
            (format!("\"{name}\" is no name of a species"), "names are letters, digits and \"_\"")
        };
        let width = if name.chars().any(char::is_whitespace) { end - at } else { 1 };
        let shift = if width == 1 { bad } else { 0 };
        return Err(TextFault::new(at + shift, width, reason, remedy));
    }
    Ok(Term { name, multiplicity, offset, width: end - offset })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rstest::rstest;

    fn names(terms: &[Term]) -> Vec<(&str, u32)> {
        terms.iter().map(|t| (t.name.as_str(), t.multiplicity)).collect()
    }

    #[test]
    fn equations_are_read() {
        let f = Formula::parse("A + 2 B -> C").unwrap();
        assert_eq!((names(&f.left), names(&f.right)), (vec![("A", 1), ("B", 2)], vec![("C", 1)]));
        assert!(!f.reversible);
        assert_eq!((f.left[1].offset, f.left[1].width), (4, 3));
        assert!(Formula::parse("R+L<->RL").unwrap().reversible);
        assert_eq!(names(&Formula::parse("A + A -> 0").unwrap().left), [("A", 2)]);
        assert_eq!(names(&Formula::parse("2*A -> ∅").unwrap().left), [("A", 2)]);
        assert!(Formula::parse("0 -> L").unwrap().left.is_empty());
        assert_eq!(names(&Formula::parse("_x1 → α").unwrap().right), [("α", 1)]);
        assert_eq!(equation_words(&[("A", 1), ("B", 2)], &[]), "A + 2 B -> 0");
    }

    #[rstest]
    #[case("A + B", 0, 5, "needs an arrow")]
    #[case("", 0, 1, "needs an arrow")]
    #[case("A <- B", 2, 2, "to the left")]
    #[case("A -> B -> C", 7, 2, "second arrow")]
    #[case("-> B", 0, 1, "nothing stands before")]
    #[case("A ->", 3, 1, "nothing stands after")]
    #[case("A + -> B", 4, 1, "missing beside")]
    #[case("2A -> B", 0, 2, "do not start with a digit")]
    #[case("0 A -> B", 0, 1, "between 1 and")]
    #[case("0 + A -> B", 0, 1, "no species")]
    #[case("A B -> C", 0, 3, "not one species")]
    #[case("A-b -> C", 1, 1, "no name")]
    fn bad_equations_say_where(
        #[case] text: &str,
        #[case] offset: usize,
        #[case] width: usize,
        #[case] reason: &str,
    ) {
        let fault = Formula::parse(text).unwrap_err();
        assert!(fault.reason.contains(reason), "{text}: {}", fault.reason);
        assert_eq!((fault.offset, fault.width), (offset, width), "{text}: {}", fault.reason);
    }
}
