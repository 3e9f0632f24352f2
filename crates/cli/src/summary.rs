//! The results of a command as one JSON object: the contract that scripts rely on.
//!
//! Numbers are SI. A key that does not apply is absent. Keys may be added; these do not change. All but
//! [`Summary::timing`] is a function of scenario and seed alone.

use std::path::Path;

use serde::Serialize;
use sextant_mapper::KnowledgeKind;

use crate::commands::write_file;
use crate::diagnostic::Failure;

/// All results of a run or of a mapping.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Summary {
    /// What was run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scenario: Option<ScenarioSummary>,
    /// The simulation as a whole.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulation: Option<SimulationSummary>,
    /// What the robots gathered, and at what price.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gathering: Option<GatheringSummary>,
    /// What the nodes found out of each other before the survey, if a map needed it, and at what price.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub discovery: Option<DiscoverySummary>,
    /// The maps, in the order of the scenario.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub maps: Vec<MapSummary>,
    /// What was done with the maps.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub applications: Vec<ApplicationSummary>,
    /// What it cost on this machine: the only part that differs from run to run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub timing: Option<Timing>,
}

/// What was run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ScenarioSummary {
    /// Name of the scenario.
    pub name: String,
    /// Name of its file, without the folder.
    pub file: String,
    /// SHA-256 of all texts it was read from, `extends` first, `--set` last, in hexadecimal digits.
    pub sha256: String,
    /// Seed of all randomness.
    pub seed: u64,
    /// Version of this program.
    pub version: String,
}

/// The simulation as a whole.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SimulationSummary {
    /// Simulated time [s].
    pub sim_time_s: f64,
    /// Events that happened.
    pub events: u64,
    /// Nodes in the network.
    pub nodes: usize,
    /// Obstacles in the world.
    pub obstacles: usize,
}

/// What the robots gathered, and at what price.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct GatheringSummary {
    /// Places where robots listened.
    pub stops: usize,
    /// Distance driven, of all robots [m].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path_length_m: Option<f64>,
    /// From the start to the end of the last robot [s].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration_s: Option<f64>,
    /// Packets that nodes wanted to send.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub packets_offered: Option<u64>,
    /// Packets that went on air.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub packets_sent: Option<u64>,
    /// Packets that a robot received.
    pub packets_received: u64,
    /// Packets lost to other packets while a robot listened.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost_collision: Option<u64>,
    /// Packets given up because the channel was busy.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost_channel_access: Option<u64>,
    /// Packets too weak while a robot listened in range.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost_signal: Option<u64>,
    /// Packets replaced before they were sent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost_queue: Option<u64>,
    /// Packets sent beyond the radius of communication of all robots that listened.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub out_of_range: Option<u64>,
    /// Packets sent while no robot listened.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_listened: Option<u64>,
    /// Packets still on their way at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pending: Option<u64>,
    /// Energy that all nodes' radios took.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_j: Option<EnergySummary>,
    /// How each robot ended.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub robots: Vec<RobotSummary>,
    /// Whether the user ended the simulation early.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub interrupted: bool,
}

/// Energy that all nodes' radios took [J].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct EnergySummary {
    /// Transmitting [J].
    pub tx: f64,
    /// Receiving and listening [J].
    pub rx: f64,
    /// Idle or asleep [J].
    pub idle: f64,
}

/// What the nodes found out of each other before the survey.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct DiscoverySummary {
    /// All nodes broadcast hello packets.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub neighbours: Option<RoundSummary>,
    /// The anchors broadcast.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub anchors: Option<RoundSummary>,
}

/// One round of broadcasts.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RoundSummary {
    /// Nodes that broadcast.
    pub senders: usize,
    /// Packets that went on air.
    pub packets_sent: u64,
    /// Packets given up because the channel was busy.
    pub packets_unsent: u64,
    /// Pairs of a node and another that it heard.
    pub links: usize,
    /// From the start to the end of the last packet [s].
    pub duration_s: f64,
    /// Energy that all nodes' radios took, receivers always on.
    pub energy_j: EnergySummary,
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

/// What one robot did.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RobotSummary {
    /// Name of the robot.
    pub name: String,
    /// Places where it listened.
    pub stops: usize,
    /// Distance driven [m].
    pub path_length_m: f64,
    /// Why it finished: `complete`, `steps_exhausted`, `stuck`; absent if it was interrupted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ending: Option<&'static str>,
    /// When it had finished [s]; absent if it was interrupted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration_s: Option<f64>,
    /// Nodes that all robots together heard less often than this one was to hear each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unreached: Vec<String>,
}

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
    /// uses them [m].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_error_m: Option<ErrorSummary>,
    /// Mean distance between a node and the mean of its posterior under the true channel and obstacles of the
    /// simulation, which no map of this log can beat by much: the error is to be compared with it [m].
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
    /// The same after the best rotation, reflection, scale and shift [m].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub aligned_error_m: Option<ErrorSummary>,
    /// The same without a reflection [m].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub aligned_error_without_reflection_m: Option<ErrorSummary>,
    /// One-hop connectivity error: the first of `connectivity_errors`, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub connectivity_error: Option<f64>,
    /// Connectivity error at each neighbourhood asked for, and its variants.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub connectivity_errors: Vec<ConnectivitySummary>,
    /// Share of the neighbours in the map that are none in the world, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub false_neighbour_rate: Option<f64>,
    /// Share of the pairs of nodes along lines of the network that stand on the map in another order, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub topology_preservation_error: Option<f64>,
    /// Energy that the nodes spend by the thesis' count of messages (eq. 3.17 to 3.19) [J]; what their radios took in the
    /// simulation is in `gathering` and `discovery`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub message_energy_j: Option<f64>,
    /// Share of receptions whose sector is 0, 1, .. sectors off.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sector_displacement: Vec<f64>,
    /// Distance between vertices of the grid [m].
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
    /// Distance from which on receptions are outliers [m].
    pub range_m: f64,
    /// Probability of a reception at 0, 1/8, 2/8, .. of the range.
    pub probability: Vec<f64>,
    /// Stops that were left out because the receiver was dead.
    pub dead_stops: Vec<u32>,
    /// Receptions that were left out because they came from far beyond the range.
    pub outliers: usize,
}

/// What was estimated beside a self-calibrated map, and from which knowledge.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct CalibrationSummary {
    /// Rounds of the estimation.
    pub rounds: u32,
    /// Whether it converged.
    pub converged: bool,
    /// Distance beyond which less than one packet in a hundred arrives [m]; absent if the log is too poor to tell a curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range_m: Option<f64>,
    /// Probability of a reception over a clear link at a stop of average efficiency at 0, 1/8, 2/8, .. of the range.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub probability: Vec<f64>,
    /// Least, lower quartile, median, upper quartile and highest efficiency of the stops.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub efficiency: Vec<f64>,
    /// Knowledge of obstacles that was used: `none`, `from_receptions`, or `from_log` (receptions, where the robot
    /// drove, and what it met).
    pub obstacle_knowledge: &'static str,
    /// Area that absorbs [m²]; absent if no obstacles were sought, or none explains what was heard.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub absorbing_m2: Option<f64>,
}

/// How large an error is [m].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ErrorSummary {
    /// Mean [m].
    pub mean: f64,
    /// Median [m].
    pub median: f64,
    /// Nine in ten are at most this [m].
    pub p90: f64,
    /// Nineteen in twenty are at most this [m].
    pub p95: f64,
    /// The largest [m].
    pub max: f64,
}

/// How well a map keeps who is whose neighbour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ConnectivitySummary {
    /// Radius of the neighbourhood [m].
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
    /// Share of the neighbours in the map that are none in the world.
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
    pub node_error_cdf: Option<[[f64; 2]; 11]>,
}

/// What was done with a map.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ApplicationSummary {
    /// The algorithm.
    pub algorithm: String,
    /// Whether the target was captured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub captured: Option<bool>,
    /// How long it took [s].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_s: Option<f64>,
}

/// What it cost on this machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Timing {
    /// From start to end [s].
    pub wall_s: f64,
    /// Simulating and recording [s].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gather_s: Option<f64>,
    /// Mapping and measuring [s].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map_s: Option<f64>,
    /// Simulated events a second of `gather_s` [1/s].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub events_per_s: Option<f64>,
    /// Most memory in use at any time, where the system tells [B].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak_rss_bytes: Option<u64>,
}

impl Summary {
    /// The object as indented JSON with a line break at the end.
    ///
    /// # Errors
    /// Never for a summary that this program makes.
    pub fn to_json(&self) -> Result<String, Failure> {
        let json = serde_json::to_string_pretty(self);
        json.map(|text| text + "\n").map_err(|error| Failure::failed(format!("the summary is not JSON: {error}")))
    }

    /// Writes the object to the file at `path`.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Failure> {
        write_file(path, self.to_json()?.as_bytes())
    }

    /// The same without what differs from run to run: the form that a recording carries.
    #[must_use]
    pub fn without_timing(&self) -> Self {
        Self { timing: None, ..self.clone() }
    }
}

/// Most memory that this process has used so far [B]; `None` where the system does not tell.
#[must_use]
pub fn peak_rss_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_apply_is_absent() {
        assert_eq!(Summary::default().to_json().unwrap(), "{}\n");
        let map = MapSummary { algorithm: "ml-tm".into(), mapped: 3, ..MapSummary::default() };
        let json = Summary { maps: vec![map], ..Summary::default() }.to_json().unwrap();
        let json: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!(json, serde_json::json!({"maps": [{"algorithm": "ml-tm", "mapped": 3, "unmapped": 0}]}));
    }

    #[test]
    fn timing_can_be_left_out() {
        let summary = Summary { timing: Some(Timing { wall_s: 1.0, ..Timing::default() }), ..Summary::default() };
        assert_eq!(summary.without_timing(), Summary::default());
    }
}
