//! Fixed sinks: stations that always listen, and to which nodes send.

use serde::{Deserialize, Serialize};
use sextant_channel::{ObstacleField, Position};
use sextant_kernel::SettingError;

use crate::service::network_id::NetworkId;

/// A fixed sink, as written in a scenario: a station with power from the mains, so that its receiver is always on. It
/// collects what the nodes send.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SinkConfig {
    /// Name; no robot and no other sink has it.
    pub name: String,
    /// Where it stands (m).
    pub position_m: Position,
    /// Names of the networks in which it takes part; all if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub networks: Option<Vec<String>>,
}

/// A fixed sink.
#[derive(Clone, Debug, PartialEq)]
pub struct Sink {
    /// Name.
    pub name: String,
    /// Where it stands (m).
    pub position: Position,
    /// The networks in which it takes part; `None` if all.
    pub networks: Option<Vec<NetworkId>>,
}

impl Sink {
    /// Whether it takes part in a network.
    #[must_use]
    pub fn is_in(&self, network: NetworkId) -> bool {
        self.networks.as_ref().is_none_or(|networks| networks.contains(&network))
    }
}

impl SinkConfig {
    /// The sink among `obstacles`.
    ///
    /// # Errors
    /// If its name has characters beyond letters, digits, `-`, `_` and `.`, or its place is not finite or inside an
    /// obstacle.
    pub fn place(&self, obstacles: &ObstacleField) -> Result<Sink, SettingError> {
        super::robot::check_name(&self.name)?;
        super::robot::check_place("position_m", self.position_m)?;
        if let Some((found, allowed)) = obstacles.fault(self.position_m) {
            return Err(SettingError::new("position_m", found, allowed));
        }
        Ok(Sink { name: self.name.clone(), position: self.position_m, networks: None })
    }
}
