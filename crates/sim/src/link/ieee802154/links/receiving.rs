//! Receiving: a data frame ends, and is delivered to the stations for which it is.

use sextant_kernel::StationId;
use sextant_mac::responder::Verdict;

use super::Links;
use crate::air::{Arrival, Asked};
use crate::link::ieee802154::frame_queue::QueuedFrame;
use crate::link::ieee802154::transceiver::Transceiver;
use crate::observer::Observer;
use crate::scene::Scene;
use crate::service::outcome::FrameOutcome;
use crate::service::report::Destination;
use crate::service::upcall::Upcall;

impl Links {
    /// A data frame ends: finds its outcome, and delivers it.
    pub(super) fn end_frame(&mut self, station: StationId, scene: &mut Scene, observer: &mut impl Observer) {
        let stack = &mut self.stacks[station.index()];
        let transmission = stack.transmission.take().expect("only a frame on air ends");
        let frame = stack.frame.expect("a frame is under way");
        let asked = match frame.to {
            Destination::Station(to) if !observer.wants_frames() => Asked::One(to),
            Destination::Station(_) | Destination::All => Asked::All,
        };
        scene.airs[self.radios.air].end_asking(scene.now, &transmission, asked, &mut self.arrivals);
        if let Destination::Station(to) = frame.to {
            self.catch_up_now(to, scene);
        }
        let fate = match frame.to {
            Destination::Station(to) => self.fate(&transmission, scene, |station| station == to),
            Destination::All => self.fate(&transmission, scene, |station| self.hears[station.index()]),
        };
        let stack = &mut self.stacks[station.index()];
        let is_copy = stack.outcome == FrameOutcome::Received;
        if fate.outcome == FrameOutcome::Received && !is_copy {
            self.ledger.note_reception(station, frame.offered, scene.now);
        }
        stack.outcome = stack.outcome.max(fate.outcome);
        stack.transmissions += 1;
        if let Some(track) = &mut stack.track {
            track.end_transmission(&transmission, fate, &self.radios, scene);
        }
        let is_heard = self.arrivals.iter().any(|arrival| self.is_delivered(arrival));
        if !(is_heard || observer.wants_frames()) {
            return;
        }
        self.write_frame(station, observer.wants_frames());
        if observer.wants_frames() {
            self.tell_frame(&transmission, fate, scene, observer);
        }
        if is_heard {
            self.deliver(station, is_copy, scene);
        }
    }

    /// Whether the station of `arrival` looks at the frame.
    fn is_delivered(&self, arrival: &Arrival) -> bool {
        arrival.outcome == FrameOutcome::Received && self.hears[arrival.station.index()]
    }

    /// Delivers the frame of `from`, whose payload is in the buffer, to all stations that have received it and for which it is. A
    /// copy, because its acknowledgement was lost, is only acknowledged again: it goes to one station, which has the frame.
    fn deliver(&mut self, from: StationId, is_copy: bool, scene: &mut Scene) {
        let stack = &self.stacks[from.index()];
        let QueuedFrame { to, offered, .. } = stack.frame.expect("a frame is under way");
        let counts = offered >= self.ledger.counted_from;
        // Whether it is for a station does not depend on its payload.
        let frame = self.data_frame(from, to).frame(stack.sequence, &[]);
        for i in 0..self.arrivals.len() {
            let arrival = self.arrivals[i];
            if !self.is_delivered(&arrival) {
                continue;
            }
            let station = arrival.station;
            let gap = self.ack_gap(station, scene.now);
            let stack = &mut self.stacks[station.index()];
            stack.answered = Some(from);
            let mut radio = Transceiver { radios: &self.radios, stack, scene, station, awaits_ack: false };
            let verdict = self.responders[station.index()].receive_and_respond(&frame, gap, &mut radio);
            if verdict == Verdict::Deliver && !is_copy {
                self.ledger.deliveries[station.index()] += u64::from(counts);
                let (sequence, power) = (frame.sequence, arrival.power);
                scene.upcalls.push(Upcall::Delivered { station, from, sequence, power, sector: None, snr: None });
            }
        }
    }
}
