//! How far nodes are heard, estimated from a log without a model.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;

/// Share of the nodes whose farthest stop is within the reach. The others may be outliers.
const COMMON: f64 = 0.95;

/// A reception is a gross error of the log if its stop is farther from the others that heard the node than this many
/// times the usual distance from them: the fix of a receiver that jumps, or a stop at the origin of the coordinates.
/// The farthest receptions of real links are a few times as far as usual ones.
const GROSS: f64 = 20.0;

/// Where a node was heard. Receptions that are gross errors do not count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HeardNode {
    pub(crate) node: NodeId,
    /// The middle of the stops that heard it, weighted by packets (m).
    pub(crate) middle: Position,
    /// Distance from the middle to the farthest of these stops (m).
    pub(crate) farthest_m: f64,
    /// Number of these stops.
    pub(crate) stops: u32,
    /// Corners of the box that holds these stops (m).
    pub(crate) corners: [[f64; 3]; 2],
}

/// The nodes that were heard, in the order of their numbers.
pub(crate) fn heard_nodes(log: &ReceptionLog) -> Vec<HeardNode> {
    let nodes = || (0..log.node_count()).map(NodeId::from_index);
    let centres: Vec<Option<Position>> = nodes().map(|node| centre(log, node)).collect();
    let usual_m = |(node, centre): (NodeId, &Option<Position>)| {
        let centre = (*centre)?;
        let mut distances_m: Vec<f64> = heard_at(log, node).map(|(place, _)| place.distance_m(centre)).collect();
        Some(median(&mut distances_m))
    };
    let mut usual_m: Vec<f64> = nodes().zip(&centres).filter_map(usual_m).filter(|&m| m > 0.0).collect();
    let gross_m = if usual_m.is_empty() { f64::INFINITY } else { GROSS * median(&mut usual_m) };
    nodes().zip(centres).filter_map(|(node, centre)| heard_node(log, node, centre?, gross_m)).collect()
}

/// The stops that heard a node, with the packets heard.
fn heard_at(log: &ReceptionLog, node: NodeId) -> impl Iterator<Item = (Position, u32)> + Clone {
    let receptions = log.of(node).iter().filter(|reception| reception.received > 0);
    receptions.map(|reception| (log.stops()[reception.stop as usize].position, reception.received))
}

/// Of the stops that heard a node, the one nearest to their median along each axis; `None` if none did.
fn centre(log: &ReceptionLog, node: NodeId) -> Option<Position> {
    let along = |axis: usize| {
        let mut values: Vec<f64> = heard_at(log, node).map(|(place, _)| <[f64; 3]>::from(place)[axis]).collect();
        if values.is_empty() { None } else { Some(median(&mut values)) }
    };
    let middle = Position::new(along(0)?, along(1)?, along(2)?);
    let nearest = heard_at(log, node).min_by(|a, b| a.0.distance_m(middle).total_cmp(&b.0.distance_m(middle)));
    nearest.map(|(place, _)| place)
}

fn heard_node(log: &ReceptionLog, node: NodeId, centre: Position, gross_m: f64) -> Option<HeardNode> {
    let heard = || heard_at(log, node).filter(|(place, _)| place.distance_m(centre) <= gross_m);
    let packets: f64 = heard().map(|(_, packets)| f64::from(packets)).sum();
    if packets <= 0.0 {
        return None;
    }
    let sum = heard().fold(Position::ORIGIN, |sum, (place, packets)| sum + place * f64::from(packets));
    let middle = sum * (1.0 / packets);
    let corners = heard().fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[low, high], (place, _)| {
        let place: [f64; 3] = place.into();
        [[0, 1, 2].map(|axis| low[axis].min(place[axis])), [0, 1, 2].map(|axis| high[axis].max(place[axis]))]
    });
    // The middle of several stops at one place may miss it by rounding.
    let is_one_place = corners[0].map(f64::to_bits) == corners[1].map(f64::to_bits);
    let farthest_m = heard().map(|(place, _)| place.distance_m(middle)).fold(0.0, f64::max);
    Some(HeardNode {
        node,
        middle,
        farthest_m: if is_one_place { 0.0 } else { farthest_m },
        stops: u32::try_from(heard().count()).unwrap_or(u32::MAX),
        corners,
    })
}

/// The distance from the middle of the stops that heard a node to the farthest of them which 95 % of the nodes do not
/// exceed, and at least one of several nodes does (m): about the range of the radios where the survey is larger than
/// that, less where it is smaller. The usual gap between stops if each node was heard at one place only, 1 m if there is
/// no gap.
pub(crate) fn reach_m(log: &ReceptionLog, heard: &[HeardNode]) -> f64 {
    known_reach_m(heard).or_else(|| gap_m(log)).unwrap_or(1.0)
}

/// Whether the log tells how far nodes are heard: nodes were heard at several places.
pub(crate) fn is_reach_known(heard: &[HeardNode]) -> bool {
    known_reach_m(heard).is_some()
}

fn known_reach_m(heard: &[HeardNode]) -> Option<f64> {
    let mut farthest_m: Vec<f64> = heard.iter().map(|heard| heard.farthest_m).collect();
    farthest_m.sort_unstable_by(f64::total_cmp);
    let most = farthest_m.len().saturating_sub(if farthest_m.len() > 2 { 2 } else { 1 });
    let common = crate::numerics::whole(COMMON * farthest_m.len() as f64).min(most);
    farthest_m.get(common).copied().filter(|&reach_m| reach_m > 0.0)
}

/// The median distance from a stop of a robot to its next one, of those that differ (m); `None` if no robot moved.
pub(crate) fn gap_m(log: &ReceptionLog) -> Option<f64> {
    let mut gaps: Vec<f64> = log.drives().map(|drive| drive.length_m()).filter(|&gap| gap > 0.0).collect();
    if gaps.is_empty() { None } else { Some(median(&mut gaps)) }
}

/// The median of `values`, of two middle values the upper one. There must be at least one value.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
