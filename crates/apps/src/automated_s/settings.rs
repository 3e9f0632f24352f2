//! Settings of the automated S path.

use serde::{Deserialize, Serialize};
use sextant_channel::Position;
use sextant_kernel::SettingError;
use sextant_sim::layout::RegionConfig;

use crate::height_range::within_steps;

/// The automated S path, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct AutomatedSConfig {
    /// Distance between stops along a lane (m).
    #[serde(default = "default_step_m")]
    pub step_m: f64,
    /// Distance between lanes (m). A good value is half the communication radius; it should never exceed the radius.
    #[serde(default = "default_lane_spacing_m")]
    pub lane_spacing_m: f64,
    /// Packets wanted from each node (N_p of the thesis).
    #[serde(default = "default_packets_per_node")]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub packets_per_node: u32,
    /// Maximum number of drives, including repeated listening at one place.
    #[serde(default = "default_max_steps")]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub max_steps: u32,
    /// Number of consecutive silent stops after which the robot turns. With more, it drives farther beyond the
    /// network.
    #[serde(default = "default_silent_stops_to_turn")]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub silent_stops_to_turn: u32,
    /// A stop that hears fewer nodes than this counts as silent. With a higher value the robot turns nearer to the
    /// network.
    #[serde(default = "default_silent_below_nodes")]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub silent_below_nodes: usize,
    /// When the survey is complete.
    #[serde(default)]
    pub until: Until,
    /// What the robot does if packets are missing when all lanes are driven. If true, it visits places that it
    /// passed, and listens again where it heard the nodes concerned. If false, it drives the lanes again; a survey in
    /// layers ends.
    #[serde(default = "default_coverage_check")]
    pub coverage_check: bool,
    /// The robot stays in this region and must start in it. It turns at the border as it does at silent stops. The
    /// survey is complete when the area is swept and its gaps are visited, whatever the robot heard, because nodes
    /// outside belong to other robots.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub area: Option<RegionConfig>,
    /// Layers of lanes, for a network in space. If absent, all lanes are at the height of the start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layers: Option<LayersConfig>,
}

/// Layers of lanes, one above the other, as written in a scenario. The robot begins at the height of its start and
/// goes up until it reaches the ceiling or a layer that hears nothing. Then it goes down from the start until it
/// reaches the floor or such a layer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct LayersConfig {
    /// Height between layers (m).
    #[serde(default = "default_lane_spacing_m")]
    pub spacing_m: f64,
    /// Lowest height of the robot (m).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub floor_m: Option<f64>,
    /// Highest height of the robot (m).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ceiling_m: Option<f64>,
}

/// When an automated survey is complete.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Until {
    /// Each node was heard as often as wanted (thesis). The robot may then be far from the last nodes.
    #[default]
    Heard,
    /// In addition, a lane beyond the network heard nothing, so that the last nodes were heard from both sides.
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
            area: None,
            layers: None,
        }
    }
}

impl AutomatedSConfig {
    /// The lowest and the highest height of the robot (m); `None` if a value is invalid.
    pub(crate) fn height_range_m(&self, start: Position) -> Option<[f64; 2]> {
        let Settings { layers, max_steps, step_m, .. } = Settings::try_from(self).ok()?;
        let climbs = |layers: &Layers| [1.0, -1.0].iter().any(|&up| layers.next_m(start.z_m, up).is_some());
        Some(match layers.filter(climbs) {
            Some(layers) => within_steps(start, [layers.floor_m, layers.ceiling_m], max_steps, step_m),
            None => [start.z_m; 2],
        })
    }
}

impl Default for LayersConfig {
    fn default() -> Self {
        Self { spacing_m: default_lane_spacing_m(), floor_m: None, ceiling_m: None }
    }
}

/// What the robot does if packets are missing when all lanes are driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AfterLanes {
    /// Visit the places that it passed.
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
    pub(super) layers: Option<Layers>,
}

/// Validated layers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layers {
    pub(super) spacing_m: f64,
    floor_m: f64,
    ceiling_m: f64,
}

impl Layers {
    /// The height of the next layer after that at `z_m`; `up` is 1 or -1. `None` if the space up to the ceiling, or
    /// down to the floor, is covered from here.
    pub(super) fn next_m(&self, z_m: f64, up: f64) -> Option<f64> {
        let next_m = (z_m + up * self.spacing_m).clamp(self.floor_m, self.ceiling_m);
        (up * (next_m - z_m) > 0.5 * self.spacing_m).then_some(next_m)
    }

    /// Key and value of the limit that `z_m`, a height outside the layers, violates.
    pub(super) fn limit_beyond(&self, z_m: f64) -> (&'static str, f64) {
        if z_m < self.floor_m { ("floor_m", self.floor_m) } else { ("ceiling_m", self.ceiling_m) }
    }

    /// Whether the robot may be at this height.
    pub(super) fn holds(&self, z_m: f64) -> bool {
        (self.floor_m..=self.ceiling_m).contains(&z_m)
    }
}

impl TryFrom<LayersConfig> for Layers {
    type Error = SettingError;

    fn try_from(config: LayersConfig) -> Result<Self, SettingError> {
        let limit = |key: &str, value: Option<f64>| value.map(|value| SettingError::finite(key, value)).transpose();
        let floor_m = limit("floor_m", config.floor_m)?.unwrap_or(f64::NEG_INFINITY);
        let ceiling_m = limit("ceiling_m", config.ceiling_m)?.unwrap_or(f64::INFINITY);
        if ceiling_m < floor_m {
            return Err(SettingError::new("ceiling_m", ceiling_m, format!("at least floor_m = {floor_m}")));
        }
        Ok(Self { spacing_m: SettingError::positive("spacing_m", config.spacing_m)?, floor_m, ceiling_m })
    }
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
            layers: {
                let layers = config.layers.map(Layers::try_from).transpose();
                layers.map_err(|error| error.within("layers"))?
            },
            after_lanes: if config.coverage_check { AfterLanes::Check } else { AfterLanes::Again },
        })
    }
}
