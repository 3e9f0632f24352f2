//! Conversion to single precision.

/// The nearest number in single precision.
#[expect(clippy::cast_possible_truncation, reason = "rounded on purpose")]
pub(super) fn single(value: f64) -> f32 {
    value as f32
}
