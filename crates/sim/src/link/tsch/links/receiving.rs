//! Receiving: who follows a frame, to whom it is delivered, and when a station sleeps again.

use sextant_kernel::{SimTime, StationId};
use sextant_mac::tsch::{SlotKind, Turn};

use super::Links;
use crate::scene::Scene;
use crate::service::outcome::{Deafness, FrameOutcome};
use crate::service::upcall::Upcall;

impl Links {
    /// Notes who was locked on to a frame that ends now.
    pub(super) fn note_followers(&mut self, now: SimTime) {
        for arrival in self.arrivals.iter().filter(|arrival| arrival.was_followed) {
            if let Some(listening) = &mut self.stacks[arrival.station.index()].listening {
                listening.followed = Some(now);
            }
        }
    }

    /// Delivers the packet whose frame ends now to all stations that have received it and for which it is.
    pub(super) fn deliver(&mut self, from: StationId, turn: Turn, was_received: bool, scene: &mut Scene) {
        let frame = self.stacks[from.index()].sender.frame(turn);
        let (sequence, counts) = (frame.sequence, frame.offered >= self.ledger.counted_from);
        let places = match turn {
            Turn::Station(to) if !was_received => self.place_of(to).map_or(0..0, |place| place..place + 1),
            Turn::Station(_) | Turn::Beacon => 0..0,
            Turn::All => 0..self.arrivals.len(),
        };
        for arrival in &self.arrivals[places] {
            let (station, power, outcome) = (arrival.station, arrival.power, arrival.outcome);
            let is_received = outcome == FrameOutcome::Received;
            if is_received && self.hears[station.index()] && self.stacks[station.index()].is_joined() {
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
        // The air finds the last of them first.
        for station in stations.drain(..).rev() {
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
        self.place_of(station).is_some_and(|place| self.arrivals[place].outcome == FrameOutcome::Received)
    }

    /// The place of a station among the arrivals, which are in the order of the stations.
    fn place_of(&self, station: StationId) -> Option<usize> {
        self.arrivals.binary_search_by_key(&station, |arrival| arrival.station).ok()
    }
}
