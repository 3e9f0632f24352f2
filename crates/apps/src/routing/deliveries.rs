//! What became of packets over several hops.

use std::time::Duration;

use sextant_kernel::{SimTime, StationId};
use sextant_sim::Delays;

/// What became of packets.
#[derive(Clone, Debug, Default)]
pub struct Deliveries {
    /// Packets that there were.
    pub offered: u64,
    /// Those that arrived where they should.
    pub delivered: u64,
    /// Those that did not arrive and wait in a queue at the end.
    pub pending: u64,
    /// Those that did not arrive and waited in no queue but those of stations that died.
    pub died: u64,
    /// Copies that arrived after the first one.
    pub copies: u64,
    /// Time from the offer to the arrival.
    pub delays: Delays,
    /// Hops of all that arrived together, ...
    pub hops: u64,
    /// ... and the most of one.
    pub most_hops: u8,
    /// Hops of those that arrived and have a shortest way, each divided by the hops of that, together, ...
    pub stretch: f64,
    /// ... and their number.
    pub stretched: u64,
}

/// Where a packet that did not arrive is at the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Left {
    /// In the queue of a station that lives.
    Waiting,
    /// In the queues of stations that died alone.
    Dead,
}

/// A packet that arrived where it should.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arrival {
    pub(super) origin: StationId,
    /// The last bits of its number.
    pub(super) number: u16,
    pub(super) hops: u8,
    pub(super) time: SimTime,
}

impl Deliveries {
    /// Packets that are lost: neither arrived nor left anywhere.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.offered - self.delivered - self.pending - self.died
    }

    /// What became of the packets that were `offered`, of which these `arrived`, in any order.
    pub(super) fn of(
        offered: &[SimTime],
        arrived: &[Arrival],
        left: impl Fn(u16) -> Option<Left>,
        shortest_hops: Option<u32>,
        counted_from: SimTime,
    ) -> Self {
        let mut all = Self::default();
        let mut numbered: Vec<(u32, &Arrival)> = arrived
            .iter()
            .filter_map(|arrival| Some((whole_number(arrival.number, offered, arrival.time)?, arrival)))
            .collect();
        numbered.sort_by_key(|(number, arrival)| (*number, arrival.time));
        let mut arrived = numbered.into_iter().peekable();
        for (number, &time) in (0..=u32::MAX).zip(offered) {
            let mut copies = 0;
            let mut first = None;
            while let Some((_, arrival)) = arrived.next_if(|(whole, _)| *whole <= number) {
                copies += u64::from(first.is_some());
                first = first.or(Some(arrival));
            }
            if time < counted_from {
                continue;
            }
            all.offered += 1;
            all.copies += copies;
            match first {
                Some(arrival) => all.deliver(arrival.time - time, arrival.hops, shortest_hops),
                None => {
                    #[expect(clippy::cast_possible_truncation, reason = "numbers of packets go round")]
                    let short = number as u16;
                    // Only the latest packet with these bits can be left.
                    let is_latest = offered.len() as u64 - u64::from(number) <= 1 << 16;
                    match left(short).filter(|_| is_latest) {
                        Some(Left::Waiting) => all.pending += 1,
                        Some(Left::Dead) => all.died += 1,
                        None => {}
                    }
                }
            }
        }
        all
    }

    fn deliver(&mut self, delay: Duration, hops: u8, shortest_hops: Option<u32>) {
        self.delivered += 1;
        self.delays.add(delay);
        self.hops += u64::from(hops);
        self.most_hops = self.most_hops.max(hops);
        if let Some(shortest) = shortest_hops.filter(|&shortest| shortest > 0) {
            self.stretch += f64::from(hops) / f64::from(shortest);
            self.stretched += 1;
        }
    }
}

impl std::ops::AddAssign<&Deliveries> for Deliveries {
    fn add_assign(&mut self, other: &Self) {
        // Without `..`, so that no field is forgotten.
        let Self { offered, delivered, pending, died, copies, delays, hops, most_hops, stretch, stretched } = other;
        self.offered += offered;
        self.delivered += delivered;
        self.pending += pending;
        self.died += died;
        self.copies += copies;
        self.delays.merge(delays);
        self.hops += hops;
        self.most_hops = self.most_hops.max(*most_hops);
        self.stretch += stretch;
        self.stretched += stretched;
    }
}

/// The number of a packet that arrives at `time`, from its last 16 bits: the greatest one that was offered by then.
fn whole_number(number: u16, offered: &[SimTime], time: SimTime) -> Option<u32> {
    let latest = offered.partition_point(|&offer| offer <= time).checked_sub(1)?;
    #[expect(clippy::cast_possible_truncation, reason = "numbers of packets go round")]
    let behind = (latest as u16).wrapping_sub(number);
    u32::try_from(latest).ok()?.checked_sub(behind.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(s: u64) -> SimTime {
        SimTime::ZERO + Duration::from_secs(s)
    }

    #[test]
    fn each_packet_is_delivered_once_left_or_lost() {
        let arrival = |number, hops, time_s| Arrival { origin: StationId(0), number, hops, time: at(time_s) };
        let offered = [at(1), at(2), at(3), at(4), at(5), at(6)];
        // Number 0 is before the warm-up, number 3 is lost, number 4 waits, number 5 is in a dead station.
        let arrived = [arrival(0, 9, 2), arrival(1, 2, 4), arrival(1, 3, 9), arrival(2, 4, 6)];
        let left = |number: u16| match number {
            4 => Some(Left::Waiting),
            5 => Some(Left::Dead),
            _ => None,
        };
        let all = Deliveries::of(&offered, &arrived, left, Some(2), at(2));
        assert_eq!((all.offered, all.delivered, all.pending, all.died, all.lost(), all.copies), (5, 2, 1, 1, 1, 1));
        assert_eq!((all.hops, all.most_hops, all.stretched, all.delays.mean_s()), (6, 4, 2, Some(2.5)));
        assert!((all.stretch - 3.0).abs() < 1e-12);
    }

    #[test]
    fn numbers_of_packets_go_round_and_are_made_whole_again() {
        let offered: Vec<SimTime> = (0..70_000).map(at).collect();
        for (number, time_s, whole) in [
            (7, 7, Some(7)),
            (5, 9, Some(5)),
            (8, 7, None),
            (65_535, 65_535, Some(65_535)),
            (0, 65_536, Some(65_536)),
            (65_535, 65_536, Some(65_535)),
            // The first one that arrives may have any number.
            (4_000, 69_999, Some(69_536)),
            (4_464, 99_999, Some(4_464)),
        ] {
            assert_eq!(whole_number(number, &offered, at(time_s)), whole, "{number} at {time_s} s");
        }
        assert_eq!(whole_number(0, &[], at(9)), None);
    }
}
