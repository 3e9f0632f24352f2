//! A map: where an algorithm places the nodes, and how sure that is.

use serde::Serialize;
use sextant_channel::Position;
use sextant_kernel::{NodeId, SimTime};
use sextant_mapper::TopologyMap;
use sextant_recording::Places;
use sextant_recording::messages::MappedNodeMessage;

use super::column::Column;
use super::frame::Frame;

/// A map.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Map {
    /// Its name: that of its algorithm, unless the scenario gives it one.
    pub name: String,
    /// The map at each instant at which it was written; the last one is the finished map.
    pub snapshots: Vec<Snapshot>,
    /// Distance of each node from its true place in the finished map (m); NaN where the node is not mapped, its true place
    /// is not known, or the map was told its place. Absent if no truth is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub errors_m: Option<Column>,
    /// How sure the places of the finished map are, if that is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub details: Option<NodeDetails>,
}

/// A map at an instant.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Snapshot {
    /// When it was written (s).
    pub time_s: f64,
    /// The mapped nodes.
    pub nodes: Column,
    /// Their coordinates (m).
    pub places_m: Column,
}

/// What a map knows of each node besides its place: one number a node of the log, NaN where there is none.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct NodeDetails {
    /// Natural logarithm of the highest likelihood.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub log_likelihood: Option<Column>,
    /// Places with that likelihood.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ties: Option<Column>,
    /// Covariance of the place (m²): xx, xy, xz, yy, yz, zz of each node.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub covariance_m2: Option<Column>,
}

impl Snapshot {
    /// These places at this instant.
    pub(super) fn of(time: SimTime, places: &Places, frame: &Frame) -> Self {
        Self {
            time_s: frame.seconds(time),
            nodes: Column::U32(places.keys().map(|node| node.0).collect()),
            places_m: frame.places(places.values().copied()),
        }
    }
}

impl NodeDetails {
    /// What a map that was computed just now knows.
    pub(super) fn of_map(map: &TopologyMap) -> Option<Self> {
        let details = Self {
            log_likelihood: column(map.estimates.iter().map(|estimate| estimate.as_ref()?.log_likelihood)),
            ties: column(map.estimates.iter().map(|estimate| {
                let estimate = estimate.as_ref()?;
                estimate.log_likelihood.map(|_| f64::from(estimate.ties))
            })),
            covariance_m2: covariances(map.estimates.iter().map(|estimate| {
                let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = estimate.as_ref()?.covariance?;
                Some([xx, xy, xz, yy, yz, zz])
            })),
        };
        (details != Self::default()).then_some(details)
    }

    /// What `nodes` nodes know that computed their places themselves.
    pub(super) fn of_nodes(messages: &[MappedNodeMessage], nodes: usize) -> Option<Self> {
        let mut by_node = vec![None; nodes];
        for message in messages {
            if let Some(slot) = by_node.get_mut(NodeId(message.node).index()) {
                *slot = Some(message);
            }
        }
        let details = Self {
            log_likelihood: column(by_node.iter().map(|node| node.as_ref()?.log_likelihood)),
            ties: column(by_node.iter().map(|node| {
                let node = node.as_ref()?;
                node.log_likelihood.map(|_| f64::from(node.ties))
            })),
            covariance_m2: covariances(by_node.iter().map(|node| {
                let node = node.as_ref()?;
                Some([
                    node.cov_xx_m2?,
                    node.cov_xy_m2?,
                    node.cov_xz_m2?,
                    node.cov_yy_m2?,
                    node.cov_yz_m2?,
                    node.cov_zz_m2?,
                ])
            })),
        };
        (details != Self::default()).then_some(details)
    }
}

/// The numbers, if there is at least one.
fn column(numbers: impl Iterator<Item = Option<f64>> + Clone) -> Option<Column> {
    let is_known = numbers.clone().any(|number| number.is_some());
    is_known.then(|| Column::reals(numbers.map(|number| number.unwrap_or(f64::NAN))))
}

/// The covariances, if there is at least one.
fn covariances(entries: impl Iterator<Item = Option<[f64; 6]>> + Clone) -> Option<Column> {
    let is_known = entries.clone().any(|entry| entry.is_some());
    is_known.then(|| Column::reals(entries.flat_map(|entry| entry.unwrap_or([f64::NAN; 6]))))
}

/// At a smaller distance (m) from the place that an anchor believes in, the map was given the place.
const TOLD_M: f64 = 1e-6;

/// The errors of `nodes` nodes on a map with these `places`: distances from the `truth` (m). A place that was told to the
/// map by an anchor does not count.
pub(super) fn errors(nodes: usize, places: &Places, truth: &Places, anchors: &Places) -> Option<Column> {
    let error = |node: NodeId| {
        let place = places.get(&node)?;
        let was_told = anchors.get(&node).is_some_and(|told: &Position| told.distance_m(*place) < TOLD_M);
        let error_m = truth.get(&node)?.distance_m(*place);
        (!was_told).then_some(error_m)
    };
    (!truth.is_empty())
        .then(|| Column::reals((0..nodes).map(|node| error(NodeId::from_index(node)).unwrap_or(f64::NAN))))
}
