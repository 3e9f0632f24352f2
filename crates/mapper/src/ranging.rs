//! Distances from signal strengths.

use sextant_kernel::SettingError;

/// The law that turns signal strengths into distances, as written in a scenario. It ignores obstacles. In a scenario,
/// absent values come from its radio and channel. Elsewhere, exponent and transmit power are required.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RangingConfig {
    /// Path loss exponent.
    #[cfg_attr(feature = "config", serde(skip_serializing_if = "Option::is_none"))]
    pub exponent: Option<f64>,
    /// Transmit power at the reference distance (dBm).
    #[cfg_attr(feature = "config", serde(skip_serializing_if = "Option::is_none"))]
    pub tx_power_dbm: Option<f64>,
    /// Distance at which the transmit power is given (m); 1 if absent, also in the channel.
    #[cfg_attr(feature = "config", serde(skip_serializing_if = "Option::is_none"))]
    pub reference_distance_m: Option<f64>,
    /// Standard deviation of shadowing (dB).
    #[cfg_attr(feature = "config", serde(skip_serializing_if = "Option::is_none"))]
    pub sigma_db: Option<f64>,
}

/// The law by which signal strengths become distances: `P = P_tx − 10 n log₁₀(d/d₀)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ranging {
    exponent: f64,
    tx_power_dbm: f64,
    reference_distance_m: f64,
    sigma_db: f64,
}

impl TryFrom<RangingConfig> for Ranging {
    type Error = SettingError;

    fn try_from(config: RangingConfig) -> Result<Self, SettingError> {
        let needed = |key, value: Option<f64>| {
            value.ok_or_else(|| SettingError::missing(key, "a number; in a scenario, that of its channel"))
        };
        Ok(Self {
            exponent: SettingError::positive("exponent", needed("exponent", config.exponent)?)?,
            tx_power_dbm: SettingError::finite("tx_power_dbm", needed("tx_power_dbm", config.tx_power_dbm)?)?,
            reference_distance_m: SettingError::positive(
                "reference_distance_m",
                config.reference_distance_m.unwrap_or(1.0),
            )?,
            sigma_db: SettingError::not_negative("sigma_db", config.sigma_db.unwrap_or(0.0))?,
        })
    }
}

impl Ranging {
    /// The distance at which `rssi_dbm` is the mean strength (m).
    #[must_use]
    pub fn distance_m(&self, rssi_dbm: f64) -> f64 {
        self.reference_distance_m * libm::pow(10.0, (self.tx_power_dbm - rssi_dbm) / (10.0 * self.exponent))
    }

    /// Mean strength over `distance_m` (dBm).
    #[must_use]
    pub fn power_dbm(&self, distance_m: f64) -> f64 {
        self.tx_power_dbm - self.db_per_decade() * libm::log10(distance_m / self.reference_distance_m)
    }

    /// Path loss per tenfold distance (dB).
    #[must_use]
    pub(crate) fn db_per_decade(&self) -> f64 {
        10.0 * self.exponent
    }

    /// Standard deviation of shadowing (dB).
    #[must_use]
    pub fn sigma_db(&self) -> f64 {
        self.sigma_db
    }

    /// Mean of a distance from one shadowed packet over the true distance: `exp(½ (σ ln 10 / 10 n)²)`.
    #[must_use]
    pub(crate) fn bias(&self) -> f64 {
        libm::exp(0.5 * (self.sigma_db * std::f64::consts::LN_10 / self.db_per_decade()).powi(2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_kernel::{Purpose, Seed};

    fn law(sigma_db: f64) -> Ranging {
        let config = RangingConfig {
            exponent: Some(2.7),
            tx_power_dbm: Some(-50.0),
            sigma_db: Some(sigma_db),
            ..Default::default()
        };
        Ranging::try_from(config).expect("a law")
    }

    #[test]
    fn distance_and_power_are_inverse_functions() {
        let law = law(0.0);
        assert!((law.distance_m(-77.0) - 10.0).abs() < 1e-12);
        for distance_m in [0.1, 1.0, 3.7, 25.0] {
            assert!((law.distance_m(law.power_dbm(distance_m)) / distance_m - 1.0).abs() < 1e-12);
        }
        assert!((law.bias() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn shadowed_distances_are_too_long_by_the_bias_on_average() {
        // exp((5 ln 10 / 27)²/2) = 1.095; the relative spread of a distance is 0.45: with 40 000 draws five standard
        // errors are 0.0112 (a false alarm in 1.7 million seeds).
        let law = law(5.0);
        let draws = (0..40_000).map(|i| law.distance_m(-70.0 + 5.0 * Seed(1).normal(Purpose::new(8), [i, 0, 3])));
        let mean = draws.sum::<f64>() / 40_000.0 / law.distance_m(-70.0);
        assert!((mean - law.bias()).abs() < 0.0125, "{mean}, {}", law.bias());
    }
}
