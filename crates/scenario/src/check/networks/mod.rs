//! The networks of a scenario: one, as the tables of the scenario say, or several by name.

pub(crate) mod surveyed;
pub(crate) mod tables;

use std::sync::Arc;

use sextant_channel::ChannelLaw;
use sextant_kernel::{Files, SettingError};
use sextant_sim::{MacConfig, Network, NetworkId, Technology};

use super::errors::Errors;
use crate::config::ScenarioConfig;
use tables::{ForeignChip, IncompleteChip, Named, NetworkTables};

/// The networks of a scenario, in the order of their numbers: at least one.
pub(crate) struct Networks<'a> {
    config: &'a ScenarioConfig,
    all: Vec<CheckedNetwork<'a>>,
}

/// A network whose channel and links are checked, so that other checks can ask about it also if something else in the
/// scenario has an error.
struct CheckedNetwork<'a> {
    tables: NetworkTables<'a>,
    /// The law of its channel; `None` if it has an error or is not known.
    channel: Option<ChannelLaw>,
    /// The technology of its links; `None` if it has an error or is not known.
    technology: Option<Technology>,
}

impl<'a> Networks<'a> {
    /// The networks of a simulation.
    pub(crate) fn check(config: &'a ScenarioConfig, named: Named<'_>, errors: &mut Errors) -> Self {
        let check = |tables: NetworkTables<'a>| {
            let channel = tables.law(errors);
            let technology = tables.technology(named, errors);
            CheckedNetwork { tables, channel, technology }
        };
        Self { config, all: NetworkTables::all(config).into_iter().map(check).collect() }
    }

    /// The networks of a log. That of a real robot has no channel, so links without radios or with errors are not known.
    pub(crate) fn of_log(config: &'a ScenarioConfig, files: &Files, errors: &mut Errors) -> Self {
        let check = |tables: NetworkTables<'a>| {
            let channel = tables.radio.value.and_then(|_| tables.law(errors));
            let technology = Technology::read(&tables.link_config(), None, files).ok();
            CheckedNetwork { tables, channel, technology }
        };
        Self { config, all: NetworkTables::all(config).into_iter().map(check).collect() }
    }

    /// The networks as they are simulated, if none has an error.
    pub(crate) fn simulated(&self, named: Named<'_>, errors: &mut Errors) -> Option<Vec<Network>> {
        let networks = self.all.iter().map(|network| network.simulated(self.config, named, errors));
        // All are checked, also after one that has an error.
        networks.collect::<Vec<_>>().into_iter().collect()
    }

    /// The tables of a network.
    pub(crate) fn tables(&self, network: NetworkId) -> &NetworkTables<'a> {
        &self.all[network.index()].tables
    }

    /// Whether the links of any network sweep sectors.
    pub(crate) fn sweep_sectors(&self) -> bool {
        self.all.iter().any(|network| network.tables.sweeps_sectors())
    }

    /// Whether programs command the radios of any network.
    pub(crate) fn have_programs(&self) -> bool {
        self.all.iter().any(|network| network.tables.is_programmed())
    }

    /// The key of the channel access of the first network, in which nodes discover their neighbours, if that is one by which
    /// they send no hellos.
    pub(crate) fn first_without_hellos(&self) -> Option<String> {
        let mac = self.all.first()?.tables.mac.value;
        match mac {
            MacConfig::Program(_) | MacConfig::Tsch(_) | MacConfig::Sleep(_) => Some(format!("mac.{}", mac.key())),
            MacConfig::CsmaUnslotted(_) | MacConfig::BeaconEnabled(_) | MacConfig::SectorSweep(_) => None,
        }
    }

    /// The named chips whose energy is counted, though they have not the band of the radios.
    pub(crate) fn foreign_chips(&self) -> Vec<ForeignChip> {
        self.all.iter().filter_map(|network| network.tables.foreign_chip()).collect()
    }

    /// The chips whose energy is counted, though they have no number for something.
    pub(crate) fn incomplete_chips(&self) -> Vec<IncompleteChip> {
        self.all.iter().flat_map(|network| network.tables.incomplete_chip()).collect()
    }

    /// The number of the network `name`, or of the only one.
    ///
    /// # Errors
    /// If there is no network of this name, or several and no name.
    pub(crate) fn number(&self, key: &str, name: Option<&str>) -> Result<NetworkId, SettingError> {
        let names = || self.all.iter().filter_map(|network| network.tables.name);
        let known = || names().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
        let position = match name {
            None if self.all.len() == 1 => Some(0),
            None => {
                let allowed = format!("one of {}, because there are several networks", known());
                return Err(SettingError::new(key, "nothing", allowed));
            }
            Some(name) => names().position(|other| other == name),
        };
        let position = position.and_then(|position| u8::try_from(position).ok());
        position.map(NetworkId).ok_or_else(|| {
            let name = name.unwrap_or_default();
            let is_alone = names().next().is_none();
            let allowed = if is_alone { "no name: there is one network".to_owned() } else { known() };
            SettingError::new(key, format!("`{name}`"), allowed)
        })
    }
}

impl CheckedNetwork<'_> {
    /// The law of its channel and the technology of its links, if both are known.
    fn links(&self) -> Option<(&ChannelLaw, &Technology)> {
        self.channel.as_ref().zip(self.technology.as_ref())
    }

    /// The network as it is simulated, if it has no error.
    fn simulated(&self, config: &ScenarioConfig, named: Named<'_>, errors: &mut Errors) -> Option<Network> {
        let radio_states = self.tables.radio_states(errors);
        let traffic = self.tables.traffic_plan(config, named, errors);
        let link_trace = self.tables.link_trace(config, named, errors);
        let ranging = errors.take("", self.tables.ranging());
        let members = named.nodes.map(|nodes| errors.take("", self.tables.members(nodes, config)));
        Some(Network {
            name: self.tables.name.map(str::to_owned),
            channel: self.channel?,
            technology: self.technology.clone()?,
            radio_states: radio_states?,
            link_trace: link_trace.map(Arc::new),
            traffic: traffic?,
            ranging: ranging?,
            members: members??,
        })
    }
}
