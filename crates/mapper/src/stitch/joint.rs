//! The frames of all robots together: those with which the places of all shared nodes agree best.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use sextant_channel::Position;
use sextant_kernel::NodeId;

use super::consensus::level_m;
use super::frame_change::{FrameChange, Lengths, vector};
use super::shared::OwnMap;
use super::tukey;

/// Rounds of Gauss and Newton.
const ROUNDS: usize = 100;
/// Rounds in which the standard deviation is estimated anew; then it stays, so that the rounds converge.
const SCALE_ROUNDS: usize = 10;
/// Standard deviations below this share of the extent are rounding.
const ROUNDING: f64 = 1e-9;

/// How the map of a robot agrees with those of the others.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameAgreement {
    /// Nodes that are on the map of another robot too.
    pub shared: usize,
    /// Those that agree.
    pub agreeing: usize,
    /// Root of the mean square distance of these from where all maps together have them (m).
    pub residual_m: f64,
}

/// The place of a node on the map of one robot.
pub(super) struct Observation {
    pub(super) robot: usize,
    place: Position,
    variance: f64,
    /// Covariance in the frame of the robot (m²), if the map claims one.
    covariance: Option<Matrix3<f64>>,
    /// Weight of its residual, 0 to 1.
    trust: f64,
}

/// The frames of robots, and the nodes that tell them.
pub(super) struct PoseGraph {
    /// The observations of each node that several robots have.
    pub(super) nodes: Vec<Vec<Observation>>,
    pub(super) frames: Vec<Option<FrameChange>>,
    pub(super) lengths: Lengths,
    extent_m: f64,
}

/// The frames near `frames` with the least sum of squares over all robots and shared nodes. Outliers are found with Tukey's
/// biweight, and then do not count at all, and the others fully (Rousseeuw and Leroy 1987, section 1.2): so the errors of the
/// frames are those of least squares. The frame of the first robot stays.
pub(super) fn refined(maps: &[OwnMap], frames: Vec<Option<FrameChange>>, lengths: Lengths) -> PoseGraph {
    let mut graph = PoseGraph::new(maps, frames, lengths);
    let mut deviation = 0.0;
    for round in 0..ROUNDS {
        if round < SCALE_ROUNDS {
            deviation = graph.deviation();
        }
        graph.trust(deviation);
        if graph.is_settled_by_step() {
            break;
        }
    }
    graph.trust(deviation);
    graph.nodes.iter_mut().flatten().for_each(|seen| seen.trust = if seen.trust > 0.0 { 1.0 } else { 0.0 });
    for _ in 0..ROUNDS {
        if graph.is_settled_by_step() {
            break;
        }
    }
    graph
}

impl PoseGraph {
    fn new(maps: &[OwnMap], frames: Vec<Option<FrameChange>>, lengths: Lengths) -> Self {
        let mut nodes: BTreeMap<NodeId, Vec<Observation>> = BTreeMap::new();
        for (robot, (map, _)) in maps.iter().zip(&frames).enumerate().filter(|(_, (_, frame))| frame.is_some()) {
            for node in &map.nodes {
                let covariance = node.covariance.map(|rows| Matrix3::from_fn(|row, column| rows[row][column]));
                let seen = Observation { robot, place: node.place, variance: node.variance, covariance, trust: 1.0 };
                nodes.entry(node.node).or_default().push(seen);
            }
        }
        let nodes: Vec<Vec<Observation>> = nodes.into_values().filter(|seen| seen.len() > 1).collect();
        let places = nodes.iter().flatten().map(|seen| seen.place);
        let extent_m = sextant_channel::Bounds::of(places).map_or(0.0, |bounds| level_m(bounds.max - bounds.min));
        Self { nodes, frames, lengths, extent_m }
    }

    fn frame_of(&self, seen: &Observation) -> FrameChange {
        self.frames[seen.robot].unwrap_or(FrameChange::NONE)
    }

    /// Where an observation is in the common frame.
    pub(super) fn seen_at(&self, seen: &Observation) -> Vector3<f64> {
        vector(self.frame_of(seen).apply(seen.place))
    }

    /// The covariance of an observation in the common frame (m²). Of a map that claims none, relative to those of others.
    pub(super) fn covariance_of(&self, seen: &Observation) -> Matrix3<f64> {
        let linear = self.frame_of(seen).linear();
        let plain = Matrix3::from_diagonal(&Vector3::new(seen.variance, seen.variance, 0.0));
        linear * seen.covariance.unwrap_or(plain) * linear.transpose()
    }

    /// Whether all maps claim how exact they are.
    pub(super) fn has_claims(&self) -> bool {
        self.nodes.iter().flatten().all(|seen| seen.covariance.is_some())
    }

    /// Where all observations of a node together have it, and the sum of their weights; `None` if none is trusted.
    pub(super) fn middle(&self, node: &[Observation]) -> Option<(Vector3<f64>, f64)> {
        let total: f64 = node.iter().map(weight).sum();
        let sum = node.iter().fold(Vector3::zeros(), |sum, seen| sum + self.seen_at(seen) * weight(seen));
        (total > 0.0).then(|| (sum / total, total))
    }

    /// The distances of observations from the middle of the others of the same node, seen from above: where outliers of nodes
    /// with two observations are outliers too.
    fn residual(&self, node: &[Observation], of: usize) -> f64 {
        let others = || node.iter().enumerate().filter(|&(other, _)| other != of).map(|(_, seen)| seen);
        let total: f64 = others().map(|seen| 1.0 / seen.variance).sum();
        let middle = others().fold(Vector3::zeros(), |sum, seen| sum + self.seen_at(seen) / (seen.variance * total));
        let apart = self.seen_at(&node[of]) - middle;
        libm::hypot(apart.x, apart.y) / (node[of].variance + 1.0 / total).sqrt()
    }

    fn deviation(&self) -> f64 {
        let residuals: Vec<f64> =
            self.nodes.iter().flat_map(|node| (0..node.len()).map(|of| self.residual(node, of))).collect();
        let usual = self.nodes.iter().flatten().map(|seen| seen.variance).fold(f64::INFINITY, f64::min).sqrt();
        let degrees = 2 * self.frames.iter().flatten().count();
        tukey::standard_deviation(residuals, degrees).max(ROUNDING * self.extent_m / usual)
    }

    /// Trusts each observation as far as it agrees with the others.
    fn trust(&mut self, deviation: f64) {
        let trust: Vec<Vec<f64>> = self
            .nodes
            .iter()
            .map(|node| (0..node.len()).map(|of| tukey::weight(self.residual(node, of) / deviation)).collect())
            .collect();
        for (node, trust) in self.nodes.iter_mut().zip(trust) {
            node.iter_mut().zip(trust).for_each(|(seen, trust)| seen.trust = trust);
        }
    }

    /// How the place of an observation changes with each unknown of its frame.
    pub(super) fn slopes(&self, seen: &Observation) -> Vec<Vector3<f64>> {
        self.frame_of(seen).slopes(self.seen_at(seen), self.lengths)
    }

    /// Adds `entry(a, b)` to `matrix` for the frames of each two observations of a node, as it acts on their places.
    pub(super) fn add(
        &self,
        matrix: &mut DMatrix<f64>,
        node: &[Observation],
        entry: impl Fn(usize, usize) -> Matrix3<f64>,
    ) {
        let slopes: Vec<Vec<Vector3<f64>>> = node.iter().map(|seen| self.slopes(seen)).collect();
        for (a, seen) in node.iter().enumerate() {
            let Some(row) = self.lengths.first_of(seen.robot) else { continue };
            for (b, other) in node.iter().enumerate() {
                let Some(column) = self.lengths.first_of(other.robot) else { continue };
                let entry = entry(a, b);
                for (i, slope) in slopes[a].iter().enumerate() {
                    for (j, other) in slopes[b].iter().enumerate() {
                        matrix[(row + i, column + j)] += slope.dot(&(entry * other));
                    }
                }
            }
        }
    }

    /// Number of unknowns of all frames but the first.
    pub(super) fn size(&self) -> usize {
        self.lengths.unknowns() * self.frames.len().saturating_sub(1)
    }

    /// The normal matrix of all frames but the first, with the places of the nodes eliminated (Schur's complement). Robots
    /// without a frame have ones.
    pub(super) fn normal_matrix(&self) -> DMatrix<f64> {
        let mut normal = DMatrix::zeros(self.size(), self.size());
        for node in &self.nodes {
            let Some((_, total)) = self.middle(node) else { continue };
            self.add(&mut normal, node, |a, b| {
                let own = if a == b { weight(&node[a]) } else { 0.0 };
                Matrix3::from_diagonal_element(own - weight(&node[a]) * weight(&node[b]) / total)
            });
        }
        for robot in (1..self.frames.len()).filter(|&robot| self.frames[robot].is_none()) {
            let Some(row) = self.lengths.first_of(robot) else { continue };
            (row..row + self.lengths.unknowns()).for_each(|at| normal[(at, at)] = 1.0);
        }
        normal
    }

    /// The step of Gauss and Newton for all frames but the first; `None` if the nodes do not tell all frames.
    fn step(&self) -> Option<DVector<f64>> {
        let mut gradient = DVector::zeros(self.size());
        for node in &self.nodes {
            let Some((middle, _)) = self.middle(node) else { continue };
            for seen in node {
                let Some(row) = self.lengths.first_of(seen.robot) else { continue };
                let apart = self.seen_at(seen) - middle;
                for (i, slope) in self.slopes(seen).iter().enumerate() {
                    gradient[row + i] += weight(seen) * slope.dot(&apart);
                }
            }
        }
        self.normal_matrix().cholesky().map(|solver| solver.solve(&gradient))
    }

    /// Takes a step. Returns whether it was the last one: no observation moves any more, or the nodes do not tell the frames.
    fn is_settled_by_step(&mut self) -> bool {
        let Some(step) = self.step() else { return true };
        self.advance(&step) <= 1e-12 * self.extent_m
    }

    /// Goes against `step`. Returns how far an observation moves at most (m).
    fn advance(&mut self, step: &DVector<f64>) -> f64 {
        let before: Vec<Vector3<f64>> = self.nodes.iter().flatten().map(|seen| self.seen_at(seen)).collect();
        for (robot, frame) in self.frames.iter_mut().enumerate() {
            let (Some(frame), Some(at)) = (frame, self.lengths.first_of(robot)) else { continue };
            frame.offset = frame.offset - Position::new(step[at], step[at + 1], step[at + 2]);
            frame.turn_rad -= step[at + 3];
            if self.lengths == Lengths::Scaled {
                frame.scale *= libm::exp(-step[at + 4]);
            }
        }
        let after = self.nodes.iter().flatten().map(|seen| self.seen_at(seen));
        before.iter().zip(after).map(|(before, after)| (after - before).norm()).fold(0.0, f64::max)
    }

    /// How the map of each robot agrees with those of the others.
    pub(super) fn agreements(&self) -> Vec<FrameAgreement> {
        let mut agreements = vec![FrameAgreement::default(); self.frames.len()];
        for node in &self.nodes {
            let middle = self.middle(node);
            for seen in node {
                let own = &mut agreements[seen.robot];
                own.shared += 1;
                if let Some((middle, _)) = middle.filter(|_| seen.trust > 0.0) {
                    let apart = self.seen_at(seen) - middle;
                    own.agreeing += 1;
                    own.residual_m += apart.x * apart.x + apart.y * apart.y;
                }
            }
        }
        for own in &mut agreements {
            own.residual_m = (own.residual_m / own.agreeing.max(1) as f64).sqrt();
        }
        agreements
    }
}

/// How much an observation counts (1/m²).
pub(super) fn weight(seen: &Observation) -> f64 {
    seen.trust / seen.variance
}
