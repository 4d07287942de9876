//! The centrelines of the cavity and all other places where velocities are read.

use crate::figures::contour::GridField;
use crate::validation::flow::Look;
use crate::validation::reading::velocities;
use crate::validation::stream_function::Mesh;
use crate::validation::table::Table;
use crate::vector::Vector;

/// Misprints of the published tables: Reynolds number, and the place of the station that is left out.
const MISPRINTS: [(u32, f64); 3] = [(10_000, 0.5), (400, 0.9063), (3200, 0.4531)];

/// Reynolds numbers of the independent solution.
const SOLVED: [u32; 2] = [100, 1000];

/// One of the centrelines.
pub struct Line {
    /// Places of the stations and Ghia's values, walls left out.
    pub place: Vec<f64>,
    pub ghia: Vec<f64>,
    /// The independent solution there; empty where there is none.
    pub solved: Vec<f64>,
    /// Ours there, averaged.
    pub ours: Vec<f64>,
    /// Ours at even distances, for the figure.
    pub fine: Vec<[f64; 2]>,
}

/// Ghia's stations of one line.
pub fn stations(table: &Table, solved: &Table, place: &str, letter: &str, reynolds: u32) -> Line {
    let column = format!("{letter}_re{reynolds}");
    let all = table.every(place, 1).into_iter().zip(table.every(&column, 1));
    let misprint = |at: f64| MISPRINTS.iter().any(|(re, m)| *re == reynolds && (at - m).abs() < 1e-9);
    let inside = |at: f64| at > 0.0 && at < 1.0 && !misprint(at);
    let solved = if SOLVED.contains(&reynolds) {
        let all = solved.every(place, 1).into_iter().zip(solved.every(&column, 1));
        all.filter(|&(at, _)| inside(at)).map(|(_, value)| value).collect()
    } else {
        Vec::new()
    };
    let (place, ghia) = all.filter(|&(at, _)| inside(at)).unzip();
    Line { place, ghia, solved, ours: Vec::new(), fine: Vec::new() }
}

/// All places velocities are read at.
pub struct Wanted {
    pub places: Vec<Vector<2>>,
    /// How many of them are on the centrelines.
    on_lines: usize,
    /// Places on the walls and the velocity there.
    walls: Vec<(Vector<2>, Vector<2>)>,
}

impl Wanted {
    const FINE: usize = 101;

    /// Stations, evenly spaced places of the figure, and the mesh.
    pub fn new(lines: &[Line; 2], mesh: Mesh) -> Wanted {
        let on = |axis: usize, s: f64| Vector::from(if axis == 0 { [0.5, s] } else { [s, 0.5] });
        let mut places = Vec::new();
        for (axis, line) in lines.iter().enumerate() {
            places.extend(line.place.iter().map(|&s| on(axis, s)));
            places.extend((0..Wanted::FINE).map(|k| on(axis, Wanted::fine(k))));
        }
        let on_lines = places.len();
        places.extend(mesh.places());
        let mut walls = Vec::new();
        // As close as the nodes of the mesh; the corners of the lid belong to nobody.
        for k in 1..mesh.cells {
            let s = k as f64 / mesh.cells as f64;
            for place in [[s, 0.0], [0.0, s], [1.0, s]] {
                walls.push((Vector::from(place), Vector::zeros()));
            }
            walls.push((Vector::from([s, 1.0]), Vector::from([1.0, 0.0])));
        }
        Wanted { places, on_lines, walls }
    }

    /// Velocities at all places: on the lines from the particles alone, on the mesh with what is known of the walls,
    /// where slow corner vortices would drown in what extrapolation makes of the last layer.
    pub fn read(&self, look: &Look<2>) -> Vec<Vector<2>> {
        let (lines, mesh) = self.places.split_at(self.on_lines);
        [velocities(look, lines, &[]), velocities(look, mesh, &self.walls)].concat()
    }

    /// Distances for the figure, wall to wall.
    fn fine(k: usize) -> f64 {
        k as f64 / (Wanted::FINE - 1) as f64
    }

    /// Gives each line its values; the rest makes the stream function.
    pub fn hand_out(&self, mean: &[Vector<2>], lines: &mut [Line; 2], mesh: Mesh) -> GridField {
        let mut at = 0;
        for (axis, line) in lines.iter_mut().enumerate() {
            let mut take = |count: usize| {
                let values: Vec<f64> = mean[at..at + count].iter().map(|v| v[axis]).collect();
                at += count;
                values
            };
            line.ours = take(line.place.len());
            line.fine =
                take(Wanted::FINE).into_iter().enumerate().map(|(k, v)| [Wanted::fine(k), v]).collect();
        }
        mesh.stream_function(&mean[at..])
    }
}

/// Root of the mean square difference of two sets of values; not a number where one is empty.
pub fn rms(ours: &[f64], theirs: &[f64]) -> f64 {
    let sum: f64 = ours.iter().zip(theirs).map(|(a, b)| (a - b).powi(2)).sum();
    (sum / ours.len().min(theirs.len()) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_and_misprints_are_left_out() {
        let table = Table::read(include_str!("../data/ghia1982_u_vertical_centreline.csv"));
        let solved = Table::read(include_str!("../data/cavity_solved_u.csv"));
        // 17 stations less two walls, and less one misprint at Re = 10000.
        assert_eq!(stations(&table, &solved, "y", "u", 100).place.len(), 15);
        let line = stations(&table, &solved, "y", "u", 10_000);
        assert!(line.place.len() == 14 && !line.place.contains(&0.5));
        // A difference of 0.1 everywhere is an error of 0.1.
        let ours: Vec<f64> = line.ghia.iter().map(|u| u + 0.1).collect();
        assert!((rms(&ours, &line.ghia) - 0.1).abs() < 1e-12);
        assert!(line.solved.is_empty() && rms(&ours, &line.solved).is_nan());
        // What Ghia's tables themselves are off by at Re = 100.
        let line = stations(&table, &solved, "y", "u", 100);
        assert!((rms(&line.solved, &line.ghia) - 2.54e-3).abs() < 1e-5);
    }
}
