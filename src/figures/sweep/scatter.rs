//! The outcome at every point against each parameter.

use super::{Outcomes, amount, at_the_end, each, interval, ruler};
use crate::figures::colours::{BLACK, PALETTE};
use crate::figures::plot::{Plot, Style, Trace, plots};
use crate::figures::{Figure, slug};
use crate::statistics::mean;

/// One figure a species: a panel for each parameter.
pub(super) fn scatter(outcomes: &Outcomes) -> Vec<Figure> {
    let grid = outcomes.record.design == "grid";
    let mut out = Vec::new();
    for one in &outcomes.species {
        let y = one.mean();
        let end = |which: usize| one.summaries.iter().map(|s| interval(s)[which]).collect::<Vec<f64>>();
        let (below, above) = (end(0), end(1));
        let panel = |(k, parameter)| {
            let x = one.value(k);
            let mut traces = vec![Trace::bars(&x, &below, &above, PALETTE[0].faint(0.6))];
            traces.push(Trace::new("", &x, &y, Style::Points, PALETTE[0]));
            if grid {
                let (at, middle) = over_the_others(&x, &y);
                traces.push(Trace::new("mean over the other parameters", &at, &middle, Style::Line, BLACK));
            }
            let spread = y.iter().chain(&below).chain(&above).copied();
            Plot { title: String::new(), x: ruler(parameter), y: amount(spread), traces }
        };
        let panels: Vec<Plot> = outcomes.record.parameters.iter().enumerate().map(panel).collect();
        let columns = panels.len().clamp(1, 3);
        let caption = format!(
            "Mean amount of {} over the whole domain {}, {}, with bars of the 95 % confidence interval; one point of the sweep each.",
            one.species,
            at_the_end(outcomes),
            each(outcomes)
        );
        let title = format!("{} against each parameter", one.species);
        let height = if columns == 3 { 36.0 } else { 46.0 };
        let name = format!("outcome_{}", slug(&one.species));
        out.push(plots(&name, &title, &caption, &panels, columns, height));
    }
    out
}

/// Mean outcome at each value of a parameter.
fn over_the_others(x: &[f64], y: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut at = x.to_vec();
    at.sort_by(f64::total_cmp);
    at.dedup();
    let middle = at.iter().map(|value| {
        let there: Vec<f64> = x.iter().zip(y).filter(|(x, _)| *x == value).map(|(_, y)| *y).collect();
        mean(&there)
    });
    let middle = middle.collect();
    (at, middle)
}
