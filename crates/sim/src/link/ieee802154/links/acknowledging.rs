//! Acknowledgements, and when a station may stop listening.

use std::time::Duration;

use sextant_kernel::{SimTime, StationId};
use sextant_mac::frame::Frame;
use sextant_mac::{csma, responder};

use super::Links;
use crate::air::Asked;
use crate::link::ieee802154::transceiver::Transceiver;
use crate::link::links::{Cut, NetworkLinks};
use crate::observer::Observer;
use crate::scene::Scene;
use crate::service::outcome::FrameOutcome;

impl Links {
    /// Handles an event of an acknowledgement that `station` sends.
    pub(super) fn handle_responder(
        &mut self,
        station: StationId,
        event: responder::Event,
        scene: &mut Scene,
        observer: &mut impl Observer,
    ) {
        if event == responder::Event::TransmissionEnded {
            self.end_acknowledgement(station, scene, observer);
        }
        let stack = &mut self.stacks[station.index()];
        let mut radio = Transceiver { radios: &self.radios, stack, scene, station, awaits_ack: false };
        self.responders[station.index()].handle(event, &mut radio);
    }

    /// An acknowledgement ends: the stations that received it look whether they wait for it.
    fn end_acknowledgement(&mut self, station: StationId, scene: &mut Scene, observer: &mut impl Observer) {
        let on_air = self.stacks[station.index()].acknowledgement.take();
        let (transmission, sequence) = on_air.expect("only an acknowledgement on air ends");
        let Self { macs, arrivals, .. } = self;
        let awaits = |station: StationId| macs[station.index()].awaits_acknowledgement();
        let asked = if observer.wants_frames() { Asked::All } else { Asked::WhoReceives(&awaits) };
        scene.airs[self.radios.air].end_asking(scene.now, &transmission, asked, arrivals);
        if observer.wants_frames() {
            Frame::acknowledgement(sequence)
                .write(&mut self.frame.octets)
                .expect("an acknowledgement has five octets");
            let answered = self.stacks[station.index()].answered;
            // Nodes that wait for a robot's answer all look at it, because it has no address: the best outcome counts.
            self.catch_up(Cut::now(scene), scene);
            let is_to_node = answered.is_some_and(|to| scene.roll.is_node(to));
            let fate = if is_to_node && !scene.roll.is_node(station) {
                self.fate_at_nodes(&transmission, scene)
            } else {
                self.fate(&transmission, scene, |station| Some(station) == answered)
            };
            self.tell_frame(&transmission, fate, scene, observer);
        }
        let now = scene.now;
        for i in 0..self.arrivals.len() {
            let arrival = self.arrivals[i];
            let listener = arrival.station;
            if arrival.outcome != FrameOutcome::Received || !self.macs[listener.index()].is_transmitter() {
                continue;
            }
            let event = csma::Event::AckReceived { sequence };
            let stack = &mut self.stacks[listener.index()];
            let mut radio = Transceiver { radios: &self.radios, stack, scene, station: listener, awaits_ack: false };
            let report = self.macs[listener.index()].handle(now, event, &mut radio);
            self.look_ahead(listener, scene);
            if let Some(report) = report {
                self.end_access(listener, report, scene);
            }
        }
    }

    /// Whether a station that has listened long enough may stop: no acknowledgement, beacon or superframe is under
    /// way.
    pub(super) fn may_leave(&self, station: StationId, now: SimTime) -> bool {
        let superframe_is_over = match &self.coordinator {
            Some((coordinator, machine)) if *coordinator == station => {
                !machine.is_sending() && machine.active_end().is_none_or(|end| end <= now)
            }
            _ => true,
        };
        superframe_is_over && !self.responders[station.index()].is_responding()
    }

    /// Time from a frame that ends now at `station` to its acknowledgement.
    pub(super) fn ack_gap(&self, station: StationId, now: SimTime) -> Duration {
        match &self.coordinator {
            Some((coordinator, machine)) if *coordinator == station => machine.ack_gap(now),
            _ => self.radios.phy().turnaround(),
        }
    }
}
