//! Frames and acknowledgements that go on air.

use sextant_kernel::StationId;
use sextant_mac::frame::Frame;

use super::Links;
use crate::air::{Aim, Emission, Transmission};
use crate::event::link::LinkEvent;
use crate::event::programmed::Event;
use crate::link::fate::Fate;
use crate::link::frame_buffer::FrameEnd;
use crate::link::ieee802154::header;
use crate::link::programmed::packet::Outgoing;
use crate::link::programmed::stack::{Kind, OnAir};
use crate::observer::Observer;
use crate::scene::Scene;
use crate::service::report::Destination;

/// Size of an acknowledgement (octets).
const ACKNOWLEDGEMENT_OCTETS: u8 = 5;

impl Links {
    /// The frame of a station goes on air.
    pub(super) fn begin_frame(&mut self, station: StationId, scene: &mut Scene) {
        let outgoing = self.stacks[station.index()].outgoing.expect("a frame is due");
        let to = match outgoing.to {
            Destination::Station(to) => Some(to),
            Destination::All => None,
        };
        let octets = header(self.pan, station, outgoing.to).overhead_octets() + self.payload_octets(&outgoing);
        self.begin(station, to, octets, Kind::Frame, scene);
        let stack = &mut self.stacks[station.index()];
        (stack.sent_from, stack.sent_packet) = (scene.now, outgoing.packet);
    }

    /// The acknowledgement of a station goes on air.
    pub(super) fn begin_acknowledgement(&mut self, station: StationId, scene: &mut Scene) {
        let (to, sequence) = self.stacks[station.index()].answered.expect("it acknowledges a frame");
        self.begin(station, Some(to), ACKNOWLEDGEMENT_OCTETS, Kind::Acknowledgement { sequence, to }, scene);
    }

    fn begin(&mut self, station: StationId, to: Option<StationId>, octets: u8, kind: Kind, scene: &mut Scene) {
        let (now, place, phy) = (scene.now, scene.place(station), self.phy());
        let stack = &mut self.stacks[station.index()];
        let radios = &self.radios[stack.channel];
        let emission = Emission { power: stack.power, aim: Aim::Omnidirectional };
        let to = to.map(|to| radios.receiver(to));
        let airtime = phy.airtime(octets);
        let transmission = scene.airs[radios.air].begin(now, radios.interface(station), to, place, emission, airtime);
        stack.on_air = Some(OnAir { transmission, kind, power: stack.power });
        let delimited = LinkEvent::Programmed(Event::Delimited);
        radios.after(phy.synchronisation_header(), station, delimited, scene);
    }

    /// What a station has on air ends.
    pub(super) fn end_on_air(&mut self, station: StationId, scene: &mut Scene, observer: &mut impl Observer) {
        let stack = &mut self.stacks[station.index()];
        stack.meter_until(scene.now);
        let OnAir { transmission, kind, .. } = stack.on_air.take().expect("only what is on air ends");
        scene.airs[self.radios[stack.channel].air].end(scene.now, &transmission, &mut self.arrivals);
        match kind {
            Kind::Frame => self.end_frame(station, &transmission, scene, observer),
            Kind::Acknowledgement { sequence, to } => {
                self.frame.payload = 0..0;
                if observer.wants_frames() {
                    Frame::acknowledgement(sequence)
                        .write(&mut self.frame.octets)
                        .expect("an acknowledgement has five octets");
                    let fate = self.fate(station, &transmission, Destination::Station(to), scene);
                    self.tell_frame(&transmission, fate, scene, observer);
                }
                self.receive_acknowledgement(&transmission, sequence, scene);
            }
        }
    }

    fn end_frame(
        &mut self,
        station: StationId,
        transmission: &Transmission,
        scene: &mut Scene,
        observer: &mut impl Observer,
    ) {
        let outgoing = self.stacks[station.index()].outgoing.take().expect("a frame is under way");
        let fate = self.fate(station, transmission, outgoing.to, scene);
        if let Some(packet) = outgoing.packet {
            self.end_transmission(station, packet, transmission, fate, scene);
        }
        self.write_frame(station, &outgoing);
        if observer.wants_frames() {
            self.tell_frame(transmission, fate, scene, observer);
        }
        self.receive_frame(station, &outgoing, transmission, scene);
        self.payloads.free(outgoing.payload);
    }

    fn fate(&self, station: StationId, transmission: &Transmission, to: Destination, scene: &Scene) -> Fate {
        let air = &scene.airs[self.radios[self.stacks[station.index()].channel].air];
        Fate::of(transmission, &self.arrivals, air, |station| match to {
            Destination::Station(to) => to == station,
            Destination::All => true,
        })
    }

    fn payload_octets(&self, outgoing: &Outgoing) -> u8 {
        u8::try_from(self.payloads.octets(outgoing.payload).len()).expect("sizes of frames were checked")
    }

    /// Writes a frame into the buffer of the network.
    fn write_frame(&mut self, station: StationId, outgoing: &Outgoing) {
        let header = match outgoing.acknowledged {
            true => header(self.pan, station, outgoing.to),
            false => header(self.pan, station, outgoing.to).without_acknowledgement(),
        };
        let payload = self.payloads.octets(outgoing.payload);
        header.write(outgoing.sequence, payload, &mut self.frame.octets);
        let end = self.frame.octets.len() - 2;
        self.frame.payload = end - payload.len()..end;
    }

    /// Tells the observer of the frame in the buffer, which ends now, with its fate.
    fn tell_frame(&mut self, transmission: &Transmission, fate: Fate, scene: &Scene, observer: &mut impl Observer) {
        let (network, channel) = (self.radios[0].network, Some(self.channel_of(transmission.source())));
        let end = FrameEnd { network, channel, transmission, fate, arrivals: &self.arrivals };
        self.frame.tell(end, scene, observer);
    }
}
