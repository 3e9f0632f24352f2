//! A path by odometry and the nodes to which it measured ranges, as one problem.

use nalgebra::{DVector, Vector4};
use sextant_channel::RangeErrorLaw;

use super::PathError;
use super::chain::{ChainStep, ChainSystem};
use super::climb::Hill;

/// A step of the path as odometry has it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leg {
    /// How far and where to (m), in the frame of odometry.
    pub(super) by: [f64; 2],
    pub(super) length_m: f64,
    /// How much the path turns at its beginning (rad).
    pub(super) turn_rad: f64,
    /// Whether it leads from one robot's last pose to the next one's first, so that it says nothing.
    pub(super) is_jump: bool,
}

/// A range from a pose.
#[derive(Clone, Copy, Debug)]
pub(super) struct PoseRange {
    pub(super) pose: usize,
    pub(super) node: usize,
    /// From the pose to where it was measured (m), in the frame of odometry.
    pub(super) offset: [f64; 2],
    /// How much higher the node is (m).
    pub(super) height_m: f64,
    pub(super) range_m: f64,
}

/// What is sought: a place and the turn of odometry's frame at each pose, and the border.
#[derive(Clone, Debug)]
pub(super) struct DrivePoint {
    /// x, y (m), turn (rad), and nothing.
    pub(super) poses: Vec<Vector4<f64>>,
    /// x, y and bias of each node (m); bias and scale of all ranges; scale and drift of odometry (rad/m).
    pub(super) border: DVector<f64>,
}

/// What is known of nodes: a place and a standard deviation, if one is known (m).
pub(super) type KnownPlace = Option<([f64; 2], f64)>;

/// Odometry with ranges.
#[derive(Clone, Debug)]
pub(super) struct DriveProblem<'a> {
    pub(super) legs: &'a [Leg],
    pub(super) ranges: &'a [PoseRange],
    pub(super) known: &'a [KnownPlace],
    pub(super) odometry: PathError,
    pub(super) law: RangeErrorLaw,
    /// How many independent ranges one is worth.
    pub(super) worth: f64,
    pub(super) node_bias_m: f64,
    pub(super) bias_m: f64,
    pub(super) scale: f64,
    /// The first pose of each robot, as believed, and how well it is known (m, rad).
    pub(super) firsts: &'a [(usize, [f64; 2])],
    pub(super) first_deviation: [f64; 2],
}

/// Entries of the border for each node, and those after all nodes.
const OF_NODE: usize = 3;
const BIAS: usize = 0;
const SCALE: usize = 1;
const ODOMETRY_SCALE: usize = 2;
const DRIFT: usize = 3;
pub(super) const AFTER_NODES: usize = 4;

impl DriveProblem<'_> {
    fn shared(&self, which: usize) -> usize {
        OF_NODE * self.known.len() + which
    }

    /// The variance of a leg's length error along each axis (m²), and of its turn (rad²).
    pub(super) fn variances(&self, leg: &Leg) -> [f64; 2] {
        let length_m = leg.length_m.max(0.01);
        let along = self.odometry.position_m_per_root_m.powi(2) * length_m + 1e-6;
        let turn = self.odometry.heading_rad_per_root_m.powi(2) * length_m + (0.02 * leg.turn_rad).powi(2) + 1e-9;
        [along, turn]
    }

    /// The residuals of a leg: along x and y of odometry's frame (m), and of the turn (rad).
    fn of_leg(&self, leg: &Leg, from: &Vector4<f64>, to: &Vector4<f64>, border: &DVector<f64>) -> [f64; 3] {
        let (sin, cos) = libm::sincos(from[2]);
        let (x, y) = (to[0] - from[0], to[1] - from[1]);
        let longer = 1.0 + border[self.shared(ODOMETRY_SCALE)];
        [
            cos * x + sin * y - longer * leg.by[0],
            -sin * x + cos * y - longer * leg.by[1],
            to[2] - from[2] - border[self.shared(DRIFT)] * leg.length_m,
        ]
    }

    /// From where a range was measured to the node (m), and the distance.
    fn apart(&self, range: &PoseRange, at: &DrivePoint) -> ([f64; 2], f64) {
        let pose = &at.poses[range.pose];
        let (sin, cos) = libm::sincos(pose[2]);
        let [x, y] = range.offset;
        let from = [pose[0] + cos * x - sin * y, pose[1] + sin * x + cos * y];
        let apart = [0, 1].map(|axis| at.border[OF_NODE * range.node + axis] - from[axis]);
        (apart, (apart[0].powi(2) + apart[1].powi(2) + range.height_m.powi(2) + 1e-12).sqrt())
    }

    fn error_m(&self, range: &PoseRange, distance_m: f64, border: &DVector<f64>) -> f64 {
        let longer = 1.0 + border[self.shared(SCALE)];
        range.range_m - longer * distance_m - border[self.shared(BIAS)] - border[OF_NODE * range.node + 2]
    }

    /// Entries of the border with a prior: where, the mean, and the standard deviation.
    fn priors(&self) -> impl Iterator<Item = (usize, f64, f64)> {
        let of_nodes = self.known.iter().enumerate().flat_map(|(node, known)| {
            let place = known.map(|(place, deviation)| [0, 1].map(|axis| (OF_NODE * node + axis, place[axis], deviation)));
            let bias = (OF_NODE * node + 2, 0.0, self.node_bias_m);
            place.into_iter().flatten().chain([bias])
        });
        let shared = [
            (BIAS, self.bias_m),
            (SCALE, self.scale),
            (ODOMETRY_SCALE, self.odometry.scale),
            (DRIFT, self.odometry.drift_rad_per_m),
        ];
        of_nodes.chain(shared.map(|(which, deviation)| (self.shared(which), 0.0, deviation.max(1e-9))))
    }

    /// What is known of the first pose of each robot: pose, entry, mean, standard deviation.
    fn first_priors(&self) -> impl Iterator<Item = (usize, usize, f64, f64)> {
        let [place, turn] = self.first_deviation;
        self.firsts
            .iter()
            .flat_map(move |&(pose, [x, y])| [(pose, 0, x, place), (pose, 1, y, place), (pose, 2, 0.0, turn)])
    }

    /// The errors of all ranges (m).
    pub(super) fn errors_m(&self, at: &DrivePoint) -> Vec<f64> {
        let error = |range: &PoseRange| self.error_m(range, self.apart(range, at).1, &at.border);
        self.ranges.iter().map(error).collect()
    }
}

impl Hill for DriveProblem<'_> {
    type Point = DrivePoint;

    fn value(&self, at: &DrivePoint) -> f64 {
        let of_range = |error_m: f64| self.law.density(error_m).log_density;
        let mut value: f64 = self.worth * self.errors_m(at).into_iter().map(of_range).sum::<f64>();
        for (number, leg) in self.legs.iter().enumerate().filter(|(_, leg)| !leg.is_jump) {
            let [x, y, turn] = self.of_leg(leg, &at.poses[number], &at.poses[number + 1], &at.border);
            let [along, turning] = self.variances(leg);
            value -= 0.5 * ((x * x + y * y) / along + turn * turn / turning);
        }
        for (entry, mean, deviation) in self.priors() {
            value -= 0.5 * ((at.border[entry] - mean) / deviation).powi(2);
        }
        for (pose, entry, mean, deviation) in self.first_priors() {
            value -= 0.5 * ((at.poses[pose][entry] - mean) / deviation).powi(2);
        }
        value
    }

    fn system(&self, at: &DrivePoint) -> ChainSystem {
        let mut system = ChainSystem::zeros(at.poses.len(), at.border.len());
        for range in self.ranges {
            let (apart, distance_m) = self.apart(range, at);
            let density = self.law.density(self.error_m(range, distance_m, &at.border));
            let longer = (1.0 + at.border[self.shared(SCALE)]) / distance_m;
            let (sin, cos) = libm::sincos(at.poses[range.pose][2]);
            let [x, y] = range.offset;
            let by_turn = apart[0] * (-sin * x - cos * y) + apart[1] * (cos * x - sin * y);
            let by_pose = Vector4::new(apart[0], apart[1], by_turn, 0.0) * longer;
            let by_border = [
                (OF_NODE * range.node, -longer * apart[0]),
                (OF_NODE * range.node + 1, -longer * apart[1]),
                (OF_NODE * range.node + 2, -1.0),
                (self.shared(BIAS), -1.0),
                (self.shared(SCALE), -distance_m),
            ];
            let (weight, slope) = (self.worth * density.stiffness, self.worth * density.by_error);
            system.add(range.pose, by_pose, None, &by_border, weight, slope);
        }
        for (number, leg) in self.legs.iter().enumerate() {
            if leg.is_jump {
                continue;
            }
            let (from, to) = (&at.poses[number], &at.poses[number + 1]);
            let [x, y, turn] = self.of_leg(leg, from, to, &at.border);
            let [along, turning] = self.variances(leg);
            let longer = 1.0 + at.border[self.shared(ODOMETRY_SCALE)];
            let (sin, cos) = libm::sincos(from[2]);
            // What the leg is in the frame of odometry, which is turned.
            let (turned_x, turned_y) = (x + longer * leg.by[0], y + longer * leg.by[1]);
            let scale = self.shared(ODOMETRY_SCALE);
            let rows = [
                (Vector4::new(-cos, -sin, turned_y, 0.0), Vector4::new(cos, sin, 0.0, 0.0), (scale, -leg.by[0]), x, along),
                (Vector4::new(sin, -cos, -turned_x, 0.0), Vector4::new(-sin, cos, 0.0, 0.0), (scale, -leg.by[1]), y, along),
                (
                    Vector4::new(0.0, 0.0, -1.0, 0.0),
                    Vector4::new(0.0, 0.0, 1.0, 0.0),
                    (self.shared(DRIFT), -leg.length_m),
                    turn,
                    turning,
                ),
            ];
            for (by_from, by_to, by_border, residual, variance) in rows {
                system.add(number, by_from, Some(by_to), &[by_border], 1.0 / variance, -residual / variance);
            }
        }
        for (entry, mean, deviation) in self.priors() {
            system.border[(entry, entry)] += deviation.powi(-2);
            system.border_slope[entry] -= (at.border[entry] - mean) / deviation.powi(2);
        }
        for (pose, entry, mean, deviation) in self.first_priors() {
            system.states[pose][(entry, entry)] += deviation.powi(-2);
            system.slopes[pose][entry] -= (at.poses[pose][entry] - mean) / deviation.powi(2);
        }
        for state in &mut system.states {
            state[(3, 3)] += 1.0;
        }
        system
    }

    fn moved(&self, at: &DrivePoint, step: &ChainStep) -> DrivePoint {
        DrivePoint {
            poses: at.poses.iter().zip(&step.states).map(|(pose, step)| pose + step).collect(),
            border: &at.border + &step.border,
        }
    }
}
