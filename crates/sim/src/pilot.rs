//! Robots on their survey: they drive, stop, listen for a slot, and continue.

use std::time::Duration;

use sextant_channel::{Milliwatts, ObstacleField, Position, Reception, Stop};
use sextant_kernel::{NodeId, RobotId, SimTime};
use sextant_mac::responder::Responder;

use crate::survey::RobotRecord;
use crate::{CommandOutcome, Ending, Heard, Robot, RobotCommand, Situation};

/// Gap between the hull of a blocked robot and the obstacle (m).
const HALT_M: f64 = 1e-3;

/// Largest number of commands in a row that take no time; a controller that gives more is stuck.
const IDLE_COMMANDS: u32 = 1000;

/// Current activity of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Activity {
    Driving { to: Position, blocked_at: Option<Position> },
    Listening { since: SimTime },
    Finished,
}

/// The decision of a robot: what it does next, and until when.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Decision {
    /// It drives; `contact` is the point of contact if an obstacle is ahead.
    Drive { span: Duration, contact: Option<Position> },
    /// It listens.
    Listen { span: Duration },
    /// It has finished.
    Finish,
}

/// A robot on its survey.
pub(crate) struct Pilot {
    id: RobotId,
    robot: Robot,
    position: Position,
    activity: Activity,
    pub(crate) responder: Responder,
    pub(crate) slot_is_over: bool,
    tally: Tally,
    stops: usize,
    path_length_m: f64,
    ending: Option<(Ending, SimTime)>,
}

/// Packets heard in a slot, by node.
struct Tally {
    slot: Vec<Slot>,
    heard: Vec<NodeId>,
    /// Number of packets of all earlier slots.
    total: Vec<u32>,
}

/// Packets heard of one node in a slot.
#[derive(Clone, Copy, Debug, Default)]
struct Slot {
    packets: u32,
    /// Packets that the node sent from the first to the last one heard, by their sequence numbers.
    sent: u32,
    rssi_sum_dbm: f64,
    last_sequence: u8,
}

impl Pilot {
    pub(crate) fn new(id: RobotId, robot: Robot, responder: Responder, nodes: usize) -> Self {
        let position = robot.body.start;
        Self {
            id,
            robot,
            position,
            activity: Activity::Driving { to: position, blocked_at: None },
            responder,
            slot_is_over: false,
            tally: Tally { slot: vec![Slot::default(); nodes], heard: Vec::new(), total: vec![0; nodes] },
            stops: 0,
            path_length_m: 0.0,
            ending: None,
        }
    }

    pub(crate) fn position(&self) -> Position {
        self.position
    }

    /// Whether it stands and listens.
    pub(crate) fn is_listening(&self) -> bool {
        matches!(self.activity, Activity::Listening { .. })
    }

    pub(crate) fn is_finished(&self) -> bool {
        self.activity == Activity::Finished
    }

    /// Counts the packet `sequence` of `node`, which was received in this slot.
    pub(crate) fn note(&mut self, node: NodeId, sequence: u8, power: Milliwatts) {
        let slot = &mut self.tally.slot[node.index()];
        if slot.packets == 0 {
            self.tally.heard.push(node);
            slot.sent = 1;
        } else {
            // Sequence numbers are modulo 256: a gap of 256 packets or more looks shorter.
            slot.sent += u32::from(sequence.wrapping_sub(slot.last_sequence)).max(1);
        }
        slot.packets += 1;
        slot.rssi_sum_dbm += power.to_dbm().0;
        slot.last_sequence = sequence;
    }

    /// The drive is over: the robot is at its destination, or in front of an obstacle.
    pub(crate) fn arrive(&mut self, now: SimTime, obstacles: &ObstacleField, first: bool) -> Decision {
        let Activity::Driving { to, blocked_at } = self.activity else {
            unreachable!("a robot arrives only from a drive");
        };
        self.path_length_m += self.position.distance_m(to);
        self.position = to;
        let outcome = match blocked_at {
            Some(place) => CommandOutcome::Blocked(place),
            None if first => CommandOutcome::Started,
            None => CommandOutcome::Arrived,
        };
        self.decide(now, outcome, obstacles)
    }

    /// The slot is over: the stop, what was heard, and the next decision.
    pub(crate) fn end_slot(
        &mut self,
        now: SimTime,
        obstacles: &ObstacleField,
        index: u32,
    ) -> (Stop, Vec<Reception>, Decision) {
        let Activity::Listening { since } = self.activity else {
            unreachable!("a slot ends only while the robot listens");
        };
        self.slot_is_over = false;
        self.stops += 1;
        let heard = self.tally.take();
        let stop = Stop { robot: self.id, time: since, position: self.position };
        let reception = |heard: &Heard| Reception {
            node: heard.node,
            stop: index,
            received: heard.packets,
            sent: heard.sent,
            sector: None,
            rssi_dbm: Some(heard.rssi_dbm),
        };
        let receptions = heard.iter().map(reception).collect();
        let decision = self.decide(now, CommandOutcome::Listened(&heard), obstacles);
        (stop, receptions, decision)
    }

    fn decide(&mut self, now: SimTime, outcome: CommandOutcome<'_>, obstacles: &ObstacleField) -> Decision {
        let mut outcome = outcome;
        let node_count = self.tally.slot.len();
        for _ in 0..IDLE_COMMANDS {
            let radius_m = self.robot.body.radius_m;
            let situation = Situation::new(now, self.position, outcome, node_count, obstacles, radius_m);
            match self.robot.controller.decide(&situation) {
                RobotCommand::Drive(to) => {
                    let (to, contact) = self.way(to, obstacles);
                    let length_m = self.position.distance_m(to);
                    if length_m > 0.0 {
                        self.activity = Activity::Driving { to, blocked_at: contact };
                        let span = Duration::from_secs_f64(length_m / self.robot.body.speed_m_per_s);
                        return Decision::Drive { span, contact };
                    }
                    outcome = contact.map_or(CommandOutcome::Arrived, CommandOutcome::Blocked);
                }
                RobotCommand::Listen => {
                    self.activity = Activity::Listening { since: now };
                    return Decision::Listen { span: self.robot.body.listen };
                }
                RobotCommand::Finish(ending) => return self.finish(now, ending),
            }
        }
        self.finish(now, Ending::Stuck)
    }

    fn finish(&mut self, now: SimTime, ending: Ending) -> Decision {
        self.activity = Activity::Finished;
        self.ending = Some((ending, now));
        Decision::Finish
    }

    /// The place that the robot reaches on the way to `to`, and the point of contact on the obstacle there, if any.
    fn way(&self, to: Position, obstacles: &ObstacleField) -> (Position, Option<Position>) {
        let length_m = self.position.distance_m(to);
        if length_m <= 0.0 {
            return (self.position, None);
        }
        let direction = (to - self.position) * (1.0 / length_m);
        let radius_m = self.robot.body.radius_m;
        let clear_m = obstacles.clearance_m(self.position, direction, length_m, radius_m);
        if clear_m >= length_m {
            return (to, None);
        }
        let halt = self.position + direction * (clear_m - HALT_M).max(0.0);
        (halt, Some(self.position + direction * (clear_m + radius_m)))
    }

    pub(crate) fn into_record(self) -> RobotRecord {
        RobotRecord {
            name: self.robot.body.name,
            stops: self.stops,
            path_length_m: self.path_length_m,
            ending: self.ending.map(|(ending, _)| ending),
            end: self.ending.map(|(_, end)| end),
            packets: self.tally.total,
        }
    }
}

impl Tally {
    /// Returns what was heard, by node, and empties the tally.
    fn take(&mut self) -> Vec<Heard> {
        self.heard.sort_unstable();
        let heard = self.heard.drain(..).map(|node| {
            let Slot { packets, sent, rssi_sum_dbm, .. } = std::mem::take(&mut self.slot[node.index()]);
            self.total[node.index()] += packets;
            Heard { node, packets, sent, rssi_dbm: rssi_sum_dbm / f64::from(packets) }
        });
        heard.collect()
    }
}
