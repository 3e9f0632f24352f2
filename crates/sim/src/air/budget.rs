//! The power of signals between stations: what does not change from packet to packet is worked out once.

use sextant_channel::{Channel, Dbm, Milliwatts, Position};
use sextant_kernel::StationId;

use super::signal::{Emission, Signal};

/// Number of links that are remembered: a power of two.
const LINKS: usize = 1 << 18;

/// The power between pairs of stations. That between two stations that stand is remembered. A link that is not remembered, or was forgotten because another one
/// took its slot, is worked out again, with the same result.
pub(super) struct Budget {
    channel: Channel,
    /// What the remembered links are sent with.
    emission: Emission,
    /// Whether shadowing changes with each packet.
    is_per_packet: bool,
    /// Number of stations, which address the slots.
    stations: u64,
    /// The stations that may move.
    mobile: std::ops::Range<u32>,
    links: Vec<Remembered>,
}

/// A remembered link, in a quarter of a cache line.
#[derive(Clone, Copy, Debug, Default)]
struct Remembered {
    /// One plus the address of the link; zero if there is none.
    link: u64,
    /// Mean power (dBm) if each packet has a shadowing of its own, or else the power (mW). Not a number beyond the radius
    /// of communication.
    power: f64,
}

impl Budget {
    /// The budget of `stations` stations, of which `mobile` may move.
    pub(super) fn new(channel: Channel, emission: Emission, stations: usize, mobile: std::ops::Range<u32>) -> Self {
        let is_per_packet = channel.law().shadowing().is_per_packet();
        let slots = if stations.saturating_mul(stations) < LINKS { stations * stations } else { LINKS };
        let links = vec![Remembered::default(); slots];
        Self { channel, emission, is_per_packet, stations: stations as u64, mobile, links }
    }

    pub(super) fn channel(&self) -> &Channel {
        &self.channel
    }

    /// Power of a signal at a station; `None` beyond the radius of communication.
    #[inline]
    pub(super) fn power_at(&mut self, signal: &Signal, station: StationId, place: Position) -> Option<Milliwatts> {
        let moves = self.mobile.contains(&signal.source.0) || self.mobile.contains(&station.0);
        if moves || signal.emission != self.emission {
            let mean = self.mean(signal, place)?;
            return Some(self.with_shadowing(mean, signal, station, place).to_milliwatts());
        }
        let address = u64::from(station.0) * self.stations + u64::from(signal.source.0);
        let slot = self.slot(address);
        let mut remembered = self.links[slot];
        if remembered.link != address + 1 {
            remembered = Remembered { link: address + 1, power: self.lasting(signal, station, place) };
            self.links[slot] = remembered;
        }
        if remembered.power.is_nan() {
            return None;
        }
        if self.is_per_packet {
            let mean = Dbm(remembered.power);
            return Some(self.with_shadowing(mean, signal, station, place).to_milliwatts());
        }
        Some(Milliwatts(remembered.power))
    }

    /// The slot of a link: its own if there is one for each, or else one that other links may take.
    fn slot(&self, address: u64) -> usize {
        #[expect(clippy::cast_possible_truncation, reason = "below the number of slots")]
        if self.links.len() < LINKS {
            address as usize
        } else {
            // Fibonacci hashing (Knuth 1998, section 6.4).
            (address.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> (64 - LINKS.trailing_zeros())) as usize
        }
    }

    /// What is the same for all packets of a link.
    #[cold]
    fn lasting(&self, signal: &Signal, station: StationId, place: Position) -> f64 {
        match self.mean(signal, place) {
            None => f64::NAN,
            Some(mean) if self.is_per_packet => mean.0,
            Some(mean) => self.with_shadowing(mean, signal, station, place).to_milliwatts().0,
        }
    }

    fn mean(&self, signal: &Signal, place: Position) -> Option<Dbm> {
        self.channel.mean_power(signal.emission.power, signal.position, place)
    }

    fn with_shadowing(&self, mean: Dbm, signal: &Signal, station: StationId, place: Position) -> Dbm {
        let shadowing = self.channel.shadowing(signal.source, signal.position, station, place, signal.packet);
        mean + shadowing + signal.emission.antenna.gain(place - signal.position)
    }
}
