//! How often each signal strength occurs in a log, as it was measured.

use std::collections::HashMap;

/// At most so many different strengths are counted one by one.
const MOST: usize = 4096;
/// No receiver reports less: the thermal noise in 1 Hz is -174 dBm, and the narrowest radios have 100 Hz.
const LEAST_DBM: f64 = -150.0;

/// How often each strength was measured, to a hundredth of a decibel. Memory does not grow with packets.
#[derive(Clone, Debug, Default)]
pub(crate) struct Levels {
    /// By the bits of the strength (dBm).
    counts: HashMap<u64, u64>,
    total: u64,
}

impl Levels {
    /// Takes a strength (dBm).
    pub(crate) fn take(&mut self, rssi_dbm: f64) {
        self.total += 1;
        // Adding 0 makes -0 a 0.
        let level = ((rssi_dbm * 100.0).round() / 100.0 + 0.0).to_bits();
        if let Some(count) = self.counts.get_mut(&level) {
            *count += 1;
        } else if self.counts.len() < MOST {
            self.counts.insert(level, 1);
        }
    }

    /// Number of strengths.
    pub(super) fn total(&self) -> u64 {
        self.total
    }

    /// The strengths that a radio may report, from the weakest, with how often they occur.
    pub(super) fn possible(&self) -> Vec<(f64, u64)> {
        self.all().filter(|(level_dbm, _)| is_possible(*level_dbm)).collect()
    }

    /// The others.
    pub(super) fn impossible(&self) -> Vec<(f64, u64)> {
        self.all().filter(|(level_dbm, _)| !is_possible(*level_dbm)).collect()
    }

    /// From the weakest.
    fn all(&self) -> impl Iterator<Item = (f64, u64)> {
        let mut all: Vec<(f64, u64)> =
            self.counts.iter().map(|(&level, &count)| (f64::from_bits(level), count)).collect();
        all.sort_unstable_by(|(a, _), (b, _)| a.total_cmp(b));
        all.into_iter()
    }
}

/// Whether a radio may report this strength (dBm): below 0, and above all noise.
fn is_possible(level_dbm: f64) -> bool {
    (LEAST_DBM..0.0).contains(&level_dbm)
}
