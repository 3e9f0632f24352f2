//! Frames as octets, and for observers.

use sextant_kernel::StationId;
use sextant_mac::frame::{Address, Endpoint};
use sextant_mac::tsch::Chance;
use sextant_mac::tsch::frame::SlotData;

use super::Links;
use crate::air::Transmission;
use crate::link::collectors::tell_collectors;
use crate::link::fate::Fate;
use crate::link::tsch::stack::FrameKind;
use crate::observer::{FrameOnAir, Observer};
use crate::scene::Scene;
use crate::service::report::Destination;

impl Links {
    /// Writes what a station sent in a slot, or only its payload if nobody looks at more.
    pub(super) fn write_sent(&mut self, station: StationId, chance: Chance, observer: &impl Observer) {
        let mut mpdu = std::mem::take(&mut self.mpdu);
        let frame = self.stacks[station.index()].sender.frame(chance.turn);
        let (kind, to, sequence, join_metric) =
            (frame.kind, frame.to, frame.sequence, self.stacks[station.index()].join_metric);
        if kind == FrameKind::Beacon {
            mpdu.clear();
            if observer.wants_frames() {
                let from = Endpoint { pan: self.pan, address: Address::of(station) };
                let mut beacon = self.plan.beacon(&self.settings, from, chance.asn, join_metric);
                beacon.sequence = sequence;
                beacon.write(&mut mpdu);
            }
            self.payload = 0..0;
            self.mpdu = mpdu;
            return;
        }
        let content = {
            let stack = &mut self.stacks[station.index()];
            let frame = stack.sender.frame(chance.turn);
            (frame.content, frame.mpdu_octets)
        };
        let payload = self.payload_of(station, kind, to, content);
        if observer.wants_frames() {
            let to = match to {
                Destination::Station(to) => Some(to),
                Destination::All => None,
            };
            SlotData { pan: self.pan, from: station, to, sequence, payload }.write(&mut mpdu);
            let end = mpdu.len() - 2;
            self.payload = end - payload.len()..end;
        } else {
            mpdu.clear();
            mpdu.extend_from_slice(payload);
            self.payload = 0..payload.len();
        }
        self.mpdu = mpdu;
    }

    /// Tells the observer of the frame in the buffer, which ends now, with its fate.
    pub(super) fn tell_frame(
        &mut self,
        place: usize,
        transmission: &Transmission,
        fate: Fate,
        scene: &Scene,
        observer: &mut impl Observer,
    ) {
        tell_collectors(&self.arrivals, &scene.roll, &mut self.told);
        observer.framed(FrameOnAir {
            network: self.radios[0].network,
            channel: Some(self.settings.hopping.channels()[place]),
            start: transmission.start(),
            airtime: scene.now - transmission.start(),
            source: transmission.source(),
            bytes: &self.mpdu,
            outcome: fate.outcome,
            power: fate.power(),
            heard: &self.told,
        });
    }
}
