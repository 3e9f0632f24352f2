//! The networks of a scenario: one, as the tables of the scenario say, or several by name.

pub(crate) mod network;
pub(crate) mod surveyed;

use sextant_kernel::{Files, SettingError};
use sextant_sim::{MacConfig, Network, NetworkId, Technology};

use super::errors::Errors;
use crate::config::ScenarioConfig;
use network::{CheckedNetwork, ForeignChip, IncompleteChip, Named};

/// The networks of a scenario, in the order of their numbers: at least one.
pub(crate) struct Networks<'a> {
    config: &'a ScenarioConfig,
    all: Vec<CheckedNetwork<'a>>,
}

impl<'a> Networks<'a> {
    /// The networks of a simulation.
    pub(crate) fn check(config: &'a ScenarioConfig, named: Named<'_>, errors: &mut Errors) -> Self {
        let check = |network: &mut CheckedNetwork<'a>| {
            network.law = network.checked_law(errors);
            network.technology = network.checked_technology(named, errors);
        };
        Self { config, all: CheckedNetwork::all(config, check) }
    }

    /// The networks of a log. That of a real robot has no channel, so links without radios or with errors are not known.
    pub(crate) fn of_log(config: &'a ScenarioConfig, files: &Files, errors: &mut Errors) -> Self {
        let check = |network: &mut CheckedNetwork<'a>| {
            network.law = network.radio.value.and_then(|_| network.checked_law(errors));
            network.technology = Technology::read(&network.link_config(), None, files).ok();
        };
        Self { config, all: CheckedNetwork::all(config, check) }
    }

    /// The networks as they are simulated, if none has an error.
    pub(crate) fn simulated(&self, named: Named<'_>, errors: &mut Errors) -> Option<Vec<Network>> {
        let networks = self.all.iter().map(|network| network.simulated(self.config, named, errors));
        // All are checked, also after one that has an error.
        networks.collect::<Vec<_>>().into_iter().collect()
    }

    /// A network.
    pub(crate) fn network(&self, network: NetworkId) -> &CheckedNetwork<'a> {
        &self.all[network.index()]
    }

    /// Whether the links of any network sweep sectors.
    pub(crate) fn sweep_sectors(&self) -> bool {
        self.all.iter().any(|network| network.sweeps_sectors())
    }

    /// Whether programs command the radios of any network.
    pub(crate) fn have_programs(&self) -> bool {
        self.all.iter().any(|network| network.is_programmed())
    }

    /// The key of the channel access of the first network, in which nodes discover their neighbours, if that is one by which
    /// they send no hellos.
    pub(crate) fn first_without_hellos(&self) -> Option<String> {
        let mac = self.all.first()?.mac.value;
        match mac {
            MacConfig::Program(_) | MacConfig::Tsch(_) | MacConfig::Sleep(_) => Some(format!("mac.{}", mac.key())),
            MacConfig::CsmaUnslotted(_) | MacConfig::BeaconEnabled(_) | MacConfig::SectorSweep(_) => None,
        }
    }

    /// The named chips whose energy is counted, though they have not the band of the radios.
    pub(crate) fn foreign_chips(&self) -> Vec<ForeignChip> {
        self.all.iter().filter_map(|network| network.foreign_chip()).collect()
    }

    /// The chips whose energy is counted, though they have no number for something.
    pub(crate) fn incomplete_chips(&self) -> Vec<IncompleteChip> {
        self.all.iter().flat_map(|network| network.incomplete_chip()).collect()
    }

    /// The number of the network `name`, or of the only one.
    ///
    /// # Errors
    /// If there is no network of this name, or several and no name.
    pub(crate) fn number(&self, key: &str, name: Option<&str>) -> Result<NetworkId, SettingError> {
        let names = || self.all.iter().filter_map(|network| network.name);
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
