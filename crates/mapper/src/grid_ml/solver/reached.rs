//! Which indices along an axis enough packets reach.

use std::ops::Range;

/// How many packets reach the indices along an axis. Its size is that of the receptions, not of the axis: a stop far from all
/// others makes the lattice wide.
#[derive(Debug, Default)]
pub(super) struct Reached {
    /// Where the number of packets changes, and by how many.
    changes: Vec<(usize, i64)>,
}

impl Reached {
    /// These packets reach these indices.
    pub(super) fn add(&mut self, indices: Range<usize>, packets: u32) {
        if !indices.is_empty() {
            self.changes.push((indices.start, i64::from(packets)));
            self.changes.push((indices.end, -i64::from(packets)));
        }
    }

    /// Calls `visit` with the runs of `indices` that at least `least` packets reach, in order, and forgets all packets.
    pub(super) fn take_runs(&mut self, indices: &Range<usize>, least: u64, mut visit: impl FnMut(Range<usize>)) {
        self.changes.sort_unstable();
        let (mut packets, mut start) = (0_i64, indices.start);
        for (at, change) in self.changes.drain(..).chain([(indices.end, 0)]) {
            let end = at.clamp(start, indices.end);
            if packets.unsigned_abs() >= least && start < end {
                visit(start..end);
            }
            (packets, start) = (packets + change, end);
        }
    }
}

#[cfg(test)]
mod tests {
    use sextant_kernel::{Purpose, Seed};

    use super::*;

    #[test]
    fn runs_are_those_of_a_count_of_each_index() {
        let indices = 3..19;
        let mut reached = Reached::default();
        for number in 0..400_u64 {
            let below = |what: u64, most: usize| {
                let bits = Seed(number).bits(Purpose::new(1), [what, 0, 0]);
                usize::try_from(bits % (most as u64 + 1)).expect("a small number")
            };
            let mut counts = [0_u64; 24];
            for ball in 0..below(0, 5) as u64 {
                let (start, packets) = (below(3 * ball + 1, 20), below(3 * ball + 2, 3));
                let end = start + below(3 * ball + 3, 22 - start);
                counts[start..end].iter_mut().for_each(|count| *count += packets as u64);
                reached.add(start..end, u32::try_from(packets).expect("a small number"));
            }
            let least = below(100, 4) as u64;
            let mut found = Vec::new();
            reached.take_runs(&indices, least, |run| found.extend(run));
            let wanted: Vec<usize> = indices.clone().filter(|&index| counts[index] >= least).collect();
            assert_eq!(found, wanted, "{counts:?}, at least {least}");
        }
    }
}
