//! Carrier sense among radios that stand: how much of a signal is enough to make the channel busy.

use std::time::Duration;

use sextant_channel::Milliwatts;

use super::budget::Budget;
use super::interface::Interface;
use super::listener::Listener;
use super::sense::Sense;
use super::signal::Signal;

/// Pairs of radios in the table at most (4 MB).
const MOST: usize = 1 << 20;

/// For each pair of radios, how much of a signal of the one is enough for the other to find the channel busy. That is
/// worked out once, so that carrier sense compares whole numbers.
#[derive(Debug)]
pub(super) struct Carrier {
    /// By radio that senses, then by sender; empty if there are too many.
    enough: Vec<u32>,
    radios: usize,
    /// The window of carrier sense.
    window: Duration,
    window_ns: u64,
}

/// It has not been worked out yet.
const UNKNOWN: u32 = 0;
/// It is not the same for all signals.
const VARIES: u32 = u32::MAX;

/// How much of a signal is enough.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Enough {
    /// An overlap with the window of so many nanoseconds; longer than the window if the signal is too weak.
    Overlap(u32),
    /// It is not the same for all signals.
    Varies,
}

impl Carrier {
    /// No radio yet; carrier sense takes `window`.
    pub(super) fn new(window: Duration) -> Self {
        let window_ns = u64::try_from(window.as_nanos()).unwrap_or(u64::MAX);
        Self { enough: Vec::new(), radios: 0, window, window_ns }
    }

    /// Adds so many radios.
    pub(super) fn add(&mut self, radios: usize) {
        self.radios += radios;
        let pairs = self.radios.saturating_mul(self.radios);
        let fits = pairs <= MOST && (1..u64::from(VARIES - 1)).contains(&self.window_ns);
        self.enough = vec![UNKNOWN; if fits { pairs } else { 0 }];
    }

    /// Whether the table is about such a look at the channel.
    #[inline]
    pub(super) fn knows(&self, sense: &Sense) -> bool {
        !self.enough.is_empty() && sense.to.as_nanos() - sense.from.as_nanos() == self.window_ns
    }

    /// How much of a signal is enough for a look at the channel of which the table [`knows`](Self::knows).
    #[inline]
    pub(super) fn enough(&mut self, signal: &Signal, sense: &Sense, reach_m: f64, budget: &mut Budget) -> Enough {
        let place = sense.radio.receiver.index() * self.radios + signal.sender.index();
        if self.enough[place] == UNKNOWN {
            self.enough[place] = self.work_out(signal, sense, reach_m, budget);
        }
        match self.enough[place] {
            VARIES => Enough::Varies,
            overlap_ns => Enough::Overlap(overlap_ns),
        }
    }

    #[cold]
    fn work_out(&self, signal: &Signal, sense: &Sense, reach_m: f64, budget: &mut Budget) -> u32 {
        if !budget.stays(signal, sense.radio.station) {
            return VARIES;
        }
        let window_s = self.window.as_secs_f64();
        let (mut short, mut long) = (0, u32::try_from(self.window_ns).expect("the table has room for it"));
        let Some(power) = power_in_reach(signal, sense, reach_m, budget) else { return long + 1 };
        // It grows with the overlap, rounding included.
        let is_enough = |overlap_ns: u32| {
            let energy = power.0 * Duration::from_nanos(overlap_ns.into()).as_secs_f64();
            Milliwatts(energy / window_s) >= sense.threshold
        };
        if !is_enough(long) {
            return long + 1;
        }
        while long - short > 1 {
            let middle = short + (long - short) / 2;
            *if is_enough(middle) { &mut long } else { &mut short } = middle;
        }
        long
    }
}

/// Overlap of a signal with the window of a look at the channel (ns); zero for a signal of the radio itself.
#[inline]
pub(super) fn overlap_ns(signal: &Signal, sense: &Sense) -> u64 {
    if signal.sender == sense.radio.receiver {
        return 0;
    }
    let (start, end) = (signal.start.max(sense.from), signal.end.min(sense.to));
    end.as_nanos().saturating_sub(start.as_nanos())
}

/// Energy of a signal at a radio in a window (mW s).
#[inline]
pub(super) fn energy_in(signal: &Signal, sense: &Sense, reach_m: f64, budget: &mut Budget) -> f64 {
    let overlap_ns = overlap_ns(signal, sense);
    if overlap_ns == 0 {
        return 0.0;
    }
    let power = power_in_reach(signal, sense, reach_m, budget);
    power.map_or(0.0, |power| power.0 * Duration::from_nanos(overlap_ns).as_secs_f64())
}

/// Power of a signal at a radio that senses the carrier; `None` if it is out of reach.
fn power_in_reach(signal: &Signal, sense: &Sense, reach_m: f64, budget: &mut Budget) -> Option<Milliwatts> {
    let &Sense { radio: Interface { receiver, station }, place, .. } = sense;
    if signal.position.distance_m(place) > reach_m {
        return None;
    }
    budget.power_at(signal, &Listener { receiver, station, place })
}

#[cfg(test)]
mod tests {
    use sextant_channel::{Channel, ChannelConfig, Dbm, ObstacleField, Position, ShadowingConfig};
    use sextant_kernel::{Seed, SimTime, StationId};

    use super::*;
    use crate::air::{Aim, Emission, ReceiverId};

    #[test]
    fn an_overlap_is_enough_if_its_energy_is() {
        let window = Duration::from_micros(128);
        let shadowing =
            Some(ShadowingConfig { sigma_db: Some(6.0), correlation: sextant_channel::CorrelationConfig::PerLink });
        let law = ChannelConfig { shadowing, ..ChannelConfig::default() }.try_into().expect("a good channel");
        let channel = Channel::new(law, ObstacleField::new(Vec::new()), Seed(3));
        let emission = Emission { power: Dbm(0.0), aim: Aim::Omnidirectional };
        let mut budget = Budget::new(channel, None, emission, Dbm(-200.0), 40, 39..40);
        let mut carrier = Carrier::new(window);
        carrier.add(40);
        let at = |station: u32| Position::new(f64::from(station * 7 % 40), f64::from(station * 3 % 17), 0.0);
        let (mut enough, mut too_short) = (0, 0);
        for (source, station) in (0..40).flat_map(|a| (0..40).map(move |b| (a, b))).filter(|(a, b)| a != b) {
            let radio = Interface { receiver: ReceiverId(station), station: StationId(station) };
            let (from, to) = (SimTime::from_nanos(1_000_000), SimTime::from_nanos(1_128_000));
            let sense = Sense { radio, place: at(station), from, to, threshold: Dbm(-70.0).to_milliwatts() };
            for overlap in [1, 997, 64_000, 100_003, 127_999, 128_000] {
                let signal = Signal {
                    packet: 0,
                    draw: 0,
                    source: StationId(source),
                    sender: ReceiverId(source),
                    position: at(source),
                    emission,
                    start: SimTime::ZERO,
                    end: SimTime::from_nanos(1_000_000 + overlap),
                };
                assert!(carrier.knows(&sense));
                let energy = energy_in(&signal, &sense, 30.0, &mut budget);
                let is_busy = Milliwatts(energy / window.as_secs_f64()) >= sense.threshold;
                match carrier.enough(&signal, &sense, 30.0, &mut budget) {
                    Enough::Varies => assert!(source == 39 || station == 39, "both stand"),
                    Enough::Overlap(least_ns) => {
                        assert_eq!(overlap >= least_ns.into(), is_busy, "{source} {station} {overlap}");
                        *if is_busy { &mut enough } else { &mut too_short } += 1;
                    }
                }
            }
        }
        assert!(enough > 1000 && too_short > 1000, "{enough} {too_short}");
    }
}
