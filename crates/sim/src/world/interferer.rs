//! Sources of noise: radios of other systems, ovens, motors.

use std::time::Duration;

use serde::{Deserialize, Serialize};
use sextant_channel::{Db, Dbm, Position};
use sextant_kernel::{Seed, SettingError, SimTime};
use sextant_mac::Phy;

use crate::purpose;
use crate::station::check_name;

/// A source of noise at a place, as written in a scenario. It disturbs receptions and carrier sense in the channels of IEEE
/// 802.15.4 into which its spectrum reaches; no station can receive it. Obstacles, path loss and shadowing are those of the
/// channel of each network.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct InterfererConfig {
    /// Name; no other interferer has it.
    pub name: String,
    /// Where it stands (m).
    pub position_m: Position,
    /// Transmit power over its whole spectrum while it is on (dBm), as `radio.tx_power_dbm` of a node: all path loss comes off it, also that
    /// at the reference distance.
    pub power_dbm: f64,
    /// The channel of IEEE 802.15.4 at 2450 MHz in whose middle its band lies, 11 to 26; instead of `center_mhz`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(range(min = 11, max = 26)))]
    pub channel: Option<u8>,
    /// Middle of its band (MHz); instead of `channel`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub center_mhz: Option<f64>,
    /// Width of its band, in which its density is constant (MHz).
    #[serde(default = "default_bandwidth_mhz")]
    pub bandwidth_mhz: f64,
    /// Its density beyond both edges of the band: pairs of the distance from the edge (MHz), rising, and the density there
    /// relative to that in the band (dB). Between them it is linear in decibels, from 0 dB at the edge on; beyond the last
    /// pair, or without any, there is none. Such is the leakage into adjacent channels.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = [])))]
    pub leakage: Vec<[f64; 2]>,
    /// It is on once in each period (s), with a random phase.
    #[serde(default = "default_period_s")]
    pub period_s: f64,
    /// Share of the period for which it is on: above 0, at most 1.
    #[serde(default = "default_duty_cycle")]
    pub duty_cycle: f64,
}

fn default_bandwidth_mhz() -> f64 {
    2.0
}

fn default_period_s() -> f64 {
    0.1
}

fn default_duty_cycle() -> f64 {
    1.0
}

/// A source of noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Interferer {
    name: String,
    position: Position,
    power: Dbm,
    center_mhz: f64,
    bandwidth_mhz: f64,
    /// Distance from the edge (MHz) and relative density (dB), from the edge on.
    leakage: Vec<(f64, f64)>,
    period: Duration,
    on: Duration,
    phase: Duration,
}

impl InterfererConfig {
    /// Interferer number `number`.
    ///
    /// # Errors
    /// If a number is out of range, the distances of the leakage do not rise, or the band is given twice or not at all.
    pub fn build(&self, number: usize, seed: Seed) -> Result<Interferer, SettingError> {
        check_name(&self.name)?;
        let place: [f64; 3] = self.position_m.into();
        if !self.position_m.is_finite() {
            return Err(SettingError::new("position_m", format!("{place:?}"), "finite coordinates"));
        }
        let power = Dbm(SettingError::in_range("power_dbm", self.power_dbm, -200.0, 100.0)?);
        let center_mhz = match (self.channel, self.center_mhz) {
            (Some(channel), None) => {
                let known = Phy::Oqpsk2450.channels();
                if !known.contains(&channel) {
                    let allowed = format!("{} to {}, or `center_mhz`", known.start(), known.end());
                    return Err(SettingError::new("channel", channel, allowed));
                }
                Phy::Oqpsk2450.center_mhz(channel)
            }
            (None, Some(center_mhz)) => SettingError::in_range("center_mhz", center_mhz, 1.0, 1e6)?,
            (Some(_), Some(_)) => {
                return Err(SettingError::conflict("channel", "`center_mhz`", "set one of them"));
            }
            (None, None) => return Err(SettingError::missing("channel", "`channel` or `center_mhz`")),
        };
        let bandwidth_mhz = SettingError::in_range("bandwidth_mhz", self.bandwidth_mhz, 1e-3, 1e4)?;
        let mut leakage: Vec<(f64, f64)> = vec![(0.0, 0.0)];
        for (i, &[offset_mhz, level_db]) in self.leakage.iter().enumerate() {
            let key = format!("leakage[{i}]");
            let (before_mhz, _) = leakage[leakage.len() - 1];
            if !(offset_mhz.is_finite() && (offset_mhz > before_mhz || i == 0 && offset_mhz >= 0.0)) {
                return Err(SettingError::new(key, offset_mhz, format!("a distance above {before_mhz} MHz")));
            }
            let level_db = SettingError::in_range(&key, level_db, -200.0, 0.0)?;
            leakage.push((offset_mhz, level_db));
        }
        let period_s = SettingError::in_range("period_s", self.period_s, 1e-5, 1e6)?;
        let duty_cycle = self.duty_cycle;
        if !(duty_cycle > 0.0 && duty_cycle <= 1.0) {
            return Err(SettingError::new("duty_cycle", duty_cycle, "above 0, at most 1"));
        }
        let period = Duration::from_secs_f64(period_s);
        let phase = period.mul_f64(seed.uniform(purpose::INTERFERENCE, [number as u64, 0, 0]));
        let on = period.mul_f64(duty_cycle).max(Duration::from_nanos(1));
        let name = self.name.clone();
        Ok(Interferer {
            name,
            position: self.position_m,
            power,
            center_mhz,
            bandwidth_mhz,
            leakage,
            period,
            on,
            phase,
        })
    }
}

impl Interferer {
    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Where it is (m).
    #[must_use]
    pub fn position(&self) -> Position {
        self.position
    }

    /// The ends of its spectrum, with its leakage (MHz).
    #[must_use]
    pub fn spectrum_mhz(&self) -> [f64; 2] {
        let (farthest_mhz, _) = self.leakage[self.leakage.len() - 1];
        let half_mhz = 0.5 * self.bandwidth_mhz + farthest_mhz;
        [self.center_mhz - half_mhz, self.center_mhz + half_mhz]
    }

    /// Its power in the channel around `center_mhz` of this width; `None` if there is none.
    #[must_use]
    pub(crate) fn power_in(&self, center_mhz: f64, width_mhz: f64) -> Option<Dbm> {
        let beyond: f64 = self.leaked_mhz(0.0, f64::INFINITY);
        let total = self.bandwidth_mhz + 2.0 * beyond;
        let (low, high) =
            (center_mhz - self.center_mhz - 0.5 * width_mhz, center_mhz - self.center_mhz + 0.5 * width_mhz);
        let edge = 0.5 * self.bandwidth_mhz;
        let within = (high.min(edge) - low.max(-edge)).max(0.0);
        let share =
            (within + self.leaked_mhz(low - edge, high - edge) + self.leaked_mhz(-high - edge, -low - edge)) / total;
        (share > 0.0).then(|| self.power + Db(10.0 * libm::log10(share)))
    }

    /// Integral of the relative density beyond one edge between two distances from it (MHz).
    fn leaked_mhz(&self, from_mhz: f64, to_mhz: f64) -> f64 {
        let density = |level_db: f64| Db(level_db).to_factor();
        let part = |pair: &[(f64, f64)]| {
            let ((x1, l1), (x2, l2)) = (pair[0], pair[1]);
            let (a, b) = (from_mhz.max(x1), to_mhz.min(x2));
            if b <= a {
                return 0.0;
            }
            let slope_db = (l2 - l1) / (x2 - x1);
            let at = |x: f64| density(l1 + slope_db * (x - x1));
            let rate = slope_db * std::f64::consts::LN_10 / 10.0;
            if rate.abs() * (b - a) < 1e-9 { at(a) * (b - a) } else { (at(b) - at(a)) / rate }
        };
        self.leakage.windows(2).map(part).sum()
    }

    /// When it is on next, at `now` or later: from and until when. A time that has begun counts from now on.
    pub(crate) fn next_burst(&self, now: SimTime) -> (SimTime, SimTime) {
        if self.on >= self.period {
            return (now, SimTime::MAX);
        }
        let period_ns = self.period.as_nanos();
        let since_start = u128::from(now.as_nanos()) + period_ns - self.phase.as_nanos();
        let into = u64::try_from(since_start % period_ns).expect("below a period of a million seconds");
        let into = Duration::from_nanos(into);
        if into < self.on {
            (now, now + (self.on - into))
        } else {
            let start = now + (self.period - into);
            (start, start + self.on)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn config() -> InterfererConfig {
        InterfererConfig {
            name: "oven".to_owned(),
            position_m: Position::ORIGIN,
            power_dbm: 20.0,
            channel: Some(15),
            center_mhz: None,
            bandwidth_mhz: 2.0,
            leakage: Vec::new(),
            period_s: 0.1,
            duty_cycle: 1.0,
        }
    }

    fn power(config: &InterfererConfig, channel: u8) -> Option<f64> {
        let interferer = config.build(0, Seed(1)).expect("good settings");
        interferer.power_in(Phy::Oqpsk2450.center_mhz(channel), 2.0).map(|power| power.0)
    }

    #[test]
    fn a_channel_gets_the_share_of_the_power_that_lies_in_it() {
        assert_eq!((power(&config(), 15), power(&config(), 16)), (Some(20.0), None));
        // 20 MHz wide: a tenth of the power in each of the channels within.
        let wide = InterfererConfig { bandwidth_mhz: 20.0, ..config() };
        let found = power(&wide, 16).expect("in the band");
        assert!((found - 10.0).abs() < 1e-9, "{found}");
        // The third channel away lies half outside: its lower megahertz ends at 14 MHz from the middle.
        assert_eq!(power(&InterfererConfig { bandwidth_mhz: 28.0, ..config() }, 18), None);
        let half = power(&InterfererConfig { bandwidth_mhz: 30.0, ..config() }, 18).expect("half in the band");
        assert!((half - (20.0 - 10.0 * 30_f64.log10())).abs() < 1e-9, "{half}");
    }

    #[test]
    fn leakage_reaches_into_adjacent_channels_on_both_sides() {
        // 30 dB down from the edge on, 20 MHz far: the adjacent channel gets 2 MHz of a thousandth.
        let leaky = InterfererConfig { leakage: vec![[0.0, -30.0], [20.0, -30.0]], ..config() };
        let total = 2.0 + 2.0 * 20.0 * 1e-3;
        for channel in [14, 16, 13, 17] {
            let found = power(&leaky, channel).expect("leakage");
            let expected = 20.0 + 10.0 * (2e-3_f64 / total).log10();
            assert!((found - expected).abs() < 1e-9, "{channel}: {found}, not {expected}");
        }
        assert_eq!(power(&leaky, 25), None);
        // A slope of 10 dB per MHz, by the middle of each thousandth of a MHz: from 3 to 5 MHz beyond the edge.
        let sloped = InterfererConfig { leakage: vec![[6.0, -60.0]], ..config() };
        let sum =
            |from: u32, to: u32| (from..to).map(|k| 10_f64.powf(-(f64::from(k) + 0.5) * 1e-3) * 1e-3).sum::<f64>();
        let expected = 20.0 + 10.0 * (sum(3000, 5000) / (2.0 + 2.0 * sum(0, 6000))).log10();
        let found = power(&sloped, 16).expect("leakage");
        assert!((found - expected).abs() < 1e-5, "{found}, not {expected}");
    }

    #[test]
    fn an_interferer_is_on_for_its_share_of_each_period() {
        let config = InterfererConfig { period_s: 0.01, duty_cycle: 0.25, ..config() };
        let interferer = config.build(3, Seed(1)).expect("good settings");
        let mut now = SimTime::ZERO;
        let mut starts = Vec::new();
        let mut on = Duration::ZERO;
        while now < SimTime::ZERO + Duration::from_secs(1) {
            let (start, end) = interferer.next_burst(now);
            starts.push(start);
            on += end - start;
            now = end;
        }
        assert!((on.as_secs_f64() - 0.25).abs() < 0.003, "{on:?}");
        for pair in starts.windows(2).skip(1) {
            assert_eq!(pair[1] - pair[0], Duration::from_millis(10));
        }
        assert_eq!(super::tests::config().build(0, Seed(1)).unwrap().next_burst(now), (now, SimTime::MAX));
    }

    #[test]
    fn invalid_interferers_are_rejected_with_their_keys() {
        let key = |config: InterfererConfig| config.build(0, Seed(1)).err().map(|error| error.key);
        assert_eq!(key(config()), None);
        assert_eq!(key(InterfererConfig { name: "a b".into(), ..config() }).as_deref(), Some("name"));
        assert_eq!(key(InterfererConfig { power_dbm: f64::NAN, ..config() }).as_deref(), Some("power_dbm"));
        assert_eq!(key(InterfererConfig { channel: Some(10), ..config() }).as_deref(), Some("channel"));
        assert_eq!(key(InterfererConfig { channel: None, ..config() }).as_deref(), Some("channel"));
        assert_eq!(key(InterfererConfig { center_mhz: Some(2450.0), ..config() }).as_deref(), Some("channel"));
        let center = |mhz| InterfererConfig { channel: None, center_mhz: Some(mhz), ..config() };
        assert_eq!((key(center(2450.0)), key(center(-1.0)).as_deref()), (None, Some("center_mhz")));
        assert_eq!(key(InterfererConfig { bandwidth_mhz: 0.0, ..config() }).as_deref(), Some("bandwidth_mhz"));
        for bad in [0.0, -0.1, 1.1, f64::NAN] {
            assert_eq!(key(InterfererConfig { duty_cycle: bad, ..config() }).as_deref(), Some("duty_cycle"));
        }
        assert_eq!(key(InterfererConfig { period_s: 0.0, ..config() }).as_deref(), Some("period_s"));
        let leaky = |leakage: &[[f64; 2]]| key(InterfererConfig { leakage: leakage.to_vec(), ..config() });
        assert_eq!(leaky(&[[1.0, -20.0], [1.0, -30.0]]).as_deref(), Some("leakage[1]"));
        assert_eq!(leaky(&[[1.0, 3.0]]).as_deref(), Some("leakage[0]"));
        assert_eq!(leaky(&[[f64::NAN, -3.0]]).as_deref(), Some("leakage[0]"));
        assert_eq!(leaky(&[[-1.0, -3.0]]).as_deref(), Some("leakage[0]"));
    }
}
