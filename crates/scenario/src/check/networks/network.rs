//! A network: its tables as written, with the key of each, and what each becomes.

use std::sync::Arc;

use sextant_channel::{ChannelConfig, ChannelLaw, Dbm, RangingDevice, RangingDeviceConfig, ReflectionsConfig};
use sextant_kernel::{Files, SettingError};
use sextant_mac::tsch::Hopping;
use sextant_mac::{EnergyConfig, Phy, RadioStates};
use sextant_sim::layout::PlacedNode;
use sextant_sim::{
    AntennasConfig, LinkConfig, LinkError, LinkTraceConfig, MacConfig, Network, NetworkTrace, NodesOfGroup,
    RadioConfig, ReceptionConfig, Technology, TraceStations, TrafficConfig, TrafficPlan,
};

use crate::check::errors::Errors;
use crate::config::ScenarioConfig;
use crate::config::network::NetworkConfig;

/// One network: its tables as written, and the key of each. Errors in what is made of them name these keys. Its channel and links
/// are checked at once, so that other checks can ask about them also if something else in the scenario has an error.
pub(crate) struct CheckedNetwork<'a> {
    /// Its name; `None` if it is the only network, with the tables of the scenario.
    pub(crate) name: Option<&'a str>,
    nodes: Option<&'a NodesOfGroup>,
    pub(crate) radio: Keyed<Option<&'a RadioConfig>>,
    channel: Keyed<&'a ChannelConfig>,
    link_trace: Keyed<Option<&'a LinkTraceConfig>>,
    pub(crate) mac: Keyed<&'a MacConfig>,
    traffic: Keyed<Option<&'a TrafficConfig>>,
    reception: Keyed<Option<&'a ReceptionConfig>>,
    ranging: Keyed<Option<&'a RangingDeviceConfig>>,
    pub(crate) antenna: Keyed<Option<&'a AntennasConfig>>,
    energy: Keyed<Option<&'a EnergyConfig>>,
    /// The law of its channel; `None` if it has an error or is not known.
    pub(super) law: Option<ChannelLaw>,
    /// The technology of its links; `None` if it has an error or is not known.
    pub(super) technology: Option<Technology>,
}

/// A value and the key of its table.
pub(crate) struct Keyed<T> {
    pub(crate) key: String,
    /// Whether the network has the table itself, and not the scenario for all.
    is_own: bool,
    pub(crate) value: T,
}

/// What tables of networks name.
#[derive(Clone, Copy)]
pub(crate) struct Named<'w> {
    /// The nodes of the world, if it has no error.
    pub(crate) nodes: Option<&'w [PlacedNode]>,
    pub(crate) files: &'w Files,
}

/// A chip whose energy is counted, though it has no number for something.
#[derive(Clone, Debug)]
pub struct IncompleteChip {
    /// The key that names it, or could name another one.
    pub key: String,
    /// The chip.
    pub chip: EnergyConfig,
    /// What it has no number for, and what is taken instead.
    pub gap: String,
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

impl<'a> CheckedNetwork<'a> {
    /// Each network of a scenario, in the order of their names; `check` fills in its channel and its links.
    pub(super) fn all(config: &'a ScenarioConfig, mut check: impl FnMut(&mut Self)) -> Vec<Self> {
        let named = config.networks.iter().map(Some);
        let networks = if config.networks.is_empty() { vec![None] } else { named.collect() };
        let mut all: Vec<Self> = networks.into_iter().map(|network| Self::of(config, network)).collect();
        all.iter_mut().for_each(&mut check);
        all
    }

    fn of(config: &'a ScenarioConfig, network: Option<(&'a String, &'a NetworkConfig)>) -> Self {
        macro_rules! pick {
            ($table:ident, $or:ident($whole:expr)) => {{
                let own = network.and_then(|(name, network)| Some((name, network.$table.as_ref()?)));
                let table = stringify!($table);
                let key = own.map_or_else(|| table.to_owned(), |(name, _)| format!("networks.{name}.{table}"));
                Keyed { key, is_own: own.is_some(), value: own.map(|(_, own)| own).$or($whole) }
            }};
        }
        Self {
            name: network.map(|(name, _)| name.as_str()),
            nodes: network.and_then(|(_, network)| network.nodes.as_ref()),
            radio: pick!(radio, or(config.radio.as_ref())),
            channel: pick!(channel, unwrap_or(&config.channel)),
            link_trace: pick!(link_trace, or(config.link_trace.as_ref())),
            mac: pick!(mac, unwrap_or(&config.mac)),
            traffic: pick!(traffic, or(config.traffic.as_ref())),
            reception: pick!(reception, or(config.reception.as_ref())),
            ranging: pick!(ranging, or(config.ranging.as_ref())),
            antenna: pick!(antenna, or(config.antenna.as_ref())),
            energy: pick!(energy, or(config.energy.as_ref())),
            law: None,
            technology: None,
        }
    }

    /// Whether its links sweep sectors.
    pub(crate) fn sweeps_sectors(&self) -> bool {
        self.mac.value.sweeps_sectors()
    }

    /// Whether programs command its radios.
    pub(crate) fn is_programmed(&self) -> bool {
        self.mac.value.is_programmed()
    }

    /// What its nodes send, if they do not answer sweeps instead, or have programs.
    pub(super) fn traffic_of_nodes(&self) -> Option<&'a TrafficConfig> {
        self.traffic.value.filter(|_| !self.sweeps_sectors() && !self.is_programmed())
    }

    /// Whether the network has this table for itself alone.
    fn is_its_own<T>(&self, table: &Keyed<Option<T>>) -> bool {
        table.value.is_some() && (self.name.is_none() || table.is_own)
    }

    /// How its channel reflects signals, if it does.
    pub(super) fn reflections(&self) -> Option<ReflectionsConfig> {
        self.channel.value.reflections
    }

    /// The law of its channel. An absent loss at the reference distance is that of free space at the carrier of its radios, which is that of the
    /// signals too, unless the channel has its own.
    pub(super) fn checked_law(&self, errors: &mut Errors) -> Option<ChannelLaw> {
        let channel = *self.channel.value;
        let of_radios = self.radio.value.map(|radio| radio.carrier_ghz(self.mac.value));
        let channel = of_radios.map_or(channel, |carrier_ghz| channel.with_free_space(carrier_ghz));
        let law = errors.take(&self.channel.key, ChannelLaw::try_from(channel))?;
        Some(of_radios.map_or(law, |carrier_ghz| law.for_radios_at(carrier_ghz)))
    }

    /// The law of its channel and the technology of its links, if both are known.
    pub(super) fn links(&self) -> Option<(&ChannelLaw, &Technology)> {
        self.law.as_ref().zip(self.technology.as_ref())
    }

    /// The network as it is simulated, if it has no error.
    pub(super) fn simulated(
        &self,
        config: &ScenarioConfig,
        named: Named<'_>,
        errors: &mut Errors,
    ) -> Option<Network> {
        let radio_states = errors.take(&self.energy.key, RadioStates::try_from(self.chip()));
        let traffic = self.traffic_plan(config, named, errors);
        let link_trace = self.link_trace(config, named, errors);
        let ranging = self.ranging.value.map(|&device| RangingDevice::try_from(device)).transpose();
        let ranging = errors.take(&self.ranging.key, ranging);
        let members = named.nodes.map(|nodes| errors.take("", self.members(nodes, config)));
        Some(Network {
            name: self.name.map(str::to_owned),
            channel: self.law?,
            technology: self.technology.clone()?,
            radio_states: radio_states?,
            link_trace: link_trace.map(Arc::new),
            traffic: traffic?,
            ranging: ranging?,
            members: members??,
        })
    }

    /// Its links as they were measured, if they are and the nodes are known.
    pub(super) fn link_trace(
        &self,
        config: &ScenarioConfig,
        Named { nodes, files }: Named<'_>,
        errors: &mut Errors,
    ) -> Option<NetworkTrace> {
        let trace = self.link_trace.value?;
        if self.sweeps_sectors() {
            let remedy = "remove the table: what was measured holds for one pair of antennas";
            errors.refuse(&SettingError::conflict(&self.link_trace.key, "`mac.sector_sweep`", remedy));
            return None;
        }
        let sinks: Vec<&str> = config.sinks.iter().map(|sink| sink.name.as_str()).collect();
        let stations = TraceStations { nodes: nodes?, sinks: &sinks, channels: &self.channels() };
        errors.take(&self.link_trace.key, trace.read(&stations, files))
    }

    /// The radio channels of its stations, if the radio is known.
    fn channels(&self) -> Vec<u8> {
        match (self.radio.value, self.mac.value) {
            (None, _) => Vec::new(),
            (Some(radio), MacConfig::Tsch(tsch)) => {
                tsch.hopping.clone().unwrap_or_else(|| Hopping::usual(radio.phy).channels().to_vec())
            }
            (Some(radio), _) => vec![radio.channel.unwrap_or(*radio.phy.channels().start())],
        }
    }

    /// The technology of its links.
    pub(super) fn checked_technology(&self, named: Named<'_>, errors: &mut Errors) -> Option<Technology> {
        let technology = Technology::read(&self.link_config(), named.nodes, named.files).map_err(|found| {
            found.into_iter().for_each(|error| match error {
                LinkError::Missing(table) => errors.refuse(&self.missing(table)),
                LinkError::Invalid { table, error } => errors.refuse(&error.within(self.key_of(table))),
            });
        });
        if !self.sweeps_sectors() && self.is_its_own(&self.antenna) {
            let with = "this `mac`: only `mac.sector_sweep` has antennas with sectors";
            errors.refuse(&SettingError::conflict(&self.antenna.key, with, "remove the table"));
        }
        technology.ok()
    }

    /// The tables of its links.
    pub(super) fn link_config(&self) -> LinkConfig<'a> {
        let Self { radio, mac, reception, antenna, .. } = self;
        LinkConfig { radio: radio.value, mac: mac.value, reception: reception.value, antenna: antenna.value }
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

    /// The chip that is counted.
    fn chip(&self) -> EnergyConfig {
        let usual = || match self.radio.value {
            _ if self.sweeps_sectors() => EnergyConfig::Mmwave60Ghz,
            radio => EnergyConfig::usual(radio.map(|radio| radio.phy).unwrap_or_default()),
        };
        self.energy.value.copied().unwrap_or_else(usual)
    }

    /// Whether robots measure the ranges to its nodes.
    pub(super) fn measures_ranges(&self) -> bool {
        self.ranging.value.is_some()
    }

    /// What its nodes send, if these are known.
    pub(super) fn traffic_plan(
        &self,
        config: &ScenarioConfig,
        Named { nodes, files }: Named<'_>,
        errors: &mut Errors,
    ) -> Option<TrafficPlan> {
        let silent = || nodes.map(|nodes| TrafficPlan::silent(nodes.len()));
        match self.traffic.value {
            Some(_) if self.sweeps_sectors() && self.is_its_own(&self.traffic) => {
                let remedy = "remove the table, because nodes answer sector sweeps and send nothing else";
                errors.refuse(&SettingError::conflict(&self.traffic.key, "`mac.sector_sweep`", remedy));
                None
            }
            _ if self.sweeps_sectors() => silent(),
            Some(traffic) if self.is_programmed() && !matches!(traffic, TrafficConfig::Silent(_)) => {
                if self.is_its_own(&self.traffic) {
                    let remedy = "remove the table, because nodes send what their programs say and nothing else";
                    errors.refuse(&SettingError::conflict(&self.traffic.key, "`mac.program`", remedy));
                    return None;
                }
                silent()
            }
            // Names of nodes are not known without a world.
            Some(traffic) if nodes.is_none() && traffic.names_nodes() => None,
            Some(traffic) => {
                let plan = TrafficPlan::new(traffic, nodes.unwrap_or_default(), files);
                errors.take(&self.traffic.key, plan).filter(|_| nodes.is_some())
            }
            // Nodes that compute a map, or that only take part in applications, send their messages alone.
            None if config.distributed_mapping.is_some() || !config.has_traffic() || self.is_programmed() => silent(),
            None => {
                errors.refuse(&self.missing("traffic"));
                None
            }
        }
    }

    /// Whether each of `nodes` is in the network, if it chooses some.
    ///
    /// # Errors
    /// If it chooses more nodes than there are, or one that there is not.
    pub(super) fn members(
        &self,
        nodes: &[PlacedNode],
        config: &ScenarioConfig,
    ) -> Result<Option<Vec<bool>>, SettingError> {
        let others = config.networks.iter().filter(|(name, _)| Some(name.as_str()) != self.name);
        let members = |chosen: &NodesOfGroup| {
            Ok(chosen_nodes(chosen, nodes)?.unwrap_or_else(|| {
                // An error in another network is reported there.
                let of_other = |(_, other): (_, &NetworkConfig)| chosen_nodes(other.nodes.as_ref()?, nodes).ok()?;
                let taken: Vec<_> = others.clone().filter_map(of_other).collect();
                (0..nodes.len()).map(|node| !taken.iter().any(|taken| taken[node])).collect()
            }))
        };
        let within = |error: SettingError| error.within(format!("networks.{}.nodes", self.name.unwrap_or_default()));
        self.nodes.map(members).transpose().map_err(within)
    }

    /// The named chip whose energy is counted, and its bands, if these are not the band of the radios.
    pub(super) fn foreign_chip(&self) -> Option<ForeignChip> {
        let phy = self.radio.value.filter(|_| !self.sweeps_sectors())?.phy;
        let chip = *self.energy.value?;
        let bands = chip.other_bands(phy)?;
        Some(ForeignChip { key: self.energy.key.clone(), chip, bands, phy })
    }

    /// What the chip whose energy is counted has no number for, if it is not complete.
    pub(super) fn incomplete_chip(&self) -> Vec<IncompleteChip> {
        let Some(radio) = self.radio.value.filter(|_| !self.sweeps_sectors()) else { return Vec::new() };
        let chip = self.chip();
        // A chip that nobody has named stands for any of its band.
        let powers = radio.groups.iter().filter_map(|group| group.tx_power_dbm).chain([radio.tx_power_dbm]);
        let power_dbm = powers.fold(f64::NEG_INFINITY, f64::max);
        let most = self.energy.value.and_then(|named| named.falls_short_of(Dbm(power_dbm)));
        let weak = most
            .map(|most| format!("sends with at most {} dBm: its current there is taken for {power_dbm} dBm", most.0));
        let incomplete = |gap: String| IncompleteChip { key: self.energy.key.clone(), chip, gap };
        chip.gap(radio.phy).map(str::to_owned).into_iter().chain(weak).map(incomplete).collect()
    }

    fn missing(&self, table: &str) -> SettingError {
        let place = self.name.map_or(String::new(), |name| format!("networks.{name}."));
        SettingError::missing_table(format!("{place}{table}"))
    }
}

/// Whether each of `nodes` is chosen; `None` if those are that no other network chooses.
fn chosen_nodes(chosen: &NodesOfGroup, nodes: &[PlacedNode]) -> Result<Option<Vec<bool>>, SettingError> {
    match chosen {
        NodesOfGroup::Count(count) if *count > nodes.len() => {
            Err(SettingError::new("count", count, format!("at most {}, the number of nodes", nodes.len())))
        }
        NodesOfGroup::Count(count) => Ok(Some((0..nodes.len()).map(|node| node < *count).collect())),
        NodesOfGroup::Names(names) => {
            let mut members = vec![false; nodes.len()];
            for (i, name) in names.iter().enumerate() {
                let node = nodes.iter().position(|node| node.name == *name);
                let refuse = || SettingError::new(format!("names[{i}]"), format!("`{name}`"), "the name of a node");
                members[node.ok_or_else(refuse)?] = true;
            }
            Ok(Some(members))
        }
        NodesOfGroup::Others {} => Ok(None),
    }
}
