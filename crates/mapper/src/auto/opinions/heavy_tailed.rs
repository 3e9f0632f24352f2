//! Opinions on a place in the plane that may be far off, and what they say together.

use nalgebra::{Matrix2, Vector2};
use sextant_kernel::maths::{exp, ln};

/// The density (1 + q / freedom)^(-exponent) of a place, where q is its squared distance to `place` in units of `scale`. A
/// Student distribution of `freedom` degrees has the exponent (freedom + 2) / 2; a smaller exponent is a power of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HeavyTailed {
    /// Where it is greatest (m).
    pub(super) place: Vector2<f64>,
    /// Its scale along the axes (m²).
    pub(super) scale: Matrix2<f64>,
    pub(super) freedom: f64,
    pub(super) exponent: f64,
}

impl HeavyTailed {
    /// A Student distribution to a power.
    pub(super) fn student(place: Vector2<f64>, scale: Matrix2<f64>, freedom: f64, power: f64) -> Self {
        Self { place, scale, freedom, exponent: power * (freedom + 2.0) / 2.0 }
    }

    /// Normal distributions whose sum it is: the density is an integral over λ of λ^(exponent - 1) exp(-λ (1 + q / freedom)),
    /// here by the trapezoidal rule in ln λ, whose error is below a thousandth. `None` if the scale has no inverse.
    fn parts(&self) -> Option<Vec<GaussianFactor>> {
        let inverse = self.scale.try_inverse()?;
        let part = |number: u32| {
            let ln_rate = LOWEST_LN_RATE + f64::from(number);
            let rate = libm::exp(ln_rate);
            let precision = inverse * (2.0 * rate / self.freedom);
            GaussianFactor { ln_weight: self.exponent * ln_rate - rate, precision, place: self.place }
        };
        Some((0..PARTS).map(part).collect())
    }
}

/// ln λ of the first part, and the number of parts, one for each step of 1. They span distances of up to 30 times the scale.
const LOWEST_LN_RATE: f64 = -7.0;
const PARTS: u32 = 10;

/// The function exp(ln_weight - (x - place)' precision (x - place) / 2).
struct GaussianFactor {
    ln_weight: f64,
    precision: Matrix2<f64>,
    place: Vector2<f64>,
}

/// Mean (m) and covariance (m²) of the product of opinions. `None` without any, or if a scale has no inverse.
pub(super) fn together(opinions: &[HeavyTailed]) -> Option<(Vector2<f64>, Matrix2<f64>)> {
    let origin = opinions.first()?.place;
    let mut products = vec![GaussianProduct::default()];
    for opinion in opinions {
        let parts = opinion.parts()?;
        products = products.iter().flat_map(|product| parts.iter().map(|part| product.with(part, origin))).collect();
    }
    let normals: Option<Vec<WeightedNormal>> = products.iter().map(GaussianProduct::normal).collect();
    let normals = normals?;
    let highest = normals.iter().map(|normal| normal.ln_weight).fold(f64::NEG_INFINITY, f64::max);
    let (mut total, mut mean, mut second_moment) = (0.0, Vector2::zeros(), Matrix2::zeros());
    for WeightedNormal { ln_weight, mean: place, covariance } in normals {
        let weight = exp(ln_weight - highest);
        total += weight;
        mean += place * weight;
        second_moment += (covariance + place * place.transpose()) * weight;
    }
    let mean = mean / total;
    let covariance = second_moment / total - mean * mean.transpose();
    Some((origin + mean, covariance))
}

/// A product of parts: the function exp(ln_weight - x' precision x / 2 + weighted' x - squared / 2) of the way x from an origin.
#[derive(Clone, Copy, Debug, Default)]
struct GaussianProduct {
    ln_weight: f64,
    precision: Matrix2<f64>,
    weighted: Vector2<f64>,
    squared: f64,
}

/// A normal distribution with the logarithm of its weight.
struct WeightedNormal {
    ln_weight: f64,
    mean: Vector2<f64>,
    covariance: Matrix2<f64>,
}

impl GaussianProduct {
    fn with(&self, part: &GaussianFactor, origin: Vector2<f64>) -> Self {
        let place = part.place - origin;
        let pulled = part.precision * place;
        Self {
            ln_weight: self.ln_weight + part.ln_weight,
            precision: self.precision + part.precision,
            weighted: self.weighted + pulled,
            squared: self.squared + place.dot(&pulled),
        }
    }

    fn normal(&self) -> Option<WeightedNormal> {
        let covariance = self.precision.try_inverse()?;
        let mean = covariance * self.weighted;
        let ln_integral = 0.5 * (ln(covariance.determinant()) + self.weighted.dot(&mean) - self.squared);
        Some(WeightedNormal { ln_weight: self.ln_weight + ln_integral, mean, covariance })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn density(opinion: &HeavyTailed, at: Vector2<f64>) -> f64 {
        let way = at - opinion.place;
        let squared = way.dot(&(opinion.scale.try_inverse().unwrap() * way));
        (1.0 + squared / opinion.freedom).powf(-opinion.exponent)
    }

    #[test]
    fn mean_and_covariance_of_a_product_are_those_of_sums_over_a_grid() {
        let wide = Matrix2::new(4.0, 1.0, 1.0, 2.0);
        let opinions = [
            HeavyTailed::student(Vector2::new(1.0, -2.0), wide, 3.0, 1.0),
            HeavyTailed::student(Vector2::new(4.0, 1.0), Matrix2::identity() * 0.5, 2.0, 0.7),
            HeavyTailed::student(Vector2::new(6.0, -1.0), Matrix2::identity() * 0.8, 2.0, 0.7),
        ];
        let (mean, covariance) = together(&opinions).unwrap();
        let (mut total, mut sum, mut squares) = (0.0, Vector2::zeros(), Matrix2::zeros());
        for i in -900..900 {
            for j in -900..900 {
                let at = Vector2::new(3.0 + 0.05 * f64::from(i), 0.05 * f64::from(j));
                let weight: f64 = opinions.iter().map(|opinion| density(opinion, at)).product();
                total += weight;
                sum += at * weight;
                squares += at * at.transpose() * weight;
            }
        }
        let expected = sum / total;
        let spread = squares / total - expected * expected.transpose();
        assert!((mean - expected).norm() < 0.01, "{mean} is not {expected}");
        assert!((covariance - spread).norm() < 0.03 * spread.norm(), "{covariance} is not {spread}");
    }

    #[test]
    fn one_opinion_far_from_two_that_agree_counts_little() {
        let unit = Matrix2::identity();
        let far = HeavyTailed::student(Vector2::new(100.0, 0.0), unit, 3.0, 1.0);
        let near = HeavyTailed::student(Vector2::new(0.0, 0.0), unit, 2.0, 1.0);
        let (mean, _) = together(&[far, near, near]).unwrap();
        assert!(mean.norm() < 1.0, "{mean}");
    }
}
