//! The events of a simulation in a recording.

use sextant_channel::{Contact, HeardAtStop, Position, Stop};
use sextant_kernel::{NodeId, SimTime, StationId};
use sextant_recording::{Level, Sensation, messages};
use sextant_sim::{FieldId, FrameOnAir, NetworkId, Observer, PacketTrace, Pose, Progress, Sensed, TargetId};

use super::{RunRecorder, packets};

impl RunRecorder {
    /// Records that a robot is at a place, with its heading, and how it came there.
    fn record_place(&mut self, robot: usize, time: SimTime, position: Position) {
        self.record(time, |recorder, simulation, time| {
            let track = &mut simulation.robots[robot];
            let is_new = track.push(position);
            recorder.robot(time, &track.name, position, track.heading_rad)?;
            if is_new { track.draw_leg(time, simulation.application.as_deref(), recorder) } else { Ok(()) }
        });
    }
}

impl Observer for RunRecorder {
    fn moved(&mut self, robot: usize, time: SimTime, position: Position) {
        let track = &mut self.simulation.robots[robot];
        if let Some(&last) = track.places.last()
            && last != position
        {
            track.heading_rad = libm::atan2(position.y_m - last.y_m, position.x_m - last.x_m);
        }
        self.record_place(robot, time, position);
    }

    fn curved(&mut self, robot: usize, time: SimTime, pose: Pose) {
        self.simulation.robots[robot].heading_rad = pose.heading_rad;
        self.record_place(robot, time, pose.position);
    }

    fn believed(&mut self, robot: usize, time: SimTime, pose: Pose) {
        self.record(time, |recorder, simulation, time| {
            recorder.odometry(time, &simulation.robots[robot].name, pose.position, pose.heading_rad)
        });
    }

    fn met(&mut self, contact: Contact) {
        // What a robot meets in a mission is not knowledge of the survey.
        if self.simulation.application.is_none() {
            self.record(contact.time, |recorder, simulation, _| {
                recorder.contact(&simulation.robots[contact.robot.index()].name, &contact)
            });
        }
    }

    fn stopped(&mut self, network: NetworkId, index: u32, stop: &Stop, end: SimTime, heard: HeardAtStop<'_>) {
        // Nor are its stops.
        if self.simulation.application.is_some() {
            return;
        }
        self.record(stop.time, |recorder, simulation, _| {
            let other = simulation.others.iter().find(|(other, _)| *other == network);
            let robot = &simulation.robots[stop.robot.index()].name;
            let nodes = heard.receptions.iter().filter(|reception| reception.received > 0);
            let nodes: Vec<Position> = nodes.map(|reception| simulation.nodes[reception.node.index()]).collect();
            recorder.listening(other.map(|(_, name)| name.as_str()), robot, stop, end, &nodes)?;
            recorder.stop(other.map(|(_, name)| name.as_str()), robot, index, stop, heard)
        });
    }

    fn captured(&mut self, robot: usize, target: TargetId, time: SimTime) {
        self.record(time, |recorder, simulation, time| {
            let (robot, target) = (&simulation.robots[robot].name, &simulation.targets[target.index()]);
            recorder.note(time, Level::Info, "capture", &format!("{robot} captured {target}"))
        });
    }

    fn target_moved(&mut self, target: TargetId, time: SimTime, position: Position) {
        self.record(time, |recorder, simulation, time| {
            recorder.target(time, &simulation.targets[target.index()], position)
        });
    }

    fn sensed(&mut self, node: NodeId, time: SimTime, sensed: &Sensed) {
        self.record(time, |recorder, simulation, time| {
            let target = |target: TargetId| simulation.targets[target.index()].as_str();
            let (sensation, name) = match *sensed {
                Sensed::Entered(entered) => (Sensation::Entered, target(entered)),
                Sensed::Left(left) => (Sensation::Left, target(left)),
                Sensed::Sampled { field, value } => {
                    (Sensation::Sampled(value), simulation.fields[field.index()].name())
                }
            };
            recorder.sensed(time, node, name, sensation)
        });
    }

    fn depleted(&mut self, node: NodeId, time: SimTime) {
        self.record(time, |recorder, simulation, time| {
            recorder.note(time, Level::Warning, &simulation.battery_names[node.index()], "its battery is empty")
        });
    }

    fn source_removed(&mut self, field: FieldId, source: usize, time: SimTime) {
        self.simulation.fields[field.index()].remove(source, time);
        self.record(time, |recorder, simulation, time| {
            let name = simulation.fields[field.index()].name();
            recorder.note(time, Level::Info, name, &format!("source {source} was removed"))
        });
    }

    fn framed(&mut self, frame: FrameOnAir<'_>) {
        if !self.simulation.frames {
            return;
        }
        self.record(frame.start, |recorder, simulation, start| {
            let deafness = frame.outcome.deafness();
            simulation.draw_frame(&frame, recorder)?;
            recorder.frame(&messages::FrameMessage {
                start_ns: start.as_nanos(),
                airtime_ns: (SimTime::ZERO + frame.airtime).as_nanos(),
                source: frame.source.0,
                mpdu: frame.bytes.to_vec(),
                outcome: frame.outcome.name().to_owned(),
                power_dbm: frame.power.map(|power| power.0),
                network: simulation.network_names[frame.network.index()].clone(),
                deafness: deafness.map_or_else(String::new, |deafness| deafness.name().to_owned()),
            })
        });
    }

    fn wants_frames(&self) -> bool {
        self.simulation.frames
    }

    fn originated(&mut self, station: StationId, number: u16, time: SimTime) {
        if self.simulation.packets && self.simulation.has_hops {
            self.simulation.origins.insert((station, number), time + self.simulation.offset);
        }
    }

    fn traced(&mut self, packet: &PacketTrace) {
        if !self.simulation.packets {
            return;
        }
        let id = self.packets;
        self.packets += 1;
        self.record(packet.ended, |recorder, simulation, _| {
            let network = &simulation.network_names[packet.network.index()];
            packets::record(recorder, (id, simulation.nodes.len()), network, packet, simulation.offset)?;
            match simulation.has_hops {
                true => packets::record_hop(recorder, id, packet, &simulation.origins, simulation.offset),
                false => Ok(()),
            }
        });
    }

    fn wants_packets(&self) -> bool {
        self.simulation.packets
    }

    fn goes_on(&mut self, _progress: Progress) -> bool {
        self.failure.is_none()
    }
}
