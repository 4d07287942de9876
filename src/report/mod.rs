//! The page of a run: what was run, what came out, whether to trust it.
//!
//! One self-contained HTML file without scripts; vector figures are inline SVG, rasters inline PNG. Reads
//! `run.json` and the tables only.

mod base64;
#[cfg(test)]
mod example;
#[cfg(test)]
mod example_solid;
mod fluid;
mod html;
mod measures;
mod numbers;
mod sections;
mod solids;
mod summary;
mod sweep;

use crate::error::RunError;
use crate::figures::{self, Figure, Samples, escape};
use crate::tables;
use rayon::prelude::*;
use std::path::Path;

/// Draws `figures/` and writes `report.html` in the folder of a run or a sweep.
///
/// # Errors
/// [`RunError::File`] if the record is missing, a table cannot be read or a file cannot be written.
pub fn write(dir: &Path) -> Result<(), RunError> {
    if tables::is_sweep(dir) {
        return sweep::write(dir);
    }
    let samples = Samples::read(dir)?;
    let drawn = figures::draw(&samples);
    let folder = dir.join("figures");
    let shown = drawn
        .par_iter()
        .enumerate()
        .map(|(number, figure)| {
            figures::save(figure, &folder)?;
            Ok((section(figure), inline(figure, number + 1, &folder)?))
        })
        .collect::<Result<Vec<(usize, String)>, RunError>>()?;
    let page = page(&samples, &shown);
    tables::write_bytes(&dir.join("report.html"), page.as_bytes())
}

/// Headings of the page's figures, in order.
const SECTIONS: [&str; 6] =
    ["At a glance", "Set-up", "Fields", "Solids", "Course in time", "Profiles and distributions"];

fn section(figure: &Figure) -> usize {
    match figure.name.as_str() {
        "overview" => 0,
        "setup" => 1,
        name if name.starts_with("field_") || name == "velocity" || name == "pressure" => 2,
        name if name.starts_with("solid_") => 3,
        "amounts" | "occupancy" => 4,
        _ => 5,
    }
}

fn inline(figure: &Figure, number: usize, folder: &Path) -> Result<String, RunError> {
    let image = if figure.raster {
        let path = folder.join(format!("{}.png", figure.name));
        let bytes = std::fs::read(&path)
            .map_err(|e| RunError::File { path: path.display().to_string(), reason: e.to_string() })?;
        let image = base64::base64(&bytes);
        format!("<img alt=\"{}\" src=\"data:image/png;base64,{image}\">", escape(&figure.title))
    } else {
        figures::svg(&figure.drawing)
    };
    Ok(format!(
        "<figure><div style=\"max-width:{:.0}mm\">{image}</div><figcaption><b>Figure {number}. {}.</b> {}</figcaption></figure>\n",
        // On a screen a figure is read from further away than in print.
        1.4 * figure.drawing.width,
        escape(&figure.title),
        escape(&figure.caption)
    ))
}

fn page(samples: &Samples, figures: &[(usize, String)]) -> String {
    let record = &samples.record;
    let mut out = head(&record.name);
    out += &summary::summary(samples);
    for (k, heading) in SECTIONS.iter().enumerate() {
        if k == 1 {
            out += &sections::chemistry(record);
            out += &fluid::fluid(record);
            out += &solids::solids(record);
        }
        let here: Vec<&str> = figures.iter().filter(|f| f.0 == k).map(|f| f.1.as_str()).collect();
        let numbers = if k == 3 { measures::measures(samples) } else { String::new() };
        if !here.is_empty() || !numbers.is_empty() {
            out += &format!("<h2>{heading}</h2>\n{numbers}{}", here.concat());
        }
    }
    out += &numbers::numbers(samples);
    out += &numbers::correlations(samples);
    out += &sections::health(samples);
    out += &sections::cost(record);
    out += &sections::provenance(record);
    out + &foot(&record.program, &record.version)
}

/// The page up to its heading.
fn head(name: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{0}</title>\n<style>\n{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n",
        escape(name),
        include_str!("style.css")
    )
}

/// The end of the page.
fn foot(program: &str, version: &str) -> String {
    format!(
        "<footer>{} {}; figures also as files under <code>figures/</code>, numbers under <code>tables/</code>.</footer>\n</body>\n</html>\n",
        escape(program),
        escape(version)
    )
}
