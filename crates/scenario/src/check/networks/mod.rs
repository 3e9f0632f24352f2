//! The networks of a scenario: one, as the tables of the scenario say, or several by name.

pub(crate) mod known;
pub(crate) mod sinks;

use std::collections::BTreeMap;

use sextant_channel::{ChannelConfig, ChannelLaw};
use sextant_kernel::{Files, SettingError};
use sextant_mac::{EnergyConfig, Phy, RadioStates};
use sextant_sim::layout::PlacedNode;
use sextant_sim::{
    AntennasConfig, LinkConfig, LinkError, MacConfig, Network, NetworkId, NodesOfGroup, RadioConfig, ReceptionConfig,
    Technology, TrafficConfig, TrafficPlan,
};

use super::errors::Errors;
use crate::config::ScenarioConfig;
use crate::config::network::NetworkConfig;

/// The tables of one network, and the key of each.
pub(crate) struct NetworkTables<'a> {
    pub(crate) name: Option<&'a str>,
    /// Whether it is the only network, with the tables of the scenario.
    is_alone: bool,
    nodes: Option<&'a NodesOfGroup>,
    pub(crate) radio: Keyed<Option<&'a RadioConfig>>,
    pub(crate) channel: Keyed<&'a ChannelConfig>,
    pub(crate) mac: Keyed<&'a MacConfig>,
    pub(crate) traffic: Keyed<Option<&'a TrafficConfig>>,
    reception: Keyed<Option<&'a ReceptionConfig>>,
    pub(crate) antenna: Keyed<Option<&'a AntennasConfig>>,
    energy: Keyed<Option<&'a EnergyConfig>>,
}

/// A value and the key of its table.
pub(crate) struct Keyed<T> {
    pub(crate) key: String,
    /// Whether the network has the table itself, and not the scenario for all.
    is_own: bool,
    pub(crate) value: T,
}

/// A named chip whose energy is counted, though it has not the band of the radios.
#[derive(Clone, Debug)]
pub struct ForeignChip {
    /// The key that names it.
    pub key: String,
    /// The chip.
    pub chip: EnergyConfig,
    /// Its bands, in words.
    pub bands: &'static str,
    /// The physical layer of the radios.
    pub phy: Phy,
}

/// The law of the channel of a network and the technology of the links over it, checked.
#[derive(Clone, Debug)]
pub(crate) struct CheckedLinks {
    pub(crate) channel: ChannelLaw,
    pub(crate) technology: Technology,
}

impl CheckedLinks {
    /// The power at the reference distance with the best sectors (dBm): maps take it as the transmit power.
    pub(crate) fn power_at_reference_dbm(&self) -> f64 {
        let power_dbm = self.technology.tx_power().0 + self.technology.link_gain().0;
        power_dbm - self.channel.path_loss().reference_loss().0
    }

    /// The radius of communication (m), if it is limited.
    pub(crate) fn max_range_m(&self) -> Option<f64> {
        Some(self.channel.max_range_m()).filter(|range_m| range_m.is_finite())
    }
}

impl<'a> NetworkTables<'a> {
    /// The tables of each network of a scenario, in the order of their names.
    pub(crate) fn all(config: &'a ScenarioConfig) -> Vec<Self> {
        if config.networks.is_empty() {
            return vec![Self::of(config, None)];
        }
        config.networks.iter().map(|(name, network)| Self::of(config, Some((name, network)))).collect()
    }

    fn of(config: &'a ScenarioConfig, network: Option<(&'a String, &'a NetworkConfig)>) -> Self {
        let keyed = |table: &str, is_own: bool| match network {
            Some((name, _)) if is_own => format!("networks.{name}.{table}"),
            _ => table.to_owned(),
        };
        macro_rules! pick {
            ($table:ident, $whole:expr) => {{
                let own = network.and_then(|(_, network)| network.$table.as_ref());
                Keyed { key: keyed(stringify!($table), own.is_some()), is_own: own.is_some(), value: own.or($whole) }
            }};
        }
        macro_rules! pick_or_default {
            ($table:ident) => {{
                let picked = pick!($table, Some(&config.$table));
                Keyed { key: picked.key, is_own: picked.is_own, value: picked.value.unwrap_or(&config.$table) }
            }};
        }
        Self {
            name: network.map(|(name, _)| name.as_str()),
            is_alone: network.is_none(),
            nodes: network.and_then(|(_, network)| network.nodes.as_ref()),
            radio: pick!(radio, config.radio.as_ref()),
            channel: pick_or_default!(channel),
            mac: pick_or_default!(mac),
            traffic: pick!(traffic, config.traffic.as_ref()),
            reception: pick!(reception, config.reception.as_ref()),
            antenna: pick!(antenna, config.antenna.as_ref()),
            energy: pick!(energy, config.energy.as_ref()),
        }
    }

    /// Whether its links sweep sectors.
    pub(crate) fn sweeps_sectors(&self) -> bool {
        self.mac.value.sweeps_sectors()
    }

    /// What its nodes send, if they do not answer sweeps instead.
    pub(crate) fn traffic_of_nodes(&self) -> Option<&'a TrafficConfig> {
        self.traffic.value.filter(|_| !self.sweeps_sectors())
    }

    /// The law of its channel. An absent loss at the reference distance is that of free space at the carrier of its radios.
    pub(crate) fn law(&self, errors: &mut Errors) -> Option<ChannelLaw> {
        let channel = *self.channel.value;
        let channel = match self.radio.value {
            Some(radio) => channel.with_free_space(radio.carrier_ghz(self.mac.value)),
            None => channel,
        };
        errors.take(&self.channel.key, ChannelLaw::try_from(channel))
    }

    /// Its channel and its links, checked; `nodes` are those of the world, if it has no error.
    pub(crate) fn links(
        &self,
        nodes: Option<&[PlacedNode]>,
        files: &Files,
        errors: &mut Errors,
    ) -> Option<CheckedLinks> {
        let channel = self.law(errors);
        let technology = Technology::read(&self.link_config(), nodes, files);
        let technology = technology.map_err(|found| {
            found.into_iter().for_each(|error| match error {
                LinkError::Missing(table) => errors.refuse(&self.missing(table)),
                LinkError::Invalid { table, error } => errors.refuse(&error.within(self.key_of(table))),
            });
        });
        if !self.sweeps_sectors() && (self.antenna.is_own || self.is_alone && self.antenna.value.is_some()) {
            let with = "this `mac`: only `mac.sector_sweep` has antennas with sectors";
            errors.refuse(&SettingError::conflict(&self.antenna.key, with, "remove the table"));
        }
        Some(CheckedLinks { channel: channel?, technology: technology.ok()? })
    }

    /// The tables of its links.
    pub(crate) fn link_config(&self) -> LinkConfig<'a> {
        LinkConfig {
            radio: self.radio.value,
            mac: self.mac.value,
            reception: self.reception.value,
            antenna: self.antenna.value,
        }
    }

    /// The key of one of the tables of its links.
    fn key_of(&self, table: &str) -> &str {
        match table {
            "mac" => &self.mac.key,
            "reception" => &self.reception.key,
            "antenna" => &self.antenna.key,
            _ => &self.radio.key,
        }
    }

    /// The network with these `links`, checked; `nodes` are those of the world, if it has no error.
    pub(crate) fn check(
        &self,
        config: &ScenarioConfig,
        links: Option<CheckedLinks>,
        nodes: Option<&[PlacedNode]>,
        files: &Files,
        errors: &mut Errors,
    ) -> Option<Network> {
        let radio_states = errors.take(&self.energy.key, RadioStates::try_from(self.energy()));
        let silent = || nodes.map(|nodes| TrafficPlan::silent(nodes.len()));
        let traffic = match self.traffic.value {
            Some(_) if self.sweeps_sectors() && (self.is_alone || self.traffic.is_own) => {
                let remedy = "remove the table, because nodes answer sector sweeps and send nothing else";
                errors.take("", Err(SettingError::conflict(&self.traffic.key, "`mac.sector_sweep`", remedy)))
            }
            _ if self.sweeps_sectors() => silent(),
            // Names of nodes are not known without a world.
            Some(traffic) if nodes.is_none() && traffic.names_nodes() => None,
            Some(traffic) => {
                let plan = TrafficPlan::new(traffic, nodes.unwrap_or_default(), files);
                errors.take(&self.traffic.key, plan).filter(|_| nodes.is_some())
            }
            // Nodes that compute a map, or that only take part in applications, send their messages alone.
            None if config.distributed_mapping.is_some() || !config.has_traffic() => silent(),
            None => errors.take("", Err(self.missing("traffic"))),
        };
        let members = match (self.nodes, nodes) {
            (Some(chosen), Some(nodes)) => {
                let members = members(chosen, nodes, self.name, &config.networks);
                Some(errors.take(&format!("networks.{}.nodes", self.name.unwrap_or_default()), members)?)
            }
            _ => None,
        };
        let CheckedLinks { channel, technology } = links?;
        Some(Network {
            name: self.name.map(str::to_owned),
            channel,
            technology,
            radio_states: radio_states?,
            traffic: traffic?,
            members,
        })
    }

    /// The chip whose energy is counted: the one that is named, or one of the band of the radios.
    fn energy(&self) -> EnergyConfig {
        let usual = || match self.radio.value {
            _ if self.sweeps_sectors() => EnergyConfig::Mmwave60Ghz,
            radio => EnergyConfig::usual(radio.map(|radio| radio.phy).unwrap_or_default()),
        };
        self.energy.value.copied().unwrap_or_else(usual)
    }

    /// The named chip whose energy is counted, and its bands, if these are not the band of the radios.
    pub(crate) fn foreign_chip(&self) -> Option<ForeignChip> {
        let phy = self.radio.value.filter(|_| !self.sweeps_sectors())?.phy;
        let chip = *self.energy.value?;
        let bands = chip.other_bands(phy)?;
        Some(ForeignChip { key: self.energy.key.clone(), chip, bands, phy })
    }

    fn missing(&self, table: &str) -> SettingError {
        let place = self.name.map_or(String::new(), |name| format!("networks.{name}."));
        SettingError::missing_table(format!("{place}{table}"))
    }
}

/// Whether each of `nodes` is in the network `own`, whose nodes are `chosen`.
fn members(
    chosen: &NodesOfGroup,
    nodes: &[PlacedNode],
    own: Option<&str>,
    networks: &BTreeMap<String, NetworkConfig>,
) -> Result<Vec<bool>, SettingError> {
    match chosen {
        NodesOfGroup::Count(count) if *count > nodes.len() => {
            Err(SettingError::new("count", count, format!("at most {}, the number of nodes", nodes.len())))
        }
        NodesOfGroup::Count(count) => Ok((0..nodes.len()).map(|node| node < *count).collect()),
        NodesOfGroup::Names(names) => {
            let mut members = vec![false; nodes.len()];
            for (i, name) in names.iter().enumerate() {
                let node = nodes.iter().position(|node| node.name == *name);
                let refuse = || SettingError::new(format!("names[{i}]"), format!("`{name}`"), "the name of a node");
                members[node.ok_or_else(refuse)?] = true;
            }
            Ok(members)
        }
        NodesOfGroup::Others {} => {
            let mut members = vec![true; nodes.len()];
            for (_, network) in networks.iter().filter(|(name, _)| Some(name.as_str()) != own) {
                match &network.nodes {
                    Some(NodesOfGroup::Others {}) | None => {}
                    Some(chosen) => {
                        // An error in the other network is reported there.
                        let taken = self::members(chosen, nodes, None, networks).unwrap_or_default();
                        members.iter_mut().zip(taken).for_each(|(member, taken)| *member &= !taken);
                    }
                }
            }
            Ok(members)
        }
    }
}

/// The number of the network `name`, or of the only one.
///
/// # Errors
/// If there is no network of this name, or several and no name.
pub(crate) fn number(
    key: &str,
    name: Option<&str>,
    networks: &BTreeMap<String, NetworkConfig>,
) -> Result<NetworkId, SettingError> {
    let known = || networks.keys().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    let position = match name {
        None if networks.len() <= 1 => Some(0),
        None => {
            let allowed = format!("one of {}, because there are several networks", known());
            return Err(SettingError::new(key, "nothing", allowed));
        }
        Some(name) => networks.keys().position(|other| other == name),
    };
    let position = position.and_then(|position| u8::try_from(position).ok());
    position.map(NetworkId).ok_or_else(|| {
        let name = name.unwrap_or_default();
        let allowed = if networks.is_empty() { "no name: there is one network".to_owned() } else { known() };
        SettingError::new(key, format!("`{name}`"), allowed)
    })
}
