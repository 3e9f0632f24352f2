//! What the commands of applications act on.

pub(crate) mod log;

use sextant_channel::{Contact, Position, Reception, Stop};
use sextant_kernel::{RobotId, StationId};

use crate::event::Event;
use crate::link::network::Network;
use crate::observer::Observer;
use crate::scene::Scene;
use crate::sensing::Sensing;
use crate::service::sensed::FieldId;
use crate::station::{Kind, Motion, RobotBody, Trip};
use crate::world::World;

/// What the commands of applications act on: everything but the applications themselves.
pub(crate) struct Model {
    pub(crate) scene: Scene,
    pub(crate) networks: Vec<Network>,
    pub(crate) world: World,
    pub(crate) vehicles: Vec<Vehicle>,
    pub(crate) sensing: Sensing,
    /// What is to be told to the observer.
    pub(crate) notes: Vec<Note>,
    /// Which stations have a task that they have not finished.
    pub(crate) has_task: Vec<bool>,
    /// Number of these stations.
    pub(crate) unfinished: usize,
}

/// A robot as it drives.
pub(crate) struct Vehicle {
    pub(crate) body: RobotBody,
    /// The point of contact at the end of the drive, if an obstacle ends it.
    pub(crate) contact: Option<Position>,
    pub(crate) path_length_m: f64,
}

/// What is to be told to the observer.
#[derive(Clone, Debug)]
pub(crate) enum Note {
    /// A robot is at a place now.
    Moved(RobotId, Position),
    /// A robot will meet an obstacle.
    Met(Contact),
    /// A robot has listened.
    Stopped(Stop, Vec<Reception>),
    /// A source of a field was removed.
    SourceRemoved(FieldId, usize),
}

impl Model {
    /// The number of the robot that is a station.
    ///
    /// # Panics
    /// If the station is no robot.
    pub(crate) fn robot(&self, station: StationId) -> RobotId {
        match self.scene.roll.kind(station) {
            Kind::Robot(robot) => RobotId::from_index(robot),
            Kind::Node(_) | Kind::Sink(_) => panic!("{station} is no robot: it cannot drive"),
        }
    }

    /// The robot goes on a trip; `contact` is where it will meet an obstacle at its end.
    pub(crate) fn depart(&mut self, station: StationId, trip: Trip, contact: Option<Position>) {
        let robot = self.robot(station);
        let now = self.scene.now;
        self.vehicles[robot.index()].contact = contact;
        self.move_as(station, Motion::Driving(trip));
        self.notes.push(Note::Moved(robot, trip.from.position));
        if let Some(position) = contact {
            self.notes.push(Note::Met(Contact { robot, time: trip.end, position }));
        }
        self.scene.after(trip.end - now, Event::DriveEnded(station));
    }

    /// The robot is at the end of its trip. Returns the point of contact, if an obstacle ended it.
    pub(crate) fn arrive(&mut self, station: StationId) -> Option<Position> {
        let robot = self.robot(station);
        let Motion::Driving(trip) = self.scene.motions[station.index()] else {
            unreachable!("a robot arrives only from a drive");
        };
        self.vehicles[robot.index()].path_length_m += trip.length_m;
        self.move_as(station, Motion::Standing(trip.to));
        self.notes.push(Note::Moved(robot, trip.to.position));
        self.vehicles[robot.index()].contact.take()
    }

    fn move_as(&mut self, station: StationId, motion: Motion) {
        self.scene.motions[station.index()] = motion;
        for network in &self.networks {
            network.moves(station, &mut self.scene);
        }
    }

    /// Tells the observer what is to be told, and keeps what belongs into the log. Returns whether a stop was among
    /// it.
    pub(crate) fn tell(&mut self, log: &mut log::Log, observer: &mut impl Observer) -> bool {
        let now = self.scene.now;
        let mut stopped = false;
        for note in self.notes.drain(..) {
            match note {
                Note::Moved(robot, place) => observer.moved(robot.index(), now, place),
                Note::Met(contact) => {
                    observer.met(contact);
                    log.contacts.push(contact);
                }
                Note::SourceRemoved(field, source) => observer.source_removed(field, source, now),
                Note::Stopped(stop, receptions) => {
                    stopped = true;
                    log.stop(stop, receptions, |index, stop, receptions| {
                        observer.stopped(index, stop, now, receptions)
                    });
                }
            }
        }
        stopped
    }
}
