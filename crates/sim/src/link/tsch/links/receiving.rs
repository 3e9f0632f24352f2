//! Receiving: who follows a frame, to whom it is delivered, and when a station sleeps again.

use sextant_kernel::StationId;
use sextant_mac::tsch::{SlotKind, Turn};

use super::Links;
use crate::air::{Arrival, Transmission};
use crate::scene::Scene;
use crate::service::outcome::{Deafness, FrameOutcome};
use crate::service::upcall::Upcall;

impl Links {
    /// Notes who is locked on to a frame that ends now.
    pub(super) fn follow(&mut self, place: usize, transmission: &Transmission, scene: &mut Scene) {
        let Self { stacks, listeners, radios, .. } = self;
        let air = &mut scene.airs[radios[place].air];
        for &station in &listeners.awake(place).stations {
            if air.follows(scene.now, radios[place].receiver(station), transmission)
                && let Some(listening) = &mut stacks[station.index()].listening
            {
                listening.followed = Some(scene.now);
            }
        }
    }

    /// Delivers the packet whose frame ends now to all stations that have received it and for which it is.
    pub(super) fn deliver(&mut self, from: StationId, turn: Turn, was_received: bool, scene: &mut Scene) {
        let frame = self.stacks[from.index()].sender.frame(turn);
        let (sequence, counts) = (frame.sequence, frame.offered >= self.ledger.counted_from);
        for i in 0..self.arrivals.len() {
            let arrival = &self.arrivals[i];
            let (station, power, outcome) = (arrival.station, arrival.power, arrival.outcome);
            let is_for = match turn {
                Turn::Station(to) => to == station && !was_received,
                Turn::All => true,
                Turn::Beacon => false,
            };
            let is_received = outcome == FrameOutcome::Received;
            if is_received && is_for && self.hears[station.index()] && self.stacks[station.index()].is_joined() {
                self.ledger.deliveries[station.index()] += u64::from(counts);
                scene.upcalls.push(Upcall::Delivered { station, from, sequence, power, sector: None, snr: None });
            }
        }
    }

    /// A frame on a channel has ended: if it was the last one, those that were woken for it sleep again, but for those that
    /// acknowledge one.
    pub(super) fn close_slot(&mut self, place: usize, scene: &mut Scene) {
        let awake = self.listeners.awake(place);
        awake.frames -= 1;
        if awake.frames > 0 {
            return;
        }
        let mut stations = std::mem::take(&mut awake.stations);
        for station in stations.drain(..) {
            let stack = &mut self.stacks[station.index()];
            let Some(listening) = stack.listening else { continue };
            let kind = match listening.followed {
                Some(end) => {
                    stack.usage.received(end.saturating_since(listening.opened));
                    if listening.answers { SlotKind::ReceiveAcknowledge } else { SlotKind::Receive }
                }
                None => {
                    stack.usage.received(listening.closes.saturating_since(listening.opened));
                    SlotKind::IdleListen
                }
            };
            stack.usage.slots.counts.add(kind, 1);
            stack.listening = None;
            scene.steps += 1;
            if !listening.answers {
                self.radios[place].tune(station, Some(Deafness::Asleep), &mut stack.deafness, scene);
            }
        }
        self.listeners.awake(place).stations = stations;
    }

    /// Whether a station has received the frame that ends now.
    pub(super) fn has_received(&self, station: StationId) -> bool {
        let is_at = |arrival: &Arrival| arrival.station == station && arrival.outcome == FrameOutcome::Received;
        self.arrivals.iter().any(is_at)
    }
}
