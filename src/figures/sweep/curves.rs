//! Curves of the outcome against one parameter: one, or one for each value of another.

use super::{FAMILY, Outcome, Outcomes, amount, at_the_end, each, interval, label, name, printed, ruler};
use crate::figures::Figure;
use crate::figures::colours::{BLACK, PALETTE, palette};
use crate::figures::plot::{Plot, Style, Trace, plots};
use crate::quantity::readable::significant;

/// Mean, its 95 % interval and the 5 to 95 % band of each species against the one parameter.
pub(super) fn against(outcomes: &Outcomes) -> Figure {
    let parameter = &outcomes.record.parameters[0];
    let panels: Vec<Plot> = outcomes.species.iter().map(|one| panel(outcomes, one)).collect();
    let (columns, height) = layout(panels.len());
    let caption = format!(
        "Amounts over the whole domain {}, {}. Points: mean, with bars of its 95 % confidence interval (Student); shaded: 5 to 95 % of the realizations.",
        at_the_end(outcomes),
        each(outcomes)
    );
    plots("outcome", &format!("Outcome against {}", name(parameter)), &caption, &panels, columns, height)
}

fn layout(panels: usize) -> (usize, f64) {
    match panels {
        1 => (1, 62.0),
        2 | 4 => (2, 46.0),
        _ => (3, 36.0),
    }
}

/// Indices of points in order of a parameter.
fn ordered(one: &Outcome, parameter: usize) -> Vec<usize> {
    let x = one.value(parameter);
    let mut order: Vec<usize> = (0..x.len()).collect();
    order.sort_by(|&a, &b| x[a].total_cmp(&x[b]));
    order
}

fn panel(outcomes: &Outcomes, one: &Outcome) -> Plot {
    let order = ordered(one, 0);
    let of = |f: &dyn Fn(usize) -> f64| order.iter().map(|&k| f(k)).collect::<Vec<f64>>();
    let x = of(&|k| one.values[k][0]);
    let mean = of(&|k| one.summaries[k].mean);
    let (low, high) = (of(&|k| one.summaries[k].q05), of(&|k| one.summaries[k].q95));
    let end = |which: usize| of(&|k| interval(&one.summaries[k])[which]);
    let (below, above) = (end(0), end(1));
    let mut traces = Vec::new();
    if one.summaries.iter().any(|s| s.count > 1) {
        traces.push(Trace::band("5 to 95 % of realizations", &x, &low, &high, PALETTE[0].faint(0.18)));
        traces.push(Trace::bars(&x, &below, &above, BLACK));
    }
    traces.push(Trace::new("mean ± 95 % confidence", &x, &mean, Style::Line, PALETTE[0]));
    traces.push(Trace::new("", &x, &mean, Style::Points, PALETTE[0]));
    let spread = [&mean, &low, &high, &below, &above].into_iter().flatten().copied();
    Plot { title: one.species.clone(), x: ruler(&outcomes.record.parameters[0]), y: amount(spread), traces }
}

/// One curve for each value of the parameter that has the fewer ones, if these can be told apart.
pub(super) fn family(outcomes: &Outcomes) -> Option<Figure> {
    let first = outcomes.species.first()?;
    let distinct = |parameter: usize| {
        let mut values = first.value(parameter);
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    };
    let (a, b) = (distinct(0), distinct(1));
    // Along x the one with more values.
    let (x, other, values) = if b.len() <= a.len() { (0, 1, b) } else { (1, 0, a) };
    if values.len() > FAMILY {
        return None;
    }
    let parameters = &outcomes.record.parameters;
    let panels: Vec<Plot> = outcomes
        .species
        .iter()
        .map(|one| {
            let mut traces = Vec::new();
            let mut spread = Vec::new();
            for (k, value) in values.iter().enumerate() {
                let order: Vec<usize> =
                    ordered(one, x).into_iter().filter(|&p| one.values[p][other] == *value).collect();
                let of = |f: &dyn Fn(usize) -> f64| order.iter().map(|&k| f(k)).collect::<Vec<f64>>();
                let at = of(&|k| one.values[k][x]);
                let mean = of(&|k| one.summaries[k].mean);
                let end = |which: usize| of(&|k| interval(&one.summaries[k])[which]);
                let (below, above) = (end(0), end(1));
                let title = format!(
                    "{} = {} {}",
                    name(&parameters[other]),
                    significant(*value, 3),
                    printed(&parameters[other].unit)
                );
                if one.summaries.iter().any(|s| s.count > 1) {
                    traces.push(Trace::bars(&at, &below, &above, palette(k)));
                }
                traces.push(Trace::new(title.trim(), &at, &mean, Style::Line, palette(k)));
                traces.push(Trace::new("", &at, &mean, Style::Points, palette(k)));
                spread.extend(mean.into_iter().chain(below).chain(above));
            }
            Plot {
                title: one.species.clone(),
                x: ruler(&parameters[x]),
                y: amount(spread.into_iter()),
                traces,
            }
        })
        .collect();
    let (columns, height) = layout(panels.len());
    let caption = format!(
        "Mean amounts over the whole domain {}, {}, with bars of the 95 % confidence interval.",
        at_the_end(outcomes),
        each(outcomes)
    );
    let title = format!("Outcome against {} and {}", label(&parameters[x]), name(&parameters[other]));
    Some(plots("outcome", &title, &caption, &panels, columns, height))
}
