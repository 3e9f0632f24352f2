//! The batteries of nodes, as written in a scenario.

use serde::{Deserialize, Serialize};
use sextant_kernel::{Seed, SettingError};
use sextant_mac::battery::{Battery, BatterySettings, Capacity, Cell, DischargeConfig};

use super::{Batteries, BatterySupply};
use crate::purpose;
use crate::world::layout::{NodesOfGroup, PlacedNode};

/// Greatest spread of capacities: draws beyond three standard deviations are cut, so that all stay above zero.
const MOST_SPREAD: f64 = 0.3;

/// Standard deviations at which draws of capacities are cut.
const CUT: f64 = 3.0;

/// The batteries of the nodes, as written in a scenario: all radios of a node draw on one. A node whose battery is empty dies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct BatteryConfig {
    /// A cell by name, whose capacity, voltage and self-discharge hold where none are given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cell: Option<Cell>,
    /// Capacity (mAh).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub capacity_mah: Option<f64>,
    /// Capacity (J), instead.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub capacity_j: Option<f64>,
    /// Standard deviation of the capacities, as a share of the capacity: each node has its own, drawn from the seed. 0 to 0.3;
    /// draws are cut at three standard deviations.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub capacity_spread: Option<f64>,
    /// Voltage (V); that of the cell, or 3 V, if absent. Radios and load take their power from it without a loss.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub voltage_v: Option<f64>,
    /// Share of what is left that is lost in a year without any load, 0 to less than 1; that of the cell, or none, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub self_discharge_per_year: Option<f64>,
    /// Current of what is not a radio (mA), all the time: sensors, processor. None if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load_ma: Option<f64>,
    /// How the battery is discharged.
    #[serde(default)]
    pub model: DischargeConfig,
    /// Nodes with a battery or a load of their own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = [])))]
    pub groups: Vec<BatteryGroupConfig>,
}

/// Nodes with a battery or a load of their own, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct BatteryGroupConfig {
    /// Which nodes.
    pub nodes: NodesOfGroup,
    /// Capacity (mAh); that of the other nodes if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub capacity_mah: Option<f64>,
    /// Capacity (J), instead.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub capacity_j: Option<f64>,
    /// Current of what is not a radio (mA); that of the other nodes if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load_ma: Option<f64>,
}

impl BatteryConfig {
    /// The batteries of `nodes`.
    ///
    /// # Errors
    /// If a setting is out of range, no capacity is given, or a group has no node, or one that is unknown or in another group.
    pub fn build(&self, nodes: &[PlacedNode], seed: Seed) -> Result<Batteries, SettingError> {
        let all = self.supply()?;
        let mut supplies = vec![all.clone(); nodes.len()];
        let mut grouped = vec![false; nodes.len()];
        for (i, group) in self.groups.iter().enumerate() {
            let table = format!("groups[{i}]");
            let own = group.supply(&all).map_err(|error| error.within(&table))?;
            for node in group.nodes.choose(nodes, |node| grouped[node]).map_err(|error| error.within(&table))? {
                grouped[node] = true;
                supplies[node] = own.clone();
            }
        }
        let spread = self.capacity_spread.unwrap_or(0.0);
        let spread = SettingError::in_range("capacity_spread", spread, 0.0, MOST_SPREAD)?;
        if spread > 0.0 {
            for (node, BatterySupply { battery, .. }) in (0..).zip(&mut supplies) {
                let deviation = seed.normal(purpose::BATTERIES, [node, 0, 0]).clamp(-CUT, CUT);
                *battery = battery.with_capacity(battery.capacity_c() * (1.0 + spread * deviation));
            }
        }
        Ok(Batteries::of_nodes(supplies))
    }

    fn supply(&self) -> Result<BatterySupply, SettingError> {
        let &Self { cell, capacity_mah, capacity_j, voltage_v, self_discharge_per_year, load_ma, model, .. } = self;
        let capacity = Capacity { capacity_mah, capacity_j };
        let battery =
            Battery::try_from(BatterySettings { cell, capacity, voltage_v, self_discharge_per_year, model })?;
        Ok(BatterySupply { load_w: load_w(load_ma.unwrap_or(0.0), &battery)?, battery })
    }
}

impl BatteryGroupConfig {
    fn supply(&self, all: &BatterySupply) -> Result<BatterySupply, SettingError> {
        let capacity = Capacity { capacity_mah: self.capacity_mah, capacity_j: self.capacity_j };
        let battery = match capacity.coulombs(all.battery.voltage_v())? {
            Some(capacity_c) => all.battery.with_capacity(capacity_c),
            None => all.battery.clone(),
        };
        let load_w = self.load_ma.map(|load_ma| load_w(load_ma, &battery)).transpose()?;
        Ok(BatterySupply { load_w: load_w.unwrap_or(all.load_w), battery })
    }
}

/// Power of a load (W).
fn load_w(load_ma: f64, battery: &Battery) -> Result<f64, SettingError> {
    Ok(SettingError::not_negative("load_ma", load_ma)? * 1e-3 * battery.voltage_v())
}

#[cfg(test)]
mod tests {
    use sextant_channel::Position;

    use super::*;

    fn nodes(count: usize) -> Vec<PlacedNode> {
        let node = |i| PlacedNode { name: format!("n{i}"), position: Position::ORIGIN };
        (0..count).map(node).collect()
    }

    fn config(text: &str) -> BatteryConfig {
        toml::from_str(text).expect("a good table")
    }

    fn capacities_mah(config: &BatteryConfig, count: usize, seed: u64) -> Vec<f64> {
        let batteries = config.build(&nodes(count), Seed(seed)).expect("good batteries");
        batteries.supplies().iter().map(|supply| supply.battery.capacity_c() / 3.6).collect()
    }

    #[test]
    fn groups_have_their_own_capacity_and_load() {
        let config = config(
            "cell = \"cr2032\"\nload_ma = 0.01\n\
             [[groups]]\nnodes = { names = [\"n1\"] }\ncapacity_j = 1080.0\n\
             [[groups]]\nnodes = { count = 1 }\nload_ma = 0.5\n",
        );
        let batteries = config.build(&nodes(3), Seed(1)).expect("good batteries");
        let found: Vec<_> = (batteries.supplies().iter())
            .map(|supply| (supply.battery.capacity_j().round(), (1e6 * supply.load_w).round()))
            .collect();
        assert_eq!(found, [(2430.0, 1500.0), (1080.0, 30.0), (2430.0, 30.0)]);
    }

    /// Of 2000 draws, mean and deviation are within four standard errors of what is asked for.
    #[test]
    fn capacities_spread_as_asked_for_and_depend_on_seed_and_node_alone() {
        let config = config("capacity_mah = 100.0\ncapacity_spread = 0.1\n");
        let drawn = capacities_mah(&config, 2000, 5);
        let mean = drawn.iter().sum::<f64>() / 2000.0;
        let deviation = (drawn.iter().map(|mah| (mah - mean) * (mah - mean)).sum::<f64>() / 1999.0).sqrt();
        assert!((mean - 100.0).abs() < 4.0 * 10.0 / 2000_f64.sqrt(), "{mean}");
        assert!((deviation - 10.0).abs() < 4.0 * 10.0 / 4000_f64.sqrt(), "{deviation}");
        assert!(drawn.iter().all(|mah| (69.999..=130.001).contains(mah)));
        assert_eq!(capacities_mah(&config, 3, 5), drawn[..3]);
        assert_ne!(capacities_mah(&config, 3, 6), drawn[..3]);
    }

    #[test]
    fn mistakes_are_named_by_their_key() {
        let key = |text: &str| config(text).build(&nodes(2), Seed(1)).err().map_or(String::new(), |error| error.key);
        assert_eq!(key("capacity_mah = 1.0"), "");
        assert_eq!(key("voltage_v = 3.0"), "capacity_mah");
        assert_eq!(key("capacity_mah = 1.0\ncapacity_spread = 0.4"), "capacity_spread");
        assert_eq!(key("capacity_mah = 1.0\nload_ma = -1.0"), "load_ma");
        let group = |rest: &str| format!("capacity_mah = 1.0\n[[groups]]\n{rest}");
        assert_eq!(key(&group("nodes = { names = [\"n7\"] }")), "groups[0].nodes.names[0]");
        assert_eq!(key(&group("nodes = { count = 1 }\ncapacity_mah = 0.0")), "groups[0].capacity_mah");
    }
}
