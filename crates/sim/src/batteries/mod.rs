//! The batteries of nodes: as written in a scenario, as checked, and what is left of them in a simulation.

mod bank;
mod config;
mod record;

pub(crate) use bank::{Bank, Outlook};
pub use config::{BatteryConfig, BatteryGroupConfig};
pub use record::BatteryRecord;

use sextant_mac::battery::Battery;

/// What a node lives on: its battery, and what draws on it all the time besides its radios.
#[derive(Clone, Debug, PartialEq)]
pub struct BatterySupply {
    /// The battery, full at the start.
    pub battery: Battery,
    /// Power of sensors, processor and whatever else is not a radio (W).
    pub load_w: f64,
}

/// The batteries of all nodes, by node.
#[derive(Clone, Debug, PartialEq)]
pub struct Batteries(Vec<BatterySupply>);

impl Batteries {
    /// That of each node.
    #[must_use]
    pub fn of_nodes(supplies: Vec<BatterySupply>) -> Self {
        Self(supplies)
    }

    /// Those of all nodes, by node.
    #[must_use]
    pub fn supplies(&self) -> &[BatterySupply] {
        &self.0
    }
}
