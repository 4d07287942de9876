//! Profiles of one-dimensional models: concentration along x at several times.

use super::colours::{Colour, viridis};
use super::fields::concentration;
use super::panel::{Axis, MARGIN, Panel, grid, legend};
use super::{Figure, Samples, WIDTH, clock, spread};

/// Concentration of each species along x in the first realization.
pub fn profiles(samples: &Samples) -> Option<Figure> {
    if samples.record.domain.dimensions != 1 || samples.frames.is_empty() {
        return None;
    }
    let chosen = spread(samples.frames.len(), 4);
    let columns = if samples.species.len() == 1 { 1 } else { 2 };
    let (mut d, frames) =
        grid(samples.species.len(), columns, if columns == 1 { 110.0 } else { WIDTH }, 45.0);
    let mut shown: Vec<(String, Colour, f64)> = Vec::new();
    for (k, frame_of_panel) in frames.into_iter().enumerate() {
        let profile = |f: usize| -> (Vec<f64>, Vec<f64>) {
            let frame = &samples.frames[f];
            let mut order: Vec<usize> = (0..frame.len()).collect();
            order.sort_by(|&a, &b| frame.position[a][0].total_cmp(&frame.position[b][0]));
            order.iter().map(|&i| (frame.position[i][0], concentration(frame, k, i))).unzip()
        };
        let curves: Vec<(f64, Vec<f64>, Vec<f64>)> = chosen
            .iter()
            .map(|&f| {
                let (x, c) = profile(f);
                (samples.frames[f].time, x, c)
            })
            .collect();
        let x = Axis::covering(curves.iter().flat_map(|c| c.1.iter().copied()), "m", "x");
        let y = Axis::covering(curves.iter().flat_map(|c| c.2.iter().copied()), "mol/m^3", "concentration")
            .with_air();
        let [left, top, width, height] = frame_of_panel;
        let p = Panel { left, top, width, height, x, y };
        shown.clear();
        for (n, (time, x, c)) in curves.iter().enumerate() {
            let colour = viridis(0.85 * n as f64 / 3.0);
            p.curve(&mut d, x, c, 0.3, colour);
            shown.push((clock(samples).show(*time), colour, 0.5));
        }
        p.axes(&mut d, &samples.species[k]);
    }
    d.height += 5.0;
    let bottom = d.height - 3.0;
    legend(&mut d, MARGIN[0], bottom, &shown);
    Some(Figure {
        name: "profiles".into(),
        title: "Profiles".into(),
        caption: "Particles of one realization; amount over particle volume.".into(),
        drawing: d,
        raster: false,
    })
}
