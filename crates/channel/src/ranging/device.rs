//! A device that measures ranges, as it is simulated.

use sextant_kernel::{NodeId, Seed, SettingError, SimTime, StationId};

use super::law::RangeErrorLaw;
use crate::purpose;

/// A device that measures ranges as written in a scenario. It measures
///
/// `scale × distance + bias + bias of the node + noise`,
///
/// and more behind obstacles, where the signal takes a longer way.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RangingDeviceConfig {
    /// What brings a range.
    pub exchange: RangeExchangeConfig,
    /// Standard deviation of the noise of a range (m); 0 for none.
    pub noise_m: f64,
    /// What all ranges are too long (m); negative if they are too short.
    pub bias_m: f64,
    /// Standard deviation of a bias that each node has for itself (m); 0 for none.
    pub node_bias_m: f64,
    /// The range that is measured of each metre: 1 if ranges are right.
    pub scale: f64,
    /// Mean of what a range by a longer way is too long (m), with an exponential law; 0 if it is right.
    pub excess_m: f64,
    /// Share of the ranges by a longer way where no obstacle blocks the straight one, from 0 to 1. Where one does, all are.
    pub late_share: f64,
    /// Share of wild values, from 0 to 1: half of them are more than 10 m off.
    pub wild_share: f64,
    /// Share of the exchanges without a range, from 0 to 1.
    pub dropout: f64,
    /// The same where an obstacle blocks the straight way; that of `dropout` if absent.
    #[cfg_attr(feature = "config", serde(skip_serializing_if = "Option::is_none"))]
    pub dropout_behind_obstacles: Option<f64>,
    /// Nodes farther away than this bring no range (m); no such limit if absent.
    #[cfg_attr(feature = "config", serde(skip_serializing_if = "Option::is_none"))]
    pub max_range_m: Option<f64>,
}

/// What brings a range, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum RangeExchangeConfig {
    /// Each packet of a node that the robot receives, and each answer to a sector sweep.
    #[default]
    Packets,
    /// A clock: while it listens, the robot measures the ranges to all nodes in regular intervals. No frame is sent for that.
    Ideal(IdealExchangeConfig),
}

/// Ranges without frames as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct IdealExchangeConfig {
    /// The interval between two ranges to a node (s), above 0. The first is measured when the robot begins to listen.
    pub interval_s: f64,
}

impl Default for RangingDeviceConfig {
    fn default() -> Self {
        Self {
            exchange: RangeExchangeConfig::Packets,
            noise_m: 0.1,
            bias_m: 0.0,
            node_bias_m: 0.0,
            scale: 1.0,
            excess_m: 1.0,
            late_share: 0.0,
            wild_share: 0.0,
            dropout: 0.0,
            dropout_behind_obstacles: None,
            max_range_m: None,
        }
    }
}

/// A device that measures ranges, checked: see [`RangingDeviceConfig`]. A range is a pure function of the seed, of the two ends and of
/// the time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangingDevice(RangingDeviceConfig);

/// One try to measure a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeTry {
    /// The node.
    pub node: NodeId,
    /// The station that measures.
    pub station: StationId,
    /// When.
    pub time: SimTime,
    /// The true distance (m).
    pub distance_m: f64,
    /// Whether an obstacle blocks the straight way.
    pub is_blocked: bool,
}

/// What the numbers of a try are drawn for.
#[derive(Clone, Copy)]
enum Draw {
    Dropout,
    Noise,
    Part,
    Excess,
    Wild,
}

impl RangingDevice {
    /// Wild values are off by at most this (m).
    const WILDEST_M: f64 = 1000.0;

    /// The interval of ranges without frames (s); `None` where packets bring them.
    #[must_use]
    pub fn interval_s(&self) -> Option<f64> {
        match self.0.exchange {
            RangeExchangeConfig::Packets => None,
            RangeExchangeConfig::Ideal(ideal) => Some(ideal.interval_s),
        }
    }

    /// How far away a node may be (m).
    #[must_use]
    pub fn max_range_m(&self) -> f64 {
        self.0.max_range_m.unwrap_or(f64::INFINITY)
    }

    /// Standard deviation of the biases of nodes (m).
    #[must_use]
    pub fn node_bias_m(&self) -> f64 {
        self.0.node_bias_m
    }

    /// The range that is measured of each metre.
    #[must_use]
    pub fn scale(&self) -> f64 {
        self.0.scale
    }

    /// The law of what is left of the errors without biases and scale.
    #[must_use]
    pub fn error_law(&self, is_blocked: bool) -> RangeErrorLaw {
        /// Shares and widths of no less, so that their logarithms are numbers.
        const LEAST: f64 = 1e-12;
        let RangingDeviceConfig { noise_m, excess_m, wild_share, .. } = self.0;
        let late_share = self.late_share(is_blocked);
        let late = if excess_m > 0.0 { (1.0 - wild_share) * late_share } else { 0.0 };
        let noise = (1.0 - wild_share - late).max(LEAST);
        let noise_m = noise_m.max(1e-6);
        RangeErrorLaw {
            log_noise: libm::log(noise_m),
            log_excess: libm::log(if excess_m > 0.0 { excess_m.max(1e-2 * noise_m) } else { noise_m }),
            log_odds_late: libm::log(late.max(LEAST) / noise),
            log_odds_wild: libm::log(wild_share.max(LEAST) / noise),
        }
    }

    /// Share of the ranges by a longer way, of those that are not wild.
    fn late_share(&self, is_blocked: bool) -> f64 {
        if is_blocked { 1.0 } else { self.0.late_share }
    }

    /// The range that a try brings (m), with draws from `seed`; `None` if it brings none.
    #[must_use]
    pub fn range_m(&self, seed: Seed, attempt: &RangeTry) -> Option<f64> {
        let RangingDeviceConfig { noise_m, bias_m, node_bias_m, scale, excess_m, wild_share, .. } = self.0;
        let &RangeTry { node, station, time, distance_m, is_blocked } = attempt;
        if distance_m > self.max_range_m() {
            return None;
        }
        let pair = u64::from(node.0) << 32 | u64::from(station.0);
        let place = |draw: Draw| [pair, time.as_nanos(), draw as u64];
        let uniform = |draw| seed.uniform(purpose::RANGING, place(draw));
        let of_open = self.0.dropout;
        let dropout = if is_blocked { self.0.dropout_behind_obstacles.unwrap_or(of_open) } else { of_open };
        if uniform(Draw::Dropout) < dropout {
            return None;
        }
        let of_node_m = node_bias_m * seed.normal(purpose::RANGE_BIAS, [node.0.into(), 0, 0]);
        let part = uniform(Draw::Part);
        let error_m = if part < wild_share {
            let widest = libm::atan(Self::WILDEST_M / RangeErrorLaw::WILD_M);
            RangeErrorLaw::WILD_M * libm::tan(widest * (2.0 * uniform(Draw::Wild) - 1.0))
        } else {
            let is_late = part < wild_share + (1.0 - wild_share) * self.late_share(is_blocked);
            let excess_m = if is_late { -excess_m * libm::log(uniform(Draw::Excess)) } else { 0.0 };
            noise_m * seed.normal(purpose::RANGING, place(Draw::Noise)) + excess_m
        };
        Some(scale * distance_m + bias_m + of_node_m + error_m)
    }
}

impl TryFrom<RangingDeviceConfig> for RangingDevice {
    type Error = SettingError;

    fn try_from(config: RangingDeviceConfig) -> Result<Self, SettingError> {
        /// Ranges are metres, not kilometres, off.
        const MOST_M: f64 = 1000.0;
        let RangingDeviceConfig {
            exchange,
            noise_m,
            bias_m,
            node_bias_m,
            scale,
            excess_m,
            late_share,
            wild_share,
            dropout,
            dropout_behind_obstacles,
            max_range_m,
        } = config;
        for (key, value_m) in [("noise_m", noise_m), ("node_bias_m", node_bias_m), ("excess_m", excess_m)] {
            if !(0.0..=MOST_M).contains(&value_m) {
                return Err(SettingError::new(key, value_m, format!("a number from 0 to {MOST_M}")));
            }
        }
        if !(-MOST_M..=MOST_M).contains(&bias_m) {
            return Err(SettingError::new("bias_m", bias_m, format!("a number from -{MOST_M} to {MOST_M}")));
        }
        if !(0.5..=2.0).contains(&scale) {
            return Err(SettingError::new("scale", scale, "a number from 0.5 to 2"));
        }
        let behind = dropout_behind_obstacles.map(|share| ("dropout_behind_obstacles", share));
        let shares = [("late_share", late_share), ("wild_share", wild_share), ("dropout", dropout)];
        for (key, share) in shares.into_iter().chain(behind) {
            if !(0.0..=1.0).contains(&share) {
                return Err(SettingError::new(key, share, "a number from 0 to 1"));
            }
        }
        if let Some(max_range_m) = max_range_m {
            SettingError::positive("max_range_m", max_range_m)?;
        }
        if let RangeExchangeConfig::Ideal(IdealExchangeConfig { interval_s }) = exchange
            && !(1e-3..=1e6).contains(&interval_s)
        {
            return Err(SettingError::new("exchange.ideal.interval_s", interval_s, "a number from 0.001 to 1e6"));
        }
        Ok(Self(config))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ranges(config: RangingDeviceConfig, is_blocked: bool) -> Vec<Option<f64>> {
        let device = RangingDevice::try_from(config).unwrap();
        let attempt = |nanos| RangeTry {
            node: NodeId(3),
            station: StationId(9),
            time: SimTime::from_nanos(nanos),
            distance_m: 20.0,
            is_blocked,
        };
        (0..40_000).map(|nanos| device.range_m(Seed(5), &attempt(nanos))).collect()
    }

    fn mean(values: impl Iterator<Item = f64>) -> f64 {
        let (count, sum) = values.fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value));
        sum / count
    }

    #[test]
    fn ranges_have_the_moments_of_their_law() {
        let config = RangingDeviceConfig {
            noise_m: 0.2,
            bias_m: 0.5,
            scale: 1.1,
            excess_m: 2.0,
            late_share: 0.25,
            dropout: 0.1,
            dropout_behind_obstacles: Some(0.5),
            ..RangingDeviceConfig::default()
        };
        for (is_blocked, late, lost) in [(false, 0.25, 0.1), (true, 1.0, 0.5)] {
            let all = ranges(config, is_blocked);
            let found: Vec<f64> = all.iter().flatten().copied().collect();
            assert!((found.len() as f64 / all.len() as f64 - (1.0 - lost)).abs() < 0.01);
            let centre = mean(found.iter().copied());
            assert!((centre - (22.0 + 0.5 + 2.0 * late)).abs() < 0.05, "{centre}");
            let variance = mean(found.iter().map(|range| (range - centre).powi(2)));
            let expected = 0.04 + 4.0 * (2.0 * late - late * late);
            assert!((variance / expected - 1.0).abs() < 0.06, "{variance}, {expected}");
        }
    }

    /// The shares of the empirical distribution within intervals against those of the density.
    #[test]
    fn ranges_are_distributed_as_the_law_says_that_maps_know() {
        let config = RangingDeviceConfig {
            noise_m: 0.3,
            excess_m: 1.5,
            late_share: 0.3,
            wild_share: 0.05,
            ..RangingDeviceConfig::default()
        };
        let law = RangingDevice::try_from(config).unwrap().error_law(false);
        let found: Vec<f64> = ranges(config, false).into_iter().flatten().map(|range| range - 20.0).collect();
        for (low, high) in [(-10.0, -1.0), (-1.0, -0.2), (-0.2, 0.2), (0.2, 1.0), (1.0, 4.0), (4.0, 20.0)] {
            let share = found.iter().filter(|&&error| low < error && error <= high).count() as f64 / 40_000.0;
            let step = (high - low) / 2000.0;
            let density = |i| libm::exp(law.density(low + step * (f64::from(i) + 0.5)).log_density);
            let expected: f64 = (0..2000).map(|i| step * density(i)).sum();
            assert!((share - expected).abs() < 4.0 * (expected / 40_000.0).sqrt(), "{low}: {share}, {expected}");
        }
    }

    #[test]
    fn each_node_has_a_bias_of_its_own_that_stays() {
        let config = RangingDeviceConfig { noise_m: 0.0, node_bias_m: 0.4, ..RangingDeviceConfig::default() };
        let device = RangingDevice::try_from(config).unwrap();
        let range = |node, nanos| {
            let time = SimTime::from_nanos(nanos);
            let attempt =
                RangeTry { node: NodeId(node), station: StationId(9), time, distance_m: 5.0, is_blocked: false };
            device.range_m(Seed(5), &attempt).unwrap() - 5.0
        };
        let biases: Vec<f64> = (0..2000).map(|node| range(node, 1)).collect();
        assert!((0..2000).all(|node| (range(node, 77) - biases[node as usize]).abs() < 1e-12));
        let deviation = mean(biases.iter().map(|bias| bias * bias)).sqrt();
        assert!((deviation - 0.4).abs() < 0.03, "{deviation}");
    }

    #[test]
    fn settings_without_meaning_are_refused() {
        let usual = RangingDeviceConfig::default;
        let ideal = RangeExchangeConfig::Ideal(IdealExchangeConfig { interval_s: 0.0 });
        for (config, key) in [
            (RangingDeviceConfig { noise_m: -1.0, ..usual() }, "noise_m"),
            (RangingDeviceConfig { bias_m: f64::NAN, ..usual() }, "bias_m"),
            (RangingDeviceConfig { scale: 0.0, ..usual() }, "scale"),
            (RangingDeviceConfig { wild_share: 1.5, ..usual() }, "wild_share"),
            (RangingDeviceConfig { max_range_m: Some(0.0), ..usual() }, "max_range_m"),
            (RangingDeviceConfig { dropout_behind_obstacles: Some(2.0), ..usual() }, "dropout_behind_obstacles"),
            (RangingDeviceConfig { exchange: ideal, ..usual() }, "exchange.ideal.interval_s"),
        ] {
            assert!(RangingDevice::try_from(config).unwrap_err().to_string().contains(key), "{key}");
        }
    }
}
