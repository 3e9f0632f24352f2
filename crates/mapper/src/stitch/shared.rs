//! The map of one robot in its own frame, and the nodes that two of them share.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;

use crate::posterior::{Concern, Estimate};
use crate::topology_map::TopologyMap;

/// A node must be heard at this many stops for its place to count.
const LEAST_STOPS: usize = 3;
/// Variance of a place that one stop heard, if its map tells none; it falls with the number of such stops.
const PLAIN_VARIANCE: f64 = 1.0;
/// Least variance as a share of the usual one, so that no node decides alone.
const LEAST_SHARE: f64 = 0.1;

/// Where the map of one robot has a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedNode {
    /// The node.
    pub node: NodeId,
    /// Its place in the frame of the robot (m).
    pub place: Position,
    /// Its variance along an axis of the plane, relative to that of other nodes on the maps of a team.
    pub variance: f64,
    /// Covariance of x, y and z in that frame (m²), if the map claims one.
    pub covariance: Option<[[f64; 3]; 3]>,
}

/// The map of one robot in its own frame: the nodes with reliable places, in the order of their numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OwnMap {
    /// The nodes.
    pub nodes: Vec<PlacedNode>,
}

/// A node on two maps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SharedNode {
    pub(super) node: NodeId,
    /// Its places on both maps (m).
    pub(super) from: Position,
    pub(super) onto: Position,
    /// The sum of both variances.
    pub(super) variance: f64,
}

impl OwnMap {
    /// The reliable places of `map`, which was made from `log`.
    pub(super) fn of(map: &TopologyMap, log: &ReceptionLog) -> Self {
        let heard = |node: NodeId| log.of(node).iter().filter(|reception| reception.received > 0).count();
        let placed = |(node, estimate): (usize, &Option<Estimate>)| {
            let (node, estimate) = (NodeId::from_index(node), estimate.as_ref()?);
            let stops = heard(node);
            // A fit that did not settle moves all nodes a little in further rounds. That is no reason to leave them all out: how
            // well they fit, their residuals tell.
            let is_placed = matches!(estimate.concern, None | Some(Concern::Unsettled));
            let is_reliable = is_placed && !estimate.infeasible && stops >= LEAST_STOPS;
            let variance = match estimate.covariance {
                Some(covariance) => 0.5 * (covariance[0][0] + covariance[1][1]),
                None => PLAIN_VARIANCE / stops as f64,
            };
            let covariance = estimate.covariance;
            is_reliable.then_some(PlacedNode { node, place: estimate.position, variance, covariance })
        };
        let mut nodes: Vec<PlacedNode> = map.estimates.iter().enumerate().filter_map(placed).collect();
        let mut variances: Vec<f64> = nodes.iter().map(|node| node.variance).collect();
        variances.sort_by(f64::total_cmp);
        let usual = variances.get(variances.len() / 2).copied().unwrap_or(PLAIN_VARIANCE);
        let least = (LEAST_SHARE * usual).max(f64::MIN_POSITIVE);
        nodes.iter_mut().for_each(|node| node.variance = node.variance.max(least));
        Self { nodes }
    }

    /// The nodes on both maps.
    pub(super) fn shared_with(&self, other: &Self) -> Vec<SharedNode> {
        let mut others = other.nodes.iter().peekable();
        let shared = |own: &PlacedNode| {
            while others.next_if(|other| other.node < own.node).is_some() {}
            let other = others.next_if(|other| other.node == own.node)?;
            let variance = own.variance + other.variance;
            Some(SharedNode { node: own.node, from: own.place, onto: other.place, variance })
        };
        self.nodes.iter().filter_map(shared).collect()
    }
}
