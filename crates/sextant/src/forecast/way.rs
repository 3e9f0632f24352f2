//! The ways of robots: driven once before the run.

use std::collections::BTreeMap;
use std::time::Duration;

use serde::Serialize;
use sextant_apps::ControllerConfig;
use sextant_channel::{ObstacleField, Position};
use sextant_kernel::{NodeId, SimTime};
use sextant_scenario::Scenario;
use sextant_sim::{CommandOutcome, HeardNode, Listening, Robot, RobotBody, RobotCommand, RobotTask, Situation};

use super::network::Reach;

/// Ways with more commands than these are not driven to the end.
const MOST_COMMANDS: usize = 40_000;

/// What follows for a robot that surveys.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WayForecast {
    /// Its name.
    pub robot: String,
    /// Whether its way depends on what it hears, so that all of this is an estimate.
    pub estimate: bool,
    /// Whether the way is longer than was looked at, so that all of this is of its first part.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub cut: bool,
    /// Length of its way (m).
    pub path_length_m: f64,
    /// Number of its stops.
    pub stops: usize,
    /// How long the survey takes (s).
    pub duration_s: f64,
    /// Packets that a node sends during a stop; absent if that is not known before the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub packets_offered: Option<f64>,
    /// Packets that it receives at a stop, of all nodes together, mean over the stops, if none are lost to others; absent
    /// if what is offered is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub packets_expected: Option<f64>,
    /// Nodes from which less than one of 100 packets is received at each stop.
    pub out_of_reach: Vec<usize>,
}

/// Whether the path of a robot is planned before the run.
pub(super) fn is_planned(scenario: &Scenario, robot: &Robot) -> bool {
    let config = scenario.config().robots.iter().find(|config| config.name == robot.body.name);
    config.and_then(|config| config.controller.as_ref()).is_some_and(ControllerConfig::is_planned)
}

/// A way of a robot.
pub(super) struct Way<'a> {
    body: &'a RobotBody,
    reaches: Vec<&'a Reach<'a>>,
    is_estimate: bool,
    is_cut: bool,
    stops: Vec<Position>,
    length_m: f64,
    duration_s: f64,
    /// Packets received, all nodes and stops together.
    expected: f64,
    /// Answers to sector sweeps, all nodes and stops together.
    answers: f64,
    /// The best probability of each node at any stop.
    best: BTreeMap<NodeId, f64>,
}

impl<'a> Way<'a> {
    /// The way of a robot that surveys networks of `reaches`; `None` for others. If its path is not `planned` before the
    /// start, it is an estimate.
    pub(super) fn driven(robot: &'a Robot, planned: bool, reaches: &'a [Reach<'a>]) -> Option<Self> {
        let RobotTask::Survey(controller) = &robot.task else { return None };
        let body = &robot.body;
        let reaches: Vec<_> = reaches.iter().filter(|reach| body.networks.contains(&reach.id)).collect();
        let is_estimate = !planned;
        let best = reaches.iter().flat_map(|reach| reach.nodes.iter().map(|(node, _)| (*node, 0.0))).collect();
        let mut way = Self {
            body,
            reaches,
            is_estimate,
            is_cut: false,
            stops: Vec::new(),
            length_m: 0.0,
            duration_s: 0.0,
            expected: 0.0,
            answers: 0.0,
            best,
        };
        let obstacles = way.reaches.first()?.obstacles();
        way.drive(controller.duplicate(), obstacles);
        Some(way)
    }

    fn drive(&mut self, mut controller: Box<dyn sextant_sim::Controller>, obstacles: &ObstacleField) {
        let mut place = self.body.start;
        let mut heading_rad = 0.0_f64;
        let mut met: Option<Position> = None;
        let mut heard: Option<Vec<HeardNode>> = None;
        let mut has_arrived = false;
        // What was expected so far, so that a node is heard once it is to be expected.
        let mut due: BTreeMap<NodeId, f64> = BTreeMap::new();
        for _ in 0..MOST_COMMANDS {
            let outcome = match (&heard, met) {
                (Some(heard), _) => CommandOutcome::Listened(heard),
                (None, Some(contact)) => CommandOutcome::Blocked(contact),
                (None, None) if has_arrived => CommandOutcome::Arrived,
                (None, None) => CommandOutcome::Started,
            };
            let time = SimTime::ZERO + Duration::from_secs_f64(self.duration_s.min(1e9));
            let situation = Situation::new(time, place, outcome, self.best.len(), obstacles, self.body.radius_m);
            let command = controller.decide(&situation);
            (met, heard) = (None, None);
            let target = match command {
                RobotCommand::Finish(_) => return,
                RobotCommand::Listen => {
                    self.duration_s += self.body.listen.as_secs_f64();
                    heard = Some(self.listen(place, &mut due));
                    continue;
                }
                RobotCommand::Drive(target) => target,
                RobotCommand::DriveArc { length_m, turn_rad } => {
                    // A chord is near enough for an estimate.
                    let toward_rad = heading_rad + 0.5 * turn_rad;
                    heading_rad += turn_rad;
                    let step = Position::new(libm::cos(toward_rad), libm::sin(toward_rad), 0.0);
                    place + step * length_m
                }
            };
            let way = target - place;
            let wanted_m = way.length_m();
            let clear_m = if wanted_m > 0.0 && self.is_estimate {
                obstacles.clearance_m(place, way, wanted_m, self.body.radius_m)
            } else {
                wanted_m
            };
            let share = if wanted_m > 0.0 { (clear_m / wanted_m).min(1.0) } else { 1.0 };
            if share < 1.0 - 1e-9 {
                met = Some(place + way * share);
            }
            if wanted_m > 0.0 {
                heading_rad = libm::atan2(way.y_m, way.x_m);
            }
            place = place + way * share;
            self.length_m += share * wanted_m;
            let drive_s = share * wanted_m / self.body.speed_m_per_s;
            self.duration_s += drive_s;
            has_arrived = true;
            if self.body.listening == Listening::AlsoWhileDriving {
                let slots = (drive_s / self.body.listen.as_secs_f64()).floor();
                let mut slot = 0.0;
                while slot < slots {
                    let middle = place - way * (share * (1.0 - (slot + 0.5) / slots));
                    self.listen(middle, &mut due);
                    slot += 1.0;
                }
            }
        }
        self.is_cut = true;
    }

    /// Listens at `place`: what is heard, if what is expected comes true.
    fn listen(&mut self, place: Position, due: &mut BTreeMap<NodeId, f64>) -> Vec<HeardNode> {
        self.stops.push(place);
        let mut heard = Vec::new();
        for reach in &self.reaches {
            let offered = self.offered_by(reach).unwrap_or(1.0);
            for (node, from) in reach.in_reach(place) {
                let probability = reach.probability(*from, place);
                if probability <= 0.0 {
                    continue;
                }
                let best = self.best.entry(*node).or_default();
                *best = best.max(probability);
                self.expected += offered * probability;
                self.answers += if reach.sweeps() { offered * probability } else { 0.0 };
                let sum = due.entry(*node).or_default();
                *sum += offered * probability;
                if *sum >= 1.0 {
                    // A whole number of packets.
                    let packets = sum.floor().min(f64::from(u32::MAX));
                    *sum -= packets;
                    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to u32::MAX")]
                    let packets = packets as u32;
                    let rssi_dbm = reach.network.technology.sensitivity().0;
                    heard.push(HeardNode { node: *node, packets, sent: packets, rssi_dbm });
                }
            }
        }
        heard.sort_by_key(|heard| heard.node);
        heard
    }

    /// Packets that a node of a network sends during a stop, if that is known.
    fn offered_by(&self, reach: &Reach<'_>) -> Option<f64> {
        if reach.sweeps() {
            return Some(f64::from(self.body.sweeps_per_stop));
        }
        reach.rate_per_s().map(|rate_per_s| rate_per_s * self.body.listen.as_secs_f64())
    }

    /// Length of the way (m).
    pub(super) fn length_m(&self) -> f64 {
        self.length_m
    }

    /// How long it takes (s).
    pub(super) fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// How often nodes answer sector sweeps.
    pub(super) fn answers(&self) -> f64 {
        self.answers
    }

    /// The robot.
    pub(super) fn body(&self) -> &RobotBody {
        self.body
    }

    /// The places of its stops.
    pub(super) fn stops(&self) -> &[Position] {
        &self.stops
    }

    /// Whether it is longer than was looked at.
    pub(super) fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// The nodes from which less than one of 100 packets is received at each stop.
    pub(super) fn out_of_reach(&self) -> Vec<NodeId> {
        self.best.iter().filter(|(_, best)| **best < 0.01).map(|(node, _)| *node).collect()
    }

    pub(super) fn forecast(&self) -> WayForecast {
        let offered: Option<f64> = self.reaches.iter().map(|reach| self.offered_by(reach)).sum();
        WayForecast {
            robot: self.body.name.clone(),
            estimate: self.is_estimate,
            cut: self.is_cut,
            path_length_m: self.length_m,
            stops: self.stops.len(),
            duration_s: self.duration_s,
            packets_offered: offered,
            packets_expected: offered.map(|_| self.expected / self.stops.len().max(1) as f64),
            out_of_reach: self.out_of_reach().into_iter().map(NodeId::index).collect(),
        }
    }
}
