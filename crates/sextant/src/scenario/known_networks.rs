//! The networks whose logs maps may use, and what maps may know of each.

use std::path::Path;

use sextant_apps::ControllerConfig;
use sextant_channel::{ChannelLaw, Db};
use sextant_kernel::SettingError;
use sextant_mapper::{AlgorithmConfig, MapConfig};
use sextant_sim::{Antennas, MacConfig, RobotConfig, RoleConfig};

use super::known_channel::KnownChannel;
use super::networks::NetworkTables;

/// The networks that robots survey, in the order of their logs.
#[derive(Clone, Debug, Default)]
pub(super) struct KnownNetworks(Vec<KnownNetwork>);

/// A network that robots survey.
#[derive(Clone, Debug)]
struct KnownNetwork {
    name: Option<String>,
    /// Its channel; `None` if the scenario does not tell it.
    channel: Option<KnownChannel>,
}

impl KnownNetworks {
    /// The networks in `tables` that `robots` survey; the first of them if there are no robots. The files that the tables
    /// name are in `folder`; if it is absent, they cannot be read.
    pub(super) fn new(
        tables: &[NetworkTables<'_>],
        robots: &[RobotConfig<ControllerConfig>],
        folder: Option<&Path>,
    ) -> Self {
        let surveys = |table: &&NetworkTables<'_>| {
            robots.iter().filter(|robot| robot.role == RoleConfig::Survey).any(|robot| {
                let named = robot.networks.iter().chain(&robot.network);
                table.name.is_none() || named.into_iter().any(|name| Some(name.as_str()) == table.name)
            })
        };
        let mut surveyed: Vec<_> = tables.iter().filter(surveys).collect();
        if surveyed.is_empty() {
            surveyed.extend(tables.first());
        }
        let known = |table: &NetworkTables<'_>| KnownNetwork {
            name: table.name.map(str::to_owned),
            channel: known_channel(table, robots, folder),
        };
        Self(surveyed.into_iter().map(known).collect())
    }

    /// The channel of the first network.
    pub(super) fn first_channel(&self) -> Option<KnownChannel> {
        self.0.first()?.channel
    }

    /// Checks the networks that a map names, and fills in the absent channel settings of the map.
    ///
    /// # Errors
    /// If robots survey no network of that name.
    pub(super) fn complete(&self, map: &mut MapConfig) -> Result<(), SettingError> {
        if let (Some(name), AlgorithmConfig::Joint(_)) = (&map.network, &map.algorithm) {
            let allowed = "no key: `algorithm.joint.networks` names the networks";
            return Err(SettingError::new("network", format!("`{name}`"), allowed));
        }
        let of_map = self.find("network", map.network.as_deref())?.and_then(|network| network.channel);
        if let Some(channel) = of_map {
            channel.complete(&mut map.algorithm);
        }
        if let AlgorithmConfig::Joint(joint) = &map.algorithm {
            for (i, member) in joint.networks.iter().enumerate() {
                self.find(&format!("algorithm.joint.networks[{i}].network"), Some(&member.network))?;
            }
        }
        for setting in map.algorithm.profiles_mut() {
            let channel = match &setting.network {
                None => of_map,
                Some(name) => self.find(&setting.key, Some(name))?.and_then(|network| network.channel),
            };
            if let Some(channel) = channel {
                channel.complete_profile(setting.profile);
            }
        }
        Ok(())
    }

    /// The network called `name`, or the first one.
    fn find(&self, key: &str, name: Option<&str>) -> Result<Option<&KnownNetwork>, SettingError> {
        let Some(name) = name else { return Ok(self.0.first()) };
        let found = self.0.iter().find(|network| network.name.as_deref() == Some(name));
        found.map(Some).ok_or_else(|| {
            let names: Vec<String> =
                self.0.iter().filter_map(|network| Some(format!("`{}`", network.name.as_ref()?))).collect();
            let allowed = match names[..] {
                [] => "no name: there is one network".to_owned(),
                [_] => format!("{}, which is the only network that robots survey", names[0]),
                _ => format!("{}, the networks that robots survey", names.join(", ")),
            };
            SettingError::new(key, format!("`{name}`"), allowed)
        })
    }
}

/// What maps may know of the channel of a network, if its tables are sound and their files can be read.
fn known_channel(
    table: &NetworkTables<'_>,
    robots: &[RobotConfig<ControllerConfig>],
    folder: Option<&Path>,
) -> Option<KnownChannel> {
    let law = ChannelLaw::try_from(*table.channel.value).ok()?;
    let (gain, traffic) = match table.mac.value {
        MacConfig::SectorSweep(_) => {
            let mut antennas = table.antenna.value?.clone();
            if folder.is_none() && antennas.files_mut().next().is_some() {
                return None;
            }
            (Antennas::read(&antennas, folder.unwrap_or(Path::new(""))).ok()?.sweep_gain(), None)
        }
        _ => (Db(0.0), table.traffic.value),
    };
    Some(KnownChannel::new(table.radio.value?, (law, gain), traffic, robots))
}
