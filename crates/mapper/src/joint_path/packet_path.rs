//! The path of odometry, corrected by packets.

use nalgebra::{DVector, Vector4};
use sextant_channel::ReceptionLog;
use sextant_kernel::{NodeId, Watch, Work};

use super::PathError;
use super::chain::Factor;
use super::climb::{Hill, Top, climb};
use super::drive::{EstimatedPath, PathPose};
use super::odometry::{FACTORS, Leg, Odometry, legs};
use super::packet_problem::{Heard, NodeGrid, PacketPoint, PacketProblem};
use super::reception_curve::ReceptionCurve;
use super::report::{LateClock, PathFit};
use crate::error::MapError;
use crate::log_facts::reach::{HeardNode, heard_nodes, reach_m};

/// At most so many nodes: those that most stops heard. Others hardly change a path.
const MOST_NODES: usize = 150;
/// Steps of a climb between new grids.
const STEPS: u32 = 6;
const LEAST_GAIN: f64 = 0.05;
/// Rounds in which only scale and drift are free, then those with all of the path, and the last ones with what the evidence chose.
const STIFF_ROUNDS: u32 = 4;
const ROUNDS: u32 = 10;
const LAST_ROUNDS: u32 = 3;
/// The wander of odometry of which only scale and drift are free.
const STIFF: f64 = 1e-3;
/// Rounds in which the curve of a path that stands is estimated.
const EVIDENCE_ROUNDS: u32 = 4;
/// Cells of a grid along an axis.
const CELLS: usize = 20;

/// The nodes by which a path is estimated.
#[derive(Clone, Debug)]
pub(super) struct PacketNodes {
    nodes: Vec<HeardNode>,
    /// How far nodes are heard (m).
    reach_m: f64,
}

impl PacketNodes {
    /// So many nodes tell a path, and whether it is better: three of each half.
    const LEAST: usize = 6;

    /// Those of `log` that were heard at three stops or more, at most [`MOST_NODES`].
    pub(super) fn of(log: &ReceptionLog) -> Result<Self, MapError> {
        let mut nodes = heard_nodes(log);
        let reach_m = reach_m(log, &nodes);
        nodes.retain(|node| node.stops >= 3);
        nodes.sort_by_key(|node| (std::cmp::Reverse(node.stops), node.node));
        nodes.truncate(MOST_NODES);
        if nodes.len() < Self::LEAST {
            return Err(MapError::Missing {
                algorithm: "estimate-path",
                what: "six nodes that were heard at three stops each, or measured ranges",
                remedy: "half of the nodes estimate a path, and the others tell whether it is better",
            });
        }
        Ok(Self { nodes, reach_m })
    }

    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Every second node, and the others.
    pub(super) fn halves(&self) -> [Self; 2] {
        [0, 1].map(|first| Self { nodes: self.nodes.iter().skip(first).step_by(2).copied().collect(), ..*self })
    }

    /// Logarithm of the marginal likelihood of what was heard of each node on a path, or on the believed one, with the curve that suits
    /// it best.
    pub(super) fn evidences(
        &self,
        log: &ReceptionLog,
        path: Option<&EstimatedPath>,
        watch: &dyn Watch,
    ) -> Result<Vec<f64>, MapError> {
        let drive = PacketDrive::of(log);
        let mut search = Search::new(log, self, &drive, PathError::default());
        if let Some(path) = path {
            for (pose, estimated) in search.point.poses.iter_mut().zip(&path.poses) {
                (pose[0], pose[1]) = (estimated.position.x_m, estimated.position.y_m);
            }
        }
        for _ in 0..EVIDENCE_ROUNDS {
            watch.check()?;
            search.refit(PathError::default());
        }
        let grids = search.grids();
        let problem = search.problem(&grids, PathError::default());
        let posteriors = problem.posteriors(&search.point.poses);
        let log_area = |area: &Area| libm::log((area.high[0] - area.low[0]) * (area.high[1] - area.low[1]));
        Ok(posteriors
            .iter()
            .zip(&search.areas)
            .map(|(posterior, area)| posterior.log_evidence + log_area(area))
            .collect())
    }
}

/// The path as odometry has it.
struct PacketDrive {
    /// The stops, robot by robot, in the order of time.
    order: Vec<usize>,
    legs: Vec<Leg>,
    firsts: Vec<(usize, [f64; 2])>,
}

impl PacketDrive {
    fn of(log: &ReceptionLog) -> Self {
        let mut order: Vec<usize> = (0..log.stops().len()).collect();
        order.sort_by_key(|&stop| (log.stops()[stop].robot, log.stops()[stop].time));
        let is_first = |at: usize| at > 0 && log.stops()[order[at - 1]].robot != log.stops()[order[at]].robot;
        let legs = legs(order.iter().enumerate().map(|(at, &stop)| (place(log, stop), is_first(at))));
        let firsts =
            (0..order.len()).filter(|&at| at == 0 || is_first(at)).map(|at| (at, place(log, order[at]))).collect();
        Self { order, legs, firsts }
    }
}

/// Estimates the path from packets: see [`super::estimate_path`]. At last, odometry is as wrong as the evidence says, or by `sure`.
pub(super) fn by_packets(
    log: &ReceptionLog,
    nodes: &PacketNodes,
    error: PathError,
    sure: Option<PathError>,
    watch: &dyn Watch,
) -> Result<EstimatedPath, MapError> {
    let drive = PacketDrive::of(log);
    let mut search = Search::new(log, nodes, &drive, error);
    watch.begin(Work {
        name: "estimate path",
        unit: "round",
        steps: u64::from(STIFF_ROUNDS + ROUNDS + LAST_ROUNDS) + FACTORS.len() as u64,
        operations: 0.0,
    });
    let stiff = PathError {
        heading_rad_per_root_m: error.heading_rad_per_root_m * STIFF,
        position_m_per_root_m: error.position_m_per_root_m * STIFF,
        ..error
    };
    for _ in 0..STIFF_ROUNDS {
        search.round(stiff, watch)?;
    }
    for round in 0..ROUNDS {
        // A path that hardly moves in a round has settled, once its grids are narrow.
        if search.round(error, watch)? && round > 2 {
            break;
        }
    }
    let chosen = match sure {
        Some(error) => error,
        None => search.chosen(error, watch)?,
    };
    let mut settled = false;
    for _ in 0..LAST_ROUNDS {
        settled = search.round(chosen, watch)?;
    }
    let Climbed { top, .. } = search.climbed(chosen, STEPS, watch)?;
    search.point = top.point.clone();
    search.take_scale_of_odometry();
    let top = Top { point: search.point, ..top };
    let odometry = Odometry { error: chosen, ..search.odometry };
    Ok(estimated(log, &drive, &nodes.nodes, &odometry, &top, settled))
}

impl EstimatedPath {
    /// The path as it is believed to be, because the packets are late by its clock.
    #[must_use]
    pub fn believed(log: &ReceptionLog, odometry: PathError, late: LateClock) -> Self {
        let drive = PacketDrive::of(log);
        let pose = |&stop: &usize| {
            let own = &log.stops()[stop];
            let [x, y] = place(log, stop);
            PathPose::of(own.robot, own.time, own.position, &Vector4::new(x, y, 0.0, 0.0), None)
        };
        let poses: Vec<PathPose> = drive.order.iter().map(pose).collect();
        let fit = PathFit {
            poses: poses.len(),
            nodes: Vec::new(),
            known_nodes: 0,
            length_m: drive.legs.iter().filter(|leg| !leg.is_jump).map(|leg| leg.length_m).sum(),
            odometry,
            scale: 0.0,
            scale_deviation: 0.0,
            drift_rad_per_m: 0.0,
            drift_deviation_rad_per_m: 0.0,
            ranges: None,
            most_moved_m: 0.0,
            held_out: None,
            contradicted: Vec::new(),
            framed: None,
            late_clock: Some(late),
            settled: true,
        };
        Self { poses, fit }
    }
}

fn place(log: &ReceptionLog, stop: usize) -> [f64; 2] {
    let position = log.stops()[stop].position;
    [position.x_m, position.y_m]
}

/// What was heard of each node, by pose.
struct Evidence<'a> {
    nodes: &'a [HeardNode],
    /// What the log says of a node at poses, by pose; the others heard nothing of one packet.
    heard: Vec<Vec<Heard>>,
}

impl<'a> Evidence<'a> {
    fn of(log: &ReceptionLog, nodes: &'a [HeardNode], order: &[usize]) -> Self {
        let mut pose_of = vec![0; order.len()];
        for (pose, &stop) in order.iter().enumerate() {
            pose_of[stop] = pose;
        }
        let of_node = |node: NodeId| {
            let mut heard: Vec<Heard> = log
                .of(node)
                .iter()
                .map(|reception| Heard {
                    pose: pose_of[reception.stop as usize],
                    received: f64::from(reception.received),
                    missed: f64::from(reception.sent - reception.received),
                })
                .collect();
            heard.sort_by_key(|heard| heard.pose);
            heard
        };
        Self { nodes, heard: nodes.iter().map(|node| of_node(node.node)).collect() }
    }

    /// All round the stops that heard each node.
    fn wide(&self, reach_m: f64) -> Vec<Area> {
        let area = |node: &HeardNode| {
            let [low, high] = node.corners;
            let out_m = 0.7 * reach_m;
            Area { low: [low[0] - out_m, low[1] - out_m], high: [high[0] + out_m, high[1] + out_m] }
        };
        self.nodes.iter().map(area).collect()
    }

    /// The grid of a node in a box, with what was heard of it at poses near there.
    fn grid(&self, node: usize, area: Area, poses: &[Vector4<f64>], end_m: f64) -> NodeGrid {
        let step = [0, 1].map(|axis| (area.high[axis] - area.low[axis]) / CELLS as f64);
        let places = (0..CELLS * CELLS).map(|cell| {
            let at = [cell % CELLS, cell / CELLS];
            [0, 1].map(|axis| area.low[axis] + (at[axis] as f64 + 0.5) * step[axis])
        });
        let is_near = |pose: &Vector4<f64>| {
            (0..2).all(|axis| pose[axis] > area.low[axis] - end_m && pose[axis] < area.high[axis] + end_m)
        };
        let mut known = self.heard[node].iter().peekable();
        let mut near = Vec::new();
        for (number, pose) in poses.iter().enumerate() {
            let told = known.next_if(|heard| heard.pose == number).copied();
            let heard = told.unwrap_or(Heard { pose: number, received: 0.0, missed: 1.0 });
            if is_near(pose) && heard.received + heard.missed > 0.0 {
                near.push(heard);
            }
        }
        NodeGrid { places: places.collect(), near }
    }
}

/// A rectangle.
#[derive(Clone, Copy, Debug)]
struct Area {
    low: [f64; 2],
    high: [f64; 2],
}

/// The search for the best path.
struct Search<'a> {
    point: PacketPoint,
    curve: ReceptionCurve,
    correlation: f64,
    /// Where each node may be.
    areas: Vec<Area>,
    evidence: Evidence<'a>,
    odometry: Odometry<'a>,
    reach_m: f64,
}

/// The end of a climb.
struct Climbed {
    top: Top<PacketPoint>,
    /// Logarithm of the marginal likelihood by Laplace's method, up to what all climbs with one curve have in common.
    log_evidence: Option<f64>,
}

impl<'a> Search<'a> {
    /// The search from the believed path.
    fn new(log: &ReceptionLog, nodes: &'a PacketNodes, drive: &'a PacketDrive, error: PathError) -> Self {
        let evidence = Evidence::of(log, &nodes.nodes, &drive.order);
        let pose = |&stop: &usize| {
            let [x, y] = place(log, stop);
            Vector4::new(x, y, 0.0, 0.0)
        };
        let after = 2 * nodes.len();
        Self {
            point: PacketPoint { poses: drive.order.iter().map(pose).collect(), border: DVector::zeros(after + 2) },
            curve: ReceptionCurve::wide(nodes.reach_m),
            correlation: 0.0,
            areas: evidence.wide(nodes.reach_m),
            evidence,
            odometry: Odometry {
                legs: &drive.legs,
                error,
                firsts: &drive.firsts,
                first_deviation: super::drive::FIRST,
                scale: after,
                drift: after + 1,
            },
            reach_m: nodes.reach_m,
        }
    }

    fn grids(&self) -> Vec<NodeGrid> {
        let poses = &self.point.poses;
        let grid = |(node, &area): (usize, &Area)| self.evidence.grid(node, area, poses, self.curve.end_m());
        self.areas.iter().enumerate().map(grid).collect()
    }

    fn problem<'b>(&'b self, grids: &'b [NodeGrid], error: PathError) -> PacketProblem<'b> {
        let odometry = Odometry { error, ..self.odometry };
        PacketProblem { odometry, grids, curve: &self.curve, correlation: self.correlation }
    }

    /// A climb from where the search is, which stays there.
    fn climbed(&self, error: PathError, steps: u32, watch: &dyn Watch) -> Result<Climbed, MapError> {
        let grids = self.grids();
        let problem = self.problem(&grids, error);
        let top = climb(&problem, self.point.clone(), steps, LEAST_GAIN, watch)?;
        let log_evidence = top.curvature.as_ref().map(|curvature| {
            let of_nodes = problem.log_determinant_of_nodes(&problem.system(&top.point));
            top.value + problem.odometry.log_widths() - 0.5 * (curvature.log_determinant - of_nodes)
        });
        Ok(Climbed { top, log_evidence })
    }

    /// Takes the path with as much error of odometry as the marginal likelihood prefers, and returns that.
    fn chosen(&mut self, error: PathError, watch: &dyn Watch) -> Result<PathError, MapError> {
        let mut best: Option<(f64, PathError, PacketPoint)> = None;
        for factor in FACTORS {
            let tried = error.wandering(factor);
            let Climbed { top, log_evidence } = self.climbed(tried, 2 * STEPS, watch)?;
            if let Some(log_evidence) = log_evidence
                && best.as_ref().is_none_or(|(best, ..)| log_evidence > *best)
            {
                best = Some((log_evidence, tried, top.point));
            }
            watch.advance(1);
        }
        Ok(best.map_or(error, |(_, chosen, point)| {
            self.point = point;
            chosen
        }))
    }

    /// Shrinks path and curve by what the path grew. Packets know no scale: a larger world with a curve that reaches farther is heard
    /// in the same way. A climb, in which the curve stands, cannot go back to the scale of odometry.
    fn take_scale_of_odometry(&mut self) {
        let &[(first, [x, y])] = self.odometry.firsts else { return };
        let scale = &mut self.point.border[self.odometry.scale];
        let larger = 1.0 + *scale;
        *scale = 0.0;
        assert_eq!(first, 0);
        for pose in &mut self.point.poses {
            (pose[0], pose[1]) = (x + (pose[0] - x) / larger, y + (pose[1] - y) / larger);
        }
        self.curve = self.curve.shrunk(larger);
    }

    /// Estimates the curve and the correlation of packets again, and lays grids round the nodes.
    fn refit(&mut self, error: PathError) {
        let grids = self.grids();
        let problem = self.problem(&grids, error);
        let (counts, correlation) = problem.counts(&self.point.poses);
        let posteriors = problem.posteriors(&self.point.poses);
        self.areas = posteriors
            .iter()
            .map(|posterior| {
                let (mean, out_m) = (posterior.mean(), 4.0 * posterior.spread_m() + self.reach_m / 8.0);
                Area { low: mean.map(|at| at - out_m), high: mean.map(|at| at + out_m) }
            })
            .collect();
        self.curve = self.curve.refitted(&counts);
        self.correlation = correlation;
    }

    /// A climb, after which the curve is estimated again and grids are laid round the nodes. Whether the path hardly moved.
    fn round(&mut self, error: PathError, watch: &dyn Watch) -> Result<bool, MapError> {
        let before = self.point.poses.clone();
        self.point = self.climbed(error, STEPS, watch)?.top.point;
        self.take_scale_of_odometry();
        self.refit(error);
        watch.advance(1);
        let moved_m =
            |(before, after): (&Vector4<f64>, &Vector4<f64>)| libm::hypot(after[0] - before[0], after[1] - before[1]);
        let most_m = before.iter().zip(&self.point.poses).map(moved_m).fold(0.0, f64::max);
        Ok(most_m < 0.05 * self.reach_m)
    }
}

fn estimated(
    log: &ReceptionLog,
    drive: &PacketDrive,
    nodes: &[HeardNode],
    odometry: &Odometry<'_>,
    top: &Top<PacketPoint>,
    settled: bool,
) -> EstimatedPath {
    let covariances = top.curvature.as_ref().map(Factor::covariances);
    let pose = |(at, (&stop, state)): (usize, (&usize, &Vector4<f64>))| {
        let own = &log.stops()[stop];
        let covariance = covariances.as_ref().map(|states| &states[at]);
        PathPose::of(own.robot, own.time, own.position, state, covariance)
    };
    let poses: Vec<PathPose> = drive.order.iter().zip(&top.point.poses).enumerate().map(pose).collect();
    let after = 2 * nodes.len();
    let deviation = |entry: usize| {
        let variance = |factor: &Factor| factor.covariance_of_border(entry, entry);
        top.curvature.as_ref().map_or(0.0, variance).max(0.0).sqrt()
    };
    let fit = PathFit {
        poses: poses.len(),
        nodes: nodes.iter().map(|node| log.names()[node.node.index()].clone()).collect(),
        known_nodes: 0,
        length_m: odometry.length_m(),
        odometry: odometry.error,
        scale: top.point.border[after],
        scale_deviation: deviation(after),
        drift_rad_per_m: top.point.border[after + 1],
        drift_deviation_rad_per_m: deviation(after + 1),
        ranges: None,
        most_moved_m: poses.iter().map(|pose| pose.position.distance_m(pose.believed)).fold(0.0, f64::max),
        held_out: None,
        contradicted: Vec::new(),
        framed: None,
        late_clock: None,
        settled: settled && covariances.is_some(),
    };
    EstimatedPath { poses, fit }
}
