//! Settings of a partition.

use serde::{Deserialize, Serialize};

/// How an area is divided among robots, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct PartitionConfig {
    /// What all parts have the same of.
    pub balance: BalanceConfig,
    /// Where the area is cut.
    pub cut: CutConfig,
}

/// What all parts have the same of, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum BalanceConfig {
    /// The time that a robot is expected to take: the length of its path by its speed, and `listen_s` for each stop. As
    /// nearly as whole lanes allow.
    #[default]
    Time,
    /// The area without obstacles.
    Area,
}

/// Where an area is cut, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum CutConfig {
    /// Across the longer side, and the parts again until there is one for each robot.
    #[default]
    Bisection,
    /// Into strips along y, side by side.
    Strips,
}
