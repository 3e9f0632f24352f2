//! The law of the strengths of a tag: they fall with the logarithm of the distance.

use crate::numerics::median;

/// The errors of strengths, as a law of Student's with four degrees of freedom: bodies and walls take much of a few.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StrengthErrors {
    /// The width of the law (dB).
    pub(super) width_db: f64,
    /// How many independent strengths one is worth.
    pub(super) worth: f64,
}

/// Degrees of freedom.
const FREEDOM: f64 = 4.0;
/// What is known of the width before a log is seen (dB), and how many strengths that is worth.
const USUAL_DB: f64 = 6.0;
const USUAL_WORTH: f64 = 20.0;

/// What is known of the law of a receiver before a log is seen: means and standard deviations. Power at a metre (dBm), exponent,
/// and how receivers differ (dB).
pub(super) const POWER_DBM: [f64; 2] = [-40.0, 40.0];
pub(super) const EXPONENT: [f64; 2] = [2.3, 0.35];
pub(super) const RECEIVER_DB: f64 = 1.5;
/// Nearer than this, strengths rise no more (m).
pub(super) const NEAREST_M: f64 = 0.5;

impl StrengthErrors {
    /// Logarithm of the density of an error, but for a constant.
    pub(super) fn log_density(self, error_db: f64) -> f64 {
        let of_width = error_db / self.width_db;
        -0.5 * (FREEDOM + 1.0) * libm::log1p(of_width * of_width / FREEDOM) - libm::log(self.width_db)
    }

    /// Its derivative by the error (1/dB).
    pub(super) fn by_error(self, error_db: f64) -> f64 {
        -error_db * self.stiffness(error_db)
    }

    /// What a method of Gauss and Newton takes for the curvature (1/dB²).
    pub(super) fn stiffness(self, error_db: f64) -> f64 {
        (FREEDOM + 1.0) / (FREEDOM * self.width_db * self.width_db + error_db * error_db)
    }

    /// The law of these errors (dB), of which one is worth so many: wild ones count up to three times their usual size.
    pub(super) fn of_errors(errors_db: &[f64], worth: f64) -> Self {
        let sizes: Vec<f64> = errors_db.iter().map(|error| error.abs()).collect();
        let most = if sizes.is_empty() { 0.0 } else { 3.0 * 1.4826 * median(&mut sizes.clone()) };
        let squares: f64 = sizes.iter().map(|size| size.min(most).powi(2)).sum();
        let count = sizes.len() as f64;
        let variance = (squares + USUAL_WORTH * USUAL_DB * USUAL_DB) / (count + USUAL_WORTH);
        Self { width_db: variance.sqrt().max(0.5), worth }
    }
}
