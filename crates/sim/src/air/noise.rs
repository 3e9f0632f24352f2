//! Bursts of noise on air.

use sextant_channel::{Dbm, Position};
use sextant_kernel::{SimTime, StationId};

use super::Air;
use super::listener::Listener;
use super::receiver_id::ReceiverId;
use super::signal::{Aim, Emission, Signal};
use crate::service::outcome::Deafness;

/// A burst of noise: where it comes from, and its power in the band of the air.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Burst {
    /// A number that no station has.
    pub(crate) source: StationId,
    pub(crate) position: Position,
    pub(crate) power: Dbm,
}

impl Air {
    /// A burst begins that lasts until `end`; returns its number, which no frame has.
    pub(crate) fn begin_noise(&mut self, now: SimTime, burst: &Burst, end: SimTime) -> u64 {
        let &Burst { source, position, power } = burst;
        // From the end backwards, so that frames have the numbers that they would have without noise.
        let packet = u64::MAX - self.bursts;
        let draw = self.draw_at(now);
        self.bursts += 1;
        let emission = Emission { power, aim: Aim::Omnidirectional };
        let sender = ReceiverId(source.0);
        let signal = Signal { packet, draw, source, sender, position, emission, start: now, end };
        self.medium.begin_burst(signal);
        let mut near = std::mem::take(&mut self.near);
        self.medium.listeners(&signal, &mut near);
        let mut reached = self.reached.spare();
        for &Listener { receiver, station, place } in &near {
            if let Some(power) = self.medium.power_at(&signal, &Listener { receiver, station, place })
                && power.0 > 0.0
            {
                let rules = *self.rules(receiver);
                self.receivers[receiver.index()].begin(now, packet, power, Some(Deafness::Off), &rules);
                self.note_carrier(receiver, station, &rules);
                reached.push((receiver, station));
            }
        }
        self.reached.begin(packet, reached);
        self.near = near;
        packet
    }

    /// A burst ends: it was nothing but a disturbance.
    pub(crate) fn end_noise(&mut self, now: SimTime, packet: u64) {
        let reached = self.reached.end(packet);
        for &(receiver, station) in &reached {
            let rules = *self.rules(receiver);
            if self.receivers[receiver.index()].end(now, packet, &rules, || 0.5).is_some() {
                self.note_carrier(receiver, station, &rules);
            }
        }
        self.reached.give_back(reached);
    }
}
