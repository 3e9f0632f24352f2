//! Notes on ranges that devices do not measure.

use std::collections::BTreeMap;

use sextant_channel::{Position, RangeSample};
use sextant_kernel::text::counted;

use super::units::{self, OTHER_COLUMNS};
use crate::median::{median, median_by};

/// Of ranges in coarse steps each value is repeated: one is odd if it is more frequent than the others by this factor.
const COARSE: usize = 4;
/// A value that so many ranges have, and this share of them, is no measurement.
const REPEATED: (usize, f64) = (20, 0.02);
/// A value so many times as long as the others usually are is no measurement wherever it is repeated.
const BEYOND: f64 = 4.0;
/// Ranges near a node may be short by less (m).
const LEAST_M: f64 = -3.0;

/// The notes on ranges of the table `name`.
pub(crate) fn notes(name: &str, samples: &[RangeSample]) -> Vec<String> {
    [repeated(name, samples), units::note(name, samples), negative(name, samples)].into_iter().flatten().collect()
}

/// A note on ranges below 0.
fn negative(name: &str, samples: &[RangeSample]) -> Option<String> {
    let below = || samples.iter().map(|sample| sample.range_m).filter(|range_m| *range_m < 0.0);
    let [wild, short] = [true, false].map(|is_wild| below().filter(|m| (*m < LEAST_M) == is_wild).count());
    let lowest_m = below().fold(0.0, f64::min);
    if wild > 0 {
        Some(format!(
            "{name}: {} below 0, down to {lowest_m:.1} m: no device is so short near a node, so these are failed tries or wild values, \
             and others may be as wild above",
            counted(wild + short, "range")
        ))
    } else {
        (short > 0).then(|| {
            format!(
                "{name}: {} below 0: devices report that near a node where ranges are too short; if a column is in another unit, name it \
                 {OTHER_COLUMNS}",
                counted(short, "range")
            )
        })
    }
}

/// A note on a value that too many ranges have.
fn repeated(name: &str, samples: &[RangeSample]) -> Option<String> {
    let mut counts: BTreeMap<u64, usize> = BTreeMap::new();
    for sample in samples {
        *counts.entry(sample.range_m.to_bits()).or_default() += 1;
    }
    let mut usual: Vec<usize> = counts.values().copied().collect();
    let usual = median_by(&mut usual, Ord::cmp)?;
    let (bits, count) = counts.into_iter().max_by_key(|&(_, count)| count)?;
    let share = count as f64 / samples.len() as f64;
    let value_m = f64::from_bits(bits);
    let mut others: Vec<f64> =
        samples.iter().map(|sample| sample.range_m).filter(|range_m| range_m.to_bits() != bits).collect();
    let is_beyond = value_m < 0.0 || median(&mut others).is_some_and(|usual_m| value_m > BEYOND * usual_m);
    // Devices with coarse steps repeat values as well, in all places.
    let is_frequent = count >= REPEATED.0 && count > COARSE * usual && share >= REPEATED.1;
    let is_one = is_frequent
        && (is_beyond || {
            let places =
                samples.iter().filter(|sample| sample.range_m.to_bits() == bits).map(|sample| sample.position);
            let corners = places.fold(None, |corners: Option<(Position, Position)>, place| {
                let (low, high) = corners.unwrap_or((place, place));
                let low = Position::new(low.x_m.min(place.x_m), low.y_m.min(place.y_m), low.z_m.min(place.z_m));
                let high = Position::new(high.x_m.max(place.x_m), high.y_m.max(place.y_m), high.z_m.max(place.z_m));
                Some((low, high))
            });
            corners.is_some_and(|(low, high)| low.distance_m(high) > 5.0)
        });
    is_one.then(|| {
        let why = if is_beyond { "far from all others" } else { "in places far apart" };
        format!(
            "{name}: {count} ranges are exactly {value_m} m, {why}: if the device reports that for failed tries, leave these cells empty"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_kernel::NodeId;

    #[test]
    fn a_value_far_from_all_others_is_told_at_one_place_and_wild_ranges_below_0_too() {
        let at = |number: usize| Position::new(0.01 * number as f64, 0.0, 0.0);
        let of = |range_m: &dyn Fn(usize) -> f64| -> Vec<RangeSample> {
            (0..200).map(|number| RangeSample::of(NodeId(0), at(number), range_m(number))).collect()
        };
        let right = |number: usize| 4.0 + 0.013 * number as f64;
        assert_eq!(notes("r", &of(&right)), Vec::<String>::new());
        let found = notes("r", &of(&|number| if number % 7 == 0 { 9999.0 } else { right(number) }));
        assert!(found[0].contains("29 ranges are exactly 9999 m, far from all others"), "{found:?}");
        let found = notes("r", &of(&|number| if number % 7 == 0 { -1.0 } else { right(number) }));
        assert!(found.iter().any(|note| note.contains("exactly -1 m, far from all others")), "{found:?}");
        let found = notes("r", &of(&|number| if number == 9 { -122.8 } else { right(number) }));
        assert!(found[0].contains("1 range below 0, down to -122.8 m"), "{found:?}");
    }
}
