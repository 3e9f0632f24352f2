//! The region that holds a node with a given probability.

use nalgebra::{DMatrix, DVector};
use sextant_channel::Position;

use crate::posterior::estimate::Estimate;

/// Below this variance along the height a map is planar (m²).
const FLAT_M2: f64 = 1e-12;
/// 95 % quantile of the chi-squared law with two and with three degrees of freedom.
const CHI_SQUARED_95: [f64; 2] = [5.991_464_547_107_982, 7.814_727_903_251_178];

/// An ellipse (an ellipsoid, if the heights are uncertain as well) that holds a node with a probability of 95 %: all
/// places x with `(x − m)ᵀ C⁻¹ (x − m) ≤ χ²₀.₉₅`, where m and C are the posterior mean and covariance. In a plane the height does
/// not count.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    mean: Position,
    /// The covariance, two or three rows (m²).
    covariance: DMatrix<f64>,
    /// Inverse of the covariance, two or three rows (1/m²).
    precision: DMatrix<f64>,
    /// Square root of the determinant of the covariance (m² or m³).
    volume: f64,
}

impl Region {
    /// The region that holds the node with 95 %; `None` for an estimate without a covariance.
    #[must_use]
    pub fn of_95(estimate: &Estimate) -> Option<Self> {
        let covariance = estimate.covariance?;
        let dimensions = if covariance[2][2] > FLAT_M2 { 3 } else { 2 };
        let matrix = DMatrix::from_fn(dimensions, dimensions, |row, column| covariance[row][column]);
        let volume = matrix.determinant().max(0.0).sqrt();
        let precision = matrix.clone().try_inverse()?;
        Some(Self { mean: estimate.position, covariance: matrix, precision, volume })
    }

    /// Whether `place` is in the region.
    #[must_use]
    pub fn contains(&self, place: Position) -> bool {
        let apart: [f64; 3] = (place - self.mean).into();
        let apart = DVector::from_column_slice(&apart[..self.dimensions()]);
        apart.dot(&(&self.precision * &apart)) <= CHI_SQUARED_95[self.dimensions() - 2]
    }

    /// The outline of the region as seen along the axis that is not among `axes` (0 to 2, for x, y and z): the places of
    /// `corners` points at equal angles, in metres along these axes. The projection of an ellipsoid is the ellipse whose
    /// matrix is the part of the covariance with these rows and columns.
    #[must_use]
    pub fn outline(&self, axes: [usize; 2], corners: u32) -> Vec<[f64; 2]> {
        let covariance = |row: usize, column: usize| self.covariance.get((row, column)).copied().unwrap_or(0.0);
        let [first, second] = axes;
        // The root of the matrix by Cholesky's method: [[a, 0], [b, c]].
        let a = covariance(first, first).max(0.0).sqrt();
        let b = if a > 0.0 { covariance(first, second) / a } else { 0.0 };
        let c = (covariance(second, second) - b * b).max(0.0).sqrt();
        let reach = CHI_SQUARED_95[self.dimensions() - 2].sqrt();
        let mean: [f64; 3] = self.mean.into();
        let corner = |i: u32| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(i) / f64::from(corners));
            [mean[first] + reach * a * cos, mean[second] + reach * (b * cos + c * sin)]
        };
        (0..corners).map(corner).collect()
    }

    /// 2 for an ellipse, 3 for an ellipsoid.
    #[must_use]
    pub fn dimensions(&self) -> usize {
        self.precision.nrows()
    }

    /// Area of the ellipse (m²) or volume of the ellipsoid (m³).
    #[must_use]
    pub fn size(&self) -> f64 {
        let squared = CHI_SQUARED_95[self.dimensions() - 2];
        let unit = if self.dimensions() == 2 { squared } else { 4.0 / 3.0 * squared * squared.sqrt() };
        std::f64::consts::PI * unit * self.volume
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(covariance: [[f64; 3]; 3]) -> Estimate {
        let position = Position::new(1.0, 2.0, 0.0);
        Estimate { log_likelihood: Some(0.0), covariance: Some(covariance), ..Estimate::of_place(position) }
    }

    #[test]
    fn the_ellipse_has_its_half_axes_where_the_chi_squared_law_puts_them() {
        let region = Region::of_95(&estimate([[4.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3]])).unwrap();
        let half = 5.991_464_547_107_982_f64.sqrt();
        for (x_m, y_m, is_in) in [
            (2.0 * half - 1e-9, 0.0, true),
            (2.0 * half + 1e-9, 0.0, false),
            (0.0, half - 1e-9, true),
            (0.0, half + 1e-9, false),
        ] {
            // In a plane the height does not count.
            assert_eq!(region.contains(Position::new(1.0 + x_m, 2.0 + y_m, 7.0)), is_in);
        }
        assert!((region.size() - std::f64::consts::PI * 2.0 * half * half).abs() < 1e-9);
    }

    #[test]
    fn the_outline_is_where_the_region_ends() {
        let region = Region::of_95(&estimate([[4.0, 1.2, 0.0], [1.2, 1.0, 0.0], [0.0; 3]])).unwrap();
        for [x_m, y_m] in region.outline([0, 1], 60) {
            let at = |share: f64| Position::new(1.0 + share * (x_m - 1.0), 2.0 + share * (y_m - 2.0), 0.0);
            assert!(region.contains(at(0.999)) && !region.contains(at(1.001)));
        }
        assert!(region.outline([0, 2], 60).iter().all(|corner| corner[1].abs() < 1e-12), "it is flat");
        // Seen along an axis, the half-axes of an ellipsoid with its axes along x, y and z are the other two.
        let space = Region::of_95(&estimate([[4.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 9.0]])).unwrap();
        let highest = space.outline([0, 2], 360).iter().map(|corner| corner[1]).fold(0.0, f64::max);
        assert!((highest - 3.0 * 7.814_727_903_251_178_f64.sqrt()).abs() < 1e-3, "{highest} m");
    }

    #[test]
    fn a_region_has_as_many_dimensions_as_the_covariance_and_none_without_one() {
        assert_eq!(Region::of_95(&Estimate { covariance: None, ..estimate([[0.0; 3]; 3]) }), None);
        assert_eq!(Region::of_95(&estimate([[0.0; 3]; 3])), None);
        let space = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!(Region::of_95(&estimate(space)).unwrap().dimensions(), 3);
    }
}
