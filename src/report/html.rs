//! Tables and formulas in HTML.

use crate::figures::escape;

/// A table; cells are plain text, columns named in `numeric` are set flush right. Empty without rows.
pub fn table(head: &[&str], numeric: &[usize], rows: &[Vec<String>]) -> String {
    let escaped: Vec<Vec<String>> = rows.iter().map(|r| r.iter().map(|c| escape(c)).collect()).collect();
    table_of_html(head, numeric, &escaped)
}

/// A table whose cells are HTML already.
pub fn table_of_html(head: &[&str], numeric: &[usize], rows: &[Vec<String>]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let class = |k: usize| if numeric.contains(&k) { " class=\"n\"" } else { "" };
    let mut out = String::from("<div class=\"scroll\"><table>\n<thead><tr>");
    for (k, name) in head.iter().enumerate() {
        out += &format!("<th{}>{}</th>", class(k), escape(name));
    }
    out += "</tr></thead>\n<tbody>\n";
    for row in rows {
        out += "<tr>";
        for (k, cell) in row.iter().enumerate() {
            out += &format!("<td{}>{cell}</td>", class(k));
        }
        out += "</tr>\n";
    }
    out + "</tbody>\n</table></div>\n"
}

/// A formula in plain text as HTML: powers, products and indices as printed.
pub fn typeset(formula: &str) -> String {
    let raised =
        escape(formula).replace("^2", "²").replace("^3", "³").replace(" * ", " · ").replace(" - 1", " − 1");
    let mut out = String::with_capacity(raised.len());
    let mut rest = raised.as_str();
    while let Some(at) = rest.find('_') {
        let word = |c: char| c.is_alphanumeric() || c == '_';
        // Only the symbols of the propensities carry an index: X_A, N_A.
        let symbol = rest[..at].ends_with(['X', 'N']) && !rest[..at - 1].ends_with(word);
        let tail = &rest[at + 1..];
        let end = tail.find(|c| !word(c)).unwrap_or(tail.len());
        out += &rest[..at];
        if symbol {
            out += &format!("<sub>{}</sub>", &tail[..end]);
        } else {
            out += &rest[at..=at + end];
        }
        rest = &tail[end..];
    }
    out + rest
}

#[cfg(test)]
mod tests {
    #[test]
    fn propensities_are_typeset() {
        let set = super::typeset("a = 25 m^3/mol/s / (N_A V) * X_R * k_on2");
        assert_eq!(set, "a = 25 m³/mol/s / (N<sub>A</sub> V) · X<sub>R</sub> · k_on2");
        assert_eq!(super::typeset("µ_X_A < 1"), "µ_X_A &lt; 1");
    }
}
