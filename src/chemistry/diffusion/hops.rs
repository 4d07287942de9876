//! The jump chain of a frozen geometry: where a molecule goes when it makes a virtual jump.

use super::Door;
use super::alias::{AliasWorker, Column, draw};
use crate::chemistry::links::Links;
use crate::chemistry::sampling_numbers::binomial_of_log;
use crate::error::RunError;
use rand::Rng;
use std::sync::OnceLock;

/// The chain P = 1 + Q / Λ on the voxels, for every diffusivity at once (Q and Λ both scale with it). With doors in
/// surfaces, which are the rows beyond the voxels, it is that of one species.
#[derive(Clone, Debug)]
pub struct HopTable {
    /// Λ per unit diffusivity: the largest rate at which a molecule leaves its voxel, 1/m².
    pub rate: f64,
    /// Rate at which a molecule leaves each voxel, 1/m²: Σ_j G_ij / V_i and what its doors take.
    pub leaving: Vec<f64>,
    offsets: Vec<u32>,
    target: Vec<u32>,
    probability: Vec<f64>,
    /// Made when the first molecule is drawn; continuous amounts need none.
    columns: OnceLock<Vec<Column>>,
    /// Made when the first row is dealt out by binomials.
    chain: OnceLock<Chain>,
}

/// Chances of the binomials that deal out a row.
#[derive(Clone, Debug, Default)]
struct Chain {
    /// Probability of an entry given that no earlier entry of its row was taken.
    conditional: Vec<f64>,
    /// ln(1 - conditional), which a binomial by inversion starts from.
    log_passed: Vec<f64>,
}

/// One draw from a row costs 1.15 ns, one binomial of a chain 65 ns: `cargo bench --bench particles -- scatter`.
const DRAWS_PER_BINOMIAL: u64 = 56;

/// Entries with less than this share of a row are rounding of 1 - Σ.
const NOTHING: f64 = 1e-15;

impl HopTable {
    /// From conductances (m) and volumes (m³), using only the links whose both ends satisfy `lives`.
    ///
    /// # Errors
    /// A conductance that is negative or not finite (kernel-gradient corrected weights can be), a volume
    /// that is not positive, or a link to a voxel that does not exist.
    pub fn build(
        links: &Links,
        volumes: &[f64],
        lives: impl Fn(usize) -> bool,
    ) -> Result<HopTable, RunError> {
        let voxels = volumes.len();
        let mut table = HopTable {
            rate: 0.0,
            leaving: vec![0.0; voxels],
            offsets: Vec::with_capacity(voxels + 1),
            target: Vec::with_capacity(links.neighbour.len() + voxels),
            probability: Vec::with_capacity(links.neighbour.len() + voxels),
            columns: OnceLock::new(),
            chain: OnceLock::new(),
        };
        for (i, &volume) in volumes.iter().enumerate() {
            if !(volume > 0.0 && volume.is_finite()) {
                return Err(bad(i, "volume / m³", volume, "a voxel needs a positive volume"));
            }
            let mut sum = 0.0;
            for (j, g) in links.row(i) {
                if !(g >= 0.0 && g.is_finite()) {
                    let remedy = "hop rates need conductances that are finite and not negative";
                    return Err(bad(i, "conductance / m", g, remedy));
                }
                if j >= voxels {
                    return Err(bad(i, "neighbour", j as f64, "the links name a voxel that does not exist"));
                }
                if j != i && lives(i) && lives(j) {
                    sum += g / volume;
                }
            }
            table.leaving[i] = sum;
            table.rate = table.rate.max(sum);
        }
        table.offsets.push(0);
        for (i, &volume) in volumes.iter().enumerate() {
            table.push_row(i, links, volume, &lives);
        }
        Ok(table)
    }

    /// Number of voxels.
    #[must_use]
    pub fn voxels(&self) -> usize {
        self.leaving.len()
    }

    /// Number of rows: voxels, then doors.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.offsets.len() - 1
    }

    /// The same chain with `doors`, row by row after the voxels, and the means by which the doors send.
    #[must_use]
    pub fn with_doors(&self, doors: &[Door]) -> (HopTable, Vec<f64>) {
        let voxels = self.voxels();
        let mut exits: Vec<(u32, u32, f64)> = Vec::new();
        for (number, door) in doors.iter().enumerate() {
            exits.extend(door.out.iter().map(|&(i, rate)| (i, (voxels + number) as u32, rate)));
        }
        exits.sort_by_key(|&(i, door, _)| (i, door));
        let mut leaving = self.leaving.clone();
        exits.iter().for_each(|&(i, _, rate)| leaving[i as usize] += rate);
        let rate = leaving.iter().copied().fold(0.0, f64::max);
        let into = |door: &Door| door.into.iter().map(|&(_, rate)| rate).sum::<f64>();
        // Where nothing leaves any voxel, any rate does.
        let rate = if rate > 0.0 { rate } else { 1.0 };
        let (length, more) =
            (self.entries() + exits.len(), doors.iter().map(|door| door.into.len()).sum::<usize>());
        let mut table = HopTable {
            rate,
            leaving,
            offsets: Vec::with_capacity(voxels + doors.len() + 1),
            target: Vec::with_capacity(length + voxels + more),
            probability: Vec::with_capacity(length + voxels + more),
            columns: OnceLock::new(),
            chain: OnceLock::new(),
        };
        table.offsets.push(0);
        let slower = self.rate / rate;
        let mut exits = exits.iter().peekable();
        for i in 0..voxels {
            for (j, p) in self.row(i).filter(|&(j, _)| j != i) {
                table.push(j, p * slower);
            }
            while let Some(&(_, door, out)) = exits.next_if(|exit| exit.0 as usize == i) {
                table.push(door as usize, out / rate);
            }
            table.end_row(i, table.leaving[i]);
        }
        let sums: Vec<f64> = doors.iter().map(into).collect();
        for (door, sum) in doors.iter().zip(&sums) {
            for &(i, entering) in &door.into {
                table.push(i as usize, entering / sum);
            }
            table.offsets.push(table.target.len() as u32);
        }
        (table, sums.iter().map(|sum| sum / rate).collect())
    }

    /// Number of entries in all rows.
    #[must_use]
    pub fn entries(&self) -> usize {
        self.target.len()
    }

    /// Targets of a virtual jump from voxel `i` and their probabilities; `i` itself among them.
    #[inline]
    pub fn row(&self, i: usize) -> impl ExactSizeIterator<Item = (usize, f64)> + '_ {
        let range = self.range(i);
        self.target[range.clone()].iter().zip(&self.probability[range]).map(|(&j, &p)| (j as usize, p))
    }

    /// Target of one virtual jump from voxel `i`.
    #[inline]
    pub fn jump<R: Rng>(&self, i: usize, random: &mut R) -> usize {
        draw(&self.columns()[self.range(i)], random)
    }

    /// Target of one hop from voxel `i` to another; by rejection of the jumps that stay.
    /// The voxel must have a link that leaves it.
    #[inline]
    pub fn hop<R: Rng>(&self, i: usize, random: &mut R) -> usize {
        let columns = &self.columns()[self.range(i)];
        if self.leaving[i] > 0.25 * self.rate {
            loop {
                let j = draw(columns, random);
                if j != i {
                    return j;
                }
            }
        }
        // Mostly staying: search the row instead.
        let mut left = random.random::<f64>() * self.leaving[i] / self.rate;
        let mut last = i;
        for (j, p) in self.row(i).filter(|&(j, p)| j != i && p > 0.0) {
            last = j;
            if left < p {
                break;
            }
            left -= p;
        }
        last
    }

    /// Moves `count` molecules of voxel `i` one virtual jump on, into `next`.
    #[inline]
    pub fn scatter<R: Rng>(&self, i: usize, count: u64, next: &mut [u64], random: &mut R) {
        let range = self.range(i);
        if count <= DRAWS_PER_BINOMIAL * range.len() as u64 {
            let columns = &self.columns()[range];
            for _ in 0..count {
                next[draw(columns, random)] += 1;
            }
            return;
        }
        let mut left = count;
        let chain = self.chain();
        let chances = chain.conditional[range.clone()].iter().zip(&chain.log_passed[range.clone()]);
        for (&j, (&p, &log)) in self.target[range].iter().zip(chances) {
            let taken = binomial_of_log(random, left, p, log);
            next[j as usize] += taken;
            left -= taken;
            if left == 0 {
                break;
            }
        }
    }

    #[inline]
    fn range(&self, i: usize) -> std::ops::Range<usize> {
        self.offsets[i] as usize..self.offsets[i + 1] as usize
    }

    fn push_row(&mut self, i: usize, links: &Links, volume: f64, lives: &impl Fn(usize) -> bool) {
        if self.leaving[i] > 0.0 {
            for (j, g) in links.row(i).filter(|&(j, g)| g > 0.0 && j != i && lives(j)) {
                self.push(j, g / volume / self.rate);
            }
        }
        self.end_row(i, self.leaving[i]);
    }

    fn push(&mut self, target: usize, probability: f64) {
        self.target.push(target as u32);
        self.probability.push(probability);
    }

    /// Ends the row of voxel `i` with the jumps that stay.
    fn end_row(&mut self, i: usize, leaving: f64) {
        let staying = if self.rate > 0.0 { 1.0 - leaving / self.rate } else { 1.0 };
        if staying > NOTHING {
            self.push(i, staying);
        }
        self.offsets.push(self.target.len() as u32);
    }

    #[inline]
    fn columns(&self) -> &[Column] {
        self.columns.get_or_init(|| {
            let mut worker = AliasWorker::default();
            let mut columns = Vec::with_capacity(self.target.len());
            for range in (0..self.nodes()).map(|i| self.range(i)) {
                let probability = &self.probability[range.clone()];
                let total = probability.iter().rev().fold(0.0, |sum, p| sum + p);
                worker.append(&self.target[range], probability, total, &mut columns);
            }
            columns
        })
    }

    #[inline]
    fn chain(&self) -> &Chain {
        self.chain.get_or_init(|| {
            let mut conditional = vec![1.0; self.target.len()];
            for range in (0..self.nodes()).map(|i| self.range(i)) {
                let mut tail = 0.0;
                for (c, &p) in
                    conditional[range.clone()].iter_mut().zip(&self.probability[range.clone()]).rev()
                {
                    tail += p;
                    *c = p / tail;
                }
            }
            let log_passed = conditional.iter().map(|c: &f64| (-c).ln_1p()).collect();
            Chain { conditional, log_passed }
        })
    }
}

fn bad(voxel: usize, quantity: &str, value: f64, remedy: &str) -> RunError {
    let (quantity, remedy) = (String::from(quantity), String::from(remedy));
    RunError::BlowUp { step: 0, time: 0.0, particle: voxel, quantity, value, remedy }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, stream};

    fn star() -> HopTable {
        let links = Links::from_pairs(4, &[(0, 1, 0.5), (0, 2, 1.0), (0, 3, 2.0)]);
        HopTable::build(&links, &[1.0, 1.0, 2.0, 4.0], |_| true).unwrap()
    }

    #[test]
    fn rows_sum_to_one_and_keep_concentration_flat() {
        let table = star();
        assert_eq!(table.rate, 3.5);
        let mut after = [0.0; 4];
        for (i, volume) in [1.0, 1.0, 2.0, 4.0].into_iter().enumerate() {
            // Rounding of four terms.
            assert!((table.row(i).map(|(_, p)| p).sum::<f64>() - 1.0).abs() < 1e-15);
            table.row(i).for_each(|(j, p)| after[j] += volume * p);
        }
        for (n, volume) in after.into_iter().zip([1.0, 1.0, 2.0, 4.0]) {
            assert!((n - volume).abs() < 1e-14);
        }
    }

    #[test]
    fn draws_of_both_sizes_follow_the_row() {
        let table = star();
        let mut random = stream(5, 0, Purpose::Diffusion);
        // 400 000 draws: six standard errors of a share are at most 6 * 0.5 / 632 = 0.0047 (chance 1e-8).
        for batch in [10, 4000] {
            let mut next = [0; 4];
            for _ in 0..400_000 / batch {
                table.scatter(0, batch, &mut next, &mut random);
            }
            assert_eq!(next.iter().sum::<u64>(), 400_000);
            for (j, p) in table.row(0) {
                assert!((next[j] as f64 / 4e5 - p).abs() < 0.0047, "{batch} {j}");
            }
        }
        let stays = (0..400_000).filter(|_| table.jump(1, &mut random) == 1).count();
        assert!((stays as f64 / 4e5 - 3.0 / 3.5).abs() < 0.0047);
        assert!((0..100).all(|_| table.hop(1, &mut random) == 0 && table.hop(0, &mut random) != 0));
    }

    #[test]
    fn refuses_what_is_no_conductance() {
        for g in [-1.0, f64::NAN, f64::INFINITY] {
            let links = Links::from_pairs(2, &[(0, 1, g)]);
            assert!(HopTable::build(&links, &[1.0, 1.0], |_| true).is_err());
        }
        let links = Links::from_pairs(2, &[(0, 1, 1.0)]);
        assert!(HopTable::build(&links, &[1.0, 0.0], |_| true).is_err());
    }

    #[test]
    fn no_link_into_a_voxel_where_the_species_may_not_live() {
        let links = Links::from_pairs(3, &[(0, 1, 1.0), (1, 2, 1.0)]);
        let table = HopTable::build(&links, &[1.0; 3], |i| i != 2).unwrap();
        assert_eq!(table.leaving, [1.0, 1.0, 0.0]);
        assert_eq!(table.row(2).collect::<Vec<_>>(), [(2, 1.0)]);
    }

    #[test]
    fn doors_are_rows_more() {
        let doors = [
            Door { out: vec![(0, 1.5), (2, 1.0)], into: Vec::new() },
            Door { out: Vec::new(), into: vec![(1, 6.0), (3, 4.0)] },
        ];
        let (table, means) = star().with_doors(&doors);
        // 3.5 by links and 1.5 by the door.
        assert_eq!((table.rate, table.voxels(), table.nodes()), (5.0, 4, 6));
        assert_eq!(means, [0.0, 2.0]);
        let chance = |i: usize, j: usize| table.row(i).find(|&(k, _)| k == j).map_or(0.0, |(_, p)| p);
        assert_eq!((chance(0, 4), chance(2, 4), chance(5, 1), chance(5, 3)), (0.3, 0.2, 0.6, 0.4));
        for i in 0..4 {
            assert!((table.row(i).map(|(_, p)| p).sum::<f64>() - 1.0).abs() < 1e-15, "{i}");
            // The rates between voxels are what they were.
            for (j, p) in star().row(i).filter(|&(j, _)| j != i) {
                assert!((chance(i, j) * 5.0 - p * 3.5).abs() < 1e-15, "{i} {j}");
            }
        }
        // From a voxel without links a molecule leaves by the door alone.
        let alone = HopTable::build(&Links::from_pairs(1, &[]), &[1.0], |_| true).unwrap();
        let (table, _) = alone.with_doors(&[Door { out: vec![(0, 2.0)], into: Vec::new() }]);
        assert_eq!((table.rate, table.row(0).collect::<Vec<_>>()), (2.0, vec![(1, 1.0)]));
    }
}
