//! Real numbers as counts.

/// `value` as a count; 0 if it is negative, the largest count if it is too large.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturating is what is wanted")]
pub(crate) fn whole(value: f64) -> usize {
    value as usize
}
