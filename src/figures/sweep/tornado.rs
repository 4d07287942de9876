//! How strongly each parameter moves the outcome: correlations of ranks as bars, the strongest on top.

use super::{Outcome, Outcomes, RANKED, at_the_end, name};
use crate::figures::colours::{BLACK, GREY, PALETTE, WHITE};
use crate::figures::drawing::{Anchor, HAIR, LABEL, TITLE, text_width};
use crate::figures::{Drawing, Figure, WIDTH};
use crate::statistics::spearman;

/// Height of a bar with the room round it, above and below a panel, mm.
const BAR: f64 = 6.0;
const TOP: f64 = 7.0;
const BOTTOM: f64 = 12.0;

/// The correlation of the ranks of a species' mean with those of each parameter; NaN where nothing changes.
#[must_use]
pub fn correlations(outcomes: &Outcomes, one: &Outcome) -> Vec<f64> {
    let y = one.mean();
    (0..outcomes.record.parameters.len()).map(|k| spearman(&one.value(k), &y)).collect()
}

/// Bars for each species.
pub(super) fn tornado(outcomes: &Outcomes) -> Option<Figure> {
    let points = outcomes.species.first()?.values.len();
    let parameters = &outcomes.record.parameters;
    if points < RANKED || parameters.len() < 2 {
        return None;
    }
    // Ranks that have nothing to do with each other scatter by 1/√(n - 1).
    let chance = 1.96 / (points as f64 - 1.0).sqrt();
    let columns = outcomes.species.len().min(2);
    let rows = outcomes.species.len().div_ceil(columns);
    let left = 4.0 + parameters.iter().map(|p| text_width(name(p), LABEL)).fold(0.0, f64::max);
    let width = if columns == 1 { 110.0 } else { WIDTH / 2.0 };
    let height = BAR * parameters.len() as f64;
    let mut d = Drawing::new(width * columns as f64, (TOP + height + BOTTOM) * rows as f64);
    for (k, one) in outcomes.species.iter().enumerate() {
        let corner =
            [(k % columns) as f64 * width + left, (k / columns) as f64 * (TOP + height + BOTTOM) + TOP];
        panel(&mut d, outcomes, one, corner, [width - left - 5.0, height], chance);
    }
    let caption = format!(
        "Spearman's correlation between each parameter and the mean amount over the whole domain {}, {points} points. Beyond the dashed lines one in twenty lies by chance.",
        at_the_end(outcomes)
    );
    Some(Figure {
        name: "tornado".into(),
        title: "What moves the outcome".into(),
        caption,
        drawing: d,
        raster: false,
    })
}

fn panel(
    d: &mut Drawing,
    outcomes: &Outcomes,
    one: &Outcome,
    [left, top]: [f64; 2],
    [width, height]: [f64; 2],
    chance: f64,
) {
    let at = |r: f64| left + 0.5 * (1.0 + r) * width;
    let found = correlations(outcomes, one);
    for r in [-chance, chance].into_iter().filter(|r| r.abs() < 1.0) {
        d.dashed(&[[at(r), top], [at(r), top + height]], HAIR, GREY);
    }
    let mut order: Vec<usize> = (0..found.len()).collect();
    let size = |k: usize| if found[k].is_finite() { found[k].abs() } else { 0.0 };
    order.sort_by(|&a, &b| size(b).total_cmp(&size(a)));
    for (row, k) in order.into_iter().enumerate() {
        let y = top + BAR * row as f64;
        let r = if found[k].is_finite() { found[k] } else { 0.0 };
        let colour = if r > 0.0 { PALETTE[0] } else { PALETTE[1] };
        let (from, to) = (at(r.min(0.0)), at(r.max(0.0)));
        d.rectangle([from, y + 1.0], [to - from, BAR - 2.0], colour.faint(0.75));
        d.text([left - 1.6, y + BAR / 2.0], name(&outcomes.record.parameters[k]), LABEL, BLACK, Anchor::End);
        let words = if found[k].is_finite() { format!("{r:.2}").replace('-', "−") } else { "–".into() };
        // Beside the bar, or inside where the frame ends.
        let outside = r.abs() < 0.8;
        let (x, anchor) = match (r < 0.0, outside) {
            (false, true) => (to + 1.2, Anchor::Start),
            (false, false) => (to - 1.2, Anchor::End),
            (true, true) => (from - 1.2, Anchor::End),
            (true, false) => (from + 1.2, Anchor::Start),
        };
        if outside {
            // No line behind the number.
            let wide = text_width(&words, LABEL);
            let start = if anchor == Anchor::Start { x } else { x - wide };
            d.rectangle([start - 0.4, y + 1.0], [wide + 0.8, BAR - 2.0], WHITE);
        }
        d.text([x, y + BAR / 2.0], &words, LABEL, BLACK, anchor);
    }
    d.line(&[[at(0.0), top], [at(0.0), top + height]], HAIR, BLACK);
    let (right, bottom) = (left + width, top + height);
    d.line(&[[left, top], [left, bottom], [right, bottom], [right, top], [left, top]], HAIR, BLACK);
    for (r, words) in [(-1.0, "−1"), (-0.5, "−0.5"), (0.0, "0"), (0.5, "0.5"), (1.0, "1")] {
        d.line(&[[at(r), bottom], [at(r), bottom + 1.0]], HAIR, BLACK);
        d.text([at(r), bottom + 3.0], words, LABEL, BLACK, Anchor::Middle);
    }
    d.text([left + width / 2.0, bottom + 6.8], "rank correlation", LABEL, BLACK, Anchor::Middle);
    d.text([left, top - 2.6], &one.species, TITLE, BLACK, Anchor::Start);
}
