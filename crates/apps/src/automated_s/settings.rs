//! Settings of the automated S path.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;

/// The automated S path, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AutomatedSConfig {
    /// Distance between stops along a lane [m].
    #[serde(default = "default_step_m")]
    pub step_m: f64,
    /// Distance between lanes [m]: half the radius of communication, never more than all of it.
    #[serde(default = "default_lane_spacing_m")]
    pub lane_spacing_m: f64,
    /// Packets wanted from each node (N_p of the thesis).
    #[serde(default = "default_packets_per_node")]
    pub packets_per_node: u32,
    /// Drives, and repeated listening at one place, at most.
    #[serde(default = "default_max_steps")]
    pub max_steps: u32,
    /// Stops in a row that hear nobody before the robot turns; more let it drive on beyond the network.
    #[serde(default = "default_silent_stops_to_turn")]
    pub silent_stops_to_turn: u32,
    /// A stop that hears fewer nodes than this counts as one that hears nobody; more let the robot turn nearer to the
    /// network.
    #[serde(default = "default_silent_below_nodes")]
    pub silent_below_nodes: usize,
    /// When the survey is complete.
    #[serde(default)]
    pub until: Until,
    /// Whether, once the lanes are driven and packets are missing, the robot visits places that it passed by and
    /// listens again where it heard the nodes concerned. If not, it drives the lanes again.
    #[serde(default = "default_coverage_check")]
    pub coverage_check: bool,
}

/// When an automated survey is complete.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Until {
    /// Each node was heard as often as wanted (thesis): the robot may be far from the last nodes then.
    #[default]
    Heard,
    /// That, and a lane beyond the network heard nobody: the last nodes are heard from both sides.
    Swept,
}

fn default_step_m() -> f64 {
    1.0
}

fn default_lane_spacing_m() -> f64 {
    5.0
}

fn default_packets_per_node() -> u32 {
    5
}

fn default_max_steps() -> u32 {
    5000
}

fn default_silent_stops_to_turn() -> u32 {
    1
}

fn default_silent_below_nodes() -> usize {
    1
}

fn default_coverage_check() -> bool {
    true
}

impl Default for AutomatedSConfig {
    fn default() -> Self {
        Self {
            step_m: default_step_m(),
            lane_spacing_m: default_lane_spacing_m(),
            packets_per_node: default_packets_per_node(),
            max_steps: default_max_steps(),
            silent_stops_to_turn: default_silent_stops_to_turn(),
            silent_below_nodes: default_silent_below_nodes(),
            until: Until::default(),
            coverage_check: default_coverage_check(),
        }
    }
}

/// What follows once the lanes are driven and packets are missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AfterLanes {
    /// Visit what was passed by.
    Check,
    /// Drive the lanes again.
    Again,
}

/// Validated settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Settings {
    pub(super) step_m: f64,
    pub(super) lane_spacing_m: f64,
    pub(super) packets_per_node: u32,
    pub(super) max_steps: u32,
    pub(super) silent_stops_to_turn: u32,
    pub(super) silent_below_nodes: usize,
    pub(super) until: Until,
    pub(super) after_lanes: AfterLanes,
}

impl TryFrom<&AutomatedSConfig> for Settings {
    type Error = SettingError;

    fn try_from(config: &AutomatedSConfig) -> Result<Self, SettingError> {
        let at_least_one = |key: &str, value: u32| {
            if value > 0 { Ok(value) } else { Err(SettingError::new(key, value, "a whole number above 0")) }
        };
        let step_m = SettingError::positive("step_m", config.step_m)?;
        let lane_spacing_m = SettingError::positive("lane_spacing_m", config.lane_spacing_m)?;
        if lane_spacing_m < step_m {
            let allowed = format!("at least step_m = {step_m}");
            return Err(SettingError::new("lane_spacing_m", lane_spacing_m, allowed));
        }
        if config.silent_below_nodes == 0 {
            return Err(SettingError::new("silent_below_nodes", 0, "a whole number above 0"));
        }
        Ok(Self {
            step_m,
            lane_spacing_m,
            packets_per_node: at_least_one("packets_per_node", config.packets_per_node)?,
            max_steps: at_least_one("max_steps", config.max_steps)?,
            silent_stops_to_turn: at_least_one("silent_stops_to_turn", config.silent_stops_to_turn)?,
            silent_below_nodes: config.silent_below_nodes,
            until: config.until,
            after_lanes: if config.coverage_check { AfterLanes::Check } else { AfterLanes::Again },
        })
    }
}
