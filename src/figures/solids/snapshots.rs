//! The particles of a solid where they are, coloured by stress or by a species, at several times and one scale.

use super::members;
use crate::figures::colours::{Colour, PALE, viridis};
use crate::figures::fields::{bar, concentration};
use crate::figures::painting::{Bar, Field, colour_bar, spacing};
use crate::figures::panel::{Axis, Panel, range};
use crate::figures::{Drawing, Figure, Samples, WIDTH, clock, slug, spread};
use crate::quantity::readable::Scale;
use crate::statistics::quantile;
use crate::tables::ParticleFrame;

/// Most panels.
const PANELS: usize = 6;
/// Room for the colour bar, and around each map: left, above, below, mm.
const BAR: f64 = 20.0;
const AROUND: [f64; 3] = [15.0, 6.0, 11.0];
/// Water behind a solid.
const WATER: Colour = Colour::hex(0xea_f2f8);

/// What is shown of the space: left, right, lower, upper end and the height of the layer, m.
struct Window {
    ends: [f64; 4],
    middle: f64,
}

/// Snapshots by stress and by each species that occurs in the solid.
pub fn snapshots(samples: &Samples, name: &str) -> Vec<Figure> {
    let chosen = chosen(samples);
    let own = members(samples, name);
    let Some(window) = window(samples, &own, &chosen).filter(|_| samples.record.domain.dimensions > 1) else {
        return Vec::new();
    };
    let mut out = Vec::new();
    let of = |value: &dyn Fn(&ParticleFrame, usize) -> f64| -> Vec<Field<'_>> {
        let shown = |frame: &ParticleFrame, i: usize| if own[i] { value(frame, i) } else { f64::NAN };
        let values = |frame: &ParticleFrame| (0..frame.len()).map(|i| shown(frame, i)).collect();
        chosen.iter().map(|frame| Field { frame, values: values(frame) }).collect()
    };
    let occurs = |fields: &[Field<'_>]| fields.iter().flat_map(|f| &f.values).any(|v| *v > 0.0);
    let stress = of(&|frame, i| frame.stress.get(i).copied().unwrap_or(f64::NAN));
    if occurs(&stress) {
        let every: Vec<f64> =
            stress.iter().flat_map(|f| f.values.iter().copied()).filter(|v| v.is_finite()).collect();
        let high = quantile(&every, 0.995).max(f64::MIN_POSITIVE);
        let bar = Bar { low: 0.0, high, unit: "Pa", label: "von Mises stress", colour: viridis };
        out.push(figure(samples, name, &window, &stress, &bar, ("stress", "Stress in".into())));
    }
    for (k, species) in samples.species.iter().enumerate() {
        let fields = of(&|frame, i| concentration(frame, k, i));
        if occurs(&fields) {
            let label = format!("[{species}]");
            let words = (species.as_str(), format!("Concentration of {species} in"));
            out.push(figure(samples, name, &window, &fields, &bar(&fields, &label), words));
        }
    }
    out
}

/// Frames spread over the run, first and last among them.
fn chosen(samples: &Samples) -> Vec<&ParticleFrame> {
    spread(samples.frames.len(), PANELS).into_iter().map(|k| &samples.frames[k]).collect()
}

/// A window that holds the solid at all times, with a little air; in space its middle layer.
fn window(samples: &Samples, own: &[bool], frames: &[&ParticleFrame]) -> Option<Window> {
    let places = || frames.iter().flat_map(|f| (0..f.len()).filter(|&i| own[i]).map(|i| f.position[i]));
    places().next()?;
    let [x, y, z] = [0, 1, 2].map(|axis| range(places().map(|p| p[axis])));
    let frame = frames.first()?;
    let size = (0..frame.len()).filter(|&i| own[i]).map(|i| spacing(samples, frame, i)).fold(0.0, f64::max);
    let air = |ends: (f64, f64)| 0.05 * (ends.1 - ends.0) + size;
    let ends = [x.0 - air(x), x.1 + air(x), y.0 - air(y), y.1 + air(y)];
    Some(Window { ends, middle: 0.5 * (z.0 + z.1) })
}

fn figure(
    samples: &Samples,
    name: &str,
    window: &Window,
    fields: &[Field<'_>],
    bar: &Bar<'_>,
    (what, title): (&str, String),
) -> Figure {
    let [x0, x1, y0, y1] = window.ends;
    let aspect = (y1 - y0) / (x1 - x0);
    let most = match aspect {
        a if a < 0.3 => 1,
        a if a < 0.7 => 2,
        _ => 3,
    };
    let columns = most.min(fields.len());
    let [left, above, below] = AROUND;
    let width = ((WIDTH - BAR) / columns as f64 - left - 2.0).min(100.0 / aspect);
    let height = width * aspect;
    let sheet = columns as f64 * (left + width + 2.0) + BAR;
    let mut d = Drawing::new(sheet, fields.len().div_ceil(columns) as f64 * (height + above + below));
    let scale = Scale::choose([x0, x1, y0, y1].map(f64::abs).into_iter().fold(0.0, f64::max), "m");
    let axis =
        |low, high, label: &str| Axis { low, high, scale: scale.clone(), label: label.into(), step: None };
    for (k, field) in fields.iter().enumerate() {
        let panel = Panel {
            left: (k % columns) as f64 * (left + width + 2.0) + left,
            top: (k / columns) as f64 * (height + above + below) + above,
            width,
            height,
            x: axis(x0, x1, "x"),
            y: axis(y0, y1, "y"),
        };
        discs(samples, &mut d, &panel, field, (bar, window.middle));
        panel.axes(&mut d, &clock(samples).show(field.frame.time));
    }
    let length = (d.height - above - below).min(60.0);
    colour_bar(&mut d, sheet - BAR + 2.0, above, length, bar);
    let mut caption =
        "Particles of one realization where they are, to scale; pale: what is not the solid.".to_string();
    if fields.iter().flat_map(|f| &f.values).any(|v| *v > bar.high) {
        caption += " The 0.5 % highest values share the last colour.";
    }
    if samples.record.domain.dimensions == 3 {
        caption += " Layer through the middle, seen along z.";
    }
    Figure {
        name: format!("solid_{}_{}", slug(name), slug(what)),
        title: format!("{title} {name}"),
        caption,
        drawing: d,
        raster: true,
    }
}

/// Each particle as a disc as wide as it is apart from the next; what is not a number lies behind.
fn discs(
    samples: &Samples,
    d: &mut Drawing,
    panel: &Panel,
    field: &Field<'_>,
    (bar, middle): (&Bar<'_>, f64),
) {
    let frame = field.frame;
    let millimetre = panel.width / (panel.x.high - panel.x.low);
    let space = samples.record.domain.dimensions == 3;
    // What waits to be used belongs to no group of the model.
    let material = |i: usize| {
        let groups = &samples.record.domain.groups;
        groups.iter().find(|g| g.name == frame.group_name(i)).map(|g| g.material.as_str())
    };
    for behind in [true, false] {
        for i in (0..frame.len()).filter(|&i| field.values[i].is_nan() == behind) {
            let [x, y, z] = frame.position[i];
            let size = spacing(samples, frame, i);
            let inside = (panel.x.low + 0.6 * size..=panel.x.high - 0.6 * size).contains(&x)
                && (panel.y.low + 0.6 * size..=panel.y.high - 0.6 * size).contains(&y);
            if !inside || material(i).is_none() || (space && (z - middle).abs() > 0.75 * size) {
                continue;
            }
            let colour = match behind {
                true if material(i) == Some("fluid") => WATER,
                true => PALE,
                false => (bar.colour)((field.values[i] - bar.low) / (bar.high - bar.low)),
            };
            // A little wider than half: neighbours of a lattice leave no white.
            d.circle(panel.at(x, y), (0.62 * size * millimetre).max(0.12), colour);
        }
    }
}
