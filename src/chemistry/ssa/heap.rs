//! An indexed binary heap of event times: the earliest on top, any entry movable.

/// Times of `n` items, in heap order.
#[derive(Clone, Debug)]
pub struct TimeHeap {
    /// Time and item at each place of the heap.
    entries: Vec<(f64, u32)>,
    /// Place of each item.
    place: Vec<u32>,
}

impl TimeHeap {
    /// From the time of each item, s.
    #[must_use]
    pub fn new(times: &[f64]) -> TimeHeap {
        let n = times.len() as u32;
        let mut heap =
            TimeHeap { entries: times.iter().copied().zip(0..n).collect(), place: (0..n).collect() };
        for place in (0..times.len() / 2).rev() {
            heap.sink(place, heap.entries[place]);
        }
        heap
    }

    /// The earliest item and its time; `None` if there is no item.
    #[inline]
    #[must_use]
    pub fn first(&self) -> Option<(usize, f64)> {
        self.entries.first().map(|&(time, item)| (item as usize, time))
    }

    /// The time of an item.
    #[inline]
    #[must_use]
    pub fn time(&self, item: usize) -> f64 {
        self.entries[self.place[item] as usize].0
    }

    /// Gives an item a new time.
    #[inline]
    pub fn set(&mut self, item: usize, time: f64) {
        let place = self.place[item] as usize;
        let entry = (time, item as u32);
        if time < self.entries[place].0 { self.rise(place, entry) } else { self.sink(place, entry) }
    }

    #[inline]
    fn put(&mut self, place: usize, entry: (f64, u32)) {
        self.entries[place] = entry;
        self.place[entry.1 as usize] = place as u32;
    }

    /// Finds the place of an entry upwards of `place`, which is free.
    fn rise(&mut self, mut place: usize, entry: (f64, u32)) {
        while place > 0 && entry.0 < self.entries[(place - 1) / 2].0 {
            self.put(place, self.entries[(place - 1) / 2]);
            place = (place - 1) / 2;
        }
        self.put(place, entry);
    }

    /// Finds the place of an entry downwards of `place`, which is free.
    fn sink(&mut self, mut place: usize, entry: (f64, u32)) {
        loop {
            let left = 2 * place + 1;
            let Some(&first) = self.entries.get(left) else { break };
            let (child, least) = match self.entries.get(left + 1) {
                Some(&second) if second.0 < first.0 => (left + 1, second),
                _ => (left, first),
            };
            if entry.0 <= least.0 {
                break;
            }
            self.put(place, least);
            place = child;
        }
        self.put(place, entry);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, stream};
    use rand::Rng;

    #[test]
    fn the_first_is_the_smallest_after_any_change() {
        let mut random = stream(3, 0, Purpose::Reactions);
        let mut times: Vec<f64> = (0..57).map(|_| random.random()).collect();
        let mut heap = TimeHeap::new(&times);
        for _ in 0..2000 {
            let item = random.random_range(0..57);
            let time = if random.random_bool(0.1) { f64::INFINITY } else { random.random() };
            times[item] = time;
            heap.set(item, time);
            let least = times.iter().copied().fold(f64::INFINITY, f64::min);
            assert_eq!(heap.first().map(|(_, t)| t), Some(least));
            assert!((0..57).all(|k| heap.time(k) == times[k]));
        }
    }
}
