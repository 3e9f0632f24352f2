//! Frames as octets.

use std::time::Duration;

use sextant_kernel::StationId;
use sextant_mac::frame::Frame;
use sextant_mac::sleep::frame::{CslAck, WakeUpFrame, rendezvous_units, unit, write_plain_ack};
use sextant_mac::sleep::{Form, STROBE_OCTETS, Sent, WAKE_UP_OCTETS};
use sextant_mac::tsch::frame::SlotData;

use super::Links;
use crate::link::ieee802154::header;
use crate::link::payloads::Content;
use crate::link::sleeping::stack::Stack;
use crate::observer::Observer;
use crate::service::report::Destination;

/// The payload of a strobe: an octet that is none of 6LoWPAN (RFC 4944, 5.1: NALP).
const STROBE: &[u8] = &[0];

/// Size of an acknowledgement that tells nothing (octets).
const ACKNOWLEDGEMENT_OCTETS: u8 = 5;

/// A frame of a station.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeFrame {
    pub(super) sent: Sent,
    pub(super) to: Destination,
    pub(super) sequence: u8,
}

impl Links {
    /// For whom a frame of a station is.
    pub(super) fn recipient(&self, station: StationId, sent: Sent) -> Destination {
        let stack = &self.stacks[station.index()];
        match sent {
            Sent::Acknowledgement => Destination::Station(stack.answered.expect("it acknowledges a frame").0),
            _ => stack.waiting.front().expect("it sends a packet").to,
        }
    }

    /// The frame that a station sends.
    pub(super) fn node_frame(&self, station: StationId, sent: Sent, to: Destination) -> NodeFrame {
        let stack = &self.stacks[station.index()];
        let sequence = match sent {
            Sent::Acknowledgement => stack.answered.expect("it acknowledges a frame").1,
            _ => stack.waiting.front().expect("it sends a packet").sequence,
        };
        NodeFrame { sent, to, sequence }
    }

    /// Size of a frame of a station (octets).
    pub(super) fn octets(&self, station: StationId, sent: Sent) -> u8 {
        match sent {
            Sent::Strobe => STROBE_OCTETS,
            Sent::WakeUp { .. } => WAKE_UP_OCTETS,
            Sent::Data => self.stacks[station.index()].waiting.front().expect("it sends a packet").mpdu_octets,
            Sent::Acknowledgement => match self.settings.form {
                Form::Csl if !self.is_always_on(station) => CslAck::OCTETS,
                _ => ACKNOWLEDGEMENT_OCTETS,
            },
        }
    }

    /// The time to a rendezvous as a frame tells it.
    pub(super) fn told_rendezvous(&self, rendezvous: Duration) -> Duration {
        unit(self.phy()) * u32::from(rendezvous_units(rendezvous, self.phy()))
    }

    /// Writes a frame of a station, or only its payload if nobody looks at more.
    pub(super) fn write_frame(&mut self, station: StationId, frame: &NodeFrame, observer: &impl Observer) {
        let &NodeFrame { sent, to, sequence } = frame;
        let mut mpdu = std::mem::take(&mut self.frame.octets);
        mpdu.clear();
        self.frame.payload = 0..0;
        let peer = match to {
            Destination::Station(to) => Some(to),
            Destination::All => None,
        };
        let packet = self.stacks[station.index()].waiting.front();
        match (sent, packet) {
            (Sent::Data, Some(packet)) => {
                let header = header(self.pan, station, to);
                let payload = match packet.content {
                    Content::Octets(slot) => self.payloads.octets(slot),
                    Content::Filler => header.filler(packet.mpdu_octets).expect("sizes of traffic were checked"),
                };
                match (observer.wants_frames(), self.settings.form) {
                    (false, _) => mpdu.extend_from_slice(payload),
                    (true, Form::Csl) => {
                        SlotData { pan: self.pan, from: station, to: peer, sequence, payload }.write(&mut mpdu);
                    }
                    (true, Form::XMac | Form::RepeatedData) => header.write(sequence, payload, &mut mpdu),
                }
                let end = if observer.wants_frames() { mpdu.len() - 2 } else { mpdu.len() };
                self.frame.payload = end - payload.len()..end;
            }
            _ if !observer.wants_frames() => {}
            (Sent::Strobe, _) => header(self.pan, station, to).write(sequence, STROBE, &mut mpdu),
            (Sent::WakeUp { rendezvous }, _) => {
                let frame =
                    WakeUpFrame { pan: self.pan, to: peer, rendezvous: rendezvous_units(rendezvous, self.phy()) };
                frame.write(&mut mpdu);
            }
            (Sent::Acknowledgement, _) if self.settings.form == Form::Csl => match self.is_always_on(station) {
                true => write_plain_ack(sequence, &mut mpdu),
                false => self.csl_acknowledgement(station, sequence, peer).write(&mut mpdu),
            },
            _ => Frame::acknowledgement(sequence).write(&mut mpdu).expect("an acknowledgement has five octets"),
        }
        self.frame.octets = mpdu;
    }

    /// The acknowledgement of a station with CSL, which ends now: it tells when the station listens next.
    fn csl_acknowledgement(&self, station: StationId, sequence: u8, to: Option<StationId>) -> CslAck {
        let stack = &self.stacks[station.index()];
        let period = rendezvous_units(self.settings.interval, self.phy());
        CslAck { sequence, pan: self.pan, to, phase: self.csl_phase(stack), period }
    }

    /// The time from the first symbol of the last acknowledgement of a station to when its receiver is on next, as it tells it.
    pub(super) fn csl_phase(&self, stack: &Stack) -> u16 {
        let listens = stack.checks.start_of(stack.checks.next_from(stack.answer_start)) + self.phy().turnaround();
        rendezvous_units(listens.saturating_since(stack.answer_start), self.phy())
    }
}
