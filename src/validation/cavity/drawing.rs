//! Figures of the cavity: centrelines over Ghia's points, stream lines, particles.

use super::{Steady, corner};
use crate::figures::Figure;
use crate::figures::colours::{BLACK, Colour, palette};
use crate::figures::maps::{Cloud, Levels, Window, level_lines, particles};
use crate::figures::plot::{Plot, Ruler, Style, Trace, plots};
use crate::validation::findings::Curves;
use crate::validation::flow::Look;
use crate::validation::vortices::Corner;

/// Particles coloured by speed; none yet if `None`.
pub fn cloud_of(look: Option<&Look<2>>, side: u32) -> Cloud {
    Cloud {
        window: window(String::new()),
        position: look.map_or_else(Vec::new, |l| l.position.iter().map(|x| [x[0], x[1]]).collect()),
        value: look.map_or_else(Vec::new, |l| l.velocity.iter().map(|v| v.norm()).collect()),
        size: 1.0 / f64::from(side),
    }
}

fn window(title: String) -> Window {
    Window { title, ends: [0.0, 1.0, 0.0, 1.0], labels: ["x / L".into(), "y / L".into()] }
}

fn name(one: &Steady) -> String {
    format!("Re {}, {1} x {1}", one.reynolds, one.side)
}

/// All figures and the numbers behind them.
pub fn draw(found: &[Steady]) -> (Vec<Curves>, Vec<Figure>) {
    let mut curves = Vec::new();
    let (mut u, mut v, mut energies) = (Vec::new(), Vec::new(), Vec::new());
    for (k, one) in found.iter().enumerate() {
        for (line, traces) in one.lines.iter().zip([&mut u, &mut v]) {
            let (s, value): (Vec<f64>, Vec<f64>) = line.fine.iter().map(|p| (p[0], p[1])).unzip();
            traces.push(Trace::new(&name(one), &s, &value, Style::Line, palette(k)));
        }
        energies.push(Trace::new(&name(one), &one.energy[0], &one.energy[1], Style::Line, palette(k)));
        for (line, letter) in one.lines.iter().zip(["u", "v"]) {
            let place = if letter == "u" { "y" } else { "x" };
            curves.push(Curves::new(
                &format!("{letter}_re{}_{}", one.reynolds, one.side),
                [(place, line.place.clone()), (letter, line.ours.clone()), ("ghia1982", line.ghia.clone())],
            ));
        }
        curves.push(Curves::new(
            &format!("energy_re{}_{}", one.reynolds, one.side),
            [("t", one.energy[0].clone()), ("kinetic_energy", one.energy[1].clone())],
        ));
    }
    // Reference points over the lines, once for each Reynolds number.
    let mut shown = Vec::new();
    for one in found {
        if !shown.contains(&one.reynolds) {
            shown.push(one.reynolds);
            for (line, traces) in one.lines.iter().zip([&mut u, &mut v]) {
                traces.push(Trace::new("Ghia et al. 1982", &line.place, &line.ghia, Style::Points, BLACK));
            }
        }
    }
    let panels = [
        Plot {
            title: "a  on x = L/2".into(),
            x: Ruler::linear("y / L").from(0.0, 1.0),
            y: Ruler::linear("u / U"),
            traces: u,
        },
        Plot {
            title: "b  on y = L/2".into(),
            x: Ruler::linear("x / L").from(0.0, 1.0),
            y: Ruler::linear("v / U"),
            traces: v,
        },
        Plot {
            title: "c  energy over time".into(),
            x: Ruler::linear("t U / L"),
            y: Ruler::linear("kinetic energy / (ρ U² L²)"),
            traces: energies,
        },
    ];
    let mut figures = vec![plots(
        "cavity",
        "Velocity on the centrelines of the lid-driven cavity",
        "Lines: means over the last 5 L/U. Circles: Ghia, Ghia & Shin (1982). c: from rest, but 200 x 200 at Re = 10 000, run after 100 x 100, from the \
         mean flow of that.",
        &panels,
        3,
        44.0,
    )];
    for one in found {
        figures.push(streamlines(one));
        let mut cloud = one.cloud.clone();
        cloud.window.title = name(one);
        figures.push(particles(
            &format!("cavity_particles_re{}_{}", one.reynolds, one.side),
            "Particles of the lid-driven cavity",
            "Coloured by speed, at the end.",
            &[cloud],
            "speed / U",
        ));
    }
    (curves, figures)
}

/// Stream lines of the whole cavity, and of its lower corners closer.
fn streamlines(one: &Steady) -> Figure {
    let strongest =
        one.psi.values.iter().copied().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
    let levels = |main: &[f64], counter: &[f64]| -> Vec<(f64, Colour)> {
        let main = main.iter().map(|part| (part * strongest, palette(0)));
        let counter = counter.iter().map(|part| (-part * strongest, palette(1)));
        main.chain(counter).chain([(0.0, BLACK)]).collect()
    };
    let whole: Vec<f64> = (1..=9).map(|k| f64::from(k) / 10.0).chain([0.98, 0.03, 0.01]).collect();
    let faint: Vec<f64> = (0..6).map(|k| 1.5e-2 * 0.4_f64.powi(k)).collect();
    let mut near = window("lower corners".into());
    near.ends = [0.0, 1.0, 0.0, 0.5];
    let mut marks = Vec::new();
    for which in [Corner::Left, Corner::Right] {
        if let Some(extent) = corner(&one.psi, which) {
            let x = if which == Corner::Left { extent.width } else { 1.0 - extent.width };
            let wall = if which == Corner::Left { 0.0 } else { 1.0 };
            marks.push([[x, 0.0], [x, extent.height]]);
            marks.push([[wall, extent.height], [x, extent.height]]);
        }
    }
    let panel =
        |window, levels, marks| Levels { window, field: one.psi.clone(), levels, solid: Vec::new(), marks };
    level_lines(
        &format!("cavity_streamlines_re{}_{}", one.reynolds, one.side),
        &format!("Stream lines of the lid-driven cavity, {}", name(one)),
        "Levels of the stream function over its extreme: 0.01 to 0.98 in the main vortex, 0.00015 to 0.015 in those of \
         the corners. Broken: extents of the corner vortices.",
        &[
            panel(window(name(one)), levels(&whole, &faint), Vec::new()),
            panel(near, levels(&[0.001, 0.003, 0.01, 0.03, 0.1, 0.2], &faint), marks),
        ],
        &[
            ("main vortex".into(), palette(0)),
            ("turning the other way".into(), palette(1)),
            ("dividing line".into(), BLACK),
        ],
    )
}
