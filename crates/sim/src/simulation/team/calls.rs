//! What an observer would have been told, kept until all parts of a simulation are over.

use sextant_channel::{Contact, HeardAtStop, Position, Stop, StopLog};
use sextant_kernel::SimTime;

use super::course::Course;
use crate::model::log::Logs;
use crate::observer::Observer;
use crate::service::network_id::NetworkId;
use crate::station::Pose;

/// What the robots of a group did, in its order.
#[derive(Default)]
pub(super) struct Calls {
    calls: Vec<Said>,
    now: SimTime,
}

/// What a robot did at a time.
struct Said {
    time: SimTime,
    robot: usize,
    call: Call,
}

/// A call of an observer.
enum Call {
    Moved(Position),
    Curved(Pose),
    Believed(Pose),
    Met(Contact),
    Stopped(NetworkId, Stop, StopLog),
}

impl Calls {
    fn add(&mut self, time: SimTime, robot: usize, call: Call) {
        self.now = time;
        self.calls.push(Said { time, robot, call });
    }

    /// The course of a robot.
    pub(super) fn course(&self, robot: usize) -> Course {
        let of_robot = self.calls.iter().filter(|said| said.robot == robot);
        of_robot
            .filter_map(|said| match said.call {
                Call::Moved(place) => Some((said.time, place)),
                Call::Curved(pose) => Some((said.time, pose.position)),
                Call::Stopped(..) | Call::Believed(_) | Call::Met(_) => None,
            })
            .collect()
    }
}

impl Observer for Calls {
    fn moved(&mut self, robot: usize, time: SimTime, position: Position) {
        self.add(time, robot, Call::Moved(position));
    }

    fn curved(&mut self, robot: usize, time: SimTime, pose: Pose) {
        self.add(time, robot, Call::Curved(pose));
    }

    fn believed(&mut self, robot: usize, time: SimTime, pose: Pose) {
        self.add(time, robot, Call::Believed(pose));
    }

    fn met(&mut self, contact: Contact) {
        // The contact comes at the end of a drive that begins now.
        self.add(self.now, contact.robot.index(), Call::Met(contact));
    }

    fn stopped(&mut self, network: NetworkId, _index: u32, stop: &Stop, end: SimTime, heard: HeardAtStop<'_>) {
        self.add(end, stop.robot.index(), Call::Stopped(network, *stop, heard.into()));
    }
}

/// Tells `observer` the calls of all groups in the order of time, and at one instant by robot: as one simulation would.
/// Writes the stops and contacts into `logs`.
pub(super) fn replay(groups: Vec<Calls>, logs: &mut Logs, observer: &mut dyn Observer) {
    let mut groups: Vec<_> = groups.into_iter().map(|group| group.calls.into_iter().peekable()).collect();
    loop {
        let heads = groups.iter_mut().enumerate();
        let heads = heads.filter_map(|(i, group)| group.peek().map(|said| ((said.time, said.robot), i)));
        let Some((_, first)) = heads.min() else { return };
        let Some(Said { time, robot, call }) = groups[first].next() else { return };
        match call {
            Call::Moved(position) => observer.moved(robot, time, position),
            Call::Curved(pose) => observer.curved(robot, time, pose),
            Call::Believed(pose) => observer.believed(robot, time, pose),
            Call::Met(contact) => {
                observer.met(contact);
                logs.contacts.push(contact);
            }
            Call::Stopped(network, stop, heard) => {
                logs.stop(network, stop, heard, |index, stop, heard| {
                    observer.stopped(network, index, stop, time, heard);
                });
            }
        }
    }
}
