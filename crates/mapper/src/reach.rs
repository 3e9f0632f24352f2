//! How far nodes are heard, estimated from a log without a model.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;

/// Share of the nodes whose farthest stop is within the reach. The others may be outliers.
const COMMON: f64 = 0.95;

/// Where a node was heard.
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
    (0..log.node_count()).map(NodeId::from_index).filter_map(|node| heard_node(log, node)).collect()
}

fn heard_node(log: &ReceptionLog, node: NodeId) -> Option<HeardNode> {
    let heard = || {
        let receptions = log.of(node).iter().filter(|reception| reception.received > 0);
        receptions.map(|reception| (log.stops()[reception.stop as usize].position, reception.received))
    };
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
    Some(HeardNode {
        node,
        middle,
        farthest_m: heard().map(|(place, _)| place.distance_m(middle)).fold(0.0, f64::max),
        stops: u32::try_from(heard().count()).unwrap_or(u32::MAX),
        corners,
    })
}

/// The distance from the middle of the stops that heard a node to the farthest of them which 95 % of the nodes do not
/// exceed (m): about the range of the radios where the survey is larger than that, less where it is smaller. The usual
/// gap between stops if each node was heard at one place only, 1 m if there is no gap.
pub(crate) fn reach_m(log: &ReceptionLog, heard: &[HeardNode]) -> f64 {
    let mut farthest_m: Vec<f64> = heard.iter().map(|heard| heard.farthest_m).collect();
    farthest_m.sort_unstable_by(f64::total_cmp);
    let common = crate::lattice::whole(COMMON * farthest_m.len() as f64).min(farthest_m.len().saturating_sub(1));
    let reach_m = farthest_m.get(common).copied().unwrap_or(0.0);
    if reach_m > 0.0 { reach_m } else { gap_m(log).unwrap_or(1.0) }
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
