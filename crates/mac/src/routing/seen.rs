//! Packets that a station has seen, to find those that come twice.

use sextant_kernel::StationId;

/// Packets that are remembered.
const KEPT: usize = 32;

/// The packets that a station has seen last.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    packets: Vec<(StationId, u16, u8)>,
    /// The oldest one, once there are as many as are kept.
    oldest: usize,
}

/// A packet that a station has seen before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Repeat {
    /// A copy, sent again because its acknowledgement was lost.
    Duplicate,
    /// The packet has made more hops since: it came back, or a copy of it came by a longer way.
    Loop,
}

impl Seen {
    /// Notes the packet number `number` of `origin` after so many hops; what it repeats, if it was seen before.
    pub fn note(&mut self, origin: StationId, number: u16, hops: u8) -> Option<Repeat> {
        let known = self.packets.iter_mut().find(|(other, count, _)| (*other, *count) == (origin, number));
        if let Some((_, _, before)) = known {
            let is_farther = hops > *before;
            *before = (*before).max(hops);
            return Some(if is_farther { Repeat::Loop } else { Repeat::Duplicate });
        }
        if self.packets.len() < KEPT {
            self.packets.push((origin, number, hops));
        } else {
            self.packets[self.oldest] = (origin, number, hops);
            self.oldest = (self.oldest + 1) % KEPT;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_copy_is_a_duplicate_and_a_packet_that_comes_back_is_a_loop() {
        let mut seen = Seen::default();
        let mut note = |number, hops| seen.note(StationId(1), number, hops);
        assert_eq!((note(5, 2), note(5, 2), note(5, 4)), (None, Some(Repeat::Duplicate), Some(Repeat::Loop)));
        assert_eq!(note(5, 4), Some(Repeat::Duplicate));
        // The oldest of more than 32 are forgotten.
        (6..6 + 31).for_each(|number| assert_eq!(note(number, 0), None));
        assert_eq!(note(5, 4), Some(Repeat::Duplicate));
        assert_eq!((note(40, 0), note(5, 4)), (None, None));
    }
}
