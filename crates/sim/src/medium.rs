//! The air between the stations: the signals on it, and the stations that can hear them.

use std::time::Duration;

use sextant_channel::{Channel, Dbm, Milliwatts, Position};
use sextant_kernel::{NodeId, SimTime};

use crate::cells::Cells;

/// A frame on air: `[start, end)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Signal {
    pub(crate) packet: u64,
    pub(crate) source: NodeId,
    pub(crate) position: Position,
    pub(crate) power: Dbm,
    pub(crate) start: SimTime,
    pub(crate) end: SimTime,
}

/// The air between the stations.
///
/// A signal takes no computing time until a station needs the power at its place: a station that senses the carrier,
/// or a radio that listens. Both look only at signals and listeners within reach, so the time for a frame grows with
/// the number of neighbours and not with the size of the network.
pub(crate) struct Medium {
    channel: Channel,
    signals: Cells<Signal>,
    listeners: Cells<(NodeId, Position)>,
    /// How long a signal is kept after its end: the window of carrier sense.
    memory: Duration,
}

impl Medium {
    /// An empty medium for stations that stay near `places` and transmit with at most `power`; signals below
    /// `floor` may be neglected.
    pub(crate) fn new(
        channel: Channel,
        places: impl Iterator<Item = Position> + Clone,
        power: Dbm,
        floor: Dbm,
        memory: Duration,
    ) -> Self {
        let reach_m = channel.law().reach_m(power, floor);
        let signals = Cells::covering(places.clone(), reach_m);
        let listeners = Cells::covering(places, reach_m);
        Self { channel, signals, listeners, memory }
    }

    /// Starts a signal.
    pub(crate) fn begin(&mut self, signal: Signal) {
        let forgotten = signal.start.saturating_sub(self.memory);
        let cell = self.signals.at(signal.position);
        cell.retain(|old| old.end > forgotten);
        cell.push(signal);
    }

    /// Power of a signal at a station; `None` beyond the radius of communication.
    pub(crate) fn power_at(&self, signal: &Signal, station: NodeId, place: Position) -> Option<Milliwatts> {
        power_at(&self.channel, signal, station, place)
    }

    /// Mean power that a station hears from others during `[from, to)`.
    pub(crate) fn sensed(&mut self, station: NodeId, place: Position, from: SimTime, to: SimTime) -> Milliwatts {
        let forgotten = to.saturating_sub(self.memory);
        let mut energy = 0.0;
        let channel = &self.channel;
        self.signals.near(place, |cell| {
            cell.retain(|signal| signal.end > forgotten);
            for signal in cell.iter().filter(|s| s.source != station && s.start < to && s.end > from) {
                if let Some(power) = power_at(channel, signal, station, place) {
                    let overlap = signal.end.min(to).saturating_since(signal.start.max(from));
                    energy += power.0 * overlap.as_secs_f64();
                }
            }
        });
        Milliwatts(energy / (to - from).as_secs_f64())
    }

    /// The signals on air at `now` that may reach `place`, by packet.
    pub(crate) fn on_air(&mut self, now: SimTime, place: Position) -> Vec<Signal> {
        let mut signals = Vec::new();
        self.signals.near(place, |cell| {
            signals.extend(cell.iter().filter(|signal| signal.start <= now && now < signal.end));
        });
        signals.sort_by_key(|signal: &Signal| signal.packet);
        signals
    }

    /// Adds a station to those that listen; it stays at `place` until [`Medium::leave`].
    pub(crate) fn join(&mut self, station: NodeId, place: Position) {
        self.listeners.at(place).push((station, place));
    }

    /// Removes a station from those that listen.
    pub(crate) fn leave(&mut self, station: NodeId, place: Position) {
        self.listeners.at(place).retain(|&(listener, _)| listener != station);
    }

    /// Fills `found` with the stations that listen within reach of a signal, by number, and their places.
    pub(crate) fn listeners(&mut self, signal: &Signal, found: &mut Vec<(NodeId, Position)>) {
        found.clear();
        self.listeners.near(signal.position, |cell| {
            found.extend(cell.iter().filter(|&&(listener, _)| listener != signal.source));
        });
        found.sort_by_key(|&(listener, _)| listener);
    }
}

fn power_at(channel: &Channel, signal: &Signal, station: NodeId, place: Position) -> Option<Milliwatts> {
    let mean = channel.mean_power(signal.power, signal.position, place)?;
    let shadowing = channel.shadowing(signal.source, signal.position, station, place, signal.packet);
    Some((mean + shadowing).to_milliwatts())
}
