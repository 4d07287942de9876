//! Conserved sums: the whole-number vectors c with c·N = 0, N the stoichiometric matrix.

use nalgebra::DMatrix;

/// Candidates kept while non-negative sums are sought; networks beyond it fall back to signed ones.
const MOST_CANDIDATES: usize = 2000;

/// A basis of the conserved sums, each without common factor.
///
/// The non-negative sums with smallest support (extreme rays) are found first, by the Fourier-Motzkin
/// (Farkas) elimination used for invariants of Petri nets (Colom & Silva 1991); the smallest of them that are
/// independent come first. Where they do not span all conserved sums, signed ones from exact elimination of
/// fractions complete the basis. Exact in whole numbers; a sum whose coefficients leave 64 bits is left out.
#[must_use]
pub fn conservation_laws(stoichiometry: &DMatrix<i32>) -> Vec<Vec<i64>> {
    let species = stoichiometry.nrows();
    let signed = signed_laws(stoichiometry);
    let mut candidates = non_negative_laws(stoichiometry).unwrap_or_default();
    candidates.sort_by_key(|law| {
        let support = law.iter().filter(|c| **c != 0).count();
        (support, law.iter().map(|c| c.abs()).sum::<i64>(), law.iter().map(|c| -c).collect::<Vec<i64>>())
    });
    let mut basis: Vec<Vec<i64>> = Vec::new();
    for law in candidates.into_iter().chain(signed.iter().cloned()) {
        if basis.len() == signed.len() {
            break;
        }
        basis.push(law);
        if rank(&basis, species) < basis.len() {
            basis.pop();
        }
    }
    // In the order of the first species in them, as a reader of the species list expects.
    basis.sort_by_key(|law| law.iter().position(|c| *c != 0));
    basis
}

/// Non-negative sums of minimal support; `None` if there are too many to list.
fn non_negative_laws(stoichiometry: &DMatrix<i32>) -> Option<Vec<Vec<i64>>> {
    let (species, reactions) = stoichiometry.shape();
    // Each row: what is left of the changes, and the combination of species that made it.
    let mut rows: Vec<(Vec<i64>, Vec<i64>)> = (0..species)
        .map(|s| {
            let changes = stoichiometry.row(s).iter().map(|c| i64::from(*c)).collect();
            (changes, (0..species).map(|k| i64::from(k == s)).collect())
        })
        .collect();
    for r in 0..reactions {
        let mut next: Vec<(Vec<i64>, Vec<i64>)> = rows.iter().filter(|row| row.0[r] == 0).cloned().collect();
        for above in rows.iter().filter(|row| row.0[r] > 0) {
            for below in rows.iter().filter(|row| row.0[r] < 0) {
                let (p, q) = (above.0[r], -below.0[r]);
                let join = |a: &[i64], b: &[i64]| -> Option<Vec<i64>> {
                    a.iter().zip(b).map(|(x, y)| x.checked_mul(q)?.checked_add(y.checked_mul(p)?)).collect()
                };
                let mut row = (join(&above.0, &below.0)?, join(&above.1, &below.1)?);
                let divisor = row.0.iter().chain(&row.1).fold(0, |d, c| gcd(d, c.abs())).max(1);
                row.0.iter_mut().chain(&mut row.1).for_each(|c| *c /= divisor);
                next.push(row);
                if next.len() > MOST_CANDIDATES {
                    return None;
                }
            }
        }
        // A row whose support holds another's is no extreme ray.
        let supports: Vec<Vec<bool>> =
            next.iter().map(|row| row.1.iter().map(|c| *c != 0).collect()).collect();
        let holds = |a: usize, b: usize| supports[a].iter().zip(&supports[b]).all(|(x, y)| *x || !*y);
        let minimal = |a: usize| !(0..next.len()).any(|b| b != a && holds(a, b) && (!holds(b, a) || b < a));
        rows = (0..next.len()).filter(|&a| minimal(a)).map(|a| next[a].clone()).collect();
    }
    Some(rows.into_iter().map(|row| row.1).collect())
}

/// A basis of all conserved sums: the left null space by fraction-free elimination.
fn signed_laws(stoichiometry: &DMatrix<i32>) -> Vec<Vec<i64>> {
    let (species, reactions) = stoichiometry.shape();
    let mut rows: Vec<Vec<i128>> = (0..species)
        .map(|s| {
            let changes = stoichiometry.row(s).iter().map(|c| i128::from(*c)).collect::<Vec<_>>();
            changes.into_iter().chain((0..species).map(|k| i128::from(k == s))).collect()
        })
        .collect();
    let pivots = eliminate(&mut rows, reactions);
    rows[pivots..]
        .iter()
        .filter_map(|row| {
            let mut law: Vec<i64> =
                row[reactions..].iter().map(|c| i64::try_from(*c).ok()).collect::<Option<_>>()?;
            if law.iter().find(|c| **c != 0).is_some_and(|c| *c < 0) {
                law.iter_mut().for_each(|c| *c = -*c);
            }
            Some(law)
        })
        .collect()
}

/// Brings the first `columns` columns into echelon form; gives their rank.
fn eliminate(rows: &mut [Vec<i128>], columns: usize) -> usize {
    let mut top = 0;
    for column in 0..columns {
        // The smallest pivot keeps the numbers small.
        let pivot = (top..rows.len())
            .filter(|&k| rows[k][column] != 0)
            .min_by_key(|&k| rows[k][column].unsigned_abs());
        let Some(pivot) = pivot else { continue };
        rows.swap(top, pivot);
        let (head, tail) = rows.split_at_mut(top + 1);
        let pivot_row = &head[top];
        for row in tail.iter_mut().filter(|row| row[column] != 0) {
            let (p, q) = (pivot_row[column], row[column]);
            let common = gcd(p.abs(), q.abs());
            let (p, q) = (p / common, q / common);
            for (x, y) in row.iter_mut().zip(pivot_row) {
                *x = x.saturating_mul(p).saturating_sub(y.saturating_mul(q));
            }
            let divisor = row.iter().fold(0, |d, c| gcd(d, c.saturating_abs())).max(1);
            row.iter_mut().for_each(|c| *c /= divisor);
        }
        top += 1;
        if top == rows.len() {
            break;
        }
    }
    top
}

fn rank(laws: &[Vec<i64>], columns: usize) -> usize {
    let mut rows: Vec<Vec<i128>> =
        laws.iter().map(|law| law.iter().map(|c| i128::from(*c)).collect()).collect();
    eliminate(&mut rows, columns)
}

fn gcd<T>(a: T, b: T) -> T
where
    T: Copy + PartialEq + Default + std::ops::Rem<Output = T>,
{
    let (mut a, mut b) = (a, b);
    while b != T::default() {
        (a, b) = (b, a % b);
    }
    a
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn without_reactions_every_species_is_conserved() {
        assert_eq!(conservation_laws(&DMatrix::zeros(2, 0)), [[1, 0], [0, 1]]);
        assert!(conservation_laws(&DMatrix::zeros(0, 0)).is_empty());
    }

    #[test]
    fn a_phosphorylation_cycle_conserves_each_protein() {
        // E + S <-> ES -> E + P, F + P <-> FP -> F + S: species E, S, ES, P, F, FP.
        let columns = [[-1, -1, 1, 0, 0, 0], [1, 0, -1, 1, 0, 0], [0, 0, 0, -1, -1, 1], [0, 1, 0, 0, 1, -1]];
        let matrix = DMatrix::from_fn(6, 4, |s, r| columns[r][s]);
        let laws = conservation_laws(&matrix);
        assert_eq!(laws, [[1, 0, 1, 0, 0, 0], [0, 1, 1, 1, 0, 1], [0, 0, 0, 0, 1, 1]]);
    }

    proptest! {
        #[test]
        fn laws_annihilate_the_matrix_and_are_as_many_as_they_should(
            values in prop::collection::vec(-2_i32..=2, 30), species in 1_usize..6,
        ) {
            let matrix = DMatrix::from_fn(species, 5, |s, r| values[s * 5 + r]);
            let laws = conservation_laws(&matrix);
            for law in &laws {
                for r in 0..5 {
                    let sum: i64 = (0..species).map(|s| law[s] * i64::from(matrix[(s, r)])).sum();
                    prop_assert_eq!(sum, 0);
                }
            }
            // The rank by singular values: entries up to 2 in 5 x 5, so non-zero ones are far above 1e-9.
            let rank = matrix.map(f64::from).rank(1e-9);
            prop_assert_eq!(laws.len(), species - rank);
        }
    }
}
