//! What was measured of elastic solids, and whether walls held, mass is accounted for, and the mechanics
//! was at rest.

use super::html::table;
use super::sections::{Check, Verdict};
use crate::figures::Samples;
use crate::figures::solids::{Course, courses, ends, names, round, words};
use crate::quantity::readable::{grouped, show, significant};

/// Relative deviation of a solid's mass from what it had and was given.
const MASS: f64 = 1e-6;
/// Time of the mechanics over that of the chemistry up to which a wall is always in equilibrium.
const TIMES: f64 = 1e-3;

/// What is measured of every solid: at the end and over all times.
pub fn measures(samples: &Samples) -> String {
    let mut out = String::new();
    for name in names(samples) {
        // A wall in balance has none.
        let rests = |course: &Course| {
            course.quantity == "kinetic_energy" && course.values.iter().flatten().all(|v| *v == 0.0)
        };
        let found = courses(samples, name);
        let seen = || found.iter().filter(|course| !course.times.is_empty() && !rests(course));
        let several = seen().any(|course| course.values.len() > 1);
        let rows: Vec<Vec<String>> = seen()
            .map(|course| {
                let [mean, q05, q95, low, high] = ends(course);
                // What has no unit stays a plain number.
                let tell = |v: f64| match course.unit.as_str() {
                    "" | "1" => significant(v, 4),
                    unit => show(v, unit),
                };
                let end = course.end();
                let band = if course.quantity == "direction" && end.len() > 1 {
                    format!("agreement {}", significant(round(&end).1, 3))
                } else if course.values.len() > 1 {
                    format!("{} … {}", tell(q05), tell(q95))
                } else {
                    "–".into()
                };
                let extreme = |v: f64| if v.is_finite() { tell(v) } else { "–".into() };
                let mut row = vec![words(&course.quantity), tell(mean), band, extreme(low), extreme(high)];
                if !several {
                    row.remove(2);
                }
                row
            })
            .collect();
        let head: &[&str] = if several {
            &["", "mean at the end", "5 … 95 %", "least", "greatest"]
        } else {
            &["", "at the end", "least", "greatest"]
        };
        if !rows.is_empty() {
            let numbers: Vec<usize> = (1..head.len()).collect();
            out += &format!("<h3>{}</h3>\n{}", crate::figures::escape(name), table(head, &numbers, &rows));
        }
    }
    out
}

/// Checks of the solids, from what the tables say of them.
pub fn checks(samples: &Samples) -> Vec<Check> {
    let judge = |ok: bool| if ok { Verdict::Pass } else { Verdict::Fail };
    let mut out = Vec::new();
    for name in names(samples) {
        for course in courses(samples, name) {
            let every = course.values.iter().flatten().filter(|v| v.is_finite());
            let Some(worst) = every.map(|v| v.abs()).reduce(f64::max) else { continue };
            let (what, found, allowed, verdict) = match course.quantity.as_str() {
                "escapes" => {
                    ("Escapes through", grouped(worst.round() as u64), "0".into(), judge(worst == 0.0))
                }
                "mass_balance" => (
                    "Mass unaccounted for, relative, of",
                    significant(worst, 3),
                    format!("≤ {}", significant(MASS, 2)),
                    judge(worst <= MASS),
                ),
                "residual" => (
                    "Largest force out of balance over the loads of",
                    significant(worst, 3),
                    "for information".into(),
                    Verdict::Open,
                ),
                "time_ratio" => (
                    "Time of the mechanics over that of the chemistry of",
                    significant(worst, 3),
                    format!("≤ {}", significant(TIMES, 2)),
                    judge(worst <= TIMES),
                ),
                _ => continue,
            };
            out.push(Check { name: format!("{what} {name}"), found, allowed, verdict });
        }
    }
    out
}
