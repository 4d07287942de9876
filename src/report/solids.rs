//! The elastic solids on the page.

use super::html::table;
use crate::quantity::readable::{grouped, length, show, significant};
use crate::record::{RunRecord, SolidRecord};

/// The numbers of the solids; nothing where there are none.
pub fn solids(record: &RunRecord) -> String {
    if record.solids.is_empty() {
        return String::new();
    }
    let number = |x: f64| significant(x, 4);
    type Row = (&'static str, Box<dyn Fn(&SolidRecord) -> String>);
    let rows: [Row; 17] = [
        ("particles", Box::new(|s| grouped(s.particles as u64))),
        ("spacing", Box::new(|s| length(s.spacing))),
        ("thickness", Box::new(|s| length(s.thickness))),
        ("particles across", Box::new(move |s| significant(s.thickness / s.spacing, 3))),
        ("law", Box::new(|s| s.law.replace('_', " "))),
        ("method", Box::new(|s| s.method.replace('_', " "))),
        ("density", Box::new(|s| show(s.density, "kg/m^3"))),
        (
            "Young's modulus E, Poisson's ratio ν",
            Box::new(move |s| format!("{}, {}", show(s.youngs_modulus, "Pa"), number(s.poisson_ratio))),
        ),
        (
            "bulk modulus K, shear modulus G",
            Box::new(|s| format!("{}, {}", show(s.bulk_modulus, "Pa"), show(s.shear_modulus, "Pa"))),
        ),
        ("sound speed √(K/ρ)", Box::new(|s| show(s.sound_speed, "m/s"))),
        ("longest step", Box::new(|s| format!("{}, limited by {}", show(s.step, "s"), s.limited_by))),
        (
            "clamped, driven particles",
            Box::new(|s| format!("{}, {}", grouped(s.clamped as u64), grouped(s.driven as u64))),
        ),
        ("columns", Box::new(|s| or_none(&s.columns))),
        ("in balance", Box::new(|s| or_none(&s.balance))),
        ("turgor", Box::new(|s| or_none(&s.turgor))),
        ("growth", Box::new(|s| or_none(&s.growth))),
        ("softened by", Box::new(|s| or_none(&s.softening))),
    ];
    let head: Vec<&str> = std::iter::once("").chain(record.solids.iter().map(|s| s.name.as_str())).collect();
    // What only walls in balance have is left out where there are none.
    let told = |of: &dyn Fn(&SolidRecord) -> String| record.solids.iter().any(|s| of(s) != NONE);
    let rows: Vec<Vec<String>> = rows
        .iter()
        .filter(|(what, of)| !ONLY_BALANCED.contains(what) || told(of))
        .map(|(what, of)| std::iter::once((*what).to_string()).chain(record.solids.iter().map(of)).collect())
        .collect();
    let most = record.health.largest_stretch;
    let most = most.map_or_else(String::new, |s| format!("<p>Largest stretch {}.</p>\n", significant(s, 5)));
    format!("<h3>Elastic solids</h3>\n{}{most}", table(&head, &[], &rows))
}

const NONE: &str = "–";
const ONLY_BALANCED: [&str; 4] = ["columns", "in balance", "turgor", "growth"];

fn or_none(words: &str) -> String {
    if words.is_empty() { NONE.into() } else { words.into() }
}
