//! The signal strengths of a log as they are read.

use sextant_kernel::text::counted;

use crate::doctor::{self, Finding, Levels};
use crate::options::noise_floor::NoiseFloor;
use crate::options::read_options::ReadOptions;

/// Takes signal strengths as they are read: counts them, and leaves out the values that stand for none.
#[derive(Clone, Debug, Default)]
pub(crate) struct RssiCheck {
    /// Values that the user says are no measurements (dBm).
    missing: Vec<f64>,
    /// Strengths up to this one are those of noise.
    floor: Option<NoiseFloor>,
    levels: Levels,
    left_out: u64,
    /// Values that no receiver can mean, and the first of them (dBm).
    beyond: u64,
    first_beyond: f64,
}

/// No strength in decibels is larger than this, or less than its negative.
const MOST_DBM: f64 = 1000.0;

/// A strength is one of the missing values if it differs from it by less (dB).
const SAME_DB: f64 = 1e-6;

impl RssiCheck {
    /// A check of strengths of which some are no measurements, or noise, as `options` say.
    pub(crate) fn new(options: &ReadOptions) -> Self {
        let (missing, floor) = (options.repair.rssi_missing.clone(), options.form.noise_floor);
        Self { missing, floor, ..Self::default() }
    }

    /// The same of the cells of a wide table.
    pub(crate) fn of_cells(options: &ReadOptions) -> Self {
        Self { levels: Levels::of_cells(), ..Self::new(options) }
    }

    /// The strength, if it was measured (dBm).
    pub(crate) fn take(&mut self, rssi_dbm: Option<f64>) -> Option<f64> {
        let level = rssi_dbm?;
        if self.is_missing(level) {
            self.left_out += 1;
            return None;
        }
        if level.abs() > MOST_DBM {
            if self.beyond == 0 {
                self.first_beyond = level;
            }
            self.beyond += 1;
            return None;
        }
        if !self.floor.is_some_and(|floor| floor.is_noise(level)) {
            self.levels.take(level);
        }
        Some(level)
    }

    /// Whether a strength (dBm) stands for none.
    pub(crate) fn is_missing(&self, level: f64) -> bool {
        self.missing.iter().any(|missing| (missing - level).abs() < SAME_DB)
    }

    /// What the user should know of those that were left out.
    pub(crate) fn note(&self) -> Option<String> {
        let values: Vec<String> = self.missing.iter().map(|value| format!("{value} dBm")).collect();
        let left_out = self.left_out;
        let missing = (!values.is_empty()).then(|| {
            format!(
                "{left_out} signal strengths of {} count as not measured (option `rssi_missing`)",
                values.join(" or ")
            )
        });
        let beyond = (self.beyond > 0).then(|| {
            format!(
                "{} beyond {MOST_DBM} dBm, such as {}, are no powers in dBm and count as not measured",
                counted(usize::try_from(self.beyond).unwrap_or(usize::MAX), "signal strength"),
                self.first_beyond
            )
        });
        let notes: Vec<String> = missing.into_iter().chain(beyond).collect();
        (!notes.is_empty()).then(|| notes.join("; "))
    }

    /// What is odd of the others.
    pub(crate) fn findings(&self) -> Vec<Finding> {
        doctor::of_levels(&self.levels)
    }
}
