//! The channel of a scenario, for maps that may know it.

use sextant_apps::ControllerConfig;
use sextant_channel::{ChannelLaw, Db};
use sextant_mapper::{AlgorithmConfig, ChannelProfileConfig, ProfileConfig, RangingConfig};
use sextant_sim::{RadioConfig, RobotConfig, RoleConfig, TrafficConfig};

/// The channel of a scenario, for maps that may know it.
#[derive(Clone, Copy, Debug)]
pub struct KnownChannel {
    /// Transmit power, but for groups of nodes (dBm).
    pub tx_power_dbm: f64,
    /// Minimum power of a frame that can be received, but for groups of nodes (dBm).
    pub sensitivity_dbm: f64,
    /// Path loss and shadowing.
    pub channel: ChannelLaw,
    /// Gain of both antennas of a link together, in the weaker direction of a sector sweep.
    pub gain: Db,
    /// Mean number of packets that a node sends while a robot listens at a stop, over the robots; 1 if there are none.
    pub packets_per_stop: f64,
    /// Whether this number is the same at all stops of all robots.
    pub is_alike_at_all_stops: bool,
}

impl KnownChannel {
    pub(super) fn new(
        radio: &RadioConfig,
        (channel, gain): (ChannelLaw, Db),
        traffic: Option<&TrafficConfig>,
        robots: &[RobotConfig<ControllerConfig>],
    ) -> Self {
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
        let packets_per_stop = if count == 0 { 1.0 } else { robots().map(packets).sum::<f64>() / count as f64 };
        let (tx_power_dbm, sensitivity_dbm) = (radio.tx_power_dbm, radio.sensitivity_dbm);
        Self {
            tx_power_dbm,
            sensitivity_dbm,
            channel,
            gain,
            packets_per_stop,
            is_alike_at_all_stops: stands && least >= most,
        }
    }

    /// The power at the reference distance with the best sectors (dBm): maps take it as the transmit power.
    fn power_at_reference_dbm(&self) -> f64 {
        (self.tx_power_dbm + self.gain.0) - self.channel.path_loss().reference_loss().0
    }

    /// The radius of communication (m), if it is limited.
    fn max_range_m(&self) -> Option<f64> {
        Some(self.channel.max_range_m()).filter(|range_m| range_m.is_finite())
    }

    /// Fills in the absent channel settings of an algorithm that knows the channel, without those of its profiles.
    pub(super) fn complete(&self, algorithm: &mut AlgorithmConfig) {
        let path_loss = self.channel.path_loss();
        let tx_power_dbm_at_reference = self.power_at_reference_dbm();
        let sigma_of_channel_db = self.channel.shadowing().sigma_db();
        if let Some(ranging) = algorithm.ranging_mut() {
            let RangingConfig { exponent, tx_power_dbm, reference_distance_m, sigma_db } = ranging;
            exponent.get_or_insert(path_loss.exponent());
            tx_power_dbm.get_or_insert(tx_power_dbm_at_reference);
            reference_distance_m.get_or_insert(path_loss.reference_distance_m());
            sigma_db.get_or_insert(sigma_of_channel_db);
        }
        if let AlgorithmConfig::RssGrid(grid) = algorithm {
            grid.sensitivity_dbm.get_or_insert(self.sensitivity_dbm);
            grid.max_range_m = grid.max_range_m.or(self.max_range_m());
        }
    }

    /// Fills in the absent settings of a profile that is that of the channel.
    pub(super) fn complete_profile(&self, profile: &mut ProfileConfig) {
        let path_loss = self.channel.path_loss();
        let ProfileConfig::Channel(profile) = profile else { return };
        let ChannelProfileConfig { exponent, sigma_db, tx_power_dbm, sensitivity_dbm, .. } = profile;
        exponent.get_or_insert(path_loss.exponent());
        sigma_db.get_or_insert(self.channel.shadowing().sigma_db());
        tx_power_dbm.get_or_insert(self.power_at_reference_dbm());
        sensitivity_dbm.get_or_insert(self.sensitivity_dbm);
        profile.max_range_m = profile.max_range_m.or(self.max_range_m());
        profile.reference_distance_m.get_or_insert(path_loss.reference_distance_m());
        profile.min_distance_m.get_or_insert(path_loss.min_distance_m());
        if path_loss.gas_db_per_m() > 0.0 {
            profile.gas_db_per_km.get_or_insert(1000.0 * path_loss.gas_db_per_m());
        }
        profile.carrier_ghz = profile.carrier_ghz.or(self.channel.carrier_ghz());
        profile.packets_per_stop.get_or_insert(self.packets_per_stop);
    }

    /// Whether the receptions at two stops are independent, given the position of the node.
    #[must_use]
    pub fn is_independent(&self) -> bool {
        !self.channel.shadowing().is_spatial()
    }
}
