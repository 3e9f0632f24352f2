//! Link quality of IEEE 802.15.4.

use sextant_channel::Dbm;

/// A link with at least this power above the sensitivity has the best quality (dB). It is the minimum range of energy
/// detection (IEEE 802.15.4-2006, 6.9.7 and 6.9.8).
const QUALITY_RANGE_DB: f64 = 40.0;

/// Link quality (LQI): 0 at the sensitivity of the receiver, 255 at 40 dB or more above it, linear in between.
#[must_use]
pub fn link_quality(power: Dbm, sensitivity: Dbm) -> u8 {
    let share = (power - sensitivity).0 / QUALITY_RANGE_DB;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 255")]
    let quality = (255.0 * share.clamp(0.0, 1.0)).round() as u8;
    quality
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quality_rises_from_the_sensitivity_to_40_db_above() {
        let quality = |dbm| link_quality(Dbm(dbm), Dbm(-90.0));
        assert_eq!([-95.0, -90.0, -70.0, -50.0, -20.0].map(quality), [0, 0, 128, 255, 255]);
    }
}
