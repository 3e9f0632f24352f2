//! The SNRs that stations report: of the best frame heard, and of each sector.

use sextant_channel::Db;

/// The SNR report field: 8 bits, two's complement, steps of 0.25 dB around 19 dB (IEEE 802.11ad-2012, 8.4a.2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct SnrReport(pub i8);

impl SnrReport {
    /// The nearest report of `snr`: lower values than −13 dB are reported as −13 dB, higher ones than 50.75 dB as
    /// 50.75 dB.
    #[must_use]
    pub fn of(snr: Db) -> Self {
        let quarters = (4.0 * (snr.0 - 19.0)).round().clamp(-128.0, 127.0);
        #[expect(clippy::cast_possible_truncation, reason = "between -128 and 127")]
        let report = quarters as i8;
        Self(report)
    }

    /// The SNR reported.
    #[must_use]
    pub fn snr(self) -> Db {
        Db(19.0 + f64::from(self.0) / 4.0)
    }

    pub(super) const fn to_octet(self) -> u8 {
        self.0.to_le_bytes()[0]
    }

    pub(super) const fn from_octet(octet: u8) -> Self {
        Self(i8::from_le_bytes([octet]))
    }
}

/// The SNR of a sector in a Channel Measurement Feedback element: 8 bits, steps of 0.25 dB from −8 dB (IEEE 802.11ad-2012,
/// 8.4.2.138). It is another code than that of [`SnrReport`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct MeasuredSnr(pub u8);

impl MeasuredSnr {
    /// The nearest report of `snr`: lower values than −8 dB are reported as −8 dB, higher ones than 55.75 dB as 55.75 dB.
    #[must_use]
    pub fn of(snr: Db) -> Self {
        let quarters = (4.0 * (snr.0 + 8.0)).round().clamp(0.0, 255.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 255")]
        let report = quarters as u8;
        Self(report)
    }

    /// The SNR reported.
    #[must_use]
    pub fn snr(self) -> Db {
        Db(f64::from(self.0) / 4.0 - 8.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reports_are_quarters_of_a_decibel_around_19_and_clamped() {
        let of = |snr| SnrReport::of(Db(snr)).0;
        assert_eq!([of(12.0), of(19.0), of(19.2), of(44.0)], [-28, 0, 1, 100]);
        assert_eq!([of(-13.0), of(-40.0), of(50.75), of(90.0)], [-128, -128, 127, 127]);
        assert_eq!(SnrReport::of(Db(12.0)).to_octet(), 0xE4);
        assert!((SnrReport(-128).snr().0 + 13.0).abs() < 1e-12 && (SnrReport(127).snr().0 - 50.75).abs() < 1e-12);
        for report in i8::MIN..=i8::MAX {
            assert_eq!(SnrReport::of(SnrReport(report).snr()), SnrReport(report));
            assert_eq!(SnrReport::from_octet(SnrReport(report).to_octet()), SnrReport(report));
        }
    }

    #[test]
    fn measurements_are_quarters_of_a_decibel_from_minus_8_and_clamped() {
        let of = |snr| MeasuredSnr::of(Db(snr)).0;
        assert_eq!([of(-8.0), of(-7.8), of(0.0), of(19.2), of(55.75)], [0, 1, 32, 109, 255]);
        assert_eq!([of(-9.0), of(-80.0), of(56.0), of(90.0)], [0, 0, 255, 255]);
        for report in 0..=255 {
            assert_eq!(MeasuredSnr::of(MeasuredSnr(report).snr()), MeasuredSnr(report));
        }
    }
}
