//! A path by odometry and the nodes whose packets it heard: the places of nodes are integrated over grids, never fixed.

use nalgebra::{DVector, Matrix2, Vector2, Vector4};
use rayon::prelude::*;

use super::chain::{ChainStep, ChainSystem};
use super::climb::Hill;
use super::odometry::Odometry;
use super::reception_curve::{CurveCounts, ReceptionCurve};

/// What was heard of a node at a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Heard {
    pub(super) pose: usize,
    pub(super) received: f64,
    pub(super) missed: f64,
}

/// Where a node may be, and what was heard of it at the poses near there.
#[derive(Clone, Debug, Default)]
pub(super) struct NodeGrid {
    pub(super) places: Vec<[f64; 2]>,
    pub(super) near: Vec<Heard>,
}

/// What is sought: a place and the turn of odometry's frame at each pose; scale and drift of odometry.
#[derive(Clone, Debug)]
pub(super) struct PacketPoint {
    pub(super) poses: Vec<Vector4<f64>>,
    /// Two entries for each node, which are 0: its place is integrated over. Then scale and drift.
    pub(super) border: DVector<f64>,
}

/// Odometry with packets.
#[derive(Clone, Debug)]
pub(super) struct PacketProblem<'a> {
    pub(super) odometry: Odometry<'a>,
    pub(super) grids: &'a [NodeGrid],
    pub(super) curve: &'a ReceptionCurve,
    /// Correlation of the packets of a link: so many count as fewer.
    pub(super) correlation: f64,
}

/// The least share of the greatest probability at which a place counts.
const NEGLIGIBLE: f64 = 1e-7;

/// The posterior of a node.
pub(super) struct NodePosterior {
    /// Places with their probabilities.
    pub(super) places: Vec<([f64; 2], f64)>,
    /// Logarithm of the mean likelihood over the grid.
    pub(super) log_evidence: f64,
}

impl NodePosterior {
    pub(super) fn mean(&self) -> [f64; 2] {
        [0, 1].map(|axis| self.places.iter().map(|(place, weight)| place[axis] * weight).sum())
    }

    /// The greatest standard deviation along an axis (m).
    pub(super) fn spread_m(&self) -> f64 {
        let mean = self.mean();
        let variance = |axis: usize| -> f64 {
            self.places.iter().map(|(place, weight)| (place[axis] - mean[axis]).powi(2) * weight).sum()
        };
        variance(0).max(variance(1)).max(0.0).sqrt()
    }
}

impl PacketProblem<'_> {
    /// How many independent packets so many of one link are.
    fn worth(&self, packets: f64) -> f64 {
        1.0 / (1.0 + (packets - 1.0).max(0.0) * self.correlation)
    }

    /// The posterior of a node on its grid.
    pub(super) fn posterior(&self, grid: &NodeGrid, poses: &[Vector4<f64>]) -> NodePosterior {
        let near: Vec<(f64, f64, f64, f64)> = grid
            .near
            .iter()
            .map(|heard| {
                let worth = self.worth(heard.received + heard.missed);
                (poses[heard.pose][0], poses[heard.pose][1], worth * heard.received, worth * heard.missed)
            })
            .collect();
        let of_place = |place: &[f64; 2]| -> f64 {
            near.iter()
                .map(|&(x, y, received, missed)| {
                    let (x, y) = (place[0] - x, place[1] - y);
                    self.curve.log_probability((x * x + y * y).sqrt(), received, missed)
                })
                .sum()
        };
        let logs: Vec<f64> = grid.places.iter().map(of_place).collect();
        let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let weights: Vec<f64> = logs.iter().map(|log| libm::exp(log - most)).collect();
        let sum: f64 = weights.iter().sum();
        let places = grid.places.iter().zip(&weights).filter(|&(_, &weight)| weight >= NEGLIGIBLE);
        NodePosterior {
            places: places.map(|(&place, &weight)| (place, weight / sum)).collect(),
            log_evidence: most + libm::log(sum / grid.places.len() as f64),
        }
    }

    /// The posteriors of all nodes.
    pub(super) fn posteriors(&self, poses: &[Vector4<f64>]) -> Vec<NodePosterior> {
        self.grids.par_iter().map(|grid| self.posterior(grid, poses)).collect()
    }

    /// Packets received and sent over distances, over the posteriors, and the excess of the variance of links over that of
    /// independent packets.
    pub(super) fn counts(&self, poses: &[Vector4<f64>]) -> (CurveCounts, f64) {
        let of_node = |grid: &NodeGrid| {
            let posterior = self.posterior(grid, poses);
            let mut counts = self.curve.counts();
            let (mut excess, mut packets) = (0.0, 0.0);
            for heard in &grid.near {
                let pose = &poses[heard.pose];
                let sent = heard.received + heard.missed;
                let mut mean = 0.0;
                for (place, weight) in &posterior.places {
                    let distance_m = {
                        let (x, y) = (place[0] - pose[0], place[1] - pose[1]);
                        (x * x + y * y).sqrt()
                    };
                    self.curve.count(&mut counts, distance_m, weight * heard.received, weight * sent);
                    mean += weight * self.curve.share(distance_m);
                }
                if sent > 1.0 {
                    let single = (mean * (1.0 - mean)).max(0.02);
                    excess += ((heard.received - sent * mean).powi(2) / sent - single) / single;
                    packets += sent - 1.0;
                }
            }
            (counts, excess, packets)
        };
        let found: Vec<(CurveCounts, f64, f64)> = self.grids.par_iter().map(of_node).collect();
        let mut counts = self.curve.counts();
        let (mut excess, mut packets) = (0.0, 0.0);
        for (own, own_excess, own_packets) in found {
            counts = counts.plus(&own);
            excess += own_excess;
            packets += own_packets;
        }
        let correlation = if packets > 0.0 { (excess / packets).clamp(0.0, 1.0) } else { 0.0 };
        (counts, correlation)
    }

    /// What the nodes add to the logarithm of the determinant of a curvature, which has them as free places.
    pub(super) fn log_determinant_of_nodes(&self, system: &ChainSystem) -> f64 {
        let of_node = |node: usize| {
            let (x, y) = (2 * node, 2 * node + 1);
            let determinant = system.between(x, x) * system.between(y, y) - system.between(x, y).powi(2);
            libm::log(determinant.max(f64::MIN_POSITIVE))
        };
        (0..self.grids.len()).map(of_node).sum()
    }
}

/// The slope of a node's evidence by the place of a pose, and the information that both have of each other's place.
struct PoseSlope {
    pose: usize,
    slope: Vector2<f64>,
    information: Matrix2<f64>,
}

impl Hill for PacketProblem<'_> {
    type Point = PacketPoint;

    fn value(&self, at: &PacketPoint) -> f64 {
        let evidences: Vec<f64> =
            self.grids.par_iter().map(|grid| self.posterior(grid, &at.poses).log_evidence).collect();
        let log_scale = libm::log1p(at.border[self.odometry.scale].max(-0.9));
        // Nodes are as dense in a larger world as in a smaller one, for the length of the path: packets know no scale.
        evidences.into_iter().sum::<f64>() - 2.0 * self.grids.len() as f64 * log_scale
            + self.odometry.value(&at.poses, &at.border)
    }

    /// The slope is that of the evidence with all places integrated. The curvature is the expected information that poses and nodes
    /// have of each other, with the nodes as free places: their elimination leaves what the poses know of each other.
    fn system(&self, at: &PacketPoint) -> ChainSystem {
        let of_node = |grid: &NodeGrid| -> Vec<PoseSlope> {
            let posterior = self.posterior(grid, &at.poses);
            let of_pose = |heard: &Heard| {
                let pose = &at.poses[heard.pose];
                let worth = self.worth(heard.received + heard.missed);
                let (received, missed) = (worth * heard.received, worth * heard.missed);
                let (mut slope, mut information) = (Vector2::zeros(), Matrix2::zeros());
                for (place, weight) in &posterior.places {
                    let apart = Vector2::new(place[0] - pose[0], place[1] - pose[1]);
                    let distance_m = apart.norm();
                    if distance_m < 1e-9 {
                        continue;
                    }
                    let direction = apart / distance_m;
                    let value = self.curve.at(distance_m);
                    // The pose nearer by a metre is the distance shorter by one.
                    slope -= direction * (weight * (received * value.slopes[0] + missed * value.slopes[1]));
                    information +=
                        direction * direction.transpose() * (weight * (received + missed) * value.information);
                }
                PoseSlope { pose: heard.pose, slope, information }
            };
            grid.near.iter().map(of_pose).collect()
        };
        let found: Vec<Vec<PoseSlope>> = self.grids.par_iter().map(of_node).collect();
        let mut system = ChainSystem::zeros(at.poses.len(), at.border.len());
        for (node, slopes) in found.into_iter().enumerate() {
            for PoseSlope { pose, slope, information } in slopes {
                let (x, y) = (2 * node, 2 * node + 1);
                let mut state = system.states[pose].fixed_view_mut::<2, 2>(0, 0);
                state += information;
                for axis in 0..2 {
                    system.slopes[pose][axis] += slope[axis];
                    let side = Vector4::new(information[(0, axis)], information[(1, axis)], 0.0, 0.0);
                    system.add_to_side(pose, x + axis, -side);
                }
                for (entry, other, [row, column]) in [(x, x, [0, 0]), (x, y, [0, 1]), (y, y, [1, 1])] {
                    system.add_to_border(entry, other, information[(row, column)]);
                }
            }
            for entry in [2 * node, 2 * node + 1] {
                system.add_to_border(entry, entry, 1e-6);
            }
        }
        let larger = 1.0 + at.border[self.odometry.scale].max(-0.9);
        system.border_slope[self.odometry.scale] -= 2.0 * self.grids.len() as f64 / larger;
        self.odometry.add(&mut system, &at.poses, &at.border);
        system
    }

    fn moved(&self, at: &PacketPoint, step: &ChainStep) -> PacketPoint {
        let mut border = at.border.clone();
        for entry in [self.odometry.scale, self.odometry.drift] {
            border[entry] += step.border[entry];
        }
        PacketPoint { poses: at.poses.iter().zip(&step.states).map(|(pose, step)| pose + step).collect(), border }
    }
}
