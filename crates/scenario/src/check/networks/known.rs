//! The networks whose logs maps may use, and what maps may know of each.

use sextant_apps::ControllerConfig;
use sextant_kernel::SettingError;
use sextant_mapper::{
    AlgorithmConfig, ChannelProfileConfig, MapConfig, ProfileConfig, RangingConfig, ReceiverSetting,
};
use sextant_sim::{RobotConfig, RoleConfig, TrafficConfig};

use super::{CheckedLinks, NetworkTables};

/// The networks that robots survey, in the order of their logs.
#[derive(Clone, Debug, Default)]
pub(crate) struct KnownNetworks(Vec<KnownNetwork>);

/// A network that robots survey.
#[derive(Clone, Debug)]
struct KnownNetwork {
    name: Option<String>,
    /// Its channel and its links; `None` if they are not known.
    links: Option<CheckedLinks>,
    packets_per_stop: PacketsPerStop,
    /// Whether its links sweep sectors, so that a log of it has sectors.
    sweeps_sectors: bool,
}

/// How many packets a node sends while a robot listens at a stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PacketsPerStop {
    /// The mean over the robots; 1 if there are none.
    pub mean: f64,
    /// Whether this number is the same at all stops of all robots.
    pub is_alike: bool,
}

impl PacketsPerStop {
    /// Of nodes that send `traffic` while `robots` listen.
    fn new(traffic: Option<&TrafficConfig>, robots: &[RobotConfig<ControllerConfig>]) -> Self {
        let packets = |robot: &RobotConfig<ControllerConfig>| match traffic {
            // The answers to all sweeps of a stop share its shadowing, so they count as one packet.
            None => 1.0,
            Some(traffic) => match traffic {
                TrafficConfig::Beacon(periodic) | TrafficConfig::Periodic(periodic) => {
                    robot.listen_s / periodic.interval_s
                }
                TrafficConfig::Poisson(poisson) => robot.listen_s * poisson.rate_per_s,
                // A rate that is not known, or differs between nodes, counts as one packet.
                TrafficConfig::Query(_)
                | TrafficConfig::Once(_)
                | TrafficConfig::Saturated(_)
                | TrafficConfig::Trace(_)
                | TrafficConfig::Groups(_)
                | TrafficConfig::Silent(_) => 1.0,
            },
        };
        let robots = || robots.iter().filter(|robot| robot.role != RoleConfig::Agent);
        // Slots on a drive are longer.
        let stands = robots().all(|robot| !robot.listen_while_driving);
        let least = robots().map(packets).fold(f64::INFINITY, f64::min);
        let most = robots().map(packets).fold(0.0, f64::max);
        let count = robots().count();
        let mean = if count == 0 { 1.0 } else { robots().map(packets).sum::<f64>() / count as f64 };
        Self { mean, is_alike: stands && least >= most }
    }
}

impl KnownNetworks {
    /// The networks that `robots` survey, of those in `tables` with these `links`; the first of them if there are no
    /// robots.
    pub(crate) fn new(
        tables: &[NetworkTables<'_>],
        links: &[Option<CheckedLinks>],
        robots: &[RobotConfig<ControllerConfig>],
    ) -> Self {
        let surveys = |(table, _): &(&NetworkTables<'_>, _)| {
            robots.iter().filter(|robot| robot.role == RoleConfig::Survey).any(|robot| {
                let named = robot.networks.iter().chain(&robot.network);
                table.name.is_none() || named.into_iter().any(|name| Some(name.as_str()) == table.name)
            })
        };
        let all = || tables.iter().zip(links);
        let mut surveyed: Vec<_> = all().filter(surveys).collect();
        if surveyed.is_empty() {
            surveyed.extend(all().next());
        }
        let known = |(table, links): (&NetworkTables<'_>, &Option<CheckedLinks>)| KnownNetwork {
            name: table.name.map(str::to_owned),
            links: links.clone(),
            packets_per_stop: PacketsPerStop::new(table.traffic_of_nodes(), robots),
            sweeps_sectors: table.sweeps_sectors(),
        };
        Self(surveyed.into_iter().map(known).collect())
    }

    /// What nodes send in the first network.
    pub(crate) fn packets_per_stop(&self) -> Option<PacketsPerStop> {
        self.0.first().map(|network| network.packets_per_stop)
    }

    /// Whether a log of the network called `name`, or of the first one, has sectors; true if there is no such network.
    pub(crate) fn sweep_sectors(&self, name: Option<&str>) -> bool {
        self.find("network", name).ok().flatten().is_none_or(|network| network.sweeps_sectors)
    }

    /// Whether the channel and the links of all networks are known.
    pub(crate) fn are_known(&self) -> bool {
        self.0.iter().all(|network| network.links.is_some())
    }

    /// Checks the networks that a map names, and fills in the absent channel settings of the map.
    ///
    /// # Errors
    /// If robots survey no network of that name.
    pub(crate) fn complete(&self, map: &mut MapConfig) -> Result<(), SettingError> {
        if let (Some(name), Some(_)) = (&map.network, map.algorithm.networks()) {
            let allowed = "no key: `algorithm.joint.networks` names the networks";
            return Err(SettingError::new("network", format!("`{name}`"), allowed));
        }
        let of_map = self.find("network", map.network.as_deref())?;
        if let Some(network) = of_map {
            network.complete(&mut map.algorithm);
        }
        for (i, member) in map.algorithm.networks().into_iter().flatten().enumerate() {
            self.find(&format!("algorithm.{}.networks[{i}].network", map.algorithm.key()), Some(member))?;
        }
        for setting in map.algorithm.profiles_mut() {
            let network = match &setting.network {
                None => of_map,
                Some(name) => self.find(&setting.key, Some(name))?,
            };
            if let Some(network) = network {
                network.complete_profile(setting.profile);
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

impl KnownNetwork {
    /// Fills in the absent channel settings of an algorithm that knows the channel, without those of its profiles.
    fn complete(&self, algorithm: &mut AlgorithmConfig) {
        let Some(links) = &self.links else { return };
        let (channel, path_loss) = (&links.channel, links.channel.path_loss());
        if let Some(ranging) = algorithm.ranging_mut() {
            let RangingConfig { exponent, tx_power_dbm, reference_distance_m, sigma_db } = ranging;
            exponent.get_or_insert(path_loss.exponent());
            tx_power_dbm.get_or_insert(links.power_at_reference_dbm());
            reference_distance_m.get_or_insert(path_loss.reference_distance_m());
            sigma_db.get_or_insert(channel.shadowing().sigma_db());
        }
        if let Some(ReceiverSetting { sensitivity_dbm, max_range_m }) = algorithm.receiver_mut() {
            sensitivity_dbm.get_or_insert(links.technology.sensitivity().0);
            *max_range_m = max_range_m.or(links.max_range_m());
        }
    }

    /// Fills in the absent settings of a profile that is that of the channel.
    fn complete_profile(&self, profile: &mut ProfileConfig) {
        let (Some(links), ProfileConfig::Channel(profile)) = (&self.links, profile) else { return };
        let (channel, path_loss) = (&links.channel, links.channel.path_loss());
        let ChannelProfileConfig { exponent, sigma_db, tx_power_dbm, sensitivity_dbm, .. } = profile;
        exponent.get_or_insert(path_loss.exponent());
        sigma_db.get_or_insert(channel.shadowing().sigma_db());
        tx_power_dbm.get_or_insert(links.power_at_reference_dbm());
        sensitivity_dbm.get_or_insert(links.technology.sensitivity().0);
        profile.max_range_m = profile.max_range_m.or(links.max_range_m());
        profile.reference_distance_m.get_or_insert(path_loss.reference_distance_m());
        profile.min_distance_m.get_or_insert(path_loss.min_distance_m());
        if path_loss.gas_db_per_m() > 0.0 {
            profile.gas_db_per_km.get_or_insert(1000.0 * path_loss.gas_db_per_m());
        }
        profile.carrier_ghz = profile.carrier_ghz.or(channel.carrier_ghz());
        profile.packets_per_stop.get_or_insert(self.packets_per_stop.mean);
    }
}
