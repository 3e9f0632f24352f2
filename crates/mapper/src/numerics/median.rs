//! The median.

/// The median of some numbers, at least one, which are sorted for it; of two middle ones their mean.
pub(crate) fn median(numbers: &mut [f64]) -> f64 {
    numbers.sort_unstable_by(f64::total_cmp);
    let upper = numbers.len() / 2;
    if numbers.len().is_multiple_of(2) { 0.5 * (numbers[upper - 1] + numbers[upper]) } else { numbers[upper] }
}
