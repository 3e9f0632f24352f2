//! How often each signal strength occurs in a log, as it was measured.

use std::cmp::Ordering;
use std::collections::BTreeMap;

/// At most so many different strengths are counted one by one.
const MOST: usize = 4096;
/// No receiver reports less: the thermal noise in 1 Hz is -174 dBm, and the narrowest radios have 100 Hz.
const LEAST_DBM: f64 = -150.0;
/// Strengths from [`LEAST_DBM`] to below 0 dBm, which nearly all are, in hundredths of a decibel.
const USUAL: usize = 15_000;

/// No strength in dBm is above 0 and below this.
const FAINT: f64 = 0.005;

/// A strength (dBm), ordered.
#[derive(Clone, Copy, Debug)]
struct Level(f64);

impl PartialEq for Level {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Level {}

impl PartialOrd for Level {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Level {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0)
    }
}

/// How often each strength was measured, to a hundredth of a decibel. Memory does not grow with packets.
#[derive(Clone, Debug, Default)]
pub(crate) struct Levels {
    /// How often each of the usual strengths occurs, from the weakest; empty if none does.
    usual: Vec<u64>,
    others: BTreeMap<Level, u64>,
    /// Number of different strengths that are counted.
    distinct: usize,
    total: u64,
    /// Number of those above 0 that are nearly 0: of powers in milliwatts, nearly all are.
    faint: u64,
    /// Whether they are the cells of a wide table, in which a node has no other sign that it was not heard.
    of_cells: bool,
}

impl Levels {
    /// None yet, of the cells of a wide table.
    pub(crate) fn of_cells() -> Self {
        Self { of_cells: true, ..Self::default() }
    }

    /// Whether they are the cells of a wide table.
    pub(super) const fn are_cells(&self) -> bool {
        self.of_cells
    }

    /// Takes a strength (dBm).
    pub(crate) fn take(&mut self, rssi_dbm: f64) {
        self.total += 1;
        self.faint += u64::from(rssi_dbm > 0.0 && rssi_dbm < FAINT);
        // Adding 0 makes -0 a 0.
        let hundredths = (rssi_dbm * 100.0).round() + 0.0;
        let has_room = self.distinct < MOST;
        if let Some(place) = place(hundredths) {
            if self.usual.is_empty() {
                self.usual = vec![0; USUAL];
            }
            let count = &mut self.usual[place];
            let is_new = *count == 0;
            if !is_new || has_room {
                *count += 1;
                self.distinct += usize::from(is_new);
            }
            return;
        }
        let level = Level(hundredths / 100.0);
        if let Some(count) = self.others.get_mut(&level) {
            *count += 1;
        } else if has_room {
            self.others.insert(level, 1);
            self.distinct += 1;
        }
    }

    /// Number of strengths.
    pub(super) fn total(&self) -> u64 {
        self.total
    }

    /// Whether they seem to be powers and not their logarithms: none is below 0, and some are nearly 0.
    pub(super) fn are_linear(&self) -> bool {
        let is_negative = self.others.first_key_value().is_some_and(|(lowest, _)| lowest.0 < 0.0);
        self.faint > 0 && self.usual.is_empty() && !is_negative
    }

    /// The strengths that a radio may report, from the weakest, with how often they occur.
    pub(super) fn possible(&self) -> Vec<(f64, u64)> {
        let counted = self.usual.iter().enumerate().filter(|(_, count)| **count > 0);
        counted.map(|(place, &count)| (level_dbm(place), count)).collect()
    }

    /// The others.
    pub(super) fn impossible(&self) -> Vec<(f64, u64)> {
        self.others.iter().map(|(level, &count)| (level.0, count)).collect()
    }
}

/// The place of a strength in hundredths of a decibel among the usual ones: those that a radio may report, below 0 dBm and above
/// all noise.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole, and within the bounds")]
fn place(hundredths: f64) -> Option<usize> {
    (LEAST_DBM * 100.0..0.0).contains(&hundredths).then_some((hundredths - LEAST_DBM * 100.0) as usize)
}

/// Whether a radio may report this strength (dBm).
pub(super) fn is_usual(level_dbm: f64) -> bool {
    (LEAST_DBM..0.0).contains(&level_dbm)
}

/// The usual strength at a place (dBm).
fn level_dbm(place: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "at most 15 000")]
    let hundredths = place as f64 + LEAST_DBM * 100.0;
    hundredths / 100.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strengths_are_counted_to_a_hundredth_of_a_decibel() {
        let mut levels = Levels::default();
        for level_dbm in
            [-70.004, -70.0, -149.999, -150.0, -150.006, -0.006, -0.004, 0.0, 127.0, -1e300, f64::INFINITY]
        {
            levels.take(level_dbm);
        }
        assert_eq!(levels.possible(), [(-150.0, 2), (-70.0, 2), (-0.01, 1)]);
        let others = [(-1e300, 1), (-150.01, 1), (0.0, 2), (127.0, 1), (f64::INFINITY, 1)];
        assert_eq!(levels.impossible(), others);
        assert_eq!(levels.total(), 11);
    }

    #[test]
    fn only_so_many_different_strengths_are_counted() {
        let mut levels = Levels::default();
        let level = |i: i32| -1.0 - 0.01 * f64::from(i);
        (0..5000).chain(0..10).for_each(|i| levels.take(level(i)));
        assert_eq!((levels.possible().len(), levels.total()), (MOST, 5010));
        assert_eq!(levels.possible().iter().filter(|(_, count)| *count == 2).count(), 10);
    }
}
