//! Which part of the nodes' traffic is simulated, as written in a scenario.

use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;
use sextant_sim::SimulatedRegion;

/// Which part of the nodes' traffic is simulated, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct SimulationConfig {
    /// Where nodes are simulated.
    pub region: RegionConfig,
    /// Radius round each robot that surveys within which all nodes are simulated (m), at least as far as a frame can be
    /// received. If absent, as far as a signal disturbs, and as far again as carrier sense reaches. Not with `region = "all"`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub halo_m: Option<f64>,
}

/// Where nodes are simulated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RegionConfig {
    /// As `listeners` if a robot surveys at least 1000 nodes, and otherwise as `all`. With `halo_m`, as `listeners`.
    #[default]
    Auto,
    /// Round the listeners: robots that survey. Nodes farther away rest: their frames are counted, and not sent; what became of
    /// them is estimated. What robots hear is the same, and the cost does not grow with the area. Nodes whose frames cannot be
    /// left out are all simulated: with sinks, with acknowledgements, saturated ones, those in superframes, and those that
    /// answer what they hear.
    Listeners,
    /// Everywhere, all the time.
    All,
}

impl SimulationConfig {
    /// Whether nothing is set.
    pub(crate) fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// The part that is simulated.
    pub(crate) fn region(self) -> Result<SimulatedRegion, SettingError> {
        let halo_m = self.halo_m.map(|halo_m| SettingError::positive("halo_m", halo_m)).transpose()?;
        match (self.region, halo_m) {
            (RegionConfig::Auto, None) => Ok(SimulatedRegion::NearListenersIfMany),
            (RegionConfig::Auto | RegionConfig::Listeners, halo_m) => Ok(SimulatedRegion::Listeners { halo_m }),
            (RegionConfig::All, None) => Ok(SimulatedRegion::All),
            (RegionConfig::All, Some(_)) => {
                let remedy = "remove one of them, because there is no halo if all nodes are simulated";
                Err(SettingError::conflict("halo_m", "`region = \"all\"`", remedy))
            }
        }
    }
}
