//! Draws from a row of probabilities at one random number each: the alias method.

use rand::Rng;

/// One column of an alias table (Walker 1977; Vose 1991): `own` below the cut, `other` above.
#[derive(Clone, Copy, Debug)]
pub(super) struct Column {
    cut: u64,
    own: u32,
    other: u32,
}

/// The column from the high word of a product, the cut from its low word: one 64-bit number per draw.
#[inline]
pub(super) fn draw<R: Rng>(columns: &[Column], random: &mut R) -> usize {
    let wide = u128::from(random.next_u64()) * columns.len() as u128;
    let column = columns[(wide >> 64) as usize];
    // Chosen by a mask: the comparison is as good as random, so a branch would often be mispredicted.
    let below = u32::from((wide as u64) < column.cut).wrapping_neg();
    (column.other ^ ((column.own ^ column.other) & below)) as usize
}

/// Work space for Vose's construction.
#[derive(Default)]
pub(super) struct AliasWorker {
    share: Vec<f64>,
    small: Vec<u32>,
    large: Vec<u32>,
}

impl AliasWorker {
    /// Appends the columns of one row, `total` = Σ `probability`.
    pub(super) fn append(
        &mut self,
        target: &[u32],
        probability: &[f64],
        total: f64,
        columns: &mut Vec<Column>,
    ) {
        let first = columns.len();
        let scale = target.len() as f64 / total;
        self.share.clear();
        self.small.clear();
        self.large.clear();
        for (k, &p) in probability.iter().enumerate() {
            self.share.push(p * scale);
            let list = if p * scale < 1.0 { &mut self.small } else { &mut self.large };
            list.push(k as u32);
        }
        columns.extend(target.iter().map(|&own| Column { cut: u64::MAX, own, other: own }));
        while let (Some(&s), Some(&l)) = (self.small.last(), self.large.last()) {
            self.small.pop();
            let share = self.share[s as usize];
            let column = &mut columns[first + s as usize];
            column.cut = (share * 18_446_744_073_709_551_616.0) as u64; // 2^64
            column.other = target[l as usize];
            self.share[l as usize] -= 1.0 - share;
            if self.share[l as usize] < 1.0 {
                self.large.pop();
                self.small.push(l);
            }
        }
    }
}
