//! The air between the stations, and all radios that listen to it.

use std::time::Duration;

use sextant_channel::{Channel, Dbm, Milliwatts, Position};
use sextant_kernel::{NodeId, Seed, SimTime};

use crate::FrameOutcome;
use crate::medium::{Medium, Signal};
use crate::purpose;
use crate::receiver::{Receiver, ReceptionRules};

/// A transmission under way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Transmission {
    signal: Signal,
    /// Whether receivers beyond the radius of communication listened when it began.
    beyond: bool,
}

/// The outcome of a transmission at one receiver.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrival {
    pub(crate) station: NodeId,
    pub(crate) power: Milliwatts,
    pub(crate) outcome: FrameOutcome,
}

/// The air between the stations, and all radios that listen to it. Stations numbered from `first_robot` on are
/// robots.
pub(crate) struct Air {
    medium: Medium,
    receivers: Vec<Receiver>,
    rules: ReceptionRules,
    first_robot: u32,
    robots_listening: usize,
    power: Dbm,
    packets: u64,
    seed: Seed,
    near: Vec<(NodeId, Position)>,
}

/// Settings of the air.
pub(crate) struct AirSettings {
    pub(crate) channel: Channel,
    pub(crate) power: Dbm,
    /// Signals below it may be neglected.
    pub(crate) floor: Dbm,
    pub(crate) rules: ReceptionRules,
    /// Window of carrier sense.
    pub(crate) sensing: Duration,
    /// Number of the first packet; each packet has its own number and so its own draws.
    pub(crate) first_packet: u64,
    pub(crate) seed: Seed,
}

impl Air {
    pub(crate) fn new(
        settings: AirSettings,
        places: impl Iterator<Item = Position> + Clone,
        nodes: usize,
        robots: usize,
    ) -> Self {
        let AirSettings { channel, power, floor, rules, sensing, first_packet, seed } = settings;
        Self {
            medium: Medium::new(channel, places, power, floor, sensing),
            receivers: vec![Receiver::default(); nodes + robots],
            rules,
            first_robot: NodeId::from_index(nodes).0,
            robots_listening: 0,
            power,
            packets: first_packet,
            seed,
            near: Vec::new(),
        }
    }

    fn is_robot(&self, station: NodeId) -> bool {
        station.0 >= self.first_robot
    }

    /// The radio of a station starts to listen; the station stays at `place` until [`Air::deafen`].
    pub(crate) fn listen(&mut self, now: SimTime, station: NodeId, place: Position) {
        if self.receivers[station.index()].is_listening() {
            return;
        }
        self.robots_listening += usize::from(self.is_robot(station));
        self.medium.join(station, place);
        let on_air = self.medium.on_air(now, place);
        let receiver = &mut self.receivers[station.index()];
        receiver.start(now);
        for signal in on_air.iter().filter(|signal| signal.source != station) {
            if let Some(power) = self.medium.power_at(signal, station, place) {
                receiver.begin(now, signal.packet, power, false, &self.rules);
            }
        }
    }

    /// The radio of a station stops listening.
    pub(crate) fn deafen(&mut self, station: NodeId, place: Position) {
        if self.receivers[station.index()].is_listening() {
            self.robots_listening -= usize::from(self.is_robot(station));
            self.medium.leave(station, place);
            self.receivers[station.index()].stop();
        }
    }

    /// Whether carrier sense finds power at or above `threshold` in `[from, to)`.
    pub(crate) fn is_busy(
        &mut self,
        station: NodeId,
        place: Position,
        from: SimTime,
        to: SimTime,
        threshold: Milliwatts,
    ) -> bool {
        self.medium.sensed(station, place, from, to) >= threshold
    }

    /// A station starts to send a frame.
    pub(crate) fn begin(&mut self, now: SimTime, source: NodeId, place: Position, airtime: Duration) -> Transmission {
        let signal = Signal {
            packet: self.packets,
            source,
            position: place,
            power: self.power,
            start: now,
            end: now + airtime,
        };
        self.packets += 1;
        self.medium.begin(signal);
        let mut near = std::mem::take(&mut self.near);
        self.medium.listeners(&signal, &mut near);
        let mut robots_reached = 0;
        for &(station, place) in &near {
            if let Some(power) = self.medium.power_at(&signal, station, place) {
                robots_reached += usize::from(self.is_robot(station));
                self.receivers[station.index()].begin(now, signal.packet, power, true, &self.rules);
            }
        }
        self.near = near;
        Transmission { signal, beyond: self.robots_listening > robots_reached }
    }

    /// A frame ends: fills `arrivals` with its outcome at each radio that it reached, by station, and
    /// returns its best outcome at any robot.
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
        for &(station, _) in &near {
            let seed = self.seed;
            let luck = || seed.uniform(purpose::RECEPTION, [signal.packet, station.0.into(), 0]);
            if let Some((power, outcome)) = self.receivers[station.index()].end(now, signal.packet, &self.rules, luck)
            {
                if self.is_robot(station) {
                    best = best.max(outcome);
                }
                arrivals.push(Arrival { station, power, outcome });
            }
        }
        self.near = near;
        best
    }
}

impl Transmission {
    /// The station that sends it.
    pub(crate) fn source(&self) -> NodeId {
        self.signal.source
    }

    /// Start of its first symbol on air.
    pub(crate) fn start(&self) -> SimTime {
        self.signal.start
    }
}
