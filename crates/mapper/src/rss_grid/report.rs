//! How a fitted channel reads.

use sextant_kernel::text::counted;

use super::FittedChannel;
use crate::learned::{Finding, Line, Section, Unconverged};
use crate::topology_map::TopologyMap;

#[cfg(feature = "config")]
/// A channel that was estimated from the log.
#[derive(serde::Serialize)]
struct ChannelKeys {
    /// Rounds of the estimation.
    rounds: u32,
    /// Whether it converged, and no node has a concern.
    converged: bool,
    /// Path loss exponent.
    exponent: f64,
    /// Mean signal strength over the reference distance (dBm).
    tx_power_dbm: f64,
    /// The reference distance (m).
    reference_distance_m: f64,
    /// Standard deviation of the signal strengths (dB).
    sigma_db: f64,
    /// Least signal strength at which packets are received (dBm).
    sensitivity_dbm: f64,
    /// Probability that a link that is strong enough is silent all the same, 0 to 1.
    loss: f64,
}

impl FittedChannel {
    /// A node whose place is not reliable has not converged.
    fn converged_in(&self, map: &TopologyMap) -> bool {
        self.converged && map.concerns().next().is_none()
    }
}

impl Finding for FittedChannel {
    #[cfg(feature = "config")]
    fn keys(&self, map: &TopologyMap) -> serde_json::Map<String, serde_json::Value> {
        let keys = ChannelKeys {
            rounds: self.rounds,
            converged: self.converged_in(map),
            exponent: self.exponent,
            tx_power_dbm: self.tx_power_dbm,
            reference_distance_m: self.reference_distance_m,
            sigma_db: self.sigma_db,
            sensitivity_dbm: self.sensitivity_dbm,
            loss: self.loss,
        };
        crate::learned::one_key("fitted_channel", &keys)
    }

    fn lines(&self, name: &str, map: &TopologyMap) -> Vec<Line> {
        let end = if self.converged_in(map) { "converged" } else { "did not converge" };
        let text = format!(
            "{name}: fitted channel: exponent {:.2}, {:.1} dBm at {} m, deviation {:.1} dB, sensitivity {:.1} dBm, {:.0} % \
             lost; {end} in {}",
            self.exponent,
            self.tx_power_dbm,
            self.reference_distance_m,
            self.sigma_db,
            self.sensitivity_dbm,
            100.0 * self.loss,
            counted(self.rounds as usize, "round")
        );
        let why = Unconverged::of(self.converged, map);
        let warning = why.map(|why| why.warning(name, "the fitted channel", self.rounds, None));
        std::iter::once(Line { section: Section::Channels, text }).chain(warning).collect()
    }

    fn path_loss_exponent(&self) -> Option<f64> {
        Some(self.exponent)
    }
}
