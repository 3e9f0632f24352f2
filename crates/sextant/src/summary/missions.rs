//! What missions on maps of the nodes came to.

use std::collections::BTreeMap;

use serde::Serialize;

use super::gathering::EnergySummary;
use super::links::LinkSummary;
use super::map::ErrorSummary;
use super::sensing::SensorErrorCounts;
use sextant_kernel::text::{counted, listed};

/// What a mission on a map of the nodes came to. Times count from the start of its phase.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MissionSummary {
    /// Its name in tables and recordings.
    pub name: String,
    /// Its algorithm: `detarsk`, `p-g`, `level-set`, `gradient` or `beam-tracking`.
    pub algorithm: &'static str,
    /// Name of the map that it was given: `physical`, the name of a map of the scenario, or that of a file.
    pub map: String,
    /// Distances of the nodes of the map from where they really are, after the alignment that all places of the
    /// mission are compared with (m): the mean. Absent for the true places.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map_error_m: Option<f64>,
    /// Whether all targets were captured. Absent if it seeks the source of a field.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub captured: Option<bool>,
    /// Whether a robot arrived at the level or the source that it seeks, or each robot that keeps a link at the end of its way. Absent
    /// if it searches targets.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub arrived: Option<bool>,
    /// When the last target was captured, the first robot arrived for the first time, or the last robot that keeps a link was at the end
    /// of its way (s). Absent if that did not happen.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_s: Option<f64>,
    /// Simulated time (s).
    pub sim_time_s: f64,
    /// Number of events.
    pub events: u64,
    /// Whether the user ended it early. Absent if not.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub interrupted: bool,
    /// Length of the paths of all its robots together (m).
    pub path_length_m: f64,
    /// Nodes that take part: those of its network.
    pub nodes: usize,
    /// Of these, nodes with a place on the map.
    pub nodes_on_map: usize,
    /// Whether the map is in a frame of its own: robots do not take its directions and lengths as theirs. Absent if not.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub has_own_frame: bool,
    /// Names of the nodes that died, in the order of their deaths. Absent if none did.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub deaths: Vec<String>,
    /// Names of the sinks that take part. Absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sinks: Vec<String>,
    /// The robots.
    pub robots: Vec<MissionRobot>,
    /// The targets, if it searches them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub targets: Vec<MissionTarget>,
    /// Distances between where stations thought that targets were and where they were (m). Absent if no station thought so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prediction_error_m: Option<ErrorSummary>,
    /// Distances between where robots thought to be and where they were (m). Absent if no robot thought so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub own_place_error_m: Option<ErrorSummary>,
    /// The search every 4 s until 84 s, if it searches targets. The recording has the complete series.
    #[serde(skip)]
    pub course: Vec<SearchInstant>,
    /// Absolute differences between the values of the field that robots worked out and the true ones, in the unit of the
    /// field. Absent if no robot did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub field_error: Option<ErrorSummary>,
    /// Distance between where the robot truly was at the first arrival and the nearest source (m). Absent if it seeks a
    /// level.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source_m: Option<f64>,
    /// The level that it seeks, in the unit of the field. Absent if it seeks the source itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub level: Option<f64>,
    /// The largest true value of the field where a robot was, in the unit of the field.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_value: Option<f64>,
    /// The arrivals, in the order of time.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub arrivals: Vec<ArrivalSummary>,
    /// The least time in which the control law can reach the level from the start of the robot (s), if the value that it
    /// works with is the exact one: readings that differ from the field can take it there sooner.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub law_minimum_s: Option<f64>,
    /// What became of the links that its robots kept. Absent if they keep none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub link: Option<LinkSummary>,
    /// How often each kind of step was taken, by name: what the filters, the predictions and the controllers did.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub steps: BTreeMap<&'static str, u64>,
    /// The errors of the sensors of targets. Absent if they make none.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub sensor_errors: Option<SensorErrorCounts>,
    /// The messages.
    pub messages: MissionMessages,
    /// Energy of the radios of all nodes (J).
    pub energy_j: EnergySummary,
}

impl MissionSummary {
    /// Who takes part, and on which map, in words.
    #[must_use]
    pub(crate) fn participants(&self) -> String {
        let robots: Vec<&str> = self.robots.iter().map(|robot| robot.name.as_str()).collect();
        let mut parts = vec![counted(self.nodes, "node")];
        for (names, what) in [(robots, "robot"), (self.sinks.iter().map(String::as_str).collect(), "sink")] {
            if !names.is_empty() {
                parts.push(format!("{} ({})", counted(names.len(), what), listed(&names)));
            }
        }
        let map = match self.map.as_str() {
            "physical" => "with the true places of the nodes".to_owned(),
            map => {
                let frame = if self.has_own_frame { " and is in a frame of its own" } else { "" };
                format!("on the map `{map}`, which has {} of the nodes{frame}", self.nodes_on_map)
            }
        };
        let died = match self.deaths.len() {
            0 => String::new(),
            count => format!("; {} died", counted(count, "node")),
        };
        format!("{} take part, {map}{died}", parts.join(", "))
    }

    /// What it came to, in words.
    #[must_use]
    pub fn outcome(&self) -> String {
        let captured = self.targets.iter().filter(|target| target.captured_s.is_some()).count();
        let what = match (self.captured, self.arrived) {
            (Some(_), _) => format!("{captured} of {} captured", counted(self.targets.len(), "target")),
            (None, Some(true)) => "arrived".to_owned(),
            (None, Some(false)) => "did not arrive".to_owned(),
            (None, None) => "ended".to_owned(),
        };
        let end = if self.interrupted { ", interrupted" } else { "" };
        match self.time_s {
            Some(time_s) => format!("{what} after {time_s:.1} s{end}"),
            None => format!("{what} in {:.1} s{end}", self.sim_time_s),
        }
    }
}

/// Instants at which the course of a search is read (s).
pub(crate) const SEARCH_INSTANTS_S: [u8; 21] =
    [4, 8, 12, 16, 20, 24, 28, 32, 36, 40, 44, 48, 52, 56, 60, 64, 68, 72, 76, 80, 84];

/// A search for targets at an instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SearchInstant {
    /// Distance of the robots from the nearest target that is still there (m), and 0 once all are captured. Absent after
    /// the duration of the mission, and once the last target left.
    pub distance_to_target_m: Option<f64>,
    /// Distance between where stations thought that targets were and where they were (m): the mean since the previous
    /// instant. Absent if no station thought so.
    pub prediction_error_m: Option<f64>,
}

/// A robot of a mission.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MissionRobot {
    /// Its name.
    pub name: String,
    /// Length of its path (m).
    pub path_length_m: f64,
    /// Number of targets that it captured, if it searches any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub captures: Option<usize>,
    /// Energy of its radio (J).
    pub energy_j: f64,
}

/// A target of a mission.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MissionTarget {
    /// Its name.
    pub name: String,
    /// When it was captured (s). Absent if it was not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub captured_s: Option<f64>,
    /// Name of the robot that captured it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robot: Option<String>,
    /// When it left the world (s), if it did so before it was captured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left_s: Option<f64>,
}

/// An arrival at the level or the source of a field.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ArrivalSummary {
    /// Name of the robot.
    pub robot: String,
    /// When (s).
    pub time_s: f64,
    /// The value that the robot believed in, in the unit of the field.
    pub believed: f64,
    /// The true value there.
    pub value: f64,
    /// Distance between where the robot truly was and the nearest source (m). Absent if it seeks a level.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source_m: Option<f64>,
}

/// The messages of a mission.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MissionMessages {
    /// Number of messages of each kind that were made, by name.
    #[serde(flatten)]
    pub kinds: BTreeMap<&'static str, u64>,
    /// Frames that nodes, robots and sinks put on air, without repetitions.
    pub sent: u64,
    /// Octets of all payloads, if they were counted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub octets: Option<u64>,
}
