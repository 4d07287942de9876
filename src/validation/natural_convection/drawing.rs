//! Figures of natural convection: profiles over the reference, isotherms.

use super::{Convection, RADIUS};
use crate::figures::Figure;
use crate::figures::colours::{BLACK, GREY, palette, viridis};
use crate::figures::maps::{Levels, Window, disc, level_lines};
use crate::figures::plot::{Plot, Ruler, Style, Trace, plots};
use crate::validation::findings::Curves;
use crate::validation::table::Table;

/// All figures and the numbers behind them.
pub fn draw(found: &[Convection]) -> (Vec<Curves>, Vec<Figure>) {
    let (mut curves, mut figures) = (Vec::new(), Vec::new());
    let mut exponents: Vec<i32> = found.iter().map(|one| one.rayleigh.exponent).collect();
    exponents.dedup();
    let mut panels = Vec::new();
    for exponent in exponents {
        let (mut c, mut v) = (Vec::new(), Vec::new());
        for (k, one) in found.iter().filter(|one| one.rayleigh.exponent == exponent).enumerate() {
            if k == 0 {
                let solved = Table::read(one.rayleigh.solved);
                let x = solved.every("x", 1);
                let name = "independent solution";
                c.push(Trace::new(name, &x, &solved.every("c", 1), Style::Dashed, GREY));
                v.push(Trace::new(name, &x, &solved.every("vy", 1), Style::Dashed, GREY));
                let name = "Moukalled & Acharya 1996, digitised";
                let points = |text: &str, column: &str| {
                    let table = Table::read(text);
                    Trace::new(name, &table.every("x", 1), &table.every(column, 1), Style::Points, BLACK)
                };
                c.push(points(one.rayleigh.digitised_c, "c"));
                v.push(points(one.rayleigh.digitised_v, "vy"));
            }
            let name = format!("{0} x {0}", one.across);
            c.push(Trace::new(&name, &one.x, &one.c, Style::Line, palette(k)));
            v.push(Trace::new(&name, &one.x, &one.v, Style::Line, palette(k)));
            let columns = [("x", one.x.clone()), ("c", one.c.clone()), ("vy", one.v.clone())];
            curves.push(Curves::new(&format!("profile_ra1e{exponent}_{}", one.across), columns));
        }
        let x = || Ruler::linear("x / L").from(0.6, 1.0);
        let title = |letter: &str| {
            format!("{letter}, Ra = 10{}", ["⁴", "⁵", "⁶"][(exponent - 4).clamp(0, 2) as usize])
        };
        panels.push(Plot {
            title: title("concentration"),
            x: x(),
            y: Ruler::linear("c / c of the cylinder"),
            traces: c,
        });
        panels
            .push(Plot { title: title("upward velocity"), x: x(), y: Ruler::linear("v L / ν"), traces: v });
    }
    figures.push(plots(
        "natural_convection",
        "Profiles right of the cylinder",
        "On y = L/2 from the cylinder (0.6) to the wall (1); means over the states at the end.",
        &panels,
        2,
        48.0,
    ));
    for one in found {
        let levels = (1..=19).map(|k| f64::from(k) / 20.0).map(|c| (c, viridis(0.9 * c))).collect();
        let window = Window {
            title: format!(
                "Ra = 10{}, {1} x {1}",
                ["⁴", "⁵", "⁶"][(one.rayleigh.exponent - 4).clamp(0, 2) as usize],
                one.across
            ),
            ends: [0.0, 1.0, 0.0, 1.0],
            labels: ["x / L".into(), "y / L".into()],
        };
        figures.push(level_lines(
            &format!("isotherms_ra1e{}_{}", one.rayleigh.exponent, one.across),
            "Isotherms of natural convection",
            "Lines of equal concentration, 0.05 to 0.95 of the cylinder's in steps of 0.05.",
            &[Levels {
                window,
                field: one.field.clone(),
                levels,
                solid: vec![disc([0.5, 0.5], RADIUS)],
                marks: Vec::new(),
            }],
            &[
                ("c = 0.25".into(), viridis(0.225)),
                ("0.5".into(), viridis(0.45)),
                ("0.75".into(), viridis(0.675)),
            ],
        ));
    }
    (curves, figures)
}
