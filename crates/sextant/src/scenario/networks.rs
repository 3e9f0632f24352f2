//! The networks of a scenario: one, as the tables of the scenario say, or several by name.

use std::collections::BTreeMap;
use std::path::Path;

use sextant_channel::{ChannelConfig, ChannelLaw};
use sextant_kernel::SettingError;
use sextant_mac::dmg::{SweepConfig, SweepSettings};
use sextant_mac::{EnergyConfig, RadioStates};
use sextant_sim::layout::PlacedNode;
use sextant_sim::{
    Antennas, AntennasConfig, BusyNetwork, DmgRadio, Ieee80211ad, Ieee802154, Mac, MacConfig, NetworkId,
    NetworkSetup, NodesOfGroup, Radio, RadioConfig, ReceptionConfig, ReceptionModel, SilentConfig, Technology,
    ThresholdConfig, TrafficConfig, TrafficPlan,
};

use super::config::ScenarioConfig;
use super::errors::Errors;
use super::network_config::NetworkConfig;

/// The tables of one network, and the key of each.
pub(super) struct NetworkTables<'a> {
    pub(super) name: Option<&'a str>,
    /// Whether it is the only network, with the tables of the scenario.
    is_alone: bool,
    nodes: Option<&'a NodesOfGroup>,
    pub(super) radio: Keyed<Option<&'a RadioConfig>>,
    pub(super) channel: Keyed<&'a ChannelConfig>,
    pub(super) mac: Keyed<&'a MacConfig>,
    pub(super) traffic: Keyed<Option<&'a TrafficConfig>>,
    reception: Keyed<Option<&'a ReceptionConfig>>,
    pub(super) antenna: Keyed<Option<&'a AntennasConfig>>,
    energy: Keyed<&'a EnergyConfig>,
}

/// A value and the key of its table.
pub(super) struct Keyed<T> {
    pub(super) key: String,
    /// Whether the network has the table itself, and not the scenario for all.
    is_own: bool,
    pub(super) value: T,
}

/// The tables of a scenario: those of its networks, and those for all networks without a table of their own.
#[derive(Clone, Copy)]
pub(super) struct ScenarioTables<'a> {
    pub(super) networks: &'a BTreeMap<String, NetworkConfig>,
    pub(super) radio: Option<&'a RadioConfig>,
    pub(super) channel: &'a ChannelConfig,
    pub(super) mac: &'a MacConfig,
    pub(super) traffic: Option<&'a TrafficConfig>,
    pub(super) reception: Option<&'a ReceptionConfig>,
    pub(super) antenna: Option<&'a AntennasConfig>,
    pub(super) energy: &'a EnergyConfig,
}

impl<'a> From<&'a ScenarioConfig> for ScenarioTables<'a> {
    fn from(config: &'a ScenarioConfig) -> Self {
        Self {
            networks: &config.networks,
            radio: config.radio.as_ref(),
            channel: &config.channel,
            mac: &config.mac,
            traffic: config.traffic.as_ref(),
            reception: config.reception.as_ref(),
            antenna: config.antenna.as_ref(),
            energy: &config.energy,
        }
    }
}

impl<'a> NetworkTables<'a> {
    /// The tables of each network of a scenario, in the order of their names.
    pub(super) fn all(config: impl Into<ScenarioTables<'a>>) -> Vec<Self> {
        let config = config.into();
        if config.networks.is_empty() {
            return vec![Self::of(config, None)];
        }
        config.networks.iter().map(|(name, network)| Self::of(config, Some((name, network)))).collect()
    }

    fn of(config: ScenarioTables<'a>, network: Option<(&'a String, &'a NetworkConfig)>) -> Self {
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
                let picked = pick!($table, Some(config.$table));
                Keyed { key: picked.key, is_own: picked.is_own, value: picked.value.unwrap_or(config.$table) }
            }};
        }
        Self {
            name: network.map(|(name, _)| name.as_str()),
            is_alone: network.is_none(),
            nodes: network.and_then(|(_, network)| network.nodes.as_ref()),
            radio: pick!(radio, config.radio),
            channel: pick_or_default!(channel),
            mac: pick_or_default!(mac),
            traffic: pick!(traffic, config.traffic),
            reception: pick!(reception, config.reception),
            antenna: pick!(antenna, config.antenna),
            energy: pick_or_default!(energy),
        }
    }

    /// Whether its links sweep sectors.
    pub(super) fn sweeps_sectors(&self) -> bool {
        matches!(self.mac.value, MacConfig::SectorSweep(_))
    }

    /// The law of its channel.
    pub(super) fn law(&self, errors: &mut Errors<'_>) -> Option<ChannelLaw> {
        errors.take(&self.channel.key, ChannelLaw::try_from(*self.channel.value))
    }

    /// The network, checked; `nodes` are those of the world, if it has no error.
    pub(super) fn check(
        &self,
        config: &ScenarioConfig,
        nodes: Option<&[PlacedNode]>,
        folder: &Path,
        errors: &mut Errors<'_>,
    ) -> Option<BusyNetwork> {
        let channel = self.law(errors);
        let technology = match self.mac.value {
            MacConfig::SectorSweep(sweep) => self.ieee80211ad(*sweep, folder, errors),
            mac => self.ieee802154(mac, nodes, errors),
        };
        let radio_states = errors.take(&self.energy.key, RadioStates::try_from(*self.energy.value));
        let silent = TrafficConfig::Silent(SilentConfig {});
        let traffic = match (self.traffic.value, self.mac.value, nodes) {
            (Some(_), MacConfig::SectorSweep(_), _) if self.is_alone || self.traffic.is_own => {
                let allowed = "no table: nodes answer sector sweeps, and send nothing else";
                errors.take("", Err(SettingError::new(&self.traffic.key, "a table", allowed)))
            }
            (_, MacConfig::SectorSweep(_), nodes) => {
                nodes.and_then(|nodes| TrafficPlan::new(&silent, nodes, folder).ok())
            }
            (Some(traffic), _, nodes) => {
                let plan = TrafficPlan::new(traffic, nodes.unwrap_or_default(), folder);
                // Names of nodes are not known without a world.
                nodes.and_then(|_| errors.take(&self.traffic.key, plan))
            }
            // Nodes that compute a map, or that only take part in applications, send their messages alone.
            (None, _, nodes) if config.distributed_mapping.is_some() || !config.has_traffic() => {
                nodes.and_then(|nodes| TrafficPlan::new(&silent, nodes, folder).ok())
            }
            (None, ..) => errors.take("", Err(self.missing("traffic"))),
        };
        let members = match (self.nodes, nodes) {
            (Some(chosen), Some(nodes)) => {
                let members = members(chosen, nodes, self.name, &config.networks);
                Some(errors.take(&format!("networks.{}.nodes", self.name.unwrap_or_default()), members)?)
            }
            _ => None,
        };
        let link =
            NetworkSetup { channel: channel?, technology: technology?, radio_states: radio_states?, members: None };
        Some(BusyNetwork { name: self.name.map(str::to_owned), link, traffic: traffic?, nodes: members })
    }

    /// Links of IEEE 802.15.4.
    fn ieee802154(
        &self,
        mac: &MacConfig,
        nodes: Option<&[PlacedNode]>,
        errors: &mut Errors<'_>,
    ) -> Option<Technology> {
        let radio = match (self.radio.value, nodes) {
            (Some(radio), Some(nodes)) => errors.take(&self.radio.key, Radio::new(radio, nodes)),
            // Names of nodes are not known without a world.
            (Some(radio), None) => errors.take(&self.radio.key, Radio::try_from(radio.clone())),
            (None, _) => errors.take("", Err(self.missing("radio"))),
        };
        let mac = errors.take(&self.mac.key, Mac::try_from(mac.clone()));
        let reception = self.reception.value.copied().unwrap_or_default();
        let reception = errors.take(&self.reception.key, ReceptionModel::try_from(reception));
        if self.antenna.is_own || self.is_alone && self.antenna.value.is_some() {
            let allowed = "no table: only `mac.sector_sweep` has antennas with sectors";
            errors.refuse(&SettingError::new(&self.antenna.key, "a table", allowed));
        }
        let links = Ieee802154 { radio: radio?, reception: reception?, mac: mac? };
        let table = self.radio.key.strip_suffix("radio").unwrap_or_default().trim_end_matches('.');
        errors.take(table, links.check())?;
        Some(Technology::Ieee802154(links))
    }

    /// Links of IEEE 802.11ad.
    fn ieee80211ad(&self, sweep: SweepConfig, folder: &Path, errors: &mut Errors<'_>) -> Option<Technology> {
        let radio = match self.radio.value {
            Some(radio) => errors.take(&self.radio.key, DmgRadio::try_from(radio.clone())),
            None => errors.take("", Err(self.missing("radio"))),
        };
        let antennas = match self.antenna.value {
            Some(antennas) => errors.take(&self.antenna.key, Antennas::read(antennas, folder)),
            None => errors.take("", Err(self.missing("antenna"))),
        };
        let sweep = SweepSettings::try_from(sweep).map_err(|error| error.within("sector_sweep"));
        let sweep = errors.take(&self.mac.key, sweep);
        let reception =
            self.reception.value.copied().unwrap_or(ReceptionConfig::SirThreshold(ThresholdConfig::default()));
        let reception = errors.take(&self.reception.key, ReceptionModel::try_from(reception));
        let (sweep, antennas) = (sweep?, antennas?);
        errors.take(&self.mac.key, antennas.check_answers(&sweep).map_err(|error| error.within("sector_sweep")))?;
        let links = Ieee80211ad { radio: radio?, reception: reception?, sweep, antennas };
        Some(Technology::Ieee80211ad(Box::new(links)))
    }

    fn missing(&self, table: &str) -> SettingError {
        let place = self.name.map_or(String::new(), |name| format!("networks.{name}."));
        SettingError::new(format!("{place}{table}"), "no such table", format!("a table `[{place}{table}]`"))
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
                        // An error in the other network is told there.
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
pub(super) fn number(
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
