//! Bit errors of the 2450 MHz O-QPSK physical layer (IEEE 802.15.4-2006, annex E.4.1.8).

use sextant_channel::{Db, Dbm};

/// Signal-to-noise ratio at which 1 % of frames of 20 octets are lost, the standard's definition of
/// sensitivity, by the bit error rate of this file (dB).
const SNR_AT_SENSITIVITY: Db = Db(0.403);

/// Noise power in the channel of a receiver with this sensitivity (dBm).
#[must_use]
pub fn noise_floor(sensitivity: Dbm) -> Dbm {
    sensitivity - SNR_AT_SENSITIVITY
}

/// Probability that a bit is wrong, at a ratio `sinr` (a factor, not decibels) of signal to noise
/// and interference in the channel:
///
/// `BER = (8/15)(1/16) sum_{k=2}^{16} (-1)^k C(16,k) exp(20 sinr (1/k - 1))`.
///
/// From a ratio of 6 (7.8 dB) on it is below 4e-26: no frame is long enough for that to change its probability in the last
/// digit, and the result is 0.
#[must_use]
pub fn bit_error_rate(sinr: f64) -> f64 {
    if sinr >= CLEAR {
        return 0.0;
    }
    let sum: f64 = TERMS.iter().map(|&(weight, slope)| weight * libm::exp(slope * sinr)).sum();
    // At a ratio of 0 the sum is 1/2, up to rounding.
    sum.clamp(0.0, 0.5)
}

/// The ratio from which on no bit is wrong.
const CLEAR: f64 = 6.0;

/// Quality of a link, 0 to 255, as a radio tells it with a frame (LQI; IEEE 802.15.4-2006, 6.9.8, which leaves the measure
/// to the radio). Here it grows evenly with the least ratio of signal to noise and interference during the frame, from -5 dB, at
/// which a receiver just locks on, to 25 dB.
#[must_use]
pub fn link_quality(sinr: Db) -> u8 {
    let share = (sinr.0 - LEAST_QUALITY.0) / (GREATEST_QUALITY.0 - LEAST_QUALITY.0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255; not a number becomes 0")]
    let quality = (255.0 * share.clamp(0.0, 1.0)).round() as u8;
    quality
}

/// Ratios with the least and with the greatest quality.
const LEAST_QUALITY: Db = Db(-5.0);
const GREATEST_QUALITY: Db = Db(25.0);

/// Weight and exponent per unit of SINR of each term of the sum, k from 16 down to 2: the small ones first.
const TERMS: [(f64, f64); 15] = {
    let mut terms = [(0.0, 0.0); 15];
    let mut binomial = 1.0;
    let mut k = 16;
    while k >= 2 {
        let order = k as f64;
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        terms[16 - k] = (8.0 / 15.0 / 16.0 * sign * binomial, 20.0 * (1.0 / order - 1.0));
        binomial = binomial * order / (17.0 - order);
        k -= 1;
    }
    terms
};

#[cfg(test)]
mod tests {
    use super::*;

    fn relative_error(value: f64, reference: f64) -> f64 {
        (value / reference - 1.0).abs()
    }

    /// Probability that `bits` bits in a row arrive without error while the ratio is `sinr` (a factor).
    fn chunk_success(sinr: f64, bits: f64) -> f64 {
        libm::exp(bits * libm::log1p(-bit_error_rate(sinr)))
    }

    /// Ratio at which `octets` are lost with probability `loss` (dB).
    fn sinr_db(octets: f64, loss: f64) -> f64 {
        let (mut low, mut high) = (-10.0, 10.0);
        for _ in 0..60 {
            let middle = (low + high) / 2.0;
            let lost = 1.0 - chunk_success(Db(middle).to_factor(), 8.0 * octets);
            if lost > loss { low = middle } else { high = middle }
        }
        low
    }

    #[test]
    fn the_bit_error_rate_agrees_with_an_independent_calculation() {
        // Rounded to four digits, so within 1e-3.
        let table = [
            (-5.0, 7.517e-2),
            (-4.0, 3.916e-2),
            (-3.0, 1.642e-2),
            (-2.0, 5.197e-3),
            (-1.0, 1.149e-3),
            (0.0, 1.615e-4),
            (0.5, 4.939e-5),
            (1.0, 1.291e-5),
            (1.5, 2.836e-6),
            (2.0, 5.131e-7),
            (3.0, 8.597e-9),
            (4.0, 4.930e-11),
        ];
        for (db, reference) in table {
            let rate = bit_error_rate(Db(db).to_factor());
            assert!(relative_error(rate, reference) < 1e-3, "{db} dB: {rate}");
        }
    }

    #[test]
    fn frame_losses_agree_with_an_independent_calculation() {
        let table = [
            (11.0, 0.153, -2.33),
            (20.0, 0.403, -1.86),
            (26.0, 0.509, -1.68),
            (50.0, 0.760, -1.25),
            (127.0, 1.092, -0.71),
        ];
        for (octets, one_percent, half) in table {
            assert!((sinr_db(octets, 0.01) - one_percent).abs() < 6e-4, "{octets} octets, 1 %");
            assert!((sinr_db(octets, 0.5) - half).abs() < 6e-3, "{octets} octets, 50 %");
        }
    }

    #[test]
    fn a_signal_at_the_sensitivity_loses_one_frame_of_20_octets_in_a_hundred() {
        let sensitivity = Dbm(-95.0);
        let sinr = (sensitivity - noise_floor(sensitivity)).to_factor();
        assert!((chunk_success(sinr, 160.0) - 0.99).abs() < 1e-4);
    }

    #[test]
    fn the_bit_error_rate_is_a_half_without_signal_and_zero_with_a_strong_one() {
        assert!((bit_error_rate(0.0) - 0.5).abs() < 1e-12);
        assert!(bit_error_rate(1e3) < 1e-300);
        assert!((chunk_success(1e3, 1016.0) - 1.0).abs() < f64::EPSILON);
        assert!((chunk_success(f64::INFINITY, 1016.0) - 1.0).abs() < f64::EPSILON);
    }

    #[test]
    fn the_quality_of_a_link_grows_evenly_from_the_lock_to_25_db() {
        let qualities = [f64::NEG_INFINITY, -5.0, 10.0, 25.0, f64::INFINITY].map(|db| link_quality(Db(db)));
        assert_eq!(qualities, [0, 0, 128, 255, 255]);
        assert!((-10..40).all(|db| link_quality(Db(f64::from(db))) <= link_quality(Db(f64::from(db + 1)))));
    }

    #[test]
    fn the_bit_error_rate_falls_with_the_ratio() {
        let rates: Vec<f64> = (0..400).map(|i| bit_error_rate(f64::from(i) * 0.01)).collect();
        assert!(rates.is_sorted_by(|a, b| a > b));
    }
}
