//! Maxima of functions of one value.

/// Where a function of one value is highest between two ends, by golden sections.
pub(crate) fn highest(mut value: impl FnMut(f64) -> f64, [mut low, mut high]: [f64; 2], steps: u32) -> f64 {
    const SHARE: f64 = 0.618_033_988_749_894_8;
    let (mut left, mut right) = (high - SHARE * (high - low), low + SHARE * (high - low));
    let (mut of_left, mut of_right) = (value(left), value(right));
    for _ in 0..steps {
        if of_left >= of_right {
            (high, right, of_right) = (right, left, of_left);
            left = high - SHARE * (high - low);
            of_left = value(left);
        } else {
            (low, left, of_left) = (left, right, of_right);
            right = low + SHARE * (high - low);
            of_right = value(right);
        }
    }
    0.5 * (low + high)
}
