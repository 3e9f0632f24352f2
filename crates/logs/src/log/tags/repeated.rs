//! A range that a device reports in the place of failed tries.

use std::collections::BTreeMap;

use sextant_mapper::{TagReading, TagValue};

use crate::median::median_by;

/// A value that so many ranges have, and this share of them, is no measurement.
const LEAST: usize = 20;
const SHARE: f64 = 0.02;
/// Of ranges in coarse steps each value is repeated: one is odd if it is more frequent than the usual one by this factor.
const COARSE: usize = 4;
/// It is so much longer or shorter than the usual range: a tag at rest repeats ranges as well.
const FAR: f64 = 2.0;

/// A note on a value that too many ranges of a tag to several receivers have.
pub(super) fn note(tag: &str, readings: &[TagReading]) -> Option<String> {
    let mut receivers: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    let mut ranges = Vec::new();
    for reading in readings {
        let TagValue::Range(range_m) = reading.value else { continue };
        receivers.entry(range_m.to_bits()).or_default().push(reading.receiver);
        ranges.push(range_m);
    }
    let count = ranges.len();
    let mut counts: Vec<usize> = receivers.values().map(Vec::len).collect();
    let usual = median_by(&mut counts, Ord::cmp)?;
    let usual_m = median_by(&mut ranges, f64::total_cmp)?;
    let (bits, of) = receivers.into_iter().max_by_key(|(_, of)| of.len())?;
    let range_m = f64::from_bits(bits);
    let is_far = range_m > FAR * usual_m || range_m < usual_m / FAR;
    let is_of_several = of.iter().any(|&receiver| receiver != of[0]);
    let is_frequent = of.len() >= LEAST && of.len() > COARSE * usual && of.len() as f64 >= SHARE * count as f64;
    (is_far && is_of_several && is_frequent).then(|| {
        format!(
            "{tag}: {} of {count} ranges are exactly {range_m} m, to several receivers: if the device reports that for failed tries, \
             leave these cells empty",
            of.len()
        )
    })
}

#[cfg(test)]
mod tests {
    use sextant_kernel::SimTime;

    use super::*;

    /// Ranges of a tag to three receivers, of which every fifth is `failed_m`.
    fn readings(failed_m: Option<f64>) -> Vec<TagReading> {
        let range_m = |number: u64| 3.0 + libm::sin(0.37 * number as f64);
        let reading = |number: u64| {
            let failed_m = failed_m.filter(|_| number.is_multiple_of(5));
            let time = SimTime::from_nanos(number * 100_000_000);
            TagReading::range((number % 3) as usize, time, failed_m.unwrap_or(range_m(number)))
        };
        (0..300).map(reading).collect()
    }

    #[test]
    fn a_value_of_failed_tries_is_named() {
        for failed_m in [65.535, 9999.0, -1.0] {
            let found = note("tag", &readings(Some(failed_m))).expect("a note");
            assert!(found.contains(&format!("60 of 300 ranges are exactly {failed_m} m")), "{found}");
        }
        assert_eq!(note("tag", &readings(None)), None);
        // A tag at rest has the same ranges again and again.
        let still = |reading: &TagReading| TagReading::range(reading.receiver, reading.time, 3.0);
        assert_eq!(note("tag", &readings(None).iter().map(still).collect::<Vec<_>>()), None);
    }
}
