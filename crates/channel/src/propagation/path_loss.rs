//! Mean loss with distance.

use sextant_kernel::SettingError;

use crate::power::Db;
use crate::propagation::gas::GasConfig;

/// Path loss as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum PathLossConfig {
    /// Log-distance law.
    LogDistance(LogDistanceConfig),
    /// Close-in law: the loss of free space over 1 m at the carrier, and an exponent from there.
    CloseIn(CloseInConfig),
}

/// Close-in path loss as written in a scenario: `L(d) = 20 log10(4 π f / c) + 10 n log10(d)` with d in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CloseInConfig {
    /// Carrier (GHz), 0.1 to 1000. May be absent if the channel names an environment that has one.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub carrier_ghz: Option<f64>,
    /// Path loss exponent n: 2 in free space. May be absent if the channel names an environment.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub exponent: Option<f64>,
    /// Distance below which the loss is constant (m). The law is measured from 1 m on.
    #[cfg_attr(feature = "config", serde(default = "default_close_in_distance_m"))]
    pub min_distance_m: f64,
    /// Loss by the gases of the air.
    #[cfg_attr(feature = "config", serde(default))]
    pub gas: GasConfig,
}

impl Default for CloseInConfig {
    /// No carrier, no exponent, no gases, constant below 1 m.
    fn default() -> Self {
        Self {
            carrier_ghz: None,
            exponent: None,
            min_distance_m: default_close_in_distance_m(),
            gas: GasConfig::default(),
        }
    }
}

fn default_close_in_distance_m() -> f64 {
    1.0
}

/// Speed of light in vacuum (m/s).
pub(crate) const LIGHT_M_PER_S: f64 = 299_792_458.0;

/// Log-distance path loss as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LogDistanceConfig {
    /// Path loss exponent: 2 in free space. May be absent if the channel names an environment.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub exponent: Option<f64>,
    /// Distance to which `reference_loss_db` refers (m).
    #[cfg_attr(feature = "config", serde(default = "default_reference_distance_m"))]
    pub reference_distance_m: f64,
    /// Loss at the reference distance (dB). If it is 0, transmit powers are powers at that distance. If it is absent, a
    /// scenario has the loss of free space over that distance at the carrier of its radios, 40.07 dB over 1 m in channel
    /// 11 at 2405 MHz; a law that knows no carrier has 0 dB.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub reference_loss_db: Option<f64>,
    /// Distance below which the loss is constant (m).
    #[cfg_attr(feature = "config", serde(default = "default_min_distance_m"))]
    pub min_distance_m: f64,
    /// Loss in proportion to the distance, on top (dB/km): gases of the air.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "is_zero"))]
    #[cfg_attr(feature = "schema", schemars(extend("default" = 0.0)))]
    pub gas_db_per_km: f64,
}

fn default_reference_distance_m() -> f64 {
    1.0
}

#[cfg(feature = "config")]
fn is_zero(loss_db: &f64) -> bool {
    loss_db.to_bits() == 0
}

fn default_min_distance_m() -> f64 {
    0.1
}

impl Default for LogDistanceConfig {
    /// No exponent, no loss at 1 m unless a carrier is known, constant below 0.1 m.
    fn default() -> Self {
        Self {
            exponent: None,
            reference_distance_m: default_reference_distance_m(),
            reference_loss_db: None,
            min_distance_m: default_min_distance_m(),
            gas_db_per_km: 0.0,
        }
    }
}

/// Log-distance path loss: `L(d) = L0 + 10 ε log10(d / d0) + γ d` (thesis eq. 3.14; Rappaport 2002, eq. 4.69; γ by
/// gases), constant below a minimum distance. With `L0 = 0`, transmit powers are powers at `d0`, and nearer receivers
/// have a gain. The close-in law (MacCartney et al. 2015, eq. 1) is the one with `d0 = 1 m` and the loss of free space
/// there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogDistance {
    exponent: f64,
    reference_distance_m: f64,
    reference_loss: Db,
    min_distance_m: f64,
    gas_db_per_m: f64,
}

/// Loss with distance, item by item.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistanceLoss {
    /// Loss at the reference distance.
    pub reference: Db,
    /// Loss from there on by the exponent; negative below the reference distance.
    pub spreading: Db,
    /// Loss by gases, if there are any.
    pub gas: Option<Db>,
}

impl DistanceLoss {
    /// The whole loss.
    #[must_use]
    #[inline]
    pub fn total(&self) -> Db {
        let loss = self.reference + self.spreading;
        self.gas.map_or(loss, |gas| loss + gas)
    }
}

impl TryFrom<LogDistanceConfig> for LogDistance {
    type Error = SettingError;

    fn try_from(config: LogDistanceConfig) -> Result<Self, SettingError> {
        let exponent = config.exponent.ok_or_else(|| {
            SettingError::missing("exponent", "a finite number above 0, or an environment that has one")
        })?;
        Ok(Self {
            exponent: SettingError::positive("exponent", exponent)?,
            reference_distance_m: SettingError::positive("reference_distance_m", config.reference_distance_m)?,
            reference_loss: Db(SettingError::in_range(
                "reference_loss_db",
                config.reference_loss_db.unwrap_or(0.0),
                -200.0,
                300.0,
            )?),
            min_distance_m: SettingError::positive("min_distance_m", config.min_distance_m)?,
            gas_db_per_m: SettingError::in_range("gas_db_per_km", config.gas_db_per_km, 0.0, 1e6)? / 1000.0,
        })
    }
}

impl TryFrom<CloseInConfig> for LogDistance {
    type Error = SettingError;

    fn try_from(config: CloseInConfig) -> Result<Self, SettingError> {
        let carrier_ghz = config.carrier()?;
        Self::try_from(LogDistanceConfig {
            exponent: config.exponent,
            reference_distance_m: 1.0,
            reference_loss_db: Some(free_space_loss_db(1.0, carrier_ghz)),
            min_distance_m: config.min_distance_m,
            gas_db_per_km: config.gas.db_per_km(carrier_ghz).map_err(|error| error.within("gas"))?,
        })
    }
}

/// Loss of free space over `distance_m` at `carrier_ghz` (dB): `20 log10(4 π d f / c)` (Friis 1946).
fn free_space_loss_db(distance_m: f64, carrier_ghz: f64) -> f64 {
    20.0 * libm::log10(4.0 * std::f64::consts::PI * distance_m * carrier_ghz * 1e9 / LIGHT_M_PER_S)
}

impl LogDistanceConfig {
    /// The same law; if it has no loss at the reference distance, with that of free space at `carrier_ghz`.
    #[must_use]
    pub fn with_free_space(self, carrier_ghz: f64) -> Self {
        let free_space_db = free_space_loss_db(self.reference_distance_m, carrier_ghz);
        Self { reference_loss_db: self.reference_loss_db.or(Some(free_space_db)), ..self }
    }
}

impl CloseInConfig {
    /// The carrier (GHz), checked.
    pub(crate) fn carrier(&self) -> Result<f64, SettingError> {
        let carrier_ghz = self.carrier_ghz.ok_or_else(|| {
            SettingError::missing("carrier_ghz", "0.1 to 1000, or an environment that has a carrier")
        })?;
        SettingError::in_range("carrier_ghz", carrier_ghz, 0.1, 1000.0)
    }
}

impl LogDistance {
    /// Loss by gases (dB/m).
    #[must_use]
    pub fn gas_db_per_m(&self) -> f64 {
        self.gas_db_per_m
    }

    /// Path loss exponent ε.
    #[must_use]
    pub fn exponent(&self) -> f64 {
        self.exponent
    }

    /// Distance to which the reference loss refers (m).
    #[must_use]
    pub fn reference_distance_m(&self) -> f64 {
        self.reference_distance_m
    }

    /// Loss at the reference distance.
    #[must_use]
    pub fn reference_loss(&self) -> Db {
        self.reference_loss
    }

    /// Distance below which the loss is constant (m).
    #[must_use]
    pub fn min_distance_m(&self) -> f64 {
        self.min_distance_m
    }

    /// Loss over `distance_m`.
    #[must_use]
    #[inline]
    pub fn loss(&self, distance_m: f64) -> Db {
        self.items(distance_m).total()
    }

    /// Loss over `distance_m`, item by item.
    #[must_use]
    #[inline]
    pub fn items(&self, distance_m: f64) -> DistanceLoss {
        let distance_m = distance_m.max(self.min_distance_m);
        let ratio = distance_m / self.reference_distance_m;
        let spreading = Db(10.0 * self.exponent * libm::log10(ratio));
        let gas = if self.gas_db_per_m > 0.0 { Some(Db(self.gas_db_per_m * distance_m)) } else { None };
        DistanceLoss { reference: self.reference_loss, spreading, gas }
    }

    /// The largest distance at which the loss is at most `loss` (m); 0 if the loss is larger everywhere.
    #[must_use]
    pub fn distance_m(&self, loss: Db) -> f64 {
        if loss < self.loss(0.0) {
            return 0.0;
        }
        let without_gas =
            self.reference_distance_m * libm::pow(10.0, (loss - self.reference_loss).0 / (10.0 * self.exponent));
        if self.gas_db_per_m > 0.0 { self.bisected_m(loss, without_gas) } else { without_gas }
    }

    /// The largest distance at which the loss is at most `loss`, at most `longest_m`: the loss rises with distance.
    fn bisected_m(&self, loss: Db, longest_m: f64) -> f64 {
        let by_gas_m = self.min_distance_m + (loss - self.loss(0.0)).0 / self.gas_db_per_m;
        let (mut near, mut far) = (self.min_distance_m, longest_m.min(by_gas_m).max(self.min_distance_m));
        loop {
            let middle = f64::midpoint(near, far);
            if middle <= near || middle >= far {
                return near;
            }
            if self.loss(middle) <= loss { near = middle } else { far = middle }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(exponent: f64) -> LogDistance {
        LogDistanceConfig { exponent: Some(exponent), ..LogDistanceConfig::default() }.try_into().unwrap()
    }

    #[test]
    fn a_decade_of_distance_costs_ten_times_the_exponent() {
        let law = law(2.7);
        assert!(law.loss(1.0).0.abs() < 1e-15);
        assert!((law.loss(10.0).0 - 27.0).abs() < 1e-12);
        assert!((law.loss(0.2) - law.loss(2.0)).0 + 27.0 < 1e-12);
        assert_eq!(law.loss(0.0), law.loss(0.1));
    }

    #[test]
    fn the_loss_at_the_reference_distance_is_added_everywhere() {
        let config =
            LogDistanceConfig { exponent: Some(2.0), reference_loss_db: Some(40.05), ..LogDistanceConfig::default() };
        let law = LogDistance::try_from(config).unwrap();
        assert!((law.loss(1.0).0 - 40.05).abs() < 1e-12 && (law.loss(10.0).0 - 60.05).abs() < 1e-12);
        assert!((law.distance_m(Db(60.05)) - 10.0).abs() < 1e-9);
    }

    #[test]
    fn an_absent_loss_at_the_reference_distance_is_that_of_free_space() {
        let absent = LogDistanceConfig { exponent: Some(3.0), ..LogDistanceConfig::default() };
        for (reference_distance_m, carrier_ghz, loss_db) in
            [(1.0, 2.405, 40.07), (10.0, 2.405, 60.07), (1.0, 0.8683, 31.22)]
        {
            let config = LogDistanceConfig { reference_distance_m, ..absent }.with_free_space(carrier_ghz);
            let law = LogDistance::try_from(config).unwrap();
            assert!((law.reference_loss().0 - loss_db).abs() < 0.005, "{}", law.reference_loss().0);
        }
        let given = LogDistanceConfig { reference_loss_db: Some(0.0), ..absent };
        assert_eq!(given.with_free_space(2.405), given);
    }

    #[test]
    fn distance_is_the_inverse_of_loss() {
        // 40 dB of budget: 30.3, 12.9, 7.4 m in the three environments of the thesis (Table 3.4).
        for (exponent, range_m) in [(2.7, 30.302_711), (3.6, 12.915_497), (4.6, 7.405_685)] {
            let law = law(exponent);
            assert!((law.distance_m(Db(40.0)) - range_m).abs() < 1e-3, "{}", law.distance_m(Db(40.0)));
            assert!((law.loss(law.distance_m(Db(40.0))).0 - 40.0).abs() < 1e-10);
        }
        assert!(law(2.0).distance_m(Db(-20.001)) <= 0.0);
        assert!(law(2.0).distance_m(Db(-20.0)) > 0.0999);
    }

    #[test]
    fn the_close_in_law_begins_with_the_loss_of_free_space_over_a_metre() {
        for (carrier_ghz, loss_db) in
            [(2.4, 40.05), (28.0, 61.39), (60.0, 68.01), (60.48, 68.08), (73.0, 69.71), (73.5, 69.77)]
        {
            let config =
                CloseInConfig { carrier_ghz: Some(carrier_ghz), exponent: Some(1.7), ..CloseInConfig::default() };
            let law = LogDistance::try_from(config).unwrap();
            assert!((law.loss(1.0).0 - loss_db).abs() < 0.006, "{}", law.loss(1.0).0);
            assert_eq!(law.loss(0.3), law.loss(1.0));
            assert!((law.loss(10.0) - law.loss(1.0)).0 - 17.0 < 1e-12);
        }
    }

    #[test]
    fn gases_take_their_share_of_each_metre_and_the_range_is_still_the_inverse() {
        let config = CloseInConfig {
            carrier_ghz: Some(60.0),
            exponent: Some(2.0),
            gas: GasConfig::DbPerKm(15.0),
            ..CloseInConfig::default()
        };
        let law = LogDistance::try_from(config).unwrap();
        let dry = LogDistance::try_from(CloseInConfig { gas: GasConfig::None, ..config }).unwrap();
        assert!(((law.loss(200.0) - dry.loss(200.0)).0 - 3.0).abs() < 1e-9);
        for distance_m in [1.0, 1.5, 7.0, 200.0, 5000.0] {
            let found = law.distance_m(law.loss(distance_m));
            assert!((found / distance_m - 1.0).abs() < 1e-9, "{distance_m}: {found}");
        }
        assert!(law.distance_m(Db(68.0)) <= 0.0);
        let far = law.distance_m(Db(1e6));
        assert!(far.is_finite() && (law.loss(far).0 - 1e6).abs() < 1e-3);
    }

    #[test]
    fn a_bad_law_names_its_key() {
        let good = LogDistanceConfig { exponent: Some(2.0), ..LogDistanceConfig::default() };
        for (config, key) in [
            (LogDistanceConfig { exponent: None, ..good }, "exponent"),
            (LogDistanceConfig { exponent: Some(-2.0), ..good }, "exponent"),
            (LogDistanceConfig { exponent: Some(f64::NAN), ..good }, "exponent"),
            (LogDistanceConfig { reference_distance_m: 0.0, ..good }, "reference_distance_m"),
            (LogDistanceConfig { reference_loss_db: Some(f64::NAN), ..good }, "reference_loss_db"),
            (LogDistanceConfig { min_distance_m: f64::INFINITY, ..good }, "min_distance_m"),
        ] {
            assert_eq!(LogDistance::try_from(config).unwrap_err().key, key);
        }
    }
}
