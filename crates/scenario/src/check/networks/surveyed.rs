//! What maps may know of the networks that robots survey.

use sextant_apps::ControllerConfig;
use sextant_channel::{ChannelLaw, ReflectionsConfig};
use sextant_kernel::SettingError;
use sextant_mapper::{
    AlgorithmConfig, ChannelProfileConfig, MapConfig, ObstacleUse, ProfileConfig, RangingConfig, ReceiverSetting,
};
use sextant_sim::{RobotConfig, RoleConfig, Technology, TrafficConfig};

use super::Networks;
use super::network::CheckedNetwork;

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
            Some(TrafficConfig::Beacon(periodic) | TrafficConfig::Periodic(periodic)) => {
                robot.listen_s / periodic.interval_s
            }
            Some(TrafficConfig::Poisson(poisson)) => robot.listen_s * poisson.rate_per_s,
            // The answers to all sweeps of a stop share its shadowing, so they count as one packet. So does a rate that is
            // not known, or differs between nodes.
            None
            | Some(
                TrafficConfig::Query(_)
                | TrafficConfig::Once(_)
                | TrafficConfig::Saturated(_)
                | TrafficConfig::Trace(_)
                | TrafficConfig::Groups(_)
                | TrafficConfig::Silent(_),
            ) => 1.0,
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

impl<'a> Networks<'a> {
    /// Those that robots survey, in the order of their logs; the first network if there are none.
    fn surveyed(&self) -> Vec<&CheckedNetwork<'a>> {
        let is_surveyed = |network: &&CheckedNetwork<'_>| {
            self.config.robots.iter().filter(|robot| robot.role == RoleConfig::Survey).any(|robot| {
                let mut named = robot.networks.iter().chain(&robot.network);
                network.name.is_none_or(|own| named.any(|name| name == own))
            })
        };
        let surveyed: Vec<_> = self.all.iter().filter(is_surveyed).collect();
        if surveyed.is_empty() { self.all.iter().take(1).collect() } else { surveyed }
    }

    /// How many packets a node sends while a robot listens at a stop, in the first of them.
    pub(crate) fn packets_per_stop(&self) -> PacketsPerStop {
        self.packets_in(self.surveyed()[0])
    }

    fn packets_in(&self, network: &CheckedNetwork<'_>) -> PacketsPerStop {
        PacketsPerStop::new(network.traffic_of_nodes(), &self.config.robots)
    }

    /// Whether a log of the network called `name`, or of the first one, has sectors; true if there is no such network.
    pub(crate) fn log_has_sectors(&self, name: Option<&str>) -> bool {
        self.find("network", name).ok().is_none_or(|network| network.sweeps_sectors())
    }

    /// Whether a log of the network called `name`, or of the first one, has ranges; true if there is no such network.
    pub(crate) fn log_has_ranges(&self, name: Option<&str>) -> bool {
        self.find("network", name).ok().is_none_or(|network| network.measures_ranges())
    }

    /// Whether the channel and the links of all surveyed networks are known.
    pub(crate) fn are_known_to_maps(&self) -> bool {
        self.surveyed().iter().all(|network| network.links().is_some())
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
        of_map.complete(&mut map.algorithm);
        for (i, member) in map.algorithm.networks().into_iter().flatten().enumerate() {
            self.find(&format!("algorithm.{}.networks[{i}].network", map.algorithm.key()), Some(member))?;
        }
        for setting in map.algorithm.profiles_mut() {
            let network = match &setting.network {
                None => of_map,
                Some(name) => self.find(&setting.key, Some(name))?,
            };
            if let ProfileConfig::Channel(profile) = setting.profile {
                network.complete_profile(profile, self.packets_in(network));
            }
        }
        Ok(())
    }

    /// The surveyed network called `name`, or the first one.
    fn find(&self, key: &str, name: Option<&str>) -> Result<&CheckedNetwork<'a>, SettingError> {
        let surveyed = self.surveyed();
        let Some(name) = name else { return Ok(surveyed[0]) };
        surveyed.iter().copied().find(|network| network.name == Some(name)).ok_or_else(|| {
            let names: Vec<String> =
                surveyed.iter().filter_map(|network| Some(format!("`{}`", network.name?))).collect();
            let allowed = match &names[..] {
                [] => "no name: there is one network".to_owned(),
                [only] => format!("{only}, which is the only network that robots survey"),
                _ => format!("{}, the networks that robots survey", names.join(", ")),
            };
            SettingError::new(key, format!("`{name}`"), allowed)
        })
    }
}

impl CheckedNetwork<'_> {
    /// Fills in the absent channel settings of an algorithm that knows the channel, without those of its profiles.
    fn complete(&self, algorithm: &mut AlgorithmConfig) {
        let Some((channel, technology)) = self.links() else { return };
        let path_loss = channel.path_loss();
        if let Some(ranging) = algorithm.ranging_mut() {
            let RangingConfig { exponent, tx_power_dbm, reference_distance_m, sigma_db } = ranging;
            exponent.get_or_insert(path_loss.exponent());
            tx_power_dbm.get_or_insert(power_at_reference_dbm(channel, technology));
            reference_distance_m.get_or_insert(path_loss.reference_distance_m());
            sigma_db.get_or_insert(spread_db(channel));
        }
        if let Some(ReceiverSetting { sensitivity_dbm, max_range_m }) = algorithm.receiver_mut() {
            sensitivity_dbm.get_or_insert(technology.sensitivity().0);
            *max_range_m = max_range_m.or(limited_range_m(channel));
        }
        if let Some(sectors) = algorithm.sectors_mut()
            && sectors.obstacles != ObstacleUse::Unknown
        {
            sectors.carrier_ghz = sectors.carrier_ghz.or(channel.signal_ghz());
            // Where nothing reflects, obstacles absorb alone.
            let of_channel = self.reflections();
            let nothing = ReflectionsConfig { order: 0, ..ReflectionsConfig::default() };
            sectors.reflections.get_or_insert(of_channel.unwrap_or(nothing));
        }
    }

    /// Fills in the absent settings of a profile that is that of the channel.
    fn complete_profile(&self, profile: &mut ChannelProfileConfig, packets_per_stop: PacketsPerStop) {
        let Some((channel, technology)) = self.links() else { return };
        let path_loss = channel.path_loss();
        profile.exponent.get_or_insert(path_loss.exponent());
        profile.sigma_db.get_or_insert(spread_db(channel));
        profile.tx_power_dbm.get_or_insert(power_at_reference_dbm(channel, technology));
        profile.sensitivity_dbm.get_or_insert(technology.sensitivity().0);
        profile.max_range_m = profile.max_range_m.or(limited_range_m(channel));
        profile.reference_distance_m.get_or_insert(path_loss.reference_distance_m());
        profile.min_distance_m.get_or_insert(path_loss.min_distance_m());
        if path_loss.gas_db_per_m() > 0.0 {
            profile.gas_db_per_km.get_or_insert(1000.0 * path_loss.gas_db_per_m());
        }
        profile.carrier_ghz = profile.carrier_ghz.or(channel.signal_ghz());
        profile.packets_per_stop.get_or_insert(packets_per_stop.mean);
    }
}

/// The power at the reference distance with the best sectors (dBm), the mean of the decibels: maps take it as the transmit
/// power.
fn power_at_reference_dbm(channel: &ChannelLaw, technology: &Technology) -> f64 {
    let power_dbm = technology.tx_power().0 + technology.link_gain().0;
    let by_fading_db = channel.fading().map_or(0.0, |fading| fading.decibels().0);
    power_dbm - channel.path_loss().reference_loss().0 + by_fading_db
}

/// The standard deviation of a power about its mean in decibels (dB): that of shadowing, and of fading if there is any.
fn spread_db(channel: &ChannelLaw) -> f64 {
    let sigma_db = channel.shadowing().sigma_db();
    channel.fading().map_or(sigma_db, |fading| (sigma_db.powi(2) + fading.decibels().1.powi(2)).sqrt())
}

/// The radius of communication (m), if it is limited.
fn limited_range_m(channel: &ChannelLaw) -> Option<f64> {
    Some(channel.max_range_m()).filter(|range_m| range_m.is_finite())
}
