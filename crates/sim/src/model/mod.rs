//! What the commands of applications act on.

mod charge;
mod driving;
mod following;
pub(crate) mod log;
mod moving;
pub(crate) mod origins;
pub(crate) mod ranging;
mod vehicle;

use sextant_channel::{Contact, Position, Stop, StopLog};
use sextant_kernel::{NodeId, RobotId, StationId};

use crate::batteries::Bank;
use crate::halo::Halo;
use crate::link::Links;
use crate::observer::Observer;
use crate::scene::Scene;
use crate::sensing::Sensing;
use crate::service::estimate::Estimate;
use crate::service::network_id::NetworkId;
use crate::service::sensed::{FieldId, TargetId};
use crate::station::{Pose, StationKind};
use crate::world::World;
use crate::world::motion::NodeCourse;

pub(crate) use driving::Course;
pub(crate) use vehicle::Vehicle;

/// What the commands of applications act on: everything but the applications themselves.
pub(crate) struct Model {
    pub(crate) scene: Scene,
    pub(crate) networks: Vec<Links>,
    /// How ranges are measured in each network; `None` where they are not.
    pub(crate) rangings: Vec<Option<ranging::Ranging>>,
    pub(crate) world: World,
    pub(crate) vehicles: Vec<Vehicle>,
    pub(crate) sensing: Sensing,
    /// The ways of the nodes that move, by station.
    pub(crate) courses: Vec<(StationId, NodeCourse)>,
    /// The halos round the listeners; `None` if all nodes are simulated all the time.
    pub(crate) halo: Option<Halo>,
    /// The batteries of the nodes, if they have any.
    pub(crate) batteries: Option<Bank>,
    /// Which packets over several hops count.
    pub(crate) origins: origins::Origins,
    /// What the observer will see.
    pub(crate) notes: Vec<Note>,
    /// Which stations have a task that they have not finished.
    pub(crate) has_task: Vec<bool>,
    /// Number of these stations.
    pub(crate) unfinished: usize,
}

/// What the observer will see.
#[derive(Clone, Debug)]
pub(crate) enum Note {
    /// A robot that stands or drives straight is at a place now.
    Moved(RobotId, Position),
    /// A robot on an arc has this pose now.
    Curved(RobotId, Pose),
    /// A robot whose odometry has errors believes to have this pose now.
    Believed(RobotId, Pose),
    /// A robot meets an obstacle.
    Met(Contact),
    /// A robot has listened.
    Stopped(NetworkId, Stop, StopLog),
    /// A source of a field was removed.
    SourceRemoved(FieldId, usize),
    /// A robot captured a target.
    Captured(RobotId, TargetId),
    /// A target is gone, from this place.
    TargetGone(TargetId, Position),
    /// The battery of a node is empty.
    Depleted(NodeId),
    /// A station has worked out something.
    Estimated(StationId, Estimate),
    /// A packet over several hops begins at a station, with this number.
    Originated(StationId, u16),
}

impl Model {
    /// The number of the robot that is a station.
    ///
    /// # Panics
    /// If the station is no robot.
    pub(crate) fn robot(&self, station: StationId) -> RobotId {
        match self.scene.roll.kind(station) {
            StationKind::Robot(robot) => RobotId::from_index(robot),
            StationKind::Node(_) | StationKind::Sink(_) => panic!("{station} is no robot: it cannot drive"),
        }
    }

    /// Shows the observer the packets that have ended.
    pub(crate) fn tell_packets(&mut self, observer: &mut impl Observer) {
        self.scene.traced.drain(..).for_each(|packet| observer.traced(&packet));
    }

    /// Shows the observer what happened, and keeps what belongs into the log. Returns whether a stop was among
    /// it.
    pub(crate) fn tell(&mut self, logs: &mut log::Logs, observer: &mut impl Observer) -> bool {
        let now = self.scene.now;
        let mut stopped = false;
        for note in self.notes.drain(..) {
            match note {
                Note::Moved(robot, place) => observer.moved(robot.index(), now, place),
                Note::Curved(robot, pose) => observer.curved(robot.index(), now, pose),
                Note::Believed(robot, pose) => observer.believed(robot.index(), now, pose),
                Note::Met(contact) => {
                    observer.met(contact);
                    logs.contacts.push(contact);
                }
                Note::SourceRemoved(field, source) => observer.source_removed(field, source, now),
                Note::Captured(robot, target) => observer.captured(robot.index(), target, now),
                Note::TargetGone(target, place) => {
                    observer.target_moved(target, now, place);
                    observer.target_gone(target, now);
                }
                Note::Depleted(node) => observer.depleted(node, now),
                Note::Estimated(station, estimate) => observer.estimated(station, now, &estimate),
                Note::Originated(station, number) => observer.originated(station, number, now),
                Note::Stopped(network, stop, heard) => {
                    stopped = true;
                    logs.stop(network, stop, heard, |index, stop, heard| {
                        observer.stopped(network, index, stop, now, heard);
                    });
                }
            }
        }
        stopped
    }
}
