//! One map and how good it is.

use serde::Serialize;
use sextant_mapper::KnowledgeKind;

/// One map and how good it is.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MapSummary {
    /// Name that the scenario gives the map, if it gives one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The algorithm, `ml-tm`.
    pub algorithm: String,
    /// What the algorithm uses: `robot-receptions`, `anchors`, `anchor-rssi` and so on.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub knowledge: Vec<KnowledgeKind>,
    /// What brought a map without a frame of its own into the world before it was measured: `none`, `anchors` or
    /// `truth`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alignment: Option<AlignmentSummary>,
    /// Nodes that have a place.
    pub mapped: usize,
    /// Nodes that have none, because they were never heard.
    pub unmapped: usize,
    /// Mapped nodes whose place is one of several equally likely ones.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ambiguous: Option<usize>,
    /// Mapped nodes for which no place explains all that was heard.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub infeasible: Option<usize>,
    /// Mapped nodes that share their place with another.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coincident: Option<usize>,
    /// Distance between mapped and true places, of the nodes whose place the map had to find: anchors do not count if it
    /// uses them (m).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_error_m: Option<ErrorSummary>,
    /// Mean distance between a node and the mean of its posterior under the true channel and obstacles of the
    /// simulation, which no map of this log can beat by much: the error is to be compared with it (m).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub posterior_bound_m: Option<f64>,
    /// Share of the mapped nodes that are within their 95 % region, if the map has such regions, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coverage_95: Option<f64>,
    /// The reception profile, if it was estimated from the log.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fitted_profile: Option<FittedProfileSummary>,
    /// What was estimated beside the map, if it is self-calibrated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calibration: Option<CalibrationSummary>,
    /// Nodes that might as well be farther away than they were sought, so that their places say little.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub at_bound: Vec<String>,
    /// At which heights nodes were sought, by an algorithm that has to search them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heights: Option<HeightsSummary>,
    /// The same after the best rotation, reflection, scale and shift (m).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub aligned_error_m: Option<ErrorSummary>,
    /// The same without a reflection (m).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub aligned_error_without_reflection_m: Option<ErrorSummary>,
    /// One-hop connectivity error: the first of `connectivity_errors`, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub connectivity_error: Option<f64>,
    /// Connectivity error at each neighbourhood asked for, and its variants.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub connectivity_errors: Vec<ConnectivitySummary>,
    /// Share of the neighbours in the map that are not neighbours in the world, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub false_neighbour_rate: Option<f64>,
    /// Share of the pairs of nodes along lines of the network that stand on the map in another order, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub topology_preservation_error: Option<f64>,
    /// Energy that the nodes spend by the thesis' count of messages (eq. 3.17 to 3.19) (J); what their radios took in the
    /// simulation is in `gathering` and `discovery`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub message_energy_j: Option<f64>,
    /// Share of receptions whose sector is 0, 1, .. sectors off.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sector_displacement: Vec<f64>,
    /// Distance between vertices of the grid (m).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grid_step_m: Option<f64>,
    /// Vertices at which a likelihood was computed, of all nodes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vertices_evaluated: Option<u64>,
}

/// A reception profile that was estimated from the log.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FittedProfileSummary {
    /// Rounds of the estimation.
    pub rounds: u32,
    /// Whether it converged.
    pub converged: bool,
    /// Distance from which on receptions are outliers (m).
    pub range_m: f64,
    /// Probability of a reception at 0, 1/8, 2/8, .. of the range.
    pub probability: Vec<f64>,
    /// Stops that were left out because the receiver was dead.
    pub dead_stops: Vec<u32>,
    /// Receptions that were left out because they came from far beyond the range.
    pub outliers: usize,
}

/// At which heights nodes were sought, and why.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HeightsSummary {
    /// The lowest height (m).
    pub low_m: f64,
    /// The highest height (m); the lowest one again for a map in a plane.
    pub high_m: f64,
    /// What says so.
    pub from: HeightsSource,
    /// How much the heights of the stops differ, if that is too little to tell heights of nodes (m).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uneven_m: Option<f64>,
}

/// What says at which heights nodes are sought.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum HeightsSource {
    /// The settings of the map.
    Settings,
    /// The stops, which are in one plane, or nearly.
    Stops,
    /// The stops, which have several heights, and how far packets reach.
    Reach,
}

/// What was estimated beside a self-calibrated map, and from which knowledge.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct CalibrationSummary {
    /// Rounds of the estimation.
    pub rounds: u32,
    /// Whether it converged; it did not if a node or the curve is at its bound.
    pub converged: bool,
    /// Distance beyond which less than one packet in a hundred arrives (m); absent if the log is too poor to tell a curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range_m: Option<f64>,
    /// Whether packets arrive even over the longest distance that the curve has, so that its range says little; absent if
    /// not.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub curve_at_bound: bool,
    /// Probability of a reception over a clear link at a stop of average efficiency at 0, 1/8, 2/8, .. of the range.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub probability: Vec<f64>,
    /// Least, lower quartile, median, upper quartile and highest efficiency of the stops.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub efficiency: Vec<f64>,
    /// Knowledge of obstacles that was used: `none`, `from_receptions`, or `from_log` (receptions, where the robot
    /// drove, and what it met).
    pub obstacle_knowledge: &'static str,
    /// Area that absorbs (m²); absent if no obstacles were sought, or none explains what was heard.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub absorbing_m2: Option<f64>,
}

/// How large an error is (m).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ErrorSummary {
    /// Mean (m).
    pub mean: f64,
    /// Median (m).
    pub median: f64,
    /// Nine in ten are at most this (m).
    pub p90: f64,
    /// Nineteen in twenty are at most this (m).
    pub p95: f64,
    /// The largest (m).
    pub max: f64,
}

/// Connectivity errors of a node at which its distribution is told.
pub const NODE_ERRORS: [f64; 11] = [0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.75, 1.0];

/// How well a map keeps who is whose neighbour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ConnectivitySummary {
    /// Radius of the neighbourhood (m).
    pub neighbourhood_m: f64,
    /// Neighbours outside the tolerance after the best affine map, over all neighbours: 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub connectivity_error: Option<f64>,
    /// The same with an ellipse from the end points of the lines that cross the network.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub connectivity_error_end_points: Option<f64>,
    /// The same with an ellipse for each node (the thesis' formula to the letter, as far as it can be computed).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub connectivity_error_per_node: Option<f64>,
    /// Share of the neighbours in the map that are not neighbours in the world.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub false_neighbour_rate: Option<f64>,
    /// Share of the nodes that have lost at most a fifth of their neighbours, under the best affine map.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nodes_within_0_2: Option<f64>,
    /// Neighbourships in the map or in the world but not in both, over those in either.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub symmetric_loss: Option<f64>,
    /// Distribution of the connectivity error of a node: pairs of an error and the share of the nodes with neighbours
    /// whose error is at most that.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub node_error_cdf: Option<[[f64; 2]; NODE_ERRORS.len()]>,
}

/// What a map was brought into the world by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum AlignmentSummary {
    /// Nothing: the algorithm works in the frame of robot or anchors.
    None,
    /// The similarity that fits the anchors best.
    Anchors,
    /// The similarity that fits the true places of all nodes best: nobody has these outside a simulation.
    Truth,
    /// Nothing could: the map is in a frame of its own.
    Relative,
}
