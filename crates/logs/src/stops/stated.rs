//! The numbers of packets sent that the rows of a log state.

use std::collections::BTreeMap;

/// How many pairs of a node and a stop state which number of packets sent at each stop.
#[derive(Debug)]
pub(crate) struct Stated {
    /// By stop and number.
    counts: BTreeMap<(u32, u32), usize>,
    /// The number that the last pairs at each stop state, and how many of these are not in `counts` yet: most state the same.
    last: Vec<(u32, usize)>,
}

impl Stated {
    /// Nothing yet, at so many stops.
    pub(crate) fn new(stops: usize) -> Self {
        Self { counts: BTreeMap::new(), last: vec![(0, 0); stops] }
    }

    /// Adds a pair that states so many packets sent, above 0.
    pub(crate) fn add(&mut self, stop: u32, sent: u32) {
        let last = &mut self.last[stop as usize];
        if last.0 == sent {
            last.1 += 1;
            return;
        }
        let (before, count) = std::mem::replace(last, (sent, 1));
        if count > 0 {
            *self.counts.entry((stop, before)).or_default() += count;
        }
    }

    /// The median number of packets sent at each stop, the lower one of two; 1 where none is stated. Where fewer than
    /// [`FEWEST_STATED`] pairs state one, it is at most that of all pairs.
    pub(crate) fn medians(&self) -> Vec<u32> {
        let mut counts = self.counts.clone();
        for (stop, &(sent, count)) in (0..).zip(&self.last).filter(|(_, (_, count))| *count > 0) {
            *counts.entry((stop, sent)).or_default() += count;
        }
        let stated: Vec<(u32, u32, usize)> =
            counts.into_iter().map(|((stop, sent), count)| (stop, sent, count)).collect();
        let mut all: Vec<(u32, usize)> = stated.iter().map(|&(_, sent, count)| (sent, count)).collect();
        all.sort_unstable();
        let of_all = median(&all);
        let mut medians = vec![1; self.last.len()];
        for of_stop in stated.chunk_by(|a, b| a.0 == b.0) {
            let numbers: Vec<(u32, usize)> = of_stop.iter().map(|&(_, sent, count)| (sent, count)).collect();
            let is_few = numbers.iter().map(|&(_, count)| count).sum::<usize>() < FEWEST_STATED;
            let own = median(&numbers);
            medians[of_stop[0].0 as usize] = if is_few { own.min(of_all) } else { own };
        }
        medians
    }
}

/// Fewer pairs do not say what is usual at a stop.
const FEWEST_STATED: usize = 3;

/// The median of numbers in ascending order, each with how often it occurs: the lower one of two, 1 of none.
fn median(numbers: &[(u32, usize)]) -> u32 {
    let all: usize = numbers.iter().map(|&(_, count)| count).sum();
    let mut below = 0;
    let middle = numbers.iter().find(|&&(_, count)| {
        below += count;
        2 * below >= all
    });
    middle.map_or(1, |&(number, _)| number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_a_stop_is_that_of_all_numbers_stated_there() {
        let mut stated = Stated::new(4);
        for (stop, sent) in [(0, 5), (1, 9), (0, 7), (0, 5), (2, 4), (0, 5), (0, 7), (0, 7), (0, 7), (2, 6), (2, 6)] {
            stated.add(stop, sent);
        }
        // One pair alone is not believed above the median of all.
        assert_eq!(stated.medians(), [7, 6, 6, 1]);
        assert_eq!(Stated::new(2).medians(), [1, 1]);
    }
}
