//! The power that a receiver reports of nothing: `-100` or `-100+6`.

use std::fmt;
use std::str::FromStr;

/// The noise of receivers that always report a power, and how far above it a packet begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseFloor {
    /// Power of the noise (dBm).
    pub floor_dbm: f64,
    /// A power at most this far above it is noise (dB).
    pub margin_db: f64,
}

impl NoiseFloor {
    /// A power at or below this one is noise (dBm).
    #[must_use]
    pub fn threshold_dbm(self) -> f64 {
        self.floor_dbm + self.margin_db
    }

    /// Whether a power (dBm) is noise.
    pub(crate) fn is_noise(self, power_dbm: f64) -> bool {
        power_dbm <= self.threshold_dbm()
    }
}

impl FromStr for NoiseFloor {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str, least: f64, most: f64| {
            let number = text.trim().parse().ok().filter(|number: &f64| (least..=most).contains(number));
            number.ok_or(
                "expected dBm from -300 to 100, and a margin in dB from 0 to 100 if there is one: -100 or -100+6",
            )
        };
        let (floor, margin) = text.split_once('+').unwrap_or((text, "0"));
        Ok(Self { floor_dbm: number(floor, -300.0, 100.0)?, margin_db: number(margin, 0.0, 100.0)? })
    }
}

impl fmt::Display for NoiseFloor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} dBm", self.threshold_dbm())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_floor_has_a_margin_or_none() {
        for (text, threshold_dbm) in [("-100", -100.0), ("-100+6", -94.0), (" -99.5 + 3.5", -96.0)] {
            let found = text.parse::<NoiseFloor>().unwrap().threshold_dbm();
            assert!((found - threshold_dbm).abs() < 1e-12, "{text}: {found}");
        }
        for text in ["", "-100+-6", "-400", "quiet", "-100+6+2", "nan"] {
            assert!(text.parse::<NoiseFloor>().unwrap_err().starts_with("expected dBm"), "{text}");
        }
    }
}
