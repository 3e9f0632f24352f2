//! Measured ranges of a log.

use sextant_kernel::{NodeId, RobotId, SimTime};

use super::{LogError, Stop};
use crate::geometry::position::Position;

/// An antenna on a robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mounting {
    /// Its number on the robot.
    pub antenna: u32,
    /// From the place of the robot to the antenna (m), in the frame of places: the heading of the robot is in it.
    pub arm: Position,
}

/// A distance to a node that a robot measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeSample {
    /// The node.
    pub node: NodeId,
    /// The robot.
    pub robot: RobotId,
    /// When it was measured.
    pub time: SimTime,
    /// Where it was measured (m): the place of the antenna.
    pub position: Position,
    /// Where the antenna is on the robot; the default if the path is that of the antenna.
    pub mounting: Mounting,
    /// How fast it drove then, by axis (m/s); zero at a stop.
    pub velocity: Position,
    /// The distance that was measured (m). A device may report a negative one: it is the true distance and an error.
    pub range_m: f64,
}

impl RangeSample {
    /// A range of the first robot at the start, which stands, by an antenna at the place of its path.
    #[must_use]
    pub fn of(node: NodeId, position: Position, range_m: f64) -> Self {
        let (robot, mounting, velocity) = (RobotId(0), Mounting::default(), Position::ORIGIN);
        Self { node, robot, time: SimTime::ZERO, position, mounting, velocity, range_m }
    }
}

/// The ranges of a log by node, each node's in the order in which they were measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct RangeSamples {
    samples: Vec<RangeSample>,
}

impl RangeSamples {
    /// The greatest distance that is a measurement (m).
    const LONGEST_M: f64 = 1e7;

    /// The ranges `samples` to nodes called `names`; those of a node keep their order.
    pub(super) fn new(names: &[String], mut samples: Vec<RangeSample>) -> Result<Self, LogError> {
        for sample in &samples {
            let name = names.get(sample.node.index());
            let name = name.ok_or(LogError::UnknownNode { node: sample.node.0, nodes: names.len() })?;
            let vectors = [sample.position, sample.velocity, sample.mounting.arm];
            let is_place = vectors.iter().all(|vector| vector.is_within_reason());
            let is_range = sample.range_m.abs() <= Self::LONGEST_M;
            if !is_place || !is_range {
                return Err(LogError::RangeNotFinite { node: name.clone(), range_m: sample.range_m });
            }
        }
        samples.sort_by_key(|sample| sample.node);
        Ok(Self { samples })
    }

    pub(super) fn all(&self) -> &[RangeSample] {
        &self.samples
    }

    /// Those of one node.
    pub(super) fn of(&self, node: NodeId) -> &[RangeSample] {
        let from = self.samples.partition_point(|sample| sample.node < node);
        let to = self.samples.partition_point(|sample| sample.node <= node);
        &self.samples[from..to]
    }

    /// The stop to which each sample belongs, of these `stops`: the last one of its robot that had begun when it was measured, or
    /// the first one.
    pub(super) fn stops(&self, stops: &[Stop]) -> Vec<u32> {
        let mut of_robots: Vec<(RobotId, SimTime, u32)> =
            (0..).zip(stops).map(|(number, stop)| (stop.robot, stop.time, number)).collect();
        of_robots.sort_unstable();
        let of = |sample: &RangeSample| {
            let next = of_robots.partition_point(|&(robot, time, _)| (robot, time) <= (sample.robot, sample.time));
            let before = next.checked_sub(1).and_then(|last| of_robots.get(last));
            let own = before.filter(|stop| stop.0 == sample.robot).or(of_robots.get(next));
            own.map_or(0, |&(_, _, number)| number)
        };
        self.samples.iter().map(of).collect()
    }

    /// The same at other places, in a frame that is turned by so much there (rad).
    pub(super) fn placed_again(&self, place: impl Fn(RobotId, SimTime, Position) -> (Position, f64)) -> Self {
        let moved = |sample: &RangeSample| {
            let (position, turn_rad) = place(sample.robot, sample.time, sample.position);
            let (sin, cos) = libm::sincos(turn_rad);
            let turned = |Position { x_m, y_m, z_m }: Position| {
                Position::new(cos * x_m - sin * y_m, sin * x_m + cos * y_m, z_m)
            };
            let mounting = Mounting { arm: turned(sample.mounting.arm), ..sample.mounting };
            RangeSample { position, velocity: turned(sample.velocity), mounting, ..*sample }
        };
        Self { samples: self.samples.iter().map(moved).collect() }
    }

    /// Those that were measured before `time`.
    pub(super) fn until(&self, time: SimTime) -> Self {
        Self { samples: self.samples.iter().filter(|sample| sample.time < time).copied().collect() }
    }
}
