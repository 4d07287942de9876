//! Profiles of one-dimensional models: concentrations along x at several times.

use super::colours::{GREY, palette};
use super::fields::concentration;
use super::panel::{Axis, MARGIN, Panel, grid, legend};
use super::probes::{BAND, unit};
use super::sections::{Section, sections};
use super::{Drawing, Figure, Samples, WIDTH, clock, moments};

/// Concentration of every species along x: mean and band where a line probe recorded it, else one realization.
pub fn profiles(samples: &Samples) -> Option<Figure> {
    if samples.record.domain.dimensions != 1 {
        return None;
    }
    along_probe(samples).or_else(|| of_particles(samples))
}

/// One panel per time.
struct Moment {
    time: f64,
    sections: Vec<(usize, Section)>,
}

fn along_probe(samples: &Samples) -> Option<Figure> {
    let probe = samples.record.probes.iter().find(|p| p.kind == "line")?;
    let names: Vec<&str> = probe
        .quantities
        .keys()
        .map(String::as_str)
        .filter(|q| unit(samples, &probe.name, q) == "mol/m^3")
        .collect();
    // From the distance along the line to x.
    let row = samples.probes.iter().find(|r| r.probe == probe.name && r.s.len() > 1)?;
    let last = row.s.len() - 1;
    let way = (row.position[last][0] - row.position[0][0]).signum();
    let start = row.position[0][0] - way * row.s[0];
    let mut moments: Vec<Moment> = Vec::new();
    for (k, name) in names.iter().enumerate() {
        for mut section in sections(samples, &probe.name, name) {
            section.s.iter_mut().for_each(|s| *s = start + way * *s);
            match moments.iter_mut().find(|m| m.time == section.time) {
                Some(moment) => moment.sections.push((k, section)),
                None => moments.push(Moment { time: section.time, sections: vec![(k, section)] }),
            }
        }
    }
    let realizations = moments.first()?.sections.first()?.1.realizations;
    let words = match realizations {
        1 => "One realization.".to_string(),
        n if n < BAND => format!("Mean of {n} realizations."),
        n => format!("Thick: mean of {n} realizations; shaded: 5 to 95 % of them; thin: one realization."),
    };
    Some(figure(samples, &moments, &names, &words))
}

fn of_particles(samples: &Samples) -> Option<Figure> {
    let times: Vec<f64> = samples.frames.iter().map(|f| f.time).collect();
    let moment = |f: usize| {
        let frame = &samples.frames[f];
        let mut order: Vec<usize> = (0..frame.len()).collect();
        order.sort_by(|&a, &b| frame.position[a][0].total_cmp(&frame.position[b][0]));
        let s: Vec<f64> = order.iter().map(|&i| frame.position[i][0]).collect();
        let section = |k: usize| {
            let mean: Vec<f64> = order.iter().map(|&i| concentration(frame, k, i)).collect();
            let (low, high, single) = (mean.clone(), mean.clone(), mean.clone());
            (k, Section { time: frame.time, s: s.clone(), mean, low, high, realizations: 1, single })
        };
        Moment { time: frame.time, sections: (0..samples.species.len()).map(section).collect() }
    };
    let moments: Vec<Moment> = moments(samples, &times).into_iter().map(moment).collect();
    let names: Vec<&str> = samples.species.iter().map(String::as_str).collect();
    let words = "Particles of one realization; amount over particle volume.";
    (!moments.is_empty()).then(|| figure(samples, &moments, &names, words))
}

fn figure(samples: &Samples, moments: &[Moment], names: &[&str], words: &str) -> Figure {
    let columns = moments.len().min(2);
    let (mut d, frames) = grid(moments.len(), columns, if columns == 1 { 110.0 } else { WIDTH }, 46.0);
    let all = || moments.iter().flat_map(|m| &m.sections).map(|s| &s.1);
    let x = Axis::covering(all().flat_map(|s| s.s.iter().copied()), "m", "x");
    let values = all().flat_map(|s| s.low.iter().chain(&s.high).chain(&s.single).copied());
    let y = Axis::covering(values, "mol/m^3", "concentration").with_air();
    for (moment, [left, top, width, height]) in moments.iter().zip(frames) {
        let p = Panel { left, top, width, height, x: x.clone(), y: y.clone() };
        for (k, section) in &moment.sections {
            draw(&mut d, &p, section, *k);
        }
        p.axes(&mut d, &clock(samples).show(moment.time));
    }
    d.height += 5.0;
    let bottom = d.height - 3.0;
    let shown: Vec<_> = names.iter().enumerate().map(|(k, n)| ((*n).to_string(), palette(k), 0.5)).collect();
    legend(&mut d, MARGIN[0], bottom, &shown);
    Figure {
        name: "profiles".into(),
        title: "Concentrations along x".into(),
        caption: words.into(),
        drawing: d,
        raster: false,
    }
}

fn draw(d: &mut Drawing, p: &Panel, section: &Section, species: usize) {
    if section.realizations >= BAND {
        p.band(d, &section.s, &section.low, &section.high, palette(species).faint(0.22));
        p.curve(d, &section.s, &section.single, 0.1, GREY);
    }
    p.curve(d, &section.s, &section.mean, 0.45, palette(species));
}
