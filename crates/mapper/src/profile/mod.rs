//! Reception profiles: how likely a packet is received over a distance.

use sextant_kernel::SettingError;

mod cell;
mod channel;
mod fitted;
mod limits;
mod table;
mod trapezoid;

pub(crate) use cell::averaged_over_cell;
#[cfg(feature = "obstacles")]
pub(crate) use channel::KnownLink;
pub use channel::{ChannelProfileConfig, ObstacleUse};
pub use fitted::FittedConfig;
pub use table::TableProfile;
pub use trapezoid::{Trapezoid, TrapezoidConfig};

/// Lowest probability that a robust profile gives to any outcome: one packet received from far away then lowers the
/// likelihood of a vertex, but does not rule the vertex out.
pub(crate) const DEFAULT_FLOOR: f64 = 1e-6;

/// A reception profile as written in a scenario.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "config",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum ProfileConfig {
    /// Constant near the node, then falling linearly to 0.
    Trapezoid(TrapezoidConfig),
    /// The curve that a known channel implies.
    Channel(ChannelProfileConfig),
    /// A curve that never rises, estimated from the log.
    Fitted(FittedConfig),
}

fn default_floor() -> f64 {
    DEFAULT_FLOOR
}

fn default_ceiling() -> f64 {
    1.0 - DEFAULT_FLOOR
}

/// A reception profile: the probability S(d) that a packet sent at distance d is received.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ReceptionProfile {
    /// Constant near the node, then falling linearly to 0.
    Trapezoid(Trapezoid),
    /// Values at equal distances.
    Table(TableProfile),
}

impl ReceptionProfile {
    /// The profile for the vertices of a grid of `grid_step_m`: averaged over its cells, if the settings say so. A
    /// step of 0 means no grid.
    ///
    /// # Errors
    /// If a value is invalid or absent, or if the profile is a fitted one, which needs a log (see
    /// [`Fitted`](crate::Fitted)).
    pub fn for_grid(config: ProfileConfig, grid_step_m: f64) -> Result<Self, SettingError> {
        match config {
            ProfileConfig::Trapezoid(config) => {
                Trapezoid::try_from(config).map(Self::Trapezoid).map_err(|error| error.within("trapezoid"))
            }
            ProfileConfig::Channel(config) => {
                config.table(grid_step_m).map(Self::Table).map_err(|error| error.within("channel"))
            }
            ProfileConfig::Fitted(_) => {
                Err(SettingError::new("fitted", "a profile estimated from the log", "a profile known beforehand"))
            }
        }
    }

    /// At this distance and beyond, a reception is impossible, or has the probability of the floor (m).
    #[must_use]
    pub fn range_m(&self) -> f64 {
        match self {
            Self::Trapezoid(trapezoid) => trapezoid.range_m(),
            Self::Table(table) => table.range_m(),
        }
    }

    /// Probability that a packet is received over `distance_m`.
    #[must_use]
    pub fn probability(&self, distance_m: f64) -> f64 {
        match self {
            Self::Trapezoid(trapezoid) => trapezoid.probability(distance_m),
            Self::Table(table) => table.probability(distance_m),
        }
    }
}

impl TryFrom<ProfileConfig> for ReceptionProfile {
    type Error = SettingError;

    fn try_from(config: ProfileConfig) -> Result<Self, SettingError> {
        Self::for_grid(config, 0.0)
    }
}
