//! The frames of all robots together: those with which the places of all shared nodes agree best.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector, Vector3};
use sextant_channel::Position;
use sextant_kernel::NodeId;

use super::consensus::level_m;
use super::frame_change::{FrameChange, Lengths};
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
pub(super) struct Agreement {
    /// Nodes that are on the map of another robot too.
    pub(super) shared: usize,
    /// Those that agree.
    pub(super) agreeing: usize,
    /// Root of the mean square distance of these from where all maps together have them (m).
    pub(super) residual_m: f64,
}

/// The place of a node on the map of one robot.
struct Observation {
    robot: usize,
    place: Position,
    variance: f64,
    /// Weight of its residual, 0 to 1.
    trust: f64,
}

/// The frames of robots, and the nodes that tell them.
struct PoseGraph {
    /// The observations of each node that several robots have.
    nodes: Vec<Vec<Observation>>,
    frames: Vec<Option<FrameChange>>,
    lengths: Lengths,
    extent_m: f64,
}

/// The frames near `frames` with the least sum of squares over all robots and shared nodes, with outliers left out by Tukey's
/// biweight. The frame of the first robot stays. Returns also how each robot's map agrees with it.
pub(super) fn refine(
    maps: &[OwnMap],
    frames: Vec<Option<FrameChange>>,
    lengths: Lengths,
) -> (Vec<Option<FrameChange>>, Vec<Agreement>) {
    let mut graph = PoseGraph::new(maps, frames, lengths);
    let mut deviation = 0.0;
    for round in 0..ROUNDS {
        if round < SCALE_ROUNDS {
            deviation = graph.deviation();
        }
        graph.trust(deviation);
        let Some(step) = graph.step() else { break };
        if graph.advance(&step) <= 1e-12 * graph.extent_m {
            break;
        }
    }
    graph.trust(deviation);
    let agreements = graph.agreements(maps.len());
    (graph.frames, agreements)
}

impl PoseGraph {
    fn new(maps: &[OwnMap], frames: Vec<Option<FrameChange>>, lengths: Lengths) -> Self {
        let mut nodes: BTreeMap<NodeId, Vec<Observation>> = BTreeMap::new();
        for (robot, (map, _)) in maps.iter().zip(&frames).enumerate().filter(|(_, (_, frame))| frame.is_some()) {
            for node in &map.nodes {
                let seen = Observation { robot, place: node.place, variance: node.variance, trust: 1.0 };
                nodes.entry(node.node).or_default().push(seen);
            }
        }
        let nodes: Vec<Vec<Observation>> = nodes.into_values().filter(|seen| seen.len() > 1).collect();
        let places = nodes.iter().flatten().map(|seen| seen.place);
        let extent_m = sextant_channel::Bounds::of(places).map_or(0.0, |bounds| level_m(bounds.max - bounds.min));
        Self { nodes, frames, lengths, extent_m }
    }

    /// Where an observation is in the common frame.
    fn seen_at(&self, seen: &Observation) -> Vector3<f64> {
        let frame = self.frames[seen.robot].unwrap_or(FrameChange::NONE);
        vector(frame.apply(seen.place))
    }

    /// Where all observations of a node together have it, and the sum of their weights; `None` if none is trusted.
    fn middle(&self, node: &[Observation]) -> Option<(Vector3<f64>, f64)> {
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

    /// Number of unknowns of a frame: its shift, its turn, and its scale if it has one.
    fn unknowns(&self) -> usize {
        match self.lengths {
            Lengths::Kept => 4,
            Lengths::Scaled => 5,
        }
    }

    /// How the place of an observation changes with each unknown of its frame.
    fn slopes(&self, seen: &Observation) -> Vec<Vector3<f64>> {
        let offset = self.frames[seen.robot].map_or(Position::ORIGIN, |frame| frame.offset);
        let arm = self.seen_at(seen) - vector(offset);
        let mut slopes = vec![Vector3::x(), Vector3::y(), Vector3::z(), Vector3::new(-arm.y, arm.x, 0.0)];
        if self.lengths == Lengths::Scaled {
            slopes.push(arm);
        }
        slopes
    }

    /// The step of Gauss and Newton for all frames but the first, with the places of the nodes eliminated (Schur's
    /// complement); `None` if the nodes do not tell all frames.
    fn step(&self) -> Option<DVector<f64>> {
        let unknowns = self.unknowns();
        let size = unknowns * self.frames.len().saturating_sub(1);
        let mut normal = DMatrix::zeros(size, size);
        let mut gradient = DVector::zeros(size);
        let first = |robot: usize| robot.checked_sub(1).map(|robot| robot * unknowns);
        for node in &self.nodes {
            let Some((middle, total)) = self.middle(node) else { continue };
            let slopes: Vec<Vec<Vector3<f64>>> = node.iter().map(|seen| self.slopes(seen)).collect();
            for (a, seen) in node.iter().enumerate() {
                let Some(row) = first(seen.robot) else { continue };
                let apart = self.seen_at(seen) - middle;
                for (i, slope) in slopes[a].iter().enumerate() {
                    gradient[row + i] += weight(seen) * slope.dot(&apart);
                }
                for (b, other) in node.iter().enumerate() {
                    let Some(column) = first(other.robot) else { continue };
                    let own = if a == b { weight(seen) } else { 0.0 };
                    let share = own - weight(seen) * weight(other) / total;
                    for (i, slope) in slopes[a].iter().enumerate() {
                        for (j, other) in slopes[b].iter().enumerate() {
                            normal[(row + i, column + j)] += share * slope.dot(other);
                        }
                    }
                }
            }
        }
        for robot in (1..self.frames.len()).filter(|&robot| self.frames[robot].is_none()) {
            let row = (robot - 1) * unknowns;
            (row..row + unknowns).for_each(|at| normal[(at, at)] = 1.0);
        }
        normal.cholesky().map(|solver| solver.solve(&gradient))
    }

    /// Goes against `step`. Returns how far an observation moves at most (m).
    fn advance(&mut self, step: &DVector<f64>) -> f64 {
        let before: Vec<Vector3<f64>> = self.nodes.iter().flatten().map(|seen| self.seen_at(seen)).collect();
        let unknowns = self.unknowns();
        for (robot, frame) in self.frames.iter_mut().enumerate().skip(1) {
            let Some(frame) = frame else { continue };
            let at = (robot - 1) * unknowns;
            frame.offset = frame.offset - Position::new(step[at], step[at + 1], step[at + 2]);
            frame.turn_rad -= step[at + 3];
            if unknowns > 4 {
                frame.scale *= libm::exp(-step[at + 4]);
            }
        }
        let after = self.nodes.iter().flatten().map(|seen| self.seen_at(seen));
        before.iter().zip(after).map(|(before, after)| (after - before).norm()).fold(0.0, f64::max)
    }

    /// How the map of each robot agrees with those of the others.
    fn agreements(&self, robots: usize) -> Vec<Agreement> {
        let mut agreements = vec![Agreement::default(); robots];
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

fn weight(seen: &Observation) -> f64 {
    seen.trust / seen.variance
}

fn vector(place: Position) -> Vector3<f64> {
    Vector3::new(place.x_m, place.y_m, place.z_m)
}
