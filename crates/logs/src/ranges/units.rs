//! Whether ranges are in the unit that their column says.

use sextant_channel::{Bounds, RangeSample};

use crate::median::median;

/// The columns of ranges, and a metre in their units. Light takes nanoseconds one way.
pub(crate) const RANGES: [(&str, f64); 5] = [
    ("range_m", 1.0),
    ("range_cm", 100.0),
    ("range_mm", 1000.0),
    ("range_ft", 1.0 / 0.3048),
    ("range_ns", 1.0 / 0.299_792_458),
];
/// Their names.
pub(crate) const RANGE_COLUMNS: [&str; 5] = [RANGES[0].0, RANGES[1].0, RANGES[2].0, RANGES[3].0, RANGES[4].0];
/// The same without that of metres, in messages.
pub(crate) const OTHER_COLUMNS: &str = "range_cm, range_mm, range_ft, range_ns";

/// Ranges so many times as long as the way is large are rather in a smaller unit, and ways are at least so large (m).
const TOO_LONG: (f64, f64) = (20.0, 5.0);
/// Ranges of less, from a way that is larger than the second number (m), are rather in a larger unit.
const TOO_SHORT_M: (f64, f64) = (0.1, 5.0);

/// A note on ranges that are far too long or too short for the way on which they were measured.
pub(crate) fn note(name: &str, samples: &[RangeSample]) -> Option<String> {
    let size = Bounds::of(samples.iter().map(|sample| sample.position))?;
    let way_m = size.min.distance_m(size.max);
    let mut ranges: Vec<f64> = samples.iter().map(|sample| sample.range_m.abs()).collect();
    let median_m = median(&mut ranges)?;
    let told = format!("{name}: half of the ranges are above {median_m:.3} m, and the way is {way_m:.1} m across");
    if median_m > TOO_LONG.0 * way_m.max(TOO_LONG.1) {
        Some(format!("{told}: if they are in millimetres or centimetres, name the column range_mm or range_cm"))
    } else if median_m < TOO_SHORT_M.0 && way_m > TOO_SHORT_M.1 {
        Some(format!("{told}: if they are in metres, name the column range_m"))
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_channel::Position;
    use sextant_kernel::NodeId;

    #[test]
    fn ranges_in_another_unit_are_told() {
        let samples = |factor: f64| -> Vec<RangeSample> {
            let sample = |at: u32| {
                RangeSample::of(NodeId(0), Position::new(f64::from(at), 0.0, 0.0), factor * (3.0 + f64::from(at % 7)))
            };
            (0..30).map(sample).collect()
        };
        assert_eq!(note("r", &samples(1.0)), None);
        assert!(note("r", &samples(1000.0)).is_some_and(|note| note.contains("range_mm")));
        assert!(note("r", &samples(100.0)).is_some_and(|note| note.contains("range_cm")));
        assert!(note("r", &samples(0.001)).is_some_and(|note| note.contains("name the column range_m")));
        assert_eq!(note("r", &[]), None);
    }
}
