//! One map and its errors.

use serde::Serialize;
use sextant_mapper::{Concern, KnowledgeKind, Line, SectorDisplacement};

use super::distributed::DistributedSummary;
use super::judgement::Judgement;

/// One map and its errors.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MapSummary {
    /// Name of the map, if the scenario gives it one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Name of the algorithm, for example `ml-tm`.
    pub algorithm: String,
    /// The networks whose logs it uses, if the scenario names them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub networks: Vec<String>,
    /// The knowledge that the algorithm uses: `robot-receptions`, `anchors`, `anchor-rssi` and so on.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub knowledge: Vec<KnowledgeKind>,
    /// What the map was aligned to before it was measured: `none`, `anchors`, `truth` or `relative`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alignment: Option<AlignmentSummary>,
    /// Why no map was made, in words, if the robots heard or measured nothing that it could be made of.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_made: Option<String>,
    /// Nodes with a position.
    pub mapped: usize,
    /// Nodes without a position, because they were never heard.
    pub unmapped: usize,
    /// Mapped nodes for which several positions are equally likely.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ambiguous: Option<usize>,
    /// Mapped nodes for which no position agrees with all receptions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub infeasible: Option<usize>,
    /// Mapped nodes with the same position as another node.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coincident: Option<usize>,
    /// Mapped nodes whose true position is known, if it is not known of all nodes. Then errors, regions and neighbours are
    /// those of the nodes whose true position is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured: Option<usize>,
    /// `plane` if the map is measured in the plane of x and y, because the true positions have no heights.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured_in: Option<MeasuredIn>,
    /// `plane` if errors are in space and regions in the plane of x and y, because the map has nodes at a height that was not estimated,
    /// and the true ones are elsewhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub regions_in: Option<MeasuredIn>,
    /// Distance between mapped and true positions in the plane of x and y (m), if regions are in it and errors in space.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_error_in_plane_m: Option<ErrorSummary>,
    /// Distance between mapped and true positions (m), over the nodes whose position the map had to estimate: anchors do
    /// not count if the map uses them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_error_m: Option<ErrorSummary>,
    /// Distribution of the position error: pairs of a distance (m) and the share of the nodes to be located whose position is
    /// at most that far from the true one. Nodes without a position count as infinitely far.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_error_cdf: Option<[[f64; 2]; POSITION_ERRORS_M.len()]>,
    /// Mean distance between a node and the mean of its posterior under the true channel and obstacles (m), if it is known
    /// where the robots listened, and at which stops each node was heard. No map that uses nothing else can be much better;
    /// compare the position error with it. Absent if the map uses more, such as signal strengths or numbers of packets.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub posterior_bound_m: Option<f64>,
    /// Why there is no such bound, in words, for a map of what robots heard in a simulation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub posterior_bound_absent: Option<String>,
    /// Share of the mapped nodes whose true position is in their 95 % region, 0 to 1, if the map has such regions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coverage_95: Option<f64>,
    /// What the algorithm learned from the log in addition to the map: keys of its own.
    #[serde(flatten)]
    pub learned: LearnedSummary,
    /// Nodes whose position is unreliable, and why.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub concerns: Vec<ConcernSummary>,
    /// Nodes at the boundary of the searched area. They may be farther away, so their positions are unreliable.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub at_bound: Vec<String>,
    /// The heights at which an algorithm searched for nodes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heights: Option<HeightsSummary>,
    /// Position error after the best rotation, reflection, scale and shift (m).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub aligned_error_m: Option<ErrorSummary>,
    /// Position error after the best rotation, scale and shift, without a reflection (m).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub aligned_error_without_reflection_m: Option<ErrorSummary>,
    /// One-hop connectivity error: the first of `connectivity_errors`, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub connectivity_error: Option<f64>,
    /// Connectivity error and its variants, for each neighbourhood of the scenario.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub connectivity_errors: Vec<ConnectivitySummary>,
    /// Share of the neighbours on the map that are not neighbours in the world, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub false_neighbour_rate: Option<f64>,
    /// Why there is no connectivity error, in words, although the map is measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub connectivity_absent: Option<String>,
    /// Share of the pairs of nodes along lines of the network whose order differs on the map, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub topology_preservation_error: Option<f64>,
    /// Energy of the nodes by the message count of the thesis (J; eq. 3.17 to 3.19, and 5.9 and 5.10 for maps that the
    /// nodes compute). The energy of the simulated radios is in `gathering`, `discovery` and `distributed`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub message_energy_j: Option<f64>,
    /// The sectors that the map suggests, against the true ones. Absent if the nodes have no sectors.
    #[serde(flatten)]
    pub sectors: Option<SectorsSummary>,
    /// Distance between vertices of the grid (m).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grid_step_m: Option<f64>,
    /// Number of likelihoods computed, over all nodes and vertices.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vertices_evaluated: Option<u64>,
    /// How the nodes computed the map, and what it took, if they did it themselves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distributed: Option<DistributedSummary>,
    /// What a user should know before trusting the map, in sentences: those that are printed under the table, warnings first.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub judgement: Vec<Judgement>,
}

/// How far the sectors that a map suggests are from those that point to the neighbours.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SectorsSummary {
    /// Share of the nodes whose antenna would point 0, 1, .. sectors away from a neighbour if it followed the map: of each
    /// node, the median or mean over its neighbours on the ground.
    pub sector_displacement: Vec<f64>,
    /// Share of the ordered pairs of neighbours whose direction on the map is 0, 1, .. sectors away from the true one.
    pub sector_displacement_of_pairs: Vec<f64>,
    /// The pairs of neighbours.
    pub sector_pairs: SectorPairsSummary,
}

/// Ordered pairs of neighbours on the ground, both of them on the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SectorPairsSummary {
    /// Pairs that are compared.
    pub compared: u64,
    /// Pairs that are not compared, because one node stands on the other and there is no true bearing.
    pub without_bearing: u64,
    /// Pairs among those compared that the map has in one place on the ground. It then suggests the azimuth 0.
    pub without_bearing_on_map: u64,
}

impl From<&SectorDisplacement> for SectorsSummary {
    fn from(found: &SectorDisplacement) -> Self {
        let sector_pairs = SectorPairsSummary {
            compared: found.compared(),
            without_bearing: found.without_bearing,
            without_bearing_on_map: found.without_bearing_on_map,
        };
        Self { sector_displacement: found.shares(), sector_displacement_of_pairs: found.pair_shares(), sector_pairs }
    }
}

/// What an algorithm learned from a log in addition to the map.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LearnedSummary {
    /// The keys in the summary, in their order.
    #[serde(flatten)]
    pub keys: serde_json::Map<String, serde_json::Value>,
    /// The lines under the table.
    #[serde(skip)]
    pub lines: Vec<Line>,
}

/// Where a map is measured, if not in space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MeasuredIn {
    /// In the plane of x and y.
    Plane,
}

/// A node whose position is unreliable.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ConcernSummary {
    /// Name of the node.
    pub node: String,
    /// Why: `at-edge`, `unsettled`, `no-evidence`, `two-places` or `too-few`.
    pub concern: Concern,
}

/// The heights at which nodes were searched for, and why.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HeightsSummary {
    /// The lowest height (m).
    pub low_m: f64,
    /// The highest height (m); equal to the lowest one for a map in a plane.
    pub high_m: f64,
    /// Where the heights come from.
    pub from: HeightsSource,
    /// Difference between the highest and the lowest stop (m), if it is too small to estimate heights of nodes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uneven_m: Option<f64>,
}

/// Where the heights come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum HeightsSource {
    /// The settings of the map.
    Settings,
    /// The stops, which are in one plane or nearly so.
    Stops,
    /// The stops, which have different heights, and the range of the packets.
    Reach,
}

/// Statistics of an error (m).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ErrorSummary {
    /// Mean (m).
    pub mean: f64,
    /// Median (m).
    pub median: f64,
    /// 80th percentile (m).
    pub p80: f64,
    /// 90th percentile (m).
    pub p90: f64,
    /// 95th percentile (m).
    pub p95: f64,
    /// Maximum (m).
    pub max: f64,
}

/// Position errors of a node at which their distribution is given (m).
pub(crate) const POSITION_ERRORS_M: [f64; 15] =
    [0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0, 20.0];

/// Connectivity errors of a node at which their distribution is given.
pub(crate) const NODE_ERRORS: [f64; 11] = [0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.75, 1.0];

/// How well a map preserves the neighbours of each node.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ConnectivitySummary {
    /// Radius of the neighbourhood (m).
    pub neighbourhood_m: f64,
    /// Share of the neighbours that are outside the tolerance after the best affine map, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub connectivity_error: Option<f64>,
    /// The same with an ellipse from the end points of the lines that cross the network.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub connectivity_error_end_points: Option<f64>,
    /// The same with an ellipse for each node: the literal formula of the thesis, where it can be computed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub connectivity_error_per_node: Option<f64>,
    /// Share of the neighbours on the map that are not neighbours in the world.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub false_neighbour_rate: Option<f64>,
    /// Share of the nodes that lose at most a fifth of their neighbours, under the best affine map.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nodes_within_0_2: Option<f64>,
    /// Pairs of nodes that are neighbours on the map or in the world but not in both, divided by those in either.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub symmetric_loss: Option<f64>,
    /// Distribution of the connectivity error of the nodes: pairs of an error and the share of the nodes whose error is
    /// at most that. Nodes without neighbours do not count.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub node_error_cdf: Option<[[f64; 2]; NODE_ERRORS.len()]>,
}

/// What a map was aligned to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum AlignmentSummary {
    /// Nothing: the algorithm works in the coordinates of the robot or of the anchors.
    None,
    /// The anchors, by the similarity that fits them best.
    Anchors,
    /// The true positions of all nodes, by the similarity that fits them best. They are known in simulations only.
    Truth,
    /// Nothing, because the truth is unknown: the map has its own coordinates.
    Relative,
}
