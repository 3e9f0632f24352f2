//! All results of a command.

use std::path::Path;

use serde::Serialize;

use super::battery::BatterySummary;
use super::gathering::{DiscoverySummary, GatheringSummary};
use super::mac::MacSummary;
use super::map::MapSummary;
use super::missions::MissionSummary;
use super::routing::RoutingSummary;
use super::sensing::SensingSummary;
use super::timing::Timing;
use super::tracks::TrackSummary;
use sextant_recording::output::{OutputError, write_file};

/// All results of a run or of a mapping.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Summary {
    /// The scenario.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scenario: Option<ScenarioSummary>,
    /// The simulation as a whole.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulation: Option<SimulationSummary>,
    /// The survey: packets, paths and energy.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gathering: Option<GatheringSummary>,
    /// The traffic, if there are sinks; that of the first network if there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mac: Option<MacSummary>,
    /// The traffic in the networks after the first one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub other_networks: Vec<MacSummary>,
    /// The packets that went over several hops, if they did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub routing: Option<RoutingSummary>,
    /// The batteries of the nodes, if they have any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub battery: Option<BatterySummary>,
    /// What the sensors of the nodes said, if there are targets or fields.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensing: Option<SensingSummary>,
    /// What went wrong, if the scenario has nodes that die or anchors that lie.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub faults: Option<FaultsSummary>,
    /// Discovery before the survey, if a map needed it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub discovery: Option<DiscoverySummary>,
    /// Whether the user interrupted the work, so that maps are missing. Absent if not.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub interrupted: bool,
    /// What the user should know of the log and of the truth that it was compared with, in sentences.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// The estimated path, if it was estimated with the places of nodes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<serde_json::Value>,
    /// The maps, in the order of the scenario.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub maps: Vec<MapSummary>,
    /// The tracks of tags, by name.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tracks: Vec<TrackSummary>,
    /// The applications, in the order of the scenario.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub applications: Vec<MissionSummary>,
    /// Time and memory on this machine: the only part that differs from run to run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub timing: Option<Timing>,
}

/// What went wrong.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct FaultsSummary {
    /// Names of the nodes that died, in the order of their deaths. Absent if none can die.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deaths: Option<Vec<String>>,
    /// Names of the anchors that lied, by node. Absent if none can lie.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lying_anchors: Option<Vec<String>>,
}

/// The scenario of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ScenarioSummary {
    /// Name of the scenario.
    pub name: String,
    /// Name of its file, without the folder.
    pub file: String,
    /// SHA-256 of the text of the scenario, in hexadecimal digits. This is the text of the file or, if the file extends
    /// another one or flags override it, the text of the merged settings. A recording contains it as the attachment
    /// `scenario.toml`. The value of `--seed` and the files that the scenario names are not part of it.
    pub sha256: String,
    /// Seed of all randomness.
    pub seed: u64,
    /// Version of this program.
    pub version: String,
}

/// The simulation as a whole.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SimulationSummary {
    /// Simulated time (s).
    pub sim_time_s: f64,
    /// Number of events.
    pub events: u64,
    /// Nodes in the network.
    pub nodes: usize,
    /// Nodes that move, if any does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moving_nodes: Option<usize>,
    /// Obstacles in the world.
    pub obstacles: usize,
    /// Which part of the nodes' traffic was simulated. Absent if all, as the scenario asks for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub region: Option<RegionSummary>,
}

/// Which part of the nodes' traffic was simulated.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RegionSummary {
    /// `listeners` if nodes far from all listeners rested, or `all`.
    pub simulated: &'static str,
    /// Why all was simulated. Absent if not all was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub because: Option<&'static str>,
    /// Radius round each listener within which all nodes were simulated (m). Absent if all was simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub halo_m: Option<f64>,
    /// Share of the packets that were due which was simulated.
    pub share: f64,
}

impl Summary {
    /// The object as indented JSON that ends with a line break.
    ///
    /// # Panics
    /// Never: all its keys are texts.
    #[must_use]
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("the keys of a summary are texts") + "\n"
    }

    /// Writes the object to the file at `path`.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        write_file(path, self.to_json().as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_that_do_not_apply_are_absent() {
        assert_eq!(Summary::default().to_json(), "{}\n");
        let map = MapSummary { algorithm: "ml-tm".into(), mapped: 3, ..MapSummary::default() };
        let json = Summary { maps: vec![map], ..Summary::default() }.to_json();
        let json: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!(json, serde_json::json!({"maps": [{"algorithm": "ml-tm", "mapped": 3, "unmapped": 0}]}));
    }
}
