//! The coordinator: it sends beacons while it stands and listens, and nodes follow the beacons.

use sextant_kernel::StationId;
use sextant_mac::coordinator;
use sextant_mac::device;
use sextant_mac::frame::{Frame, FrameBody};

use super::Links;
use crate::event::ieee802154::Event;
use crate::link::ieee802154::transceiver::{Beaconing, Transceiver};
use crate::observer::Observer;
use crate::scene::Scene;
use crate::service::outcome::FrameOutcome;

impl Links {
    /// A beacon is due one turnaround from now. The schedule of beacons never stops. The coordinator sends the beacons
    /// that are due while it listens, and opens no superframe after the end of its time at a stop.
    pub(super) fn prepare_beacon(&mut self, scene: &mut Scene) {
        let Some((station, coordinator)) = &mut self.coordinator else { return };
        let station = *station;
        let interval = coordinator.timing().beacon_interval();
        let is_free = !self.responders[station.index()].is_responding() && !coordinator.is_sending();
        let stack = &mut self.stacks[station.index()];
        let listens = stack.listening && !stack.leaving;
        let event = crate::event::link::LinkEvent::Ieee802154(Event::BeaconDue);
        self.radios.after(interval, station, event, scene);
        if listens && is_free {
            let transceiver = Transceiver { radios: &self.radios, stack, scene, station, awaits_ack: false };
            coordinator.prepare(&mut Beaconing { transceiver, beacon: &mut self.beacon });
        }
    }

    /// Handles an event of a beacon of the coordinator.
    pub(super) fn handle_coordinator(
        &mut self,
        station: StationId,
        event: coordinator::Event,
        scene: &mut Scene,
        observer: &mut impl Observer,
    ) {
        if event == coordinator::Event::TransmissionEnded {
            self.end_beacon(scene, observer);
        }
        let now = scene.now;
        let (_, coordinator) = self.coordinator.as_mut().expect("a coordinator has events");
        let stack = &mut self.stacks[station.index()];
        let transceiver = Transceiver { radios: &self.radios, stack, scene, station, awaits_ack: false };
        coordinator.handle(now, event, &mut Beaconing { transceiver, beacon: &mut self.beacon });
        if event == coordinator::Event::TransmitReady {
            let active = coordinator.timing().active();
            self.schedule(station, active, Event::ActivePartEnded, scene);
        }
    }

    /// A beacon ends: the nodes that received it follow it.
    fn end_beacon(&mut self, scene: &mut Scene, observer: &mut impl Observer) {
        let transmission = self.beacon.take().expect("only a beacon on air ends");
        scene.airs[self.radios.air].end(scene.now, &transmission, &mut self.arrivals);
        let (_, coordinator) = self.coordinator.as_ref().expect("a coordinator sends");
        coordinator.write_beacon(&mut self.frame.octets);
        if observer.wants_frames() {
            self.tell_frame(&transmission, self.fate_at_nodes(&transmission, scene), scene, observer);
        }
        let now = scene.now;
        let octets = u8::try_from(self.frame.octets.len()).expect("at most 127 octets");
        let frame = Frame::parse(&self.frame.octets).expect("stations write what they can read");
        let FrameBody::Beacon(beacon) = frame.body else { unreachable!("a coordinator writes beacons") };
        for arrival in self.arrivals.iter().filter(|arrival| arrival.outcome == FrameOutcome::Received) {
            let (station, listener) = (arrival.station, arrival.station.index());
            let stack = &mut self.stacks[listener];
            let mut radio = Transceiver { radios: &self.radios, stack, scene, station, awaits_ack: true };
            self.macs[listener].receive_beacon(now, octets, &beacon, &mut radio);
        }
    }

    /// Handles an event of a node that follows beacons.
    pub(super) fn handle_tracking(&mut self, station: StationId, event: device::Event, scene: &mut Scene) {
        let now = scene.now;
        let stack = &mut self.stacks[station.index()];
        let mut radio = Transceiver { radios: &self.radios, stack, scene, station, awaits_ack: true };
        self.macs[station.index()].track(now, event, &mut radio);
    }
}
