//! Tables in HTML.

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
