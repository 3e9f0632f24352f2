//! How fast the value of the field at the robot changes.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;

/// How the rate of change of the field at the robot is worked out from samples of it, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum RateConfig {
    /// The difference of two samples, divided by the time between them.
    Difference,
    /// The slope of the straight line of least squares through so many latest samples.
    LeastSquares {
        /// Number of samples.
        samples: u32,
    },
    /// The difference of two samples, low-pass filtered.
    Filtered {
        /// Time constant of the filter (s).
        time_constant_s: f64,
    },
}

/// Most samples of a line.
const MOST_SAMPLES: u32 = 1000;

impl RateConfig {
    /// Itself, if it is valid.
    pub(super) fn checked(self) -> Result<Self, SettingError> {
        match self {
            Self::LeastSquares { samples } if !(2..=MOST_SAMPLES).contains(&samples) => {
                Err(SettingError::new("least_squares.samples", samples, format!("2 to {MOST_SAMPLES}")))
            }
            Self::Filtered { time_constant_s } => {
                SettingError::positive("filtered.time_constant_s", time_constant_s).map(|_| self)
            }
            Self::Difference | Self::LeastSquares { .. } => Ok(self),
        }
    }
}

/// The rate of change of a value that is sampled.
#[derive(Clone, Debug)]
pub(super) struct Rate {
    config: RateConfig,
    /// The latest samples: time (s) and value. One suffices for differences.
    samples: VecDeque<(f64, f64)>,
    filtered: Option<f64>,
}

impl Rate {
    pub(super) fn new(config: RateConfig) -> Self {
        Self { config, samples: VecDeque::new(), filtered: None }
    }

    /// Forgets all samples.
    pub(super) fn clear(&mut self) {
        *self = Self::new(self.config);
    }

    /// Takes a sample at `time_s`, later than the one before, and returns the rate (1/s); `None` after a single sample.
    pub(super) fn sample(&mut self, time_s: f64, value: f64) -> Option<f64> {
        let last = self.samples.back().copied();
        let keep = match self.config {
            RateConfig::LeastSquares { samples } => samples as usize,
            RateConfig::Difference | RateConfig::Filtered { .. } => 1,
        };
        while self.samples.len() >= keep {
            self.samples.pop_front();
        }
        self.samples.push_back((time_s, value));
        match self.config {
            RateConfig::LeastSquares { .. } => self.line(),
            RateConfig::Difference => last.map(|(last_s, last)| (value - last) / (time_s - last_s)),
            RateConfig::Filtered { time_constant_s } => {
                let (last_s, last) = last?;
                let span_s = time_s - last_s;
                let difference = (value - last) / span_s;
                let keep = libm::exp(-span_s / time_constant_s);
                let filtered = self.filtered.map_or(difference, |before| keep * before + (1.0 - keep) * difference);
                self.filtered = Some(filtered);
                Some(filtered)
            }
        }
    }

    /// The slope of the line of least squares.
    fn line(&self) -> Option<f64> {
        let count = self.samples.len() as f64;
        let (time, value) = self.samples.iter().fold((0.0, 0.0), |(t, v), sample| (t + sample.0, v + sample.1));
        let (time, value) = (time / count, value / count);
        let (mut cross, mut square) = (0.0, 0.0);
        for (t, v) in &self.samples {
            cross += (t - time) * (v - value);
            square += (t - time) * (t - time);
        }
        (square > 0.0).then(|| cross / square)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_rates_of_a_ramp_are_its_slope() {
        let [line, filter] = [RateConfig::LeastSquares { samples: 5 }, RateConfig::Filtered { time_constant_s: 0.3 }];
        for config in [line, filter, RateConfig::Difference] {
            let mut rate = Rate::new(config);
            assert_eq!(rate.sample(0.0, 7.0), None);
            for i in 1..30 {
                let time_s = 0.1 * f64::from(i);
                let found = rate.sample(time_s, 7.0 - 0.25 * time_s).unwrap();
                assert!((found + 0.25).abs() < 1e-9, "{config:?}: {found}");
            }
        }
    }

    #[test]
    fn a_difference_knows_the_last_two_samples_only() {
        let mut rate = Rate::new(RateConfig::Difference);
        let rates =
            [(0.0, 1.0), (0.1, 1.2), (0.3, 0.8), (0.4, 0.8)].map(|(time_s, value)| rate.sample(time_s, value));
        // 0.2 in 0.1 s, -0.4 in 0.2 s, nothing in 0.1 s.
        for (found, expected) in rates.iter().zip([None, Some(2.0), Some(-2.0), Some(0.0)]) {
            let difference = found.zip(expected).map_or(0.0, |(found, expected)| found - expected);
            assert!(found.is_some() == expected.is_some() && difference.abs() < 1e-9, "{rates:?}");
        }
    }

    #[test]
    fn a_filter_reaches_two_thirds_of_a_new_slope_after_its_time_constant() {
        let mut rate = Rate::new(RateConfig::Filtered { time_constant_s: 0.4 });
        rate.sample(0.0, 0.0);
        rate.sample(0.1, 0.0);
        let found = (1..=4).map(|i| rate.sample(0.1 + 0.1 * f64::from(i), 0.1 * f64::from(i)).unwrap()).last();
        assert!((found.unwrap() - (1.0 - libm::exp(-1.0))).abs() < 1e-9);
    }

    #[test]
    fn one_sample_is_no_line() {
        let key = |config: RateConfig| config.checked().unwrap_err().key;
        assert_eq!(key(RateConfig::LeastSquares { samples: 1 }), "least_squares.samples");
        assert_eq!(key(RateConfig::Filtered { time_constant_s: 0.0 }), "filtered.time_constant_s");
    }
}
