//! A path by odometry and the nodes to which it measured ranges, as one problem.

use nalgebra::{DVector, Vector4};
use sextant_channel::RangeErrorLaw;

use super::chain::{ChainStep, ChainSystem};
use super::climb::Hill;
use super::odometry::Odometry;

/// A range from a pose.
#[derive(Clone, Copy, Debug)]
pub(super) struct PoseRange {
    pub(super) pose: usize,
    pub(super) node: usize,
    /// From the pose to where it was measured (m), in the frame of odometry.
    pub(super) offset: [f64; 2],
    /// How fast the robot was (m/s), in the frame of odometry.
    pub(super) velocity: [f64; 2],
    /// How much higher the node is (m).
    pub(super) height_m: f64,
    pub(super) range_m: f64,
}

/// What is sought: a place and the turn of odometry's frame at each pose, and the border.
#[derive(Clone, Debug)]
pub(super) struct DrivePoint {
    /// x, y (m), turn (rad), and nothing.
    pub(super) poses: Vec<Vector4<f64>>,
    /// x, y and bias of each node (m); bias and scale of all ranges; scale and drift of odometry (rad/m); how late the ranges are (s).
    pub(super) border: DVector<f64>,
}

/// What is known of nodes: a place and a standard deviation, if one is known (m).
pub(super) type KnownPlace = Option<([f64; 2], f64)>;

/// Odometry with ranges.
#[derive(Clone, Debug)]
pub(super) struct DriveProblem<'a> {
    pub(super) odometry: Odometry<'a>,
    pub(super) ranges: &'a [PoseRange],
    pub(super) known: &'a [KnownPlace],
    pub(super) law: RangeErrorLaw,
    /// How many independent ranges one is worth.
    pub(super) worth: f64,
    pub(super) node_bias_m: f64,
    pub(super) bias_m: f64,
    pub(super) scale: f64,
    pub(super) delay_s: f64,
}

/// Entries of the border for each node, and those after all nodes.
const OF_NODE: usize = 3;
const BIAS: usize = 0;
pub(super) const SCALE_OF_RANGES: usize = 1;
pub(super) const ODOMETRY_SCALE: usize = 2;
pub(super) const DRIFT: usize = 3;
pub(super) const DELAY: usize = 4;
pub(super) const AFTER_NODES: usize = 5;

/// Where an entry after all nodes stands in the border.
pub(super) fn after_nodes(nodes: usize, which: usize) -> usize {
    OF_NODE * nodes + which
}

impl DriveProblem<'_> {
    fn shared(&self, which: usize) -> usize {
        after_nodes(self.known.len(), which)
    }

    /// From where a range was measured to the node (m), and the distance.
    fn apart(&self, range: &PoseRange, at: &DrivePoint) -> ([f64; 2], f64) {
        let pose = &at.poses[range.pose];
        let (sin, cos) = libm::sincos(pose[2]);
        let [x, y] = self.offset(range, at);
        let from = [pose[0] + cos * x - sin * y, pose[1] + sin * x + cos * y];
        let apart = [0, 1].map(|axis| at.border[OF_NODE * range.node + axis] - from[axis]);
        (apart, (apart[0].powi(2) + apart[1].powi(2) + range.height_m.powi(2) + 1e-12).sqrt())
    }

    /// From the pose to where a range was measured, which is late (m), in the frame of odometry.
    fn offset(&self, range: &PoseRange, at: &DrivePoint) -> [f64; 2] {
        let delay_s = at.border[self.shared(DELAY)];
        [0, 1].map(|axis| range.offset[axis] - range.velocity[axis] * delay_s)
    }

    fn error_m(&self, range: &PoseRange, distance_m: f64, border: &DVector<f64>) -> f64 {
        let longer = 1.0 + border[self.shared(SCALE_OF_RANGES)];
        range.range_m - longer * distance_m - border[self.shared(BIAS)] - border[OF_NODE * range.node + 2]
    }

    /// Entries of the border with a prior: where, the mean, and the standard deviation.
    fn priors(&self) -> impl Iterator<Item = (usize, f64, f64)> {
        let of_nodes = self.known.iter().enumerate().flat_map(|(node, known)| {
            let place =
                known.map(|(place, deviation)| [0, 1].map(|axis| (OF_NODE * node + axis, place[axis], deviation)));
            let bias = (OF_NODE * node + 2, 0.0, self.node_bias_m);
            place.into_iter().flatten().chain([bias])
        });
        let shared = [(BIAS, self.bias_m), (SCALE_OF_RANGES, self.scale), (DELAY, self.delay_s)];
        of_nodes.chain(shared.map(|(which, deviation)| (self.shared(which), 0.0, deviation.max(1e-9))))
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
        let mut value = self.worth * self.law.prepared().log_likelihood(self.errors_m(at));
        value += self.odometry.value(&at.poses, &at.border);
        for (entry, mean, deviation) in self.priors() {
            value -= 0.5 * ((at.border[entry] - mean) / deviation).powi(2);
        }
        value
    }

    fn system(&self, at: &DrivePoint) -> ChainSystem {
        let mut system = ChainSystem::zeros(at.poses.len(), at.border.len());
        self.law.prepared().each_density(&self.errors_m(at), |number, density| {
            let range = &self.ranges[number];
            let (apart, distance_m) = self.apart(range, at);
            let longer = (1.0 + at.border[self.shared(SCALE_OF_RANGES)]) / distance_m;
            let (sin, cos) = libm::sincos(at.poses[range.pose][2]);
            let [x, y] = self.offset(range, at);
            let by_turn = apart[0] * (-sin * x - cos * y) + apart[1] * (cos * x - sin * y);
            let by_pose = Vector4::new(apart[0], apart[1], by_turn, 0.0) * longer;
            let [vx, vy] = range.velocity;
            let closing = apart[0] * (cos * vx - sin * vy) + apart[1] * (sin * vx + cos * vy);
            let by_border = [
                (OF_NODE * range.node, -longer * apart[0]),
                (OF_NODE * range.node + 1, -longer * apart[1]),
                (OF_NODE * range.node + 2, -1.0),
                (self.shared(BIAS), -1.0),
                (self.shared(SCALE_OF_RANGES), -distance_m),
                (self.shared(DELAY), -longer * closing),
            ];
            let (weight, slope) = (self.worth * density.stiffness, self.worth * density.by_error);
            system.add(range.pose, by_pose, None, &by_border, weight, slope);
        });
        self.odometry.add(&mut system, &at.poses, &at.border);
        for (entry, mean, deviation) in self.priors() {
            system.add_to_border(entry, entry, deviation.powi(-2));
            system.border_slope[entry] -= (at.border[entry] - mean) / deviation.powi(2);
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
