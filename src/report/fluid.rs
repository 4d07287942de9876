//! The fluid on the page: what it is, what was asked of it, what it did.

use super::html::table;
use crate::quantity::readable::{grouped, show, significant};
use crate::record::RunRecord;

/// The numbers of the fluid; nothing where nothing flows.
pub fn fluid(record: &RunRecord) -> String {
    let Some(fluid) = &record.fluid else { return String::new() };
    let mut rows: Vec<Vec<String>> = Vec::new();
    let mut row = |what: &str, asked: String, found: String| rows.push(vec![what.into(), asked, found]);
    let health = &record.health;
    let percent = |x: f64| format!("{} %", significant(100.0 * x, 3));
    let number = |x: f64| significant(x, 3);
    let or_dash = |x: Option<String>| x.unwrap_or_else(|| "–".into());
    row("method", fluid.method.clone(), String::new());
    row("density", show(fluid.density, "kg/m^3"), String::new());
    row("viscosity", show(fluid.viscosity, "Pa s"), String::new());
    row("sound speed c₀", show(fluid.sound_speed, "m/s"), String::new());
    row(
        &format!("largest speed ({})", fluid.speed_of),
        show(fluid.speed, "m/s"),
        or_dash(health.largest_mach.map(|mach| show(mach * fluid.sound_speed, "m/s"))),
    );
    row("Mach number", number(fluid.mach), or_dash(health.largest_mach.map(number)));
    row(
        &format!("Reynolds number (length {}, {})", show(fluid.length, "m"), fluid.length_of),
        number(fluid.reynolds),
        or_dash(
            health
                .largest_mach
                .filter(|_| fluid.mach > 0.0)
                .map(|mach| number(fluid.reynolds * mach / fluid.mach)),
        ),
    );
    if let Some(noise) = &fluid.noise {
        let measured =
            health.temperature.map(|t| format!("{} ({} looks)", show(t.mean, "K"), grouped(t.looks)));
        row(
            &format!("temperature ({} noise)", noise.friction),
            show(noise.temperature, "K"),
            or_dash(measured),
        );
        row("thermal speed of a particle", show(noise.thermal_speed, "m/s"), String::new());
    }
    row("largest change of density", String::new(), or_dash(health.largest_density_change.map(percent)));
    row("particles inside a wall", "0".into(), or_dash(health.penetrations.map(grouped)));
    if let Some(drift) = health.momentum_drift {
        row("drift of momentum", "0".into(), number(drift));
    }
    let note = if fluid.noise.is_some() {
        "<p>The temperature is that of velocities against the mean of their neighbours, at the output times of the second half of the run.</p>\n"
    } else {
        ""
    };
    format!("<h3>Fluid</h3>\n{}{note}", table(&["", "asked or expected", "found"], &[1, 2], &rows))
}
