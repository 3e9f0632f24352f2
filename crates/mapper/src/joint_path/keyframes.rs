//! The poses of a drive: the places where ranges were measured, at least half a metre apart.

use std::collections::BTreeMap;

use sextant_channel::{Position, RangeSample, ReceptionLog};
use sextant_kernel::{RobotId, SimTime};

use super::drive_problem::PoseRange;
use super::odometry::{Leg, legs};
use crate::numerics::median;

/// Poses are at least that far apart (m).
const APART_M: f64 = 0.5;

/// A pose as odometry has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Keyframe {
    pub(super) robot: RobotId,
    pub(super) time: SimTime,
    pub(super) position: Position,
}

/// The poses of all robots, one robot after the other, with what ties them.
#[derive(Clone, Debug, Default)]
pub(super) struct Keyframes {
    pub(super) frames: Vec<Keyframe>,
    pub(super) legs: Vec<Leg>,
    /// Ranges from each pose: those of one antenna to one node count once.
    pub(super) ranges: Vec<PoseRange>,
}

impl Keyframes {
    /// The poses of `log`, and its ranges to the nodes that have a number in `nodes`, which are so much higher than the robot.
    pub(super) fn of(log: &ReceptionLog, nodes: &[Option<usize>], heights_m: &[f64]) -> Self {
        let mut samples: Vec<&RangeSample> = log.ranges().iter().collect();
        samples.sort_by_key(|sample| (sample.robot, sample.time));
        let mut found = Self::default();
        let mut open: BTreeMap<(usize, u32), Vec<&RangeSample>> = BTreeMap::new();
        for sample in samples {
            let position = sample.position - sample.mounting.arm;
            let is_near = found
                .frames
                .last()
                .is_some_and(|last| last.robot == sample.robot && last.position.distance_m(position) < APART_M);
            if !is_near {
                found.close(&mut open, heights_m);
                found.frames.push(Keyframe { robot: sample.robot, time: sample.time, position });
            }
            if let Some(node) = nodes[sample.node.index()] {
                open.entry((node, sample.mounting.antenna)).or_default().push(sample);
            }
        }
        found.close(&mut open, heights_m);
        let place = |frame: &Keyframe| [frame.position.x_m, frame.position.y_m];
        let is_first = |at: usize| at > 0 && found.frames[at].robot != found.frames[at - 1].robot;
        found.legs = legs(found.frames.iter().enumerate().map(|(at, frame)| (place(frame), is_first(at))));
        found
    }

    /// Adds the ranges from the last pose.
    fn close(&mut self, open: &mut BTreeMap<(usize, u32), Vec<&RangeSample>>, heights_m: &[f64]) {
        for ((node, _), samples) in std::mem::take(open) {
            let pose = self.frames.len() - 1;
            let count = samples.len() as f64;
            let place = samples.iter().fold(Position::ORIGIN, |sum, sample| sum + sample.position) * (1.0 / count);
            let velocity = samples.iter().fold(Position::ORIGIN, |sum, sample| sum + sample.velocity) * (1.0 / count);
            let offset = place - self.frames[pose].position;
            self.ranges.push(PoseRange {
                pose,
                node,
                offset: [offset.x_m, offset.y_m],
                velocity: [velocity.x_m, velocity.y_m],
                height_m: heights_m[node] - place.z_m,
                range_m: median(&mut samples.iter().map(|sample| sample.range_m).collect::<Vec<_>>()),
            });
        }
    }

    /// The first pose of each robot, with its place.
    pub(super) fn firsts(&self) -> Vec<(usize, [f64; 2])> {
        let is_first = |&at: &usize| at == 0 || self.frames[at].robot != self.frames[at - 1].robot;
        let place = |at: usize| (at, [self.frames[at].position.x_m, self.frames[at].position.y_m]);
        (0..self.frames.len()).filter(is_first).map(place).collect()
    }
}
