//! What settings are called for people: the end of the key in words, and the unit that the key ends with.

use sextant_scenario::unit;

/// The name of a setting, and its unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct SettingName {
    words: String,
    unit: &'static str,
}

impl SettingName {
    /// Of a key: `tx power` in `dBm` for `radio.tx_power_dbm`. The end of a key that is a single word without a unit gets
    /// the word before it: `anchors share` for `anchors.share`.
    pub(super) fn of(key: &str) -> Self {
        let mut parts = key.rsplit('.').filter(|part| part.parse::<u32>().is_err());
        let last = parts.next().unwrap_or(key);
        let (name, unit) = match unit::split(last) {
            None | Some(("", _)) => (last, ""),
            Some((name, "degrees")) => (name, "°"),
            Some(found) => found,
        };
        let is_vague = unit.is_empty() && !name.contains('_');
        let before = parts.next().filter(|_| is_vague).map(|before| format!("{before} ")).unwrap_or_default();
        Self { words: format!("{before}{name}").replace(['_', '-'], " "), unit }
    }

    /// In words: `tx power`.
    pub(super) fn words(&self) -> &str {
        &self.words
    }

    /// As the name of an axis: `tx power (dBm)`.
    pub(super) fn axis(&self) -> String {
        if self.unit.is_empty() { self.words.clone() } else { format!("{} ({})", self.words, self.unit) }
    }

    /// Its unit; empty if its key has none.
    pub(super) fn unit(&self) -> &'static str {
        self.unit
    }

    /// With a value: `tx power −50 dBm`. A word speaks for itself: `suburban`.
    pub(super) fn with(&self, value: &str) -> String {
        if value.parse::<f64>().is_err() {
            let is_answer = matches!(value, "true" | "false");
            return if is_answer { format!("{} {value}", self.words) } else { value.to_owned() };
        }
        let value = value.strip_suffix(".0").unwrap_or(value).replacen('-', "\u{2212}", 1);
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        format!("{} {value}{unit}", self.words)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_become_words_with_their_unit() {
        for (key, axis) in [
            ("radio.tx_power_dbm", "tx power (dBm)"),
            ("traffic.poisson.rate_per_s", "rate (1/s)"),
            ("robots.0.speed_m_per_s", "speed (m/s)"),
            ("maps.0.algorithm.ml_tm.grid_step_m", "grid step (m)"),
            ("sensors.targets.false_alarms_per_h", "false alarms (1/h)"),
            ("robots.0.odometry.heading_noise_rad_per_sqrt_m", "heading noise (rad/√m)"),
            ("antenna.beamwidth_deg", "beamwidth (°)"),
            ("world.nodes.random.count", "random count"),
            ("anchors.share", "anchors share"),
            ("channel.path_loss.log_distance.exponent", "log distance exponent"),
            ("mac.csma.min_be", "min be"),
            ("seed", "seed"),
        ] {
            assert_eq!(SettingName::of(key).axis(), axis);
        }
        assert_eq!(SettingName::of("radio.tx_power_dbm").with("-55.0"), "tx power \u{2212}55 dBm");
        assert_eq!(SettingName::of("channel.environment").with("heavy-tree"), "heavy-tree");
        assert_eq!(SettingName::of("recording.frames").with("true"), "recording frames true");
    }
}
