//! The numbers of a map.

use std::sync::LazyLock;

use super::super::derived::{NEAR_LIMIT, NEAR_SCATTERING_EDGES, SCATTERING_EDGES};
use super::{Count, Joule, KnownMeasure, Made, MeanCount, Metre, Share, known};
use crate::summary::Unit::Degree;
use crate::summary::{NODE_ERRORS, POSITION_ERRORS_M};

/// Of any map.
pub(super) const MAP: &[KnownMeasure<'static>] = &[
    known("mapped", Count, "nodes with a place on the map"),
    known("unmapped", Count, "nodes without a place: never heard"),
    known("infeasible", Count, "nodes whose receptions agree with no place"),
    known("ambiguous", Count, "nodes with several places that are equally likely"),
    known("connectivity_error", Share, "connectivity error: pairs of neighbours lost, of those on the ground"),
    known("connectivity_errors.1.connectivity_error", Share, "connectivity error in the second neighbourhood"),
    known(
        "connectivity_errors.1.nodes_within_0_2",
        Share,
        "share of nodes that lose at most a fifth of their second neighbourhood",
    ),
    known("connectivity_errors.2.connectivity_error", Share, "connectivity error in the third neighbourhood"),
    known(
        "connectivity_errors.2.nodes_within_0_2",
        Share,
        "share of nodes that lose at most a fifth of their third neighbourhood",
    ),
    known(
        "connectivity_error_end_points",
        Share,
        "connectivity error with the ellipse of the lines across the network",
    ),
    known("connectivity_error_per_node", Share, "connectivity error with an ellipse for each node"),
    known("symmetric_loss", Share, "symmetric loss: 1 − F1 of the pairs of neighbours"),
    known("false_neighbour_rate", Share, "false neighbours: of the neighbours on the map"),
    known("position_error_m.mean", Metre, "mean position error: distance between mapped and true place"),
    known("position_error_m.median", Metre, "median of the position error"),
    known("position_error_m.p90", Metre, "90th percentile of the position error"),
    known("position_error_m.p95", Metre, "95th percentile of the position error"),
    known("position_error_m.max", Metre, "largest position error"),
    known("aligned_error_m.mean", Metre, "mean position error after alignment to the true places"),
    known("posterior_bound_m", Metre, "bound of the mean position error: the posterior under the true channel"),
    known("coverage_95", Share, "share of nodes whose true place is in their 95 % region"),
    known("vertices_evaluated", Count, "vertices evaluated: over all nodes"),
    known("topology_preservation_error", Share, "topology preservation error: pairs in rows whose order is reversed"),
    known("message_energy_j", Joule, "energy by the count of messages"),
    known("position_error_m.p80", Metre, "80th percentile of the position error"),
    known("sector_displacement.0", Share, "share of nodes with sector displacement 0"),
    known("sector_displacement.1", Share, "share of nodes with sector displacement 1"),
    known("sector_displacement.2", Share, "share of nodes with sector displacement 2"),
    known("sector_displacement.3", Share, "share of nodes with sector displacement 3"),
    known("sector_displacement.4", Share, "share of nodes with sector displacement 4"),
    known("sector_displacement_of_pairs.0", Share, "share of pairs of neighbours with sector displacement 0"),
    known("sector_displacement_of_pairs.1", Share, "share of pairs of neighbours with sector displacement 1"),
    known("sector_displacement_of_pairs.2", Share, "share of pairs of neighbours with sector displacement 2"),
    known("sector_displacement_of_pairs.3", Share, "share of pairs of neighbours with sector displacement 3"),
    known("sector_displacement_of_pairs.4", Share, "share of pairs of neighbours with sector displacement 4"),
    known("sector_pairs.without_bearing", Count, "pairs of neighbours without a bearing: one stands on the other"),
    known("nodes_within_0_2", Share, "share of nodes that lose at most a fifth of their neighbours"),
];

/// Of a map that nodes compute.
pub(super) const BY_NODES: &[KnownMeasure<'static>] = &[
    known("distributed.iterations", Count, "iterations: the last one with a change"),
    known("distributed.converged", Share, "converged: 1 if no placed node was bad at the end, and 0 if not"),
    known("distributed.bad", Count, "placed nodes with bad coordinates"),
    known("distributed.unplaced", Count, "nodes that found no place"),
    known("distributed.anchors.initial", Count, "anchors at the start"),
    known("distributed.anchors.new", Count, "nodes that became anchors"),
    known("distributed.anchors.gave_up", Count, "anchors that gave up"),
    known("distributed.anchors.without_directions", Count, "anchors without directions"),
    known("distributed.orientation_error_deg.mean", Degree, "mean orientation error of anchors"),
    known("distributed.messages.mean_per_node", MeanCount, "messages of a node: mean"),
    known("distributed.messages.octets", Count, "octets of all payloads"),
    known("distributed.frames_received_mean", MeanCount, "frames received by a node: mean"),
    known("distributed.mobile.heard_share", Share, "share of nodes that heard the mobile anchor"),
    known("distributed.mobile.stops_heard_mean", MeanCount, "stops of the mobile anchor heard by a node: mean"),
    known(
        "distributed.vertices_mean",
        MeanCount,
        "vertices evaluated by a node: mean over the nodes that computed a place",
    ),
    known("distributed.memory_octets.mean", MeanCount, "octets of memory of a node: mean"),
    known("distributed.radio_energy_j.total", Joule, "energy of the radios of all nodes"),
    known("distributed.radio_energy_j.mean", Joule, "energy of the radio of a node: mean"),
];

/// The distributions of the errors of a map: the shares of its nodes whose error is at most each limit.
pub(super) static DISTRIBUTIONS: LazyLock<Vec<Made>> = LazyLock::new(|| {
    let lost = NODE_ERRORS.iter().map(|limit| Made {
        path: format!("node_error_cdf_{limit}"),
        unit: Share,
        meaning: format!("share of nodes with a connectivity error of at most {limit}"),
    });
    let far = POSITION_ERRORS_M.iter().map(|limit_m| Made {
        path: format!("position_error_cdf_{limit_m}"),
        unit: Share,
        meaning: format!("share of nodes with a position error of at most {limit_m} m"),
    });
    lost.chain(far).collect()
});

/// Of a map that nodes compute: the position errors by the error of neighbour scattering.
pub(super) static SCATTERING: LazyLock<Vec<Made>> = LazyLock::new(|| {
    let up_to =
        [("nodes", Share, "share of nodes"), ("position_error_m.mean", Metre, "mean position error of nodes")];
    let up_to = up_to.into_iter().flat_map(|(what, unit, words)| {
        ["0.1", "0.2"].map(|edge| Made {
            path: format!("distributed.scattering_up_to_{edge}.{what}"),
            unit,
            meaning: format!("{words} with neighbour scattering up to {edge}"),
        })
    });
    let bins = [("mean", "mean"), ("p90", "90th percentile of the")].into_iter().flat_map(|(what, words)| {
        SCATTERING_EDGES.map(|edge| Made {
            path: format!("distributed.scattering_{edge}.position_error_m.{what}"),
            unit: Metre,
            meaning: format!("{words} position error, bin of neighbour scattering to {edge}"),
        })
    });
    let near = [("nodes", Share, "share of nodes"), ("position_error_m.mean", Metre, "mean position error")];
    let near = near.into_iter().flat_map(|(what, unit, words)| {
        NEAR_SCATTERING_EDGES.map(|edge| Made {
            path: format!("distributed.near_scattering_{edge}.{what}"),
            unit,
            meaning: format!("{words}, bin of near neighbour scattering to {edge}"),
        })
    });
    let halves = [("up_to", "up to"), ("above", "above")].map(|(name, words)| Made {
        path: format!("distributed.near_scattering_{name}_{NEAR_LIMIT}.position_error_m.mean"),
        unit: Metre,
        meaning: format!("mean position error of nodes with near neighbour scattering {words} {NEAR_LIMIT}"),
    });
    up_to.chain(bins).chain(near).chain(halves).collect()
});
