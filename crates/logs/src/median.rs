//! The median.

use std::cmp::Ordering;

/// The median of numbers, which are put in another order for it: the upper one of two in the middle. `None` of none.
pub(crate) fn median(numbers: &mut [f64]) -> Option<f64> {
    median_by(numbers, f64::total_cmp)
}

/// The same of values in this order.
pub(crate) fn median_by<T: Copy>(values: &mut [T], order: impl FnMut(&T, &T) -> Ordering) -> Option<T> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, order).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_two_in_the_middle_the_upper_one_counts() {
        assert_eq!(median(&mut [4.0, -1.0, 9.0]), Some(4.0));
        assert_eq!(median(&mut [4.0, 1.0, 9.0, 3.0]), Some(4.0));
        assert_eq!(median(&mut []), None);
        assert_eq!(median_by(&mut [5_u8, 1, 2], Ord::cmp), Some(2));
    }
}
