//! Settings of source seeking, as written in a scenario.

use serde::{Deserialize, Serialize};

use super::estimate::EstimateConfig;
use super::goal::{GoalConfig, GradientGoalConfig};
use super::level_set::HigherField;
use super::poll::PollConfig;
use super::rate::RateConfig;

/// Settings of the law of sliding mode that takes a robot to a level set (Gunathillake 2018, chapter 7; Matveev, Teimoori,
/// Savkin 2012), as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct LevelSetConfig {
    /// What robots seek.
    pub goal: GoalConfig,
    /// The values of the settings that are absent.
    #[serde(default)]
    pub preset: Preset,
    /// Largest turn rate of the robots (rad/s): 0.001 to 100.
    #[serde(default = "default_turn_rate_max")]
    pub turn_rate_max_rad_per_s: f64,
    /// Time between two decisions (s).
    #[serde(default = "default_control_s")]
    pub control_s: f64,
    /// Heading of the robots at the start, counterclockwise from x by their odometry (degrees): θ0 of the thesis, which does
    /// not print it. They turn there on the spot, which takes no time. If absent, they do not turn; a robot that has not
    /// driven before looks along x.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_heading_deg: Option<f64>,
    /// Gain γ of the law (1/s). Presets: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gamma_per_s: Option<f64>,
    /// Distance δ from the level beyond which the climb is as fast as it gets, in the unit of the field. Preset
    /// `thesis`: 0.1. The climb γ δ must be slower than the speed of the robot times the gradient of the field.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub delta: Option<f64>,
    /// Instead of `delta`: the climb as a share of the steepest one, which is worked out from the readings on the way.
    /// Preset `adaptive`: 0.7.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub climb_share: Option<f64>,
    /// On which hand the field is higher on a level set. Presets: right.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub higher_field: Option<HigherField>,
    /// The turn rate is proportional within this share of the climb rate γ δ, which avoids chattering; 0 for the bare
    /// sign. Preset `thesis`: 0, `adaptive`: 0.5.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub boundary_layer: Option<f64>,
    /// How the field at the robot is worked out from readings of nodes. Preset `thesis`: the mean over nodes within 4 m
    /// with equal weights; `adaptive`: a local fit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimate: Option<EstimateConfig>,
    /// How its rate of change is worked out. Preset `thesis`: the difference of two samples; `adaptive`: least squares of 5
    /// samples.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate: Option<RateConfig>,
    /// For robots that move in space; they move in the plane if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub space: Option<SpaceConfig>,
    /// How robots ask nodes for their readings.
    #[serde(default)]
    pub poll: PollConfig,
}

/// Settings of robots that move in space, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct SpaceConfig {
    /// Torsion of the path (1/m): the law bends the path in a plane, and the torsion turns that plane. As large as the
    /// largest curvature if absent, which is the largest turn rate divided by the speed; it should be at least 0.4 of that.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torsion_per_m: Option<f64>,
}

/// The values of settings of the law that are absent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Preset {
    /// The climb is a share of the steepest one around the robot, so that the law can always reach its sliding mode; a robot
    /// that still turns in circles climbs more slowly.
    #[default]
    Adaptive,
    /// The law as in the thesis: γ = 1/s, δ = 0.1 and the bare sign. The robot has a reading of each node in range at each
    /// decision. The value is the mean over the nodes within 4 m with equal weights, and its rate the difference of two
    /// values. The thesis does not print the 4 m and the time between two readings, and its weights are a ratio of powers.
    Thesis,
}

/// Settings of a robot that follows the gradient of a plane through the readings of the nodes around it (after Rosero and
/// Werner 2014, "Cooperative source seeking via gradient estimation and formation control", UKACC Control), as written in a
/// scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct GradientConfig {
    /// What robots seek: `"source"`, or a level.
    pub goal: GradientGoalConfig,
    /// Largest turn rate of the robots (rad/s): 0.001 to 100.
    #[serde(default = "default_turn_rate_max")]
    pub turn_rate_max_rad_per_s: f64,
    /// Time between two decisions (s).
    #[serde(default = "default_control_s")]
    pub control_s: f64,
    /// Turn rate for each radian between the heading and the gradient (1/s).
    #[serde(default = "default_heading_gain")]
    pub heading_gain_per_s: f64,
    /// The plane whose gradient is the course.
    #[serde(default)]
    pub plane: PlaneConfig,
    /// How the field at the robot is worked out from readings of nodes, which tells whether it has arrived at a level. A
    /// local fit if absent.
    #[serde(default)]
    pub estimate: EstimateConfig,
    /// How robots ask nodes for their readings.
    #[serde(default)]
    pub poll: PollConfig,
}

/// The plane through readings whose gradient is the course of a robot, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct PlaneConfig {
    /// Nodes within this distance of the robot on the map count, in the unit of the map (m). If absent, those within
    /// `poll.reach_m`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reach_m: Option<f64>,
}

fn default_turn_rate_max() -> f64 {
    1.0
}

fn default_control_s() -> f64 {
    0.1
}

fn default_heading_gain() -> f64 {
    2.0
}
