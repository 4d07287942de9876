//! An indexed binary heap of event times: the earliest on top, any entry movable.

/// Times of `n` items, in heap order.
#[derive(Clone, Debug)]
pub struct TimeHeap {
    time: Vec<f64>,
    /// Item at each place of the heap.
    item: Vec<u32>,
    /// Place of each item.
    place: Vec<u32>,
}

impl TimeHeap {
    /// From the time of each item, s.
    #[must_use]
    pub fn new(times: Vec<f64>) -> TimeHeap {
        let n = times.len() as u32;
        let mut heap = TimeHeap { time: times, item: (0..n).collect(), place: (0..n).collect() };
        for place in (0..heap.item.len() / 2).rev() {
            heap.sink(place);
        }
        heap
    }

    /// The earliest item and its time; `None` if there is no item.
    #[inline]
    #[must_use]
    pub fn first(&self) -> Option<(usize, f64)> {
        self.item.first().map(|&i| (i as usize, self.time[i as usize]))
    }

    /// The time of an item.
    #[inline]
    #[must_use]
    pub fn time(&self, item: usize) -> f64 {
        self.time[item]
    }

    /// Gives an item a new time.
    #[inline]
    pub fn set(&mut self, item: usize, time: f64) {
        self.time[item] = time;
        let place = self.place[item] as usize;
        let place = self.rise(place);
        self.sink(place);
    }

    fn at(&self, place: usize) -> f64 {
        self.time[self.item[place] as usize]
    }

    fn swap(&mut self, a: usize, b: usize) {
        self.item.swap(a, b);
        self.place[self.item[a] as usize] = a as u32;
        self.place[self.item[b] as usize] = b as u32;
    }

    fn rise(&mut self, mut place: usize) -> usize {
        while place > 0 && self.at(place) < self.at((place - 1) / 2) {
            self.swap(place, (place - 1) / 2);
            place = (place - 1) / 2;
        }
        place
    }

    fn sink(&mut self, mut place: usize) {
        loop {
            let left = 2 * place + 1;
            if left >= self.item.len() {
                return;
            }
            let right = left + 1;
            let child = if right < self.item.len() && self.at(right) < self.at(left) { right } else { left };
            if self.at(place) <= self.at(child) {
                return;
            }
            self.swap(place, child);
            place = child;
        }
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
        let mut heap = TimeHeap::new(times.clone());
        for _ in 0..2000 {
            let item = random.random_range(0..57);
            let time = if random.random_bool(0.1) { f64::INFINITY } else { random.random() };
            times[item] = time;
            heap.set(item, time);
            let least = times.iter().copied().fold(f64::INFINITY, f64::min);
            assert_eq!(heap.first().map(|(_, t)| t), Some(least));
        }
    }
}
