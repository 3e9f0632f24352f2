//! The path of odometry, corrected by ranges.

use nalgebra::{DVector, Matrix4, Vector4};
use sextant_channel::{Position, RangeErrorLaw, ReceptionLog};
use sextant_kernel::{NodeId, RobotId, SimTime, Watch};

use super::PathError;
use super::chain::Factor;
use super::climb::{Top, climb};
use super::drive_problem::{
    AFTER_NODES, DELAY, DRIFT, DrivePoint, DriveProblem, KnownPlace, ODOMETRY_SCALE, SCALE_OF_RANGES, after_nodes,
};
use super::keyframes::{Keyframe, Keyframes};
use super::odometry::{FACTORS, Odometry};
use super::report::{PathFit, PathRanges};
use crate::comparators::lateration::{Range, refine};
use crate::error::MapError;
use crate::posterior::Concern;
use crate::range_ml::error_law;
use crate::range_ml::{RangeMl, RangeMlConfig};
use crate::topology_map::TopologyMap;

/// Most steps of a climb, and the gain that ends it.
const STEPS: u32 = 80;
const LEAST_GAIN: f64 = 1e-3;
/// The noise of ranges in turn (m): with much of it, a wrong path looks straight ahead to the right one.
const NOISES_M: [f64; 4] = [3.0, 1.5, 0.8, 0.45];
/// Standard deviation of the bias of all ranges, of their scale and of the biases of nodes (m).
const BIAS_M: f64 = 3.0;
const SCALE: f64 = 0.05;
const NODE_BIAS_M: f64 = 0.1;
/// Standard deviation of how late ranges are by the clock of the path (s).
const DELAY_S: f64 = 0.15;
/// How well the first pose is known: it is the frame of the map, unless nodes are known (m, rad).
pub(super) const FIRST: [f64; 2] = [1e-3, 1e-4];
const FIRST_BY_NODES: [f64; 2] = [300.0, 3.0];
/// How well known places are known (m).
pub(super) const KNOWN_M: f64 = 0.02;

/// Where a robot was, by odometry and by the estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPose {
    /// The robot.
    pub robot: RobotId,
    /// When.
    pub time: SimTime,
    /// Where odometry has it (m).
    pub believed: Position,
    /// Where the estimate has it (m).
    pub position: Position,
    /// How far the frame of odometry is turned there, counterclockwise (rad).
    pub turn_rad: f64,
    /// Covariance of x and y (m²): relative to the first pose, or to the known nodes.
    pub covariance: [[f64; 2]; 2],
}

impl PathPose {
    /// The pose of a robot at a time, which is believed to be somewhere, with its estimated state and the covariance of that.
    pub(super) fn of(
        robot: RobotId,
        time: SimTime,
        believed: Position,
        state: &Vector4<f64>,
        covariance: Option<&Matrix4<f64>>,
    ) -> Self {
        let entry = |row, column| covariance.map_or(0.0, |covariance| covariance[(row, column)]);
        Self {
            robot,
            time,
            believed,
            position: Position::new(state[0], state[1], believed.z_m),
            turn_rad: state[2],
            covariance: [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]],
        }
    }
}

/// A path that was estimated with the places of nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimatedPath {
    /// The poses, robot by robot, in the order of time.
    pub poses: Vec<PathPose>,
    /// What was learned of odometry and ranges.
    pub fit: PathFit,
}

impl EstimatedPath {
    /// The same log with its stops, ranges and contacts on the estimated path.
    #[must_use]
    pub fn log(&self, log: &ReceptionLog) -> ReceptionLog {
        log.placed_again(|robot, time, position| self.place(robot, time, position))
    }

    /// Widens the regions of a map of the log on this path by how unsure the path is near each node: errors that neighbouring poses
    /// share move the node as well.
    pub fn widen(&self, map: &mut TopologyMap) {
        /// So many of the nearest poses are near a node.
        const NEAR: usize = 10;
        if !self.fit.is_moved() && self.fit.framed.is_none() {
            return;
        }
        for estimate in map.estimates.iter_mut().flatten() {
            let place = estimate.position;
            let Some(covariance) = &mut estimate.covariance else { continue };
            let mut poses: Vec<(f64, usize)> =
                self.poses.iter().map(|pose| pose.position.distance_m(place)).zip(0..).collect();
            let near = NEAR.min(poses.len());
            if near == 0 {
                continue;
            }
            poses.select_nth_unstable_by(near - 1, |a, b| a.0.total_cmp(&b.0));
            for &(_, pose) in &poses[..near] {
                for (row, of_pose) in covariance.iter_mut().zip(self.poses[pose].covariance) {
                    row.iter_mut().zip(of_pose).for_each(|(entry, of_pose)| *entry += of_pose / near as f64);
                }
            }
        }
    }

    /// Where a place is that odometry has at `position`, and how far its frame is turned there.
    fn place(&self, robot: RobotId, time: SimTime, position: Position) -> (Position, f64) {
        let from = self.poses.partition_point(|pose| (pose.robot, pose.time) <= (robot, time));
        let of_robot = |at: usize| self.poses.get(at).filter(|pose| pose.robot == robot);
        let Some(pose) = from.checked_sub(1).and_then(of_robot).or_else(|| of_robot(from)) else {
            return (position, 0.0);
        };
        let (sin, cos) = libm::sincos(pose.turn_rad);
        let apart = position - pose.believed;
        let turned = Position::new(cos * apart.x_m - sin * apart.y_m, sin * apart.x_m + cos * apart.y_m, apart.z_m);
        (pose.position + turned, pose.turn_rad)
    }
}

/// The nodes by ranges on the believed path.
pub(super) struct BelievedMap {
    pub(super) map: TopologyMap,
    /// How late the ranges are by its law (s).
    delay_s: f64,
}

impl BelievedMap {
    pub(super) fn of(log: &ReceptionLog, watch: &dyn Watch) -> Result<Self, MapError> {
        let estimator = RangeMl::try_from(RangeMlConfig::default()).expect("the defaults are valid");
        let (map, fit) = estimator.usual_map(log, watch)?;
        Ok(Self { map, delay_s: fit.map_or(0.0, |fit| fit.delay_s) })
    }
}

/// Estimates the path from ranges: see [`super::estimate_path`]. The search starts with the places of `believed`. At last, odometry is
/// as wrong as the evidence says, or by `sure`: then the search has one start.
pub(super) fn by_ranges(
    log: &ReceptionLog,
    believed: &BelievedMap,
    odometry: PathError,
    known: &[(NodeId, Position)],
    sure: Option<PathError>,
    watch: &dyn Watch,
) -> Result<EstimatedPath, MapError> {
    const ALGORITHM: &str = "estimate-path";
    let missing = MapError::Missing {
        algorithm: ALGORITHM,
        what: "measured ranges to two nodes or more that agree on places",
        remedy: "they stand in `ranges.csv` beside the path, each with its time",
    };
    let mut nodes = vec![None; log.node_count()];
    let (mut starts, mut places) = (Vec::new(), Vec::<KnownPlace>::new());
    let mut ids = Vec::new();
    for (number, estimate) in believed.map.estimates.iter().enumerate() {
        let node = NodeId::from_index(number);
        let place = known.iter().find(|(known, _)| *known == node).map(|&(_, place)| place);
        let told = estimate
            .as_ref()
            .filter(|estimate| estimate.concern != Some(Concern::TooFew) && !log.ranges_to(node).is_empty());
        let Some(start) = place.or(told.map(|estimate| estimate.position)) else { continue };
        nodes[number] = Some(starts.len());
        starts.push(start);
        ids.push(node);
        places.push(place.map(|place| ([place.x_m, place.y_m], KNOWN_M)));
    }
    if starts.len() < 2 {
        return Err(missing);
    }
    let heights: Vec<f64> = starts.iter().map(|start| start.z_m).collect();
    let keyframes = Keyframes::of(log, &nodes, &heights);
    if keyframes.frames.len() < 3 {
        return Err(missing);
    }
    let firsts = keyframes.firsts();
    let is_fixed_by_nodes = places.iter().flatten().count() >= 2;
    let problem = DriveProblem {
        odometry: Odometry {
            legs: &keyframes.legs,
            error: odometry,
            firsts: &firsts,
            first_deviation: if is_fixed_by_nodes { FIRST_BY_NODES } else { FIRST },
            scale: after_nodes(places.len(), ODOMETRY_SCALE),
            drift: after_nodes(places.len(), DRIFT),
        },
        ranges: &keyframes.ranges,
        known: &places,
        law: RangeErrorLaw::of([0.0; 4]),
        worth: 1.0,
        node_bias_m: NODE_BIAS_M,
        bias_m: BIAS_M,
        scale: SCALE,
        delay_s: DELAY_S,
    };
    // Two starts: the places and the delay that suit the believed path best by the law of ranges, and those of plain least squares.
    let plain: Vec<Position> = (0..starts.len()).map(|node| least_squares(&keyframes, node, starts[node])).collect();
    let mut best: Option<(DriveProblem<'_>, Top<DrivePoint>)> = None;
    for (starts, delay_s) in
        [(&starts, believed.delay_s), (&plain, 0.0)].into_iter().take(if sure.is_some() { 1 } else { 2 })
    {
        let (problem, top) = annealed(problem.clone(), &keyframes, starts, delay_s, watch)?;
        if best.as_ref().is_none_or(|(_, best)| top.value > best.value) {
            best = Some((problem, top));
        }
    }
    let (problem, start) = best.expect("there are two starts");
    let errors = sure.map_or_else(|| FACTORS.map(|factor| odometry.wandering(factor)).to_vec(), |sure| vec![sure]);
    let (problem, top) = chosen(problem, start, &errors, watch)?;
    Ok(estimated(&keyframes, &problem, &top, log, &ids))
}

/// The place of a node by least squares on the believed path.
fn least_squares(keyframes: &Keyframes, node: usize, start: Position) -> Position {
    let ranges: Vec<Range> = keyframes
        .ranges
        .iter()
        .filter(|range| range.node == node)
        .map(|range| {
            let place = keyframes.frames[range.pose].position + Position::new(range.offset[0], range.offset[1], 0.0);
            Range::new(place, range.range_m)
        })
        .collect();
    refine(start, &ranges, 2)
}

/// Climbs from the believed path with ever less noise, then with the law that the errors have.
fn annealed<'a>(
    mut problem: DriveProblem<'a>,
    keyframes: &Keyframes,
    starts: &[Position],
    delay_s: f64,
    watch: &dyn Watch,
) -> Result<(DriveProblem<'a>, Top<DrivePoint>), MapError> {
    let pose = |frame: &Keyframe| Vector4::new(frame.position.x_m, frame.position.y_m, 0.0, 0.0);
    let border = starts.iter().flat_map(|start| [start.x_m, start.y_m, 0.0]).chain([0.0; AFTER_NODES]);
    let mut point = DrivePoint {
        poses: keyframes.frames.iter().map(pose).collect(),
        border: DVector::from_iterator(3 * starts.len() + AFTER_NODES, border),
    };
    point.border[after_nodes(starts.len(), DELAY)] = delay_s;
    for noise_m in NOISES_M {
        problem.law = error_law::noisy(noise_m);
        point = climb(&problem, point, STEPS, LEAST_GAIN, watch)?.point;
    }
    let mut top = None;
    for _ in 0..2 {
        let errors = problem.errors_m(&point);
        problem.law = error_law::of_errors(&errors);
        let of_nodes = problem.ranges.iter().map(|range| range.node);
        problem.worth = error_law::worth(problem.known.len(), of_nodes.zip(errors));
        let found = climb(&problem, point, STEPS, LEAST_GAIN, watch)?;
        point = found.point.clone();
        top = Some(found);
    }
    Ok((problem, top.expect("there were rounds")))
}

/// The climb with that of these errors of odometry which the marginal likelihood prefers.
fn chosen<'a>(
    problem: DriveProblem<'a>,
    start: Top<DrivePoint>,
    errors: &[PathError],
    watch: &dyn Watch,
) -> Result<(DriveProblem<'a>, Top<DrivePoint>), MapError> {
    let mut best: Option<(f64, DriveProblem<'a>, Top<DrivePoint>)> = None;
    for &error in errors {
        let prior = Odometry { error, ..problem.odometry };
        let tried = DriveProblem { odometry: prior, ..problem.clone() };
        let top = climb(&tried, start.point.clone(), STEPS, LEAST_GAIN, watch)?;
        let Some(curvature) = &top.curvature else { continue };
        let log_evidence = top.value + tried.odometry.log_widths() - 0.5 * curvature.log_determinant;
        if best.as_ref().is_none_or(|(best, ..)| log_evidence > *best) {
            best = Some((log_evidence, tried, top));
        }
    }
    Ok(best.map_or((problem, start), |(_, problem, top)| (problem, top)))
}

fn estimated(
    keyframes: &Keyframes,
    problem: &DriveProblem<'_>,
    top: &Top<DrivePoint>,
    log: &ReceptionLog,
    ids: &[NodeId],
) -> EstimatedPath {
    let covariances = top.curvature.as_ref().map(Factor::covariances);
    let pose = |(at, (frame, state)): (usize, (&Keyframe, &Vector4<f64>))| {
        let covariance = covariances.as_ref().map(|states| &states[at]);
        PathPose::of(frame.robot, frame.time, frame.position, state, covariance)
    };
    let poses: Vec<PathPose> = keyframes.frames.iter().zip(&top.point.poses).enumerate().map(pose).collect();
    let border = &top.point.border;
    let after = 3 * problem.known.len();
    let covariance = |of: usize, with: usize| {
        top.curvature.as_ref().map_or(0.0, |factor| factor.covariance_of_border(after + of, after + with))
    };
    let deviation = |which: usize| covariance(which, which).max(0.0).sqrt();
    let of_both = covariance(SCALE_OF_RANGES, SCALE_OF_RANGES)
        + covariance(ODOMETRY_SCALE, ODOMETRY_SCALE)
        + 2.0 * covariance(SCALE_OF_RANGES, ODOMETRY_SCALE);
    let moved = poses.iter().map(|pose| pose.position.distance_m(pose.believed));
    let fit = PathFit {
        poses: poses.len(),
        nodes: ids.iter().map(|node| log.names()[node.index()].clone()).collect(),
        known_nodes: problem.known.iter().flatten().count(),
        length_m: problem.odometry.length_m(),
        odometry: problem.odometry.error,
        scale: border[after + ODOMETRY_SCALE],
        scale_deviation: deviation(ODOMETRY_SCALE),
        drift_rad_per_m: border[after + DRIFT],
        drift_deviation_rad_per_m: deviation(DRIFT),
        ranges: Some(PathRanges {
            bias_m: border[after],
            scale: border[after + SCALE_OF_RANGES],
            scale_deviation: deviation(SCALE_OF_RANGES),
            longer_than_odometry: border[after + SCALE_OF_RANGES] + border[after + ODOMETRY_SCALE],
            longer_deviation: of_both.max(0.0).sqrt(),
            delay_s: border[after + DELAY],
            delay_deviation_s: deviation(DELAY),
        }),
        most_moved_m: moved.fold(0.0, f64::max),
        held_out: None,
        contradicted: Vec::new(),
        framed: None,
        late_clock: None,
        settled: top.settled && covariances.is_some(),
    };
    EstimatedPath { poses, fit }
}
