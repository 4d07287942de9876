//! The run at a glance: concentration at the end beside what it did in time.

use super::painting::{colour_bar, map, paint};
use super::panel::MARGIN;
use super::time::{draw_curves, headline};
use super::{Drawing, Figure, Samples, WIDTH, clock, fields};

/// Room between the map and the panel in time, for the colour bar, mm.
const BETWEEN: f64 = 20.0;
const LEFT: f64 = 12.0;

/// Map of the first mobile species that occurs, and occupancy (without receptors: the whole amount) against time.
pub fn overview(samples: &Samples) -> Option<Figure> {
    let frame = samples.frames.last().filter(|_| samples.record.domain.dimensions > 1)?;
    let mobile = |name: &String| samples.record.species.iter().any(|s| s.name == *name && s.diffusion > 0.0);
    let occurs = |k: usize| frame.amounts.get(k).is_some_and(|a| a.iter().any(|v| *v > 0.0));
    let (curves, shown) = headline(samples)?;
    let fit = |&k: &usize| mobile(&samples.species[k]) && occurs(k);
    // The same species on both sides where it can be.
    let same = samples.species.iter().position(|s| Some(s.as_str()) == shown).filter(fit);
    let k = same.or_else(|| (0..samples.species.len()).find(fit))?;
    let name = &samples.species[k];
    let shape = map(samples, 0.0, 0.0, 1.0).height;
    // Wide domains take more than half of the sheet, but both panels have the same height.
    let width = (80.0_f64).min(56.0 / shape.max(0.1));
    let map = map(samples, LEFT, MARGIN[1], width);
    let height = map.height.max(36.0);
    let left = LEFT + width + BETWEEN + MARGIN[0];
    let right = (WIDTH - left - MARGIN[2]).min(1.6 * height).max(40.0);
    let mut d = Drawing::new(left + right + MARGIN[2], height + MARGIN[1] + MARGIN[3]);
    let fields = [fields::field(samples, frame, k)];
    let colours = format!("[{name}]");
    let bar = fields::bar(&fields, &colours);
    paint(samples, &mut d, &map, &fields[0], &bar);
    map.axes(&mut d, &format!("[{name}], {}", clock(samples).show(frame.time)));
    colour_bar(&mut d, LEFT + width + 3.0, MARGIN[1], map.height, &bar);
    draw_curves(&mut d, &samples.series.times, &curves, [left, MARGIN[1], right, height], None);
    let caption = format!(
        "Left: concentration of {name} in one realization. Right: {}.",
        super::time::words(samples).replace("Thick:", "thick:").replace("One", "one").trim_end_matches('.')
    );
    Some(Figure {
        name: "overview".into(),
        title: format!("Concentration {} and course in time", fields::instant(samples, frame.time)),
        caption,
        drawing: d,
        raster: true,
    })
}
