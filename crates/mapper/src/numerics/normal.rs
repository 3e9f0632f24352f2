//! A fast normal distribution function.

use sextant_kernel::maths::{PER_ROOT_OF_TAU, exp, exp_each};

/// Number of values per standard deviation.
const PER_UNIT: f64 = 128.0;
/// The table ends here on both sides.
const END: f64 = 8.0;
/// Steps of the table: two ends of 128 values a standard deviation.
const STEPS: u32 = 2048;

/// The standard normal distribution function by linear interpolation, exact to 10⁻⁵.
#[derive(Clone, Debug)]
pub(crate) struct Normal {
    values: Vec<f64>,
}

impl Normal {
    pub(crate) fn new() -> Self {
        Self { values: (0..=STEPS).map(|i| below(f64::from(i) / PER_UNIT - END)).collect() }
    }

    /// Φ(x).
    #[inline]
    pub(crate) fn below(&self, x: f64) -> f64 {
        let along = ((x + END) * PER_UNIT).clamp(0.0, f64::from(STEPS - 1));
        let index = index(along);
        let (low, high) = (self.values[index], self.values[index + 1]);
        let share = along - index as f64;
        low + (high - low) * share
    }
}

/// The index below `along`, which is small; a conversion through 32 bits is the fastest.
#[inline]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturating is what is wanted")]
pub(crate) fn index(along: f64) -> usize {
    along as u32 as usize
}

/// Φ(x).
pub(crate) fn below(x: f64) -> f64 {
    0.5 * libm::erfc(-x * std::f64::consts::FRAC_1_SQRT_2)
}

/// The scale β for which the logistic law is nearest to the normal law of the difference of two numbers with this
/// standard deviation each: `σ √2/1.702` (Camilli 1994).
pub(crate) fn logistic_scale(sigma: f64) -> f64 {
    sigma * std::f64::consts::SQRT_2 / 1.702
}

/// The standard normal density.
pub(crate) fn density(x: f64) -> f64 {
    exp(-0.5 * x * x) * PER_ROOT_OF_TAU
}

/// The same of each number.
pub(crate) fn densities<const COUNT: usize>(x: [f64; COUNT]) -> [f64; COUNT] {
    let mut values = x.map(|x| -0.5 * x * x);
    exp_each(&mut values);
    values.map(|value| value * PER_ROOT_OF_TAU)
}

/// The x with Φ(x) = `p`, between -8 and 8, by bisection.
pub(crate) fn quantile(p: f64) -> f64 {
    let (mut low, mut high) = (-END, END);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if below(middle) < p {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_the_integral_of_the_density() {
        let normal = Normal::new();
        let (mut sum, step) = (0.0, 1e-3);
        for i in -8000..4000 {
            let x = f64::from(i) * step;
            if i % 100 == 0 {
                assert!((normal.below(x) - sum).abs() < 1e-5, "Φ({x})");
            }
            sum += 0.5 * step * (density(x) + density(x + step));
        }
    }

    #[test]
    fn the_quantile_undoes_the_table_within_its_ends() {
        let normal = Normal::new();
        for p in [1e-6, 0.01, 0.3, 0.5, 0.9, 0.999] {
            assert!((normal.below(quantile(p)) - p).abs() < 1e-5);
        }
        assert!(normal.below(-100.0) < 1e-12 && normal.below(100.0) > 1.0 - 1e-12);
    }
}
