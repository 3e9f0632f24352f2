//! Packets that are larger than a frame, in fragments (RFC 4944, 5.3), as sizes and offsets.
//!
//! The first fragment has a header of 4 octets and each other one of 5. All but the last carry a multiple of 8 octets. A
//! receiver puts them together; if one is lost, so is the packet.

use std::ops::Range;
use std::time::Duration;

use sextant_kernel::{SimTime, StationId};

/// Header of the first fragment (octets): dispatch and size of the packet, and its tag.
pub const FIRST_OCTETS: usize = 4;
/// Header of each other fragment (octets): the same, and the offset.
pub const NEXT_OCTETS: usize = 5;
/// Largest packet (octets): the MTU of IPv6 over IEEE 802.15.4 (RFC 4944, 4).
pub const MOST_OCTETS: u16 = 1280;

const FIRST: u8 = 0xC0;
const NEXT: u8 = 0xE0;
const DISPATCH: u8 = 0xF8;
const UNIT: usize = 8;
/// Packets that are remembered after they were put together, to know copies of their fragments.
const REMEMBERED: usize = 8;

/// The part of a packet of `octets` that goes in piece `number`, if a frame carries at most `most` octets; `None` after the
/// last one. A packet that fits into a frame is one piece, without a header.
#[must_use]
pub fn piece(octets: usize, most: usize, number: usize) -> Option<Range<usize>> {
    if octets <= most {
        return (number == 0).then_some(0..octets);
    }
    let multiple = |octets: usize| octets / UNIT * UNIT;
    let (first, next) = (multiple(most - FIRST_OCTETS), multiple(most - NEXT_OCTETS));
    if number == 0 {
        return Some(0..first);
    }
    let start = first + (number - 1) * next;
    let left = octets.checked_sub(start).filter(|&left| left > 0)?;
    // The last one may be longer than a multiple of eight octets.
    let is_last = left <= most - NEXT_OCTETS;
    let is_over = number > 1 && left + next <= most - NEXT_OCTETS;
    (!is_over).then(|| start..if is_last { octets } else { start + next })
}

/// Number of pieces of a packet of `octets`, if a frame carries at most `most`.
#[must_use]
pub fn pieces(octets: usize, most: usize) -> usize {
    (0..).take_while(|&number| piece(octets, most, number).is_some()).count()
}

/// Writes piece `number` of a packet to `octets`, in place of what is there. `false` after the last one.
pub fn write(packet: &[u8], tag: u16, most: usize, number: usize, octets: &mut Vec<u8>) -> bool {
    let Some(part) = piece(packet.len(), most, number) else { return false };
    octets.clear();
    if packet.len() > most {
        let size = u16::try_from(packet.len()).expect("at most 1280 octets").to_be_bytes();
        let dispatch = if number == 0 { FIRST } else { NEXT };
        octets.extend([dispatch | size[0], size[1]]);
        octets.extend(tag.to_be_bytes());
        octets.extend((number > 0).then(|| u8::try_from(part.start / UNIT).expect("at most 1280 octets")));
    }
    octets.extend(&packet[part]);
    true
}

/// What a frame says of the fragment in it, and what it carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fragment<'a> {
    /// Size of the packet (octets).
    pub octets: usize,
    /// Number of the packet at the sender.
    pub tag: u16,
    /// Where this part begins.
    pub offset: usize,
    /// The part.
    pub part: &'a [u8],
}

impl<'a> Fragment<'a> {
    /// Reads a fragment; `None` if the octets are none.
    #[must_use]
    pub fn read(octets: &'a [u8]) -> Option<Self> {
        let &[high, low, t0, t1, ref rest @ ..] = octets else { return None };
        let (offset, part) = match high & DISPATCH {
            FIRST => (0, rest),
            NEXT => rest.split_first().map(|(&offset, part)| (UNIT * usize::from(offset), part))?,
            _ => return None,
        };
        let octets = usize::from(u16::from_be_bytes([high & !DISPATCH, low]));
        let fits = !part.is_empty() && offset + part.len() <= octets;
        fits.then_some(Self { octets, tag: u16::from_be_bytes([t0, t1]), offset, part })
    }
}

/// What became of a fragment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Taken {
    /// Its packet is complete.
    Complete(Vec<u8>),
    /// Its packet lacks others.
    Incomplete,
    /// It was there before.
    Copy,
    /// There is no room for one more packet.
    NoRoom,
}

/// A packet that lacks fragments.
#[derive(Clone, Debug)]
struct Partial {
    from: StationId,
    tag: u16,
    octets: Vec<u8>,
    /// Which units of eight octets are there.
    there: Vec<bool>,
    until: SimTime,
}

/// The packets that a station puts together.
#[derive(Clone, Debug)]
pub struct Reassembly {
    partial: Vec<Partial>,
    most: usize,
    timeout: Duration,
    complete: Vec<(StationId, u16)>,
}

impl Reassembly {
    /// Room for so many packets, each of which must be complete in this time.
    #[must_use]
    pub fn new(most: usize, timeout: Duration) -> Self {
        Self { partial: Vec::new(), most, timeout, complete: Vec::new() }
    }

    /// Takes a fragment from a neighbour.
    pub fn take(&mut self, from: StationId, fragment: &Fragment<'_>, now: SimTime) -> Taken {
        let key = (from, fragment.tag);
        if self.complete.contains(&key) {
            return Taken::Copy;
        }
        let known = self.partial.iter().position(|it| (it.from, it.tag) == key);
        let place = match known {
            Some(place) => place,
            None if self.partial.len() >= self.most => return Taken::NoRoom,
            None => {
                let (octets, there) = (vec![0; fragment.octets], vec![false; fragment.octets.div_ceil(UNIT)]);
                let until = now + self.timeout;
                self.partial.push(Partial { from, tag: fragment.tag, octets, there, until });
                self.partial.len() - 1
            }
        };
        let partial = &mut self.partial[place];
        let end = fragment.offset + fragment.part.len();
        if end > partial.octets.len() {
            return Taken::Copy;
        }
        let units = &mut partial.there[fragment.offset / UNIT..end.div_ceil(UNIT)];
        if units.iter().all(|&there| there) {
            return Taken::Copy;
        }
        units.fill(true);
        partial.octets[fragment.offset..end].copy_from_slice(fragment.part);
        if !partial.there.iter().all(|&there| there) {
            return Taken::Incomplete;
        }
        if self.complete.len() == REMEMBERED {
            self.complete.remove(0);
        }
        self.complete.push(key);
        Taken::Complete(self.partial.remove(place).octets)
    }

    /// When the first packet is given up.
    #[must_use]
    pub fn due(&self) -> Option<SimTime> {
        self.partial.iter().map(|partial| partial.until).min()
    }

    /// Gives up packets that are not complete in time: how many.
    pub fn expire(&mut self, now: SimTime) -> u64 {
        let before = self.partial.len();
        self.partial.retain(|partial| now < partial.until);
        (before - self.partial.len()) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FROM: StationId = StationId(4);

    /// Numbers of pieces that were worked out outside of this program.
    #[test]
    fn packets_have_as_many_pieces_as_the_table_says() {
        for (most, expected) in [(81, [2, 3, 6, 9, 18]), (96, [2, 3, 5, 7, 15]), (102, [1, 3, 5, 7, 14])] {
            assert_eq!([100, 200, 400, 600, 1280].map(|octets| pieces(octets, most)), expected, "{most} octets");
        }
    }

    #[test]
    fn pieces_cover_a_packet_once_and_fit_into_frames() {
        for most in [21, 60, 81, 102, 116] {
            for octets in 1..=1280 {
                let mut end = 0;
                for number in 0..pieces(octets, most) {
                    let part = piece(octets, most, number).expect("a piece");
                    assert_eq!(part.start, end);
                    let header = match (octets > most, number) {
                        (false, _) => 0,
                        (true, 0) => FIRST_OCTETS,
                        (true, _) => NEXT_OCTETS,
                    };
                    assert!(!part.is_empty() && header + part.len() <= most, "{octets} in {most}");
                    end = part.end;
                    assert!(end == octets || part.len().is_multiple_of(8));
                }
                assert_eq!(end, octets, "{octets} in {most}");
            }
        }
    }

    fn fragments(packet: &[u8], tag: u16) -> Vec<Vec<u8>> {
        let mut all = Vec::new();
        let mut octets = Vec::new();
        while write(packet, tag, 81, all.len(), &mut octets) {
            all.push(octets.clone());
        }
        all
    }

    #[test]
    fn fragments_in_any_order_make_the_packet_and_copies_are_known() {
        let packet: Vec<u8> = (0..=199).collect();
        let sent = fragments(&packet, 0x0102);
        assert_eq!(sent[0][..4], [0xC0, 200, 1, 2]);
        assert_eq!(sent[2][..5], [0xE0, 200, 1, 2, 18], "144 octets before it");
        let mut reassembly = Reassembly::new(1, Duration::from_secs(8));
        let mut take = |number: usize, s: u64| {
            let fragment = Fragment::read(&sent[number]).expect("a fragment");
            reassembly.take(FROM, &fragment, SimTime::from_secs(s))
        };
        assert_eq!((take(2, 0), take(2, 0), take(0, 1)), (Taken::Incomplete, Taken::Copy, Taken::Incomplete));
        assert_eq!(take(1, 2), Taken::Complete(packet));
        assert_eq!(take(1, 3), Taken::Copy);
        assert_eq!(reassembly.due(), None);
    }

    #[test]
    fn a_packet_that_lacks_a_fragment_is_given_up_and_makes_room() {
        let mut reassembly = Reassembly::new(1, Duration::from_secs(8));
        let (one, two) = (fragments(&[7; 100], 1), fragments(&[7; 100], 2));
        let read = |octets: &'static [Vec<u8>]| Fragment::read(&octets[0]).expect("a fragment");
        let (one, two) = (read(one.leak()), read(two.leak()));
        assert_eq!(reassembly.take(FROM, &one, SimTime::ZERO), Taken::Incomplete);
        assert_eq!(reassembly.take(FROM, &two, SimTime::ZERO), Taken::NoRoom);
        assert_eq!(reassembly.due(), Some(SimTime::from_secs(8)));
        assert_eq!(reassembly.expire(SimTime::from_secs(7)), 0);
        assert_eq!(reassembly.expire(SimTime::from_secs(8)), 1);
        assert_eq!(reassembly.take(FROM, &two, SimTime::from_secs(8)), Taken::Incomplete);
    }

    #[test]
    fn other_octets_are_no_fragment() {
        for octets in [&[][..], &[0xC0, 100, 0, 1], &[0x3F, 1, 2, 3, 4, 5], &[0xE0, 8, 0, 1, 1, 5]] {
            assert_eq!(Fragment::read(octets), None, "{octets:?}");
        }
    }
}
