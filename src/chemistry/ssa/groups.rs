//! Rates sorted into groups by powers of two: a choice in proportion to them at constant cost.

use rand::Rng;

/// Bits of a mantissa, the leading one included.
const MANTISSA: u32 = 53;

/// Items of rates in [2^e, 2^(e+1)).
#[derive(Clone, Debug)]
struct Group {
    /// 2^(e-52): a rate is a whole number of these.
    unit: f64,
    /// Sum of the rates in units: whole numbers, so that however many come and go nothing drifts.
    sum: u128,
    members: Vec<u32>,
}

/// The rates of `n` items, by group.
#[derive(Clone, Debug)]
pub(super) struct Groups {
    groups: Vec<Group>,
    /// Group of each exponent of an `f64`, [`NONE`] for those that have not occurred.
    of_exponent: Vec<u16>,
    /// Place of each item among the members of its group.
    place: Vec<u32>,
}

const NONE: u16 = u16::MAX;

/// Exponent bits and mantissa of a positive rate. Rates below 2^-1022 have neither; they count as zero, as
/// an event of them would not come in any run.
#[inline]
fn parts(rate: f64) -> Option<(usize, u64)> {
    let bits = rate.to_bits();
    let exponent = (bits >> (MANTISSA - 1)) as usize & 0x7ff;
    let leading = 1 << (MANTISSA - 1);
    (exponent > 0).then_some((exponent, bits & (leading - 1) | leading))
}

impl Groups {
    /// From the rates of all items, zero or more and finite.
    pub fn new(rates: &[f64]) -> Groups {
        let mut groups =
            Groups { groups: Vec::new(), of_exponent: vec![NONE; 2048], place: vec![0; rates.len()] };
        for (item, &rate) in rates.iter().enumerate() {
            groups.change(item, 0.0, rate);
        }
        groups
    }

    /// Moves an item from the rate it had to another.
    #[inline]
    pub fn change(&mut self, item: usize, before: f64, after: f64) {
        let (old, new) = (parts(before), parts(after));
        if let (Some((a, less)), Some((b, more))) = (old, new)
            && a == b
        {
            let group = &mut self.groups[usize::from(self.of_exponent[a])];
            group.sum = group.sum - u128::from(less) + u128::from(more);
            return;
        }
        if let Some((exponent, mantissa)) = old {
            let group = &mut self.groups[usize::from(self.of_exponent[exponent])];
            group.sum -= u128::from(mantissa);
            let place = self.place[item] as usize;
            group.members.swap_remove(place);
            if let Some(&moved) = group.members.get(place) {
                self.place[moved as usize] = place as u32;
            }
        }
        if let Some((exponent, mantissa)) = new {
            let group = self.group(exponent);
            group.sum += u128::from(mantissa);
            group.members.push(item as u32);
            self.place[item] = group.members.len() as u32 - 1;
        }
    }

    #[inline]
    fn group(&mut self, exponent: usize) -> &mut Group {
        if self.of_exponent[exponent] == NONE {
            self.of_exponent[exponent] = self.groups.len() as u16;
            // 2^(e-52) in two factors, each of which is in range.
            let unit = 2_f64.powi(exponent as i32 - 1023) * 2_f64.powi(1 - MANTISSA as i32);
            self.groups.push(Group { unit, sum: 0, members: Vec::new() });
        }
        &mut self.groups[usize::from(self.of_exponent[exponent])]
    }

    /// Sum of all rates.
    #[inline]
    pub fn total(&self) -> f64 {
        self.groups.iter().map(Group::weight).sum()
    }

    /// An item with chance rate / total, `total` from [`Groups::total`]; `None` if all rates are zero.
    #[inline]
    pub fn choose<R: Rng>(&self, rates: &[f64], total: f64, random: &mut R) -> Option<usize> {
        let mut left = random.random::<f64>() * total;
        let mut chosen = None;
        for group in self.groups.iter().filter(|group| group.sum > 0) {
            chosen = Some(group);
            if left < group.weight() {
                break;
            }
            left -= group.weight();
        }
        let members = &chosen?.members;
        // A member from the high word of a product, its acceptance from the low word: one number a trial,
        // and more than half of the trials succeed.
        loop {
            let wide = u128::from(random.next_u64()) * members.len() as u128;
            let item = members[(wide >> 64) as usize] as usize;
            let (_, mantissa) = parts(rates[item])?;
            if (wide as u64) >> (64 - MANTISSA) < mantissa {
                return Some(item);
            }
        }
    }
}

impl Group {
    #[inline]
    fn weight(&self) -> f64 {
        // Two halves: the conversion of 128 bits at once is a slow call.
        ((self.sum >> 64) as u64 as f64 * 18_446_744_073_709_551_616.0 + self.sum as u64 as f64) * self.unit
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, stream};

    #[test]
    fn choices_follow_the_rates_and_sums_do_not_drift() {
        let mut random = stream(4, 0, Purpose::Reactions);
        let mut rates = vec![0.0; 9];
        let mut groups = Groups::new(&rates);
        assert_eq!(groups.total(), 0.0);
        assert_eq!(groups.choose(&rates, 1.0, &mut random), None);
        for _ in 0..100_000 {
            let item = random.random_range(0..rates.len());
            let after = if random.random_bool(0.3) { 0.0 } else { random.random::<f64>().powi(20) * 1e9 };
            groups.change(item, rates[item], after);
            rates[item] = after;
        }
        // Binary fractions, whose sum is free of rounding.
        let last = [3.0, 0.0, 1.0, 0.25, 0.5, 1.5, 0.0, 1.0 / 1024.0, 767.0 / 1024.0];
        for (item, &after) in last.iter().enumerate() {
            groups.change(item, rates[item], after);
        }
        assert_eq!(groups.total(), 7.0);
        let mut seen = [0.0; 9];
        for _ in 0..400_000 {
            seen[groups.choose(&last, 7.0, &mut random).unwrap()] += 1.0;
        }
        // Five standard errors of a share of 400 000 draws; 9 shares: a false alarm in 2e5.
        for (n, rate) in seen.iter().zip(last) {
            let p: f64 = rate / 7.0;
            assert!((n / 4e5 - p).abs() <= 5.0 * (p * (1.0 - p) / 4e5).sqrt(), "{n} of rate {rate}");
        }
    }
}
