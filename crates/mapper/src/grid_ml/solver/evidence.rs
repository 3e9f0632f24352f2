//! The entries of the log for one node, sorted by how they enter the likelihood.

use sextant_channel::{Position, Receptions};

use super::receiver::ReceivingStop;
use super::wedges::Wedges;

/// A stop with an entry other than one packet received of one sent.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Count {
    pub(crate) place: Position,
    pub(crate) received: u32,
    pub(crate) missed: u32,
}

/// The entries of the log for one node.
#[derive(Debug)]
pub(crate) struct PacketEvidence {
    /// Every stop that received.
    receivers: Vec<ReceivingStop>,
    /// Stops that received one of one.
    pub(crate) heard: Vec<Position>,
    /// Stops with any other entry but `0` of `0`.
    pub(crate) counts: Vec<Count>,
    /// Whether a receiver has a sector.
    sectored: bool,
    /// One bit per stop: whether the log has an entry for it.
    listed: Vec<u64>,
    stops: usize,
    entries: usize,
    received: u64,
    missed: u64,
}

impl PacketEvidence {
    pub(crate) fn new(stops: usize) -> Self {
        Self {
            receivers: Vec::new(),
            heard: Vec::new(),
            counts: Vec::new(),
            sectored: false,
            listed: vec![0; stops.div_ceil(64)],
            stops,
            entries: 0,
            received: 0,
            missed: 0,
        }
    }

    /// Reads the entries of one node, heard at stops at `places`. [`clear`](Self::clear) them before the next.
    pub(crate) fn read(&mut self, receptions: Receptions<'_>, places: &[Position], wedges: Option<&Wedges>) {
        self.receivers.clear();
        self.heard.clear();
        self.counts.clear();
        self.entries = receptions.len();
        (self.received, self.missed) = (0, 0);
        self.sectored = false;
        let sectors = receptions.sectors().filter(|_| wedges.is_some());
        let sector = |at: usize| sectors.and_then(|sectors| sectors[at]);
        match receptions.packets() {
            None => {
                for (at, &stop) in receptions.stops().iter().enumerate() {
                    self.enter(stop as usize, places, 1, 1, sector(at));
                }
            }
            Some(packets) => {
                for (at, (&stop, (received, sent))) in receptions.stops().iter().zip(packets).enumerate() {
                    self.enter(stop as usize, places, received, sent, sector(at));
                }
            }
        }
    }

    #[inline(always)]
    fn enter(&mut self, stop: usize, places: &[Position], received: u32, sent: u32, sector: Option<u8>) {
        self.listed[stop / 64] |= 1 << (stop % 64);
        let place = places[stop];
        let missed = sent - received;
        self.received += u64::from(received);
        self.missed += u64::from(missed);
        if received > 0 {
            self.sectored |= sector.is_some();
            self.receivers.push(ReceivingStop { place, packets: received, sector });
        }
        if (received, missed) == (1, 0) {
            self.heard.push(place);
        } else if sent > 0 {
            self.counts.push(Count { place, received, missed });
        }
    }

    pub(crate) fn clear(&mut self, receptions: Receptions<'_>) {
        for &stop in receptions.stops() {
            self.listed[stop as usize / 64] = 0;
        }
    }

    /// Whether the log has an entry for a stop. If not, one packet was missed there.
    pub(crate) fn is_listed(&self, stop: u32) -> bool {
        self.listed[stop as usize / 64] >> (stop % 64) & 1 == 1
    }

    /// Stops without an entry.
    pub(crate) fn silent_stops(&self) -> usize {
        self.stops - self.entries
    }

    pub(crate) fn receptions(&self) -> &[ReceivingStop] {
        &self.receivers
    }

    /// Whether any reception is in a known sector.
    pub(crate) fn is_sectored(&self) -> bool {
        self.sectored
    }

    /// Packets received at all stops.
    pub(crate) fn heard_packets(&self) -> u64 {
        self.received
    }

    /// Packets missed at all stops, one at each stop without an entry.
    pub(crate) fn missed_packets(&self) -> u64 {
        self.missed + self.silent_stops() as u64
    }
}
