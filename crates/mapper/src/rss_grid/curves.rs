//! The evidence of a stop as a function of distance.

use crate::numerics::whole;
use crate::ranging::Ranging;

/// Below this distance the strength is constant (m).
const LEAST_M: f64 = 0.1;
/// Cells of the tables over distance.
const CELLS: usize = 8192;

/// Tables of the mean strength, which falls with distance, and of the log-probability of silence, which rises.
pub(super) struct Curves {
    per_m: f64,
    mean_dbm: Vec<f64>,
    log_silence: Vec<f64>,
}

impl Curves {
    /// The curves up to `longest_m`, for stops that hear what is at least `sensitivity_dbm` strong.
    pub(super) fn new(ranging: &Ranging, sensitivity_dbm: f64, longest_m: f64) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "a number of cells")]
        let distance_m = |cell: usize| longest_m * cell as f64 / CELLS as f64;
        let mean_dbm: Vec<f64> = (0..=CELLS).map(|cell| ranging.power_dbm(distance_m(cell).max(LEAST_M))).collect();
        let log_silence = mean_dbm.iter().map(|mean_dbm| {
            let margin = (mean_dbm - sensitivity_dbm) / ranging.sigma_db();
            log_normal_tail(margin)
        });
        #[expect(clippy::cast_precision_loss, reason = "a number of cells")]
        let per_m = CELLS as f64 / longest_m;
        Self { per_m, log_silence: log_silence.collect(), mean_dbm }
    }

    /// Mean strength over a distance (dBm).
    #[inline]
    pub(super) fn mean_dbm(&self, distance_m: f64) -> f64 {
        at(&self.mean_dbm, distance_m * self.per_m)
    }

    /// Logarithm of the probability that nothing is heard over a distance.
    #[inline]
    pub(super) fn log_silence(&self, distance_m: f64) -> f64 {
        at(&self.log_silence, distance_m * self.per_m)
    }
}

#[inline]
fn at(table: &[f64], place: f64) -> f64 {
    let cell = whole(place).min(CELLS - 1);
    #[expect(clippy::cast_precision_loss, reason = "a number of cells")]
    let within = place - cell as f64;
    table[cell] + within.min(1.0) * (table[cell + 1] - table[cell])
}

/// `log Φ(−x)`, also where Φ underflows.
fn log_normal_tail(x: f64) -> f64 {
    if x < 30.0 {
        libm::log(0.5 * libm::erfc(x / std::f64::consts::SQRT_2))
    } else {
        // Φ(−x) ≈ φ(x)/x with a relative error below 1/x².
        -0.5 * x * x - libm::log(x * (2.0 * std::f64::consts::PI).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tail_of_the_normal_law_is_smooth_where_it_underflows() {
        // Values of scipy.stats.norm.logcdf (SciPy 1.17).
        for (x, expected) in [(5.0, -15.064_998_393_988_727), (-2.0, -0.023_012_909_328_963_487)] {
            assert!((log_normal_tail(x) - expected).abs() < 1e-12, "{x}");
        }
        let step = log_normal_tail(30.0 - 1e-9) - log_normal_tail(30.0);
        assert!(step.abs() < 2e-3, "{step}");
        assert!((log_normal_tail(40.0) / -804.608_442_014_199_9 - 1.0).abs() < 1e-5);
    }
}
