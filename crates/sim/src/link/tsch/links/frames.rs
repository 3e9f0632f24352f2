//! Frames as octets, and for observers.

use sextant_kernel::StationId;
use sextant_mac::frame::{Address, Endpoint};
use sextant_mac::tsch::Chance;
use sextant_mac::tsch::frame::{EnhancedBeacon, SixPFrame, SlotData};

use super::Links;
use crate::air::Transmission;
use crate::link::fate::Fate;
use crate::link::frame_buffer::FrameEnd;
use crate::link::tsch::stack::{FrameKind, SlotFrame};
use crate::observer::Observer;
use crate::scene::Scene;
use crate::service::report::Destination;

impl Links {
    /// Writes what a station sent in a slot, or only its payload if nobody looks at more.
    pub(super) fn write_sent(&mut self, station: StationId, chance: Chance, observer: &impl Observer) {
        let mut mpdu = std::mem::take(&mut self.frame.octets);
        mpdu.clear();
        let stack = &mut self.stacks[station.index()];
        let join_metric = stack.join_metric;
        let &mut SlotFrame { kind, to, sequence, content, mpdu_octets, .. } = stack.sender.frame(chance.turn);
        let payload = self.payload_of(station, kind, to, (content, mpdu_octets));
        self.frame.payload = match (kind, observer.wants_frames()) {
            (FrameKind::Beacon, true) => {
                let from = Endpoint { pan: self.pan, address: Address::of(station) };
                let beacon = self.plan.beacon(&self.settings, from, chance.asn, join_metric);
                EnhancedBeacon { sequence, ..beacon }.write(&mut mpdu);
                0..0
            }
            (FrameKind::Beacon, false) => 0..0,
            (FrameKind::Data | FrameKind::KeepAlive, true) => {
                let to = match to {
                    Destination::Station(to) => Some(to),
                    Destination::All => None,
                };
                SlotData { pan: self.pan, from: station, to, sequence, payload }.write(&mut mpdu);
                let end = mpdu.len() - 2;
                end - payload.len()..end
            }
            (FrameKind::SixP(_), true) => {
                if let Destination::Station(to) = to {
                    SixPFrame { pan: self.pan, from: station, to, sequence, message: payload }.write(&mut mpdu);
                }
                0..0
            }
            (FrameKind::SixP(_), false) => 0..0,
            (FrameKind::Data | FrameKind::KeepAlive, false) => {
                mpdu.extend_from_slice(payload);
                0..payload.len()
            }
        };
        self.frame.octets = mpdu;
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
        let (network, channel) = (self.radios[0].network, Some(self.settings.hopping.channels()[place]));
        let end = FrameEnd { network, channel, transmission, fate, arrivals: &self.arrivals };
        self.frame.tell(end, scene, observer);
    }
}
