//! Events of robots: they arrive, listen, acknowledge, send beacons, and get the next command.

use std::time::Duration;

use sextant_channel::{Contact, Position};
use sextant_kernel::{NodeId, RobotId, SimTime};
use sextant_mac::frame::Frame;
use sextant_mac::{RadioState, coordinator, csma, responder};

use super::Simulation;
use crate::FrameOutcome;
use crate::Observer;
use crate::event::{Event, RobotEvent};
use crate::node::Network;
use crate::pilot::Decision;

impl Simulation {
    /// Handles an event of a robot; returns whether the simulation continues.
    pub(super) fn handle_robot(&mut self, robot: usize, event: RobotEvent, observer: &mut impl Observer) -> bool {
        let now = self.network.now;
        match event {
            RobotEvent::Arrived => {
                let first = now == SimTime::ZERO;
                let decision = self.pilots[robot].arrive(now, &self.world.obstacles, first);
                observer.moved(robot, now, self.pilots[robot].position());
                self.act(robot, decision, observer);
            }
            RobotEvent::SlotEnded => self.pilots[robot].slot_is_over = true,
            RobotEvent::Responder(event) => self.handle_responder(robot, event, observer),
            RobotEvent::BeaconDue => self.prepare_beacon(),
            RobotEvent::Coordinator(event) => self.handle_coordinator(event, observer),
            RobotEvent::ActivePartEnded => {}
        }
        if self.pilots[robot].slot_is_over && self.may_leave(robot) {
            return self.end_slot(robot, observer);
        }
        true
    }

    fn handle_responder(&mut self, robot: usize, event: responder::Event, observer: &mut impl Observer) {
        if event == responder::Event::TransmissionEnded {
            let on_air = self.network.acknowledgements[robot].take();
            let (ack, sequence) = on_air.expect("only an acknowledgement on air ends");
            self.network.air.end(self.network.now, &ack, &mut self.arrivals);
            if observer.wants_frames() {
                Frame::acknowledgement(sequence).write(&mut self.mpdu).expect("an acknowledgement has five octets");
                self.tell_frame(&ack, self.best_at_nodes(), observer);
            }
            let (nodes, now) = (self.macs.len(), self.network.now);
            for arrival in std::mem::take(&mut self.arrivals) {
                if arrival.outcome == FrameOutcome::Received && arrival.station.index() < nodes {
                    let event = csma::Event::AckReceived { sequence };
                    let mac = &mut self.macs[arrival.station.index()];
                    if let Some(report) = mac.handle(now, event, &mut self.network.radio(arrival.station, false)) {
                        self.count(arrival.station, report);
                    }
                }
            }
        }
        let pilot = &mut self.pilots[robot];
        let mut radio = RobotRadio { network: &mut self.network, robot, place: pilot.position() };
        pilot.responder.handle(event, &mut radio);
    }

    fn end_slot(&mut self, robot: usize, observer: &mut impl Observer) -> bool {
        let now = self.network.now;
        let station = NodeId::from_index(self.macs.len() + robot);
        let pilot = &mut self.pilots[robot];
        self.network.air.deafen(station, pilot.position());
        let index = NodeId::from_index(self.stops.len()).0;
        let (stop, receptions, decision) = pilot.end_slot(now, &self.world.obstacles, index);
        observer.stopped(index, &stop, now, &receptions);
        self.stops.push(stop);
        for reception in &receptions {
            let known = &mut self.heard[reception.node.index()];
            self.nodes_heard += usize::from(!std::mem::replace(known, true));
        }
        self.receptions.extend(receptions);
        self.act(robot, decision, observer);
        observer.goes_on(self.progress())
    }

    fn act(&mut self, robot: usize, decision: Decision, observer: &mut impl Observer) {
        let now = self.network.now;
        match decision {
            Decision::Drive { span, contact } => {
                observer.moved(robot, now, self.pilots[robot].position());
                if let Some(position) = contact {
                    let contact = Contact { robot: RobotId::from_index(robot), time: now + span, position };
                    observer.met(contact);
                    self.contacts.push(contact);
                }
                self.network.after(span, Event::of_robot(robot, RobotEvent::Arrived));
            }
            Decision::Listen { span } => {
                let station = NodeId::from_index(self.macs.len() + robot);
                self.network.air.listen(now, station, self.pilots[robot].position());
                self.network.after(span, Event::of_robot(robot, RobotEvent::SlotEnded));
            }
            Decision::Finish => {}
        }
    }
}

/// The radio of a robot, as its machines see it.
pub(super) struct RobotRadio<'a> {
    pub(super) network: &'a mut Network,
    pub(super) robot: usize,
    pub(super) place: Position,
}

impl RobotRadio<'_> {
    fn station(&self) -> NodeId {
        NodeId::from_index(self.network.nodes.len() + self.robot)
    }

    /// The robot hears while its radio receives, and is deaf otherwise.
    fn change_to(&mut self, state: RadioState) {
        let (now, station) = (self.network.now, self.station());
        if state == RadioState::Receive {
            self.network.air.listen(now, station, self.place);
        } else {
            self.network.air.deafen(station, self.place);
        }
    }
}

impl responder::Radio for RobotRadio<'_> {
    fn after(&mut self, span: Duration, event: responder::Event) {
        self.network.after(span, Event::of_robot(self.robot, RobotEvent::Responder(event)));
    }

    fn enter(&mut self, state: RadioState) {
        self.change_to(state);
    }

    fn start_acknowledgement(&mut self, sequence: u8) {
        let (now, station, airtime) = (self.network.now, self.station(), self.network.phy.ack_airtime());
        let transmission = self.network.air.begin(now, station, self.place, airtime);
        self.network.acknowledgements[self.robot] = Some((transmission, sequence));
        let event = RobotEvent::Responder(responder::Event::TransmissionEnded);
        self.network.after(airtime, Event::of_robot(self.robot, event));
    }
}

impl coordinator::Radio for RobotRadio<'_> {
    fn after(&mut self, span: Duration, event: coordinator::Event) {
        self.network.after(span, Event::of_robot(self.robot, RobotEvent::Coordinator(event)));
    }

    fn enter(&mut self, state: RadioState) {
        self.change_to(state);
    }

    fn start_beacon(&mut self, mpdu_octets: u8) {
        let (now, station, airtime) = (self.network.now, self.station(), self.network.phy.airtime(mpdu_octets));
        self.network.beacon = Some(self.network.air.begin(now, station, self.place, airtime));
        let event = RobotEvent::Coordinator(coordinator::Event::TransmissionEnded);
        self.network.after(airtime, Event::of_robot(self.robot, event));
    }
}
