//! The air between the stations: the signals of one band, and all radios that listen to them.

mod budget;
mod cells;
mod medium;
mod outcome;
mod receiver;
mod reception_model;
mod signal;

use std::time::Duration;

use sextant_channel::{Channel, Dbm, Milliwatts, Position};
use sextant_kernel::{Seed, SimTime, StationId};

use crate::purpose;
use crate::station::{Motion, Roll};
use budget::Budget;
use medium::{Listener, Medium};
use receiver::Receiver;

pub(crate) use medium::ReceiverId;
pub use outcome::FrameOutcome;
pub(crate) use receiver::ReceptionRules;
pub use reception_model::{ReceptionConfig, ReceptionModel, SinrThresholdConfig};
pub(crate) use signal::{Antenna, Emission, Signal};

/// A transmission under way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Transmission {
    signal: Signal,
    /// Whether collectors beyond the radius of communication listened when it began.
    beyond: bool,
}

/// The outcome of a transmission at one receiver.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrival {
    pub(crate) receiver: ReceiverId,
    pub(crate) station: StationId,
    pub(crate) power: Milliwatts,
    pub(crate) outcome: FrameOutcome,
}

/// The air of one band. Robots and sinks are collectors: what nodes send is meant for them.
pub(crate) struct Air {
    medium: Medium,
    receivers: Vec<Receiver>,
    rules: Vec<ReceptionRules>,
    roll: Roll,
    collectors_listening: usize,
    packets: u64,
    seed: Seed,
    near: Vec<Listener<Position>>,
}

/// Settings of the air.
pub(crate) struct AirSettings {
    pub(crate) channel: Channel,
    /// Largest transmit power.
    pub(crate) power: Dbm,
    /// Signals below it may be neglected.
    pub(crate) floor: Dbm,
    /// Window of carrier sense.
    pub(crate) sensing: Duration,
    /// Number of the first packet; each packet has its own number and so its own draws.
    pub(crate) first_packet: u64,
    pub(crate) seed: Seed,
}

impl Air {
    pub(crate) fn new(settings: AirSettings, places: impl Iterator<Item = Position> + Clone, roll: Roll) -> Self {
        let AirSettings { channel, power, floor, sensing, first_packet, seed } = settings;
        let first_robot = StationId::from_index(roll.nodes).0;
        let mobile = first_robot..StationId::from_index(roll.nodes + roll.robots).0;
        let emission = Emission { power, antenna: Antenna::Omnidirectional };
        let budget = Budget::new(channel, emission, roll.len(), mobile);
        Self {
            medium: Medium::new(budget, places, power, floor, sensing),
            receivers: Vec::new(),
            rules: Vec::new(),
            roll,
            collectors_listening: 0,
            packets: first_packet,
            seed,
            near: Vec::new(),
        }
    }

    /// Adds a receiver for each station, with these `rules`. Returns the number of the first one; the others follow
    /// in the order of the stations.
    pub(crate) fn add_receivers(&mut self, rules: ReceptionRules) -> u32 {
        let first = self.receivers.len();
        self.receivers.resize(first + self.roll.len(), Receiver::default());
        self.rules.push(rules);
        u32::try_from(first).expect("at most 2^32 receivers")
    }

    /// Whether more than one network is in this band.
    pub(crate) fn is_shared(&self) -> bool {
        self.rules.len() > 1
    }

    #[inline]
    fn rules(&self, receiver: ReceiverId) -> &ReceptionRules {
        if let [rules] = &self.rules[..] {
            return rules;
        }
        &self.rules[receiver.index() / self.roll.len()]
    }

    fn is_collector(&self, station: StationId) -> bool {
        !self.roll.is_node(station)
    }

    fn is_mobile(&self, station: StationId) -> bool {
        let index = station.index();
        index >= self.roll.nodes && index < self.roll.nodes + self.roll.robots
    }

    /// Whether a receiver listens.
    pub(crate) fn is_listening(&self, receiver: ReceiverId) -> bool {
        self.receivers[receiver.index()].is_listening()
    }

    /// The radio of a station starts to listen.
    pub(crate) fn listen(&mut self, now: SimTime, receiver: ReceiverId, station: StationId, motion: &Motion) {
        if self.is_listening(receiver) {
            return;
        }
        self.collectors_listening += usize::from(self.is_collector(station));
        let place = motion.at(now);
        if self.is_mobile(station) {
            self.medium.join_mobile(receiver, station, *motion);
        } else {
            self.medium.join(receiver, station, place);
        }
        let on_air = self.medium.on_air(now, place);
        self.receivers[receiver.index()].start(now);
        for signal in on_air.iter().filter(|signal| signal.source != station) {
            if let Some(power) = self.medium.power_at(signal, station, place) {
                let rules = *self.rules(receiver);
                self.receivers[receiver.index()].begin(now, signal.packet, power, false, &rules);
            }
        }
    }

    /// A station that listens, or not, moves differently from now on.
    pub(crate) fn moves(&mut self, receiver: ReceiverId, station: StationId, motion: &Motion) {
        if self.is_listening(receiver) {
            self.medium.join_mobile(receiver, station, *motion);
        }
    }

    /// The radio of a station stops listening; `place` is where it is.
    pub(crate) fn deafen(&mut self, receiver: ReceiverId, station: StationId, place: Position) {
        if self.is_listening(receiver) {
            self.collectors_listening -= usize::from(self.is_collector(station));
            if self.is_mobile(station) {
                self.medium.leave_mobile(receiver);
            } else {
                self.medium.leave(receiver, place);
            }
            self.receivers[receiver.index()].stop();
        }
    }

    /// Whether carrier sense finds power at or above `threshold` in `[from, to)`.
    pub(crate) fn is_busy(
        &mut self,
        station: StationId,
        place: Position,
        from: SimTime,
        to: SimTime,
        threshold: Milliwatts,
    ) -> bool {
        self.medium.sensed(station, place, from, to) >= threshold
    }

    /// A station starts to send a frame.
    pub(crate) fn begin(
        &mut self,
        now: SimTime,
        source: StationId,
        position: Position,
        emission: Emission,
        airtime: Duration,
    ) -> Transmission {
        let signal = Signal { packet: self.packets, source, position, emission, start: now, end: now + airtime };
        self.packets += 1;
        self.medium.begin(signal);
        let mut near = std::mem::take(&mut self.near);
        self.medium.listeners(&signal, &mut near);
        let mut collectors_reached = 0;
        for &Listener { receiver, station, place } in &near {
            if let Some(power) = self.medium.power_at(&signal, station, place) {
                collectors_reached += usize::from(self.is_collector(station));
                let rules = *self.rules(receiver);
                self.receivers[receiver.index()].begin(now, signal.packet, power, true, &rules);
            }
        }
        self.near = near;
        Transmission { signal, beyond: self.collectors_listening > collectors_reached }
    }

    /// A frame ends: fills `arrivals` with its outcome at each radio that it reached, by receiver, and
    /// returns its best outcome at any collector.
    pub(crate) fn end(
        &mut self,
        now: SimTime,
        transmission: &Transmission,
        arrivals: &mut Vec<Arrival>,
    ) -> FrameOutcome {
        let Transmission { signal, beyond } = transmission;
        let mut best = if *beyond { FrameOutcome::OutOfRange } else { FrameOutcome::NotListened };
        let mut near = std::mem::take(&mut self.near);
        self.medium.listeners(signal, &mut near);
        arrivals.clear();
        for &Listener { receiver, station, .. } in &near {
            let seed = self.seed;
            let luck = || seed.uniform(purpose::RECEPTION, [signal.packet, receiver.0.into(), 0]);
            let rules = *self.rules(receiver);
            if let Some((power, outcome)) = self.receivers[receiver.index()].end(now, signal.packet, &rules, luck) {
                if self.is_collector(station) {
                    best = best.max(outcome);
                }
                arrivals.push(Arrival { receiver, station, power, outcome });
            }
        }
        self.near = near;
        best
    }
}

impl Transmission {
    /// The station that sends it.
    pub(crate) fn source(&self) -> StationId {
        self.signal.source
    }

    /// Whether a robot or a sink listened when it began, but beyond the radius of communication.
    pub(crate) fn missed_a_collector(&self) -> bool {
        self.beyond
    }

    /// Start of its first symbol on air.
    pub(crate) fn start(&self) -> SimTime {
        self.signal.start
    }
}
