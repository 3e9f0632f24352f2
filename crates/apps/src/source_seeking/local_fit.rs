//! Least squares of a field about a place: a polynomial through readings nearby (Cleveland 1979, local regression).

use nalgebra::{DMatrix, DVector};
use sextant_channel::Position;

/// The polynomial that stands for a field nearby.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Degree {
    /// The field is the same all around: a weighted mean.
    Constant,
    /// It is a plane.
    Linear,
    /// It is a paraboloid: a peak is not flattened.
    Quadratic,
}

/// How many axes count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axes {
    /// x and y.
    Plane,
    /// x, y and z.
    Space,
}

impl Axes {
    /// The part of an offset along these axes.
    pub(super) fn of(self, offset: Position) -> Position {
        match self {
            Self::Plane => Position { z_m: 0.0, ..offset },
            Self::Space => offset,
        }
    }
}

/// A reading near the place of interest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// From the place of interest to where it was taken (m).
    pub(super) offset: Position,
    pub(super) value: f64,
    pub(super) weight: f64,
}

/// What a fit says about the field at the place of interest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LocalFit {
    pub(super) degree: Degree,
    /// The value there.
    pub(super) value: f64,
    /// The gradient there (1/m); zero if the degree is constant.
    pub(super) gradient: Position,
    /// Standard deviation of the gradient along an axis (1/m), if all readings are off by independent errors as large as the
    /// residuals.
    pub(super) gradient_sigma: f64,
}

/// A setting of fits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fitting {
    pub(super) axes: Axes,
    pub(super) degree: Degree,
    /// Unit of length (m): it does not change the result, but keeps the numbers near one.
    pub(super) scale_m: f64,
    /// What is added to the diagonal of the normal equations, but for the constant term, as a share of its mean: a field
    /// that the readings do not tell is taken to be even.
    pub(super) ridge: f64,
}

/// Most terms of a polynomial.
const MOST_TERMS: usize = 10;
/// Readings per term below which a polynomial of lower degree is fitted.
const READINGS_PER_TERM: f64 = 2.0;

impl Fitting {
    /// The terms of the polynomial at `offset`, and their number.
    fn terms(&self, offset: Position, degree: Degree) -> ([f64; MOST_TERMS], usize) {
        let [x, y, z] = <[f64; 3]>::from(offset * (1.0 / self.scale_m));
        let terms = match self.axes {
            Axes::Plane => [1.0, x, y, x * x, x * y, y * y, 0.0, 0.0, 0.0, 0.0],
            Axes::Space => [1.0, x, y, z, x * x, x * y, y * y, x * z, y * z, z * z],
        };
        (terms, self.count(degree))
    }

    /// Number of terms.
    pub(super) fn count(&self, degree: Degree) -> usize {
        match (degree, self.axes) {
            (Degree::Constant, _) => 1,
            (Degree::Linear, Axes::Plane) => 3,
            (Degree::Linear, Axes::Space) => 4,
            (Degree::Quadratic, Axes::Plane) => 6,
            (Degree::Quadratic, Axes::Space) => MOST_TERMS,
        }
    }

    /// Number of equal weights that would vary as much: (Σw)² / Σw² (Kish 1965).
    fn effective(samples: &[Sample]) -> f64 {
        let (sum, squares) =
            samples.iter().fold((0.0, 0.0), |(sum, squares), s| (sum + s.weight, squares + s.weight * s.weight));
        if squares > 0.0 { sum * sum / squares } else { 0.0 }
    }

    /// The fit of the wanted degree, or of the highest one below it for which there are enough readings. `None` without
    /// any.
    pub(super) fn best(&self, samples: &[Sample]) -> Option<LocalFit> {
        let effective = Self::effective(samples);
        [Degree::Quadratic, Degree::Linear, Degree::Constant]
            .into_iter()
            .filter(|&degree| degree <= self.degree)
            .filter(|&degree| {
                degree == Degree::Constant || effective >= READINGS_PER_TERM * self.count(degree) as f64
            })
            .find_map(|degree| self.exactly(samples, degree))
    }

    /// The fit of this degree; `None` if the readings do not determine it.
    pub(super) fn exactly(&self, samples: &[Sample], degree: Degree) -> Option<LocalFit> {
        let count = self.count(degree);
        let mut normal = DMatrix::<f64>::zeros(count, count);
        let mut squared = normal.clone();
        let mut right = DVector::<f64>::zeros(count);
        for sample in samples {
            let (terms, _) = self.terms(sample.offset, degree);
            for i in 0..count {
                right[i] += sample.weight * terms[i] * sample.value;
                for j in 0..=i {
                    normal[(i, j)] += sample.weight * terms[i] * terms[j];
                    squared[(i, j)] += sample.weight * sample.weight * terms[i] * terms[j];
                }
            }
        }
        normal.fill_upper_triangle_with_lower_triangle();
        squared.fill_upper_triangle_with_lower_triangle();
        if normal[(0, 0)] <= 0.0 {
            return None;
        }
        if count > 1 {
            let mean = (1..count).map(|i| normal[(i, i)]).sum::<f64>() / (count - 1) as f64;
            for i in 1..count {
                normal[(i, i)] += self.ridge * mean;
            }
        }
        let cholesky = normal.cholesky()?;
        let solution = cholesky.solve(&right);
        let residual = |sample: &Sample| {
            let (terms, _) = self.terms(sample.offset, degree);
            sample.value - (0..count).map(|i| terms[i] * solution[i]).sum::<f64>()
        };
        let (mut weight, mut square) = (0.0, 0.0);
        for sample in samples {
            weight += sample.weight;
            square += sample.weight * residual(sample) * residual(sample);
        }
        let effective = Self::effective(samples);
        let variance = square / weight * effective / (effective - count as f64).max(1.0);
        let inverse = cholesky.inverse();
        let covariance = &inverse * squared * &inverse;
        let axes = match (degree, self.axes) {
            (Degree::Constant, _) => 0,
            (_, Axes::Plane) => 2,
            (_, Axes::Space) => 3,
        };
        let slope = |axis: usize| if axis < axes { solution[axis + 1] / self.scale_m } else { 0.0 };
        let spread = (0..axes).map(|axis| covariance[(axis + 1, axis + 1)]).sum::<f64>() / axes.max(1) as f64;
        Some(LocalFit {
            degree,
            value: solution[0],
            gradient: Position::new(slope(0), slope(1), slope(2)),
            gradient_sigma: (variance * spread).max(0.0).sqrt() / self.scale_m,
        })
    }
}
