//! Whether a corrected path explains nodes that it was not corrected by: real drift moves all nodes, what walls and bodies do to
//! single links does not.

use sextant_channel::{Position, RangeSample, ReceptionLog};
use sextant_kernel::{NodeId, Watch};

use super::PathError;
use super::drive::{BelievedMap, EstimatedPath, KNOWN_M, by_ranges};
use super::packet_path::{PacketNodes, by_packets};
use super::report::{ContradictedPlace, HeldOut};
use crate::error::MapError;
use crate::posterior::LIKELY;
use crate::range_ml::{NodeBias, RangeMl, RangeMlConfig};

/// So many nodes are a few.
const FEW_NODES: usize = 8;

/// Estimates the path of the robots of `log` from their ranges or, without any, from what packets they heard where: odometry is taken
/// to be wrong by `odometry`. `known` are places of nodes, if some are known: with ranges, two fix the frame. Without them the first
/// pose is the frame.
///
/// Poses, places of nodes, biases, scales and drift are one problem, whose normal equations are eliminated along the chain of
/// poses. Ranges: it is climbed from the believed path under ever less noise. Packets: the places of nodes are integrated over grids,
/// and the share of packets that arrive over a distance is estimated again after each climb. How much of the drift and the
/// wander of odometry is real is chosen by the marginal likelihood; the scale is as unsure as `odometry` says. At last the path is estimated without each half of the nodes, or without each of a few
/// nodes. Only if what was found of those is clearly more probable on it than on the believed path, the path is moved: see [`PathFit::held_out`](super::PathFit).
///
/// # Errors
/// If the log has too few ranges or nodes, or `watch` ends the work.
pub fn estimate_path(
    log: &ReceptionLog,
    odometry: PathError,
    known: &[(NodeId, Position)],
    watch: &dyn Watch,
) -> Result<EstimatedPath, MapError> {
    if log.ranges().is_empty() {
        let nodes = PacketNodes::of(log)?;
        let whole = by_packets(log, &nodes, odometry, None, watch)?;
        let halves = nodes.halves();
        let mut gains = Vec::new();
        for (own, other) in [(&halves[0], &halves[1]), (&halves[1], &halves[0])] {
            let path = by_packets(log, own, odometry, Some(whole.fit.odometry), watch)?;
            let corrected = other.evidences(log, Some(&path), watch)?;
            let believed = other.evidences(log, None, watch)?;
            gains.extend(corrected.into_iter().zip(believed).map(|(corrected, believed)| corrected - believed));
        }
        return Ok(whole.held_to(Some(HeldOut::of_nodes(&gains))));
    }
    let believed = BelievedMap::of(log, watch)?;
    let whole = by_ranges(log, &believed, odometry, known, None, watch)?;
    let nodes = whole.nodes(log);
    let unknown: Vec<NodeId> =
        nodes.into_iter().filter(|node| !known.iter().any(|(known, _)| known == node)).collect();
    // Of a few nodes one is left out at a time.
    let folds = if unknown.len() <= FEW_NODES { unknown.len() } else { 2 };
    let mut gains = Vec::new();
    for fold in 0..folds {
        let is_left_out = |node| unknown.iter().position(|other| *other == node).is_some_and(|at| at % folds == fold);
        let own = with_ranges_of(log, |node| !is_left_out(node));
        if let Ok(path) = by_ranges(&own, &believed, odometry, known, Some(whole.fit.odometry), watch) {
            gains.extend(range_gain(&with_ranges_of(log, is_left_out), &path, watch)?);
        }
        watch.check()?;
    }
    let path = whole.held_to((!gains.is_empty()).then(|| HeldOut::of_parts(&gains)));
    path.checked(log, &believed, known, watch)
}

/// The same log with the ranges to some nodes alone.
fn with_ranges_of(log: &ReceptionLog, holds: impl Fn(NodeId) -> bool) -> ReceptionLog {
    let ranges: Vec<RangeSample> = log.ranges().iter().filter(|range| holds(range.node)).copied().collect();
    log.clone().with_ranges(ranges).unwrap_or_else(|error| unreachable!("a part of the ranges of a log: {error}"))
}

/// How much more probable the ranges of `log` are on `path` than on the believed one, with places and laws that suit each best;
/// `None` if they place no node.
fn range_gain(log: &ReceptionLog, path: &EstimatedPath, watch: &dyn Watch) -> Result<Option<f64>, MapError> {
    // Of one node, its own bias and that of all ranges are one.
    let config = RangeMlConfig { bias: NodeBias::Common, ..RangeMlConfig::default() };
    let by_ranges = RangeMl::try_from(config).expect("the defaults are valid");
    let (_, believed) = by_ranges.usual_map(log, watch)?;
    let (_, corrected) = by_ranges.usual_map(&path.log(log), watch)?;
    let (Some(believed), Some(corrected)) = (believed, corrected) else { return Ok(None) };
    let groups = believed.groups.min(corrected.groups) as f64;
    Ok(Some(groups * believed.worth.min(corrected.worth) * (corrected.log_density - believed.log_density)))
}

impl EstimatedPath {
    /// The known places that are not in the regions which ranges on the path give their nodes.
    pub(super) fn contradicted(
        &self,
        log: &ReceptionLog,
        known: &[(NodeId, Position)],
        watch: &dyn Watch,
    ) -> Result<Vec<ContradictedPlace>, MapError> {
        /// The square of the reach of a 95 % region, in standard deviations.
        const REACH: f64 = 2.0 * LIKELY;
        if known.is_empty() {
            return Ok(Vec::new());
        }
        let estimator = RangeMl::try_from(RangeMlConfig::default()).expect("the defaults are valid");
        let mut map = estimator.usual_map(&self.log(log), watch)?.0;
        self.widen(&mut map);
        let of = |&(node, place): &(NodeId, Position)| {
            let estimate = map.estimates[node.index()].as_ref().filter(|estimate| estimate.concern.is_none())?;
            let [[xx, xy, _], [_, yy, _], _] = estimate.covariance?;
            let (x, y) = (estimate.position.x_m - place.x_m, estimate.position.y_m - place.y_m);
            let apart_m = libm::hypot(x, y);
            let variance = (xx * x * x + 2.0 * xy * x * y + yy * y * y) / (apart_m * apart_m).max(f64::MIN_POSITIVE);
            let allowed_m = (REACH * (variance + KNOWN_M * KNOWN_M)).sqrt();
            (apart_m > allowed_m).then(|| ContradictedPlace {
                node: log.names()[node.index()].clone(),
                apart_m,
                allowed_m,
            })
        };
        Ok(known.iter().filter_map(of).collect())
    }

    /// The path, if nodes that were left out gain so much by it, and the believed one otherwise. Without gains it is the path, which
    /// nothing has checked.
    fn held_to(mut self, held_out: Option<HeldOut>) -> Self {
        self.fit.held_out = held_out;
        if !self.fit.is_moved() {
            self.fit.most_moved_m = 0.0;
            for pose in &mut self.poses {
                (pose.position, pose.turn_rad) = (pose.believed, 0.0);
            }
        }
        self
    }

    /// The nodes that were placed with the path.
    fn nodes(&self, log: &ReceptionLog) -> Vec<NodeId> {
        let number = |name: &String| log.names().iter().position(|other| other == name);
        self.fit.nodes.iter().filter_map(number).map(NodeId::from_index).collect()
    }
}
