//! Similarities that align one list of places to another.

use nalgebra::{DMatrix, Matrix3, SVD, Vector3};
use sextant_channel::Position;

/// Whether an alignment may mirror.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reflection {
    /// Allowed: for maps without anchors, which are known only up to a mirror image.
    Allowed,
    /// Forbidden: for maps in the frame of a physical robot.
    Forbidden,
}

/// Reasons why two lists of places cannot be aligned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AlignmentError {
    /// Too few pairs for an alignment to mean anything.
    #[error("{found} pairs of places; an alignment needs at least {needed}")]
    TooFew {
        /// Pairs found.
        found: usize,
        /// Pairs needed.
        needed: usize,
    },
    /// One of the lists is a single place, so that it has no scale.
    #[error("all {0} places coincide; an alignment needs places that differ")]
    Coincide(&'static str),
    /// A place is not finite.
    #[error("a place is not finite")]
    NotFinite,
}

/// A similarity `x ↦ scale · rotation x + translation`.
#[derive(Clone, Debug, PartialEq)]
pub struct Similarity {
    /// Scale, above zero.
    pub scale: f64,
    /// Orthogonal matrix by rows; its determinant is −1 for a mirror image.
    pub rotation: [[f64; 3]; 3],
    /// Translation (m).
    pub translation: Position,
}

impl Similarity {
    /// The similarity that brings the places `from` onto `onto` with the least sum of squared distances
    /// (orthogonal Procrustes; Umeyama 1991). Lists that both lie in one plane z = constant are aligned
    /// within the plane, so that a mirror image there counts as a reflection.
    ///
    /// # Errors
    /// If there are fewer than three pairs, or either list is a single place.
    pub fn fit(pairs: &[(Position, Position)], reflection: Reflection) -> Result<Self, AlignmentError> {
        if pairs.len() < 3 {
            return Err(AlignmentError::TooFew { found: pairs.len(), needed: 3 });
        }
        if pairs.iter().any(|(from, onto)| !(from.is_finite() && onto.is_finite())) {
            return Err(AlignmentError::NotFinite);
        }
        let share = 1.0 / pairs.len() as f64;
        let mut mean_from = Vector3::zeros();
        let mut mean_onto = Vector3::zeros();
        for &(from, onto) in pairs {
            mean_from += vector(from) * share;
            mean_onto += vector(onto) * share;
        }
        let mut covariance = Matrix3::zeros();
        let (mut spread_from, mut spread_onto) = (Vector3::zeros(), Vector3::zeros());
        for &(from, onto) in pairs {
            let (from, onto) = (vector(from) - mean_from, vector(onto) - mean_onto);
            covariance += onto * from.transpose();
            spread_from += from.component_mul(&from);
            spread_onto += onto.component_mul(&onto);
        }
        for (spread, mean, which) in [(&spread_from, &mean_from, "mapped"), (&spread_onto, &mean_onto, "reference")] {
            let rounding = 1e-12 * (1.0 + mean.norm());
            if (spread.sum() * share).sqrt() <= rounding {
                return Err(AlignmentError::Coincide(which));
            }
        }
        let flat = |spread: &Vector3<f64>| spread.z <= 1e-24 * spread.sum();
        let planar = flat(&spread_from) && flat(&spread_onto);
        let dimensions = if planar { 2 } else { 3 };
        let block = DMatrix::from_fn(dimensions, dimensions, |row, column| covariance[(row, column)]);
        let svd = SVD::new(block, true, true);
        let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
            return Err(AlignmentError::NotFinite);
        };
        // Singular values come in descending order: a forbidden reflection is undone along the last.
        let mut signs = nalgebra::DVector::from_element(dimensions, 1.0);
        if reflection == Reflection::Forbidden && (&u * &v_t).determinant() < 0.0 {
            signs[dimensions - 1] = -1.0;
        }
        let turned = &u * DMatrix::from_diagonal(&signs) * &v_t;
        let rotation = Matrix3::from_fn(|row, column| match (row < dimensions, column < dimensions) {
            (true, true) => turned[(row, column)],
            _ => f64::from(u8::from(row == column)),
        });
        let scale = svd.singular_values.dot(&signs) / spread_from.sum();
        if !(scale > 0.0 && scale.is_finite()) {
            return Err(AlignmentError::Coincide("mapped"));
        }
        let translation = mean_onto - rotation * mean_from * scale;
        Ok(Self {
            scale,
            rotation: [0, 1, 2].map(|row| [0, 1, 2].map(|column| rotation[(row, column)])),
            translation: Position::new(translation.x, translation.y, translation.z),
        })
    }

    /// The image of `place`.
    #[must_use]
    pub fn apply(&self, place: Position) -> Position {
        let turned = self.rotation.map(|[x, y, z]| Position::new(x, y, z).dot(place));
        Position::from(turned) * self.scale + self.translation
    }

    /// The inverse similarity.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let rotation = [0, 1, 2].map(|row| [0, 1, 2].map(|column| self.rotation[column][row]));
        let linear = Self { scale: 1.0 / self.scale, rotation, translation: Position::ORIGIN };
        Self { translation: linear.apply(self.translation) * -1.0, ..linear }
    }
}

fn vector(place: Position) -> Vector3<f64> {
    Vector3::new(place.x_m, place.y_m, place.z_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_kernel::{Purpose, Seed};

    fn places(seed: u64, count: u64, height_m: f64) -> Vec<Position> {
        let draw = |i, axis| 30.0 * Seed(seed).uniform(Purpose::new(8), [i, axis, 0]);
        (0..count).map(|i| Position::new(draw(i, 0), draw(i, 1), height_m * draw(i, 2))).collect()
    }

    /// Rotation about x, then z, mirrored in x if `mirror` is −1.
    fn turn(place: Position, about_x: f64, about_z: f64, mirror: f64) -> Position {
        let (x, y, z) = (mirror * place.x_m, place.y_m, place.z_m);
        let (y, z) = (y * about_x.cos() - z * about_x.sin(), y * about_x.sin() + z * about_x.cos());
        Position::new(x * about_z.cos() - y * about_z.sin(), x * about_z.sin() + y * about_z.cos(), z)
    }

    #[test]
    fn any_similarity_and_reflection_is_recovered() {
        for seed in 0..50 {
            let draw = |what| Seed(seed).uniform(Purpose::new(8), [9, 9, what]);
            for (height_m, about_x) in [(0.0, 0.0), (0.4, 6.0 * draw(0))] {
                let (about_z, scale) = (6.0 * draw(1), 0.1 + 5.0 * draw(2));
                for mirror in [1.0, -1.0] {
                    let shift = Position::new(5.0, -80.0 * draw(3), if height_m > 0.0 { 3.0 } else { 0.0 });
                    let from = places(seed, 12, height_m);
                    let pairs: Vec<_> =
                        from.iter().map(|&p| (p, turn(p, about_x, about_z, mirror) * scale + shift)).collect();
                    let fit = Similarity::fit(&pairs, Reflection::Allowed).unwrap();
                    assert!((fit.scale / scale - 1.0).abs() < 1e-12);
                    for &(from, onto) in &pairs {
                        assert!(fit.apply(from).distance_m(onto) < 1e-12 * 200.0, "seed {seed}");
                        assert!(fit.inverse().apply(onto).distance_m(from) < 1e-12 * 2000.0, "seed {seed}");
                    }
                    let physical = Similarity::fit(&pairs, Reflection::Forbidden).unwrap();
                    let determinant = Matrix3::from_fn(|row, column| physical.rotation[row][column]).determinant();
                    assert!((determinant - 1.0).abs() < 1e-12);
                    let worst = pairs.iter().map(|&(from, onto)| physical.apply(from).distance_m(onto));
                    let worst = worst.fold(0.0, f64::max);
                    assert!(if mirror < 0.0 { worst > 0.1 * scale } else { worst < 1e-12 * 200.0 }, "{worst}");
                }
            }
        }
    }

    #[test]
    fn places_that_have_nothing_to_do_with_each_other_have_no_similarity() {
        let on_x = [-1.0, 1.0, 0.0].map(|x_m| Position::new(x_m, 0.0, 0.0));
        let on_y = [1.0, 1.0, -2.0].map(|y_m| Position::new(0.0, y_m, 0.0));
        let pairs: Vec<_> = on_x.into_iter().zip(on_y).collect();
        assert_eq!(Similarity::fit(&pairs, Reflection::Allowed), Err(AlignmentError::Coincide("mapped")));
    }

    #[test]
    fn noise_is_fitted_better_than_by_any_similarity_nearby() {
        let noisy = |i: u64, p: Position| {
            let draw = |axis| Seed(4).normal(Purpose::new(8), [i, axis, 7]);
            turn(p, 0.4, 1.1, 1.0) * 2.0 + Position::new(draw(0), draw(1), draw(2))
        };
        let pairs: Vec<_> = (0..).zip(places(8, 20, 1.0)).map(|(i, p)| (p, noisy(i, p))).collect();
        let cost = |fit: &Similarity| -> f64 {
            pairs.iter().map(|&(from, onto)| fit.apply(from).distance_m(onto).powi(2)).sum()
        };
        let best = Similarity::fit(&pairs, Reflection::Forbidden).unwrap();
        for step in [-1e-3, 1e-3] {
            let scaled = Similarity { scale: best.scale + step, ..best.clone() };
            let shifted =
                Similarity { translation: best.translation + Position::new(0.0, step, 0.0), ..best.clone() };
            let (sine, cosine) = (step.sin(), step.cos());
            let [a, b, c] = best.rotation;
            let mix = |p: f64, q: f64| cosine * p - sine * q;
            let turned = [[0, 1, 2].map(|i| mix(a[i], b[i])), [0, 1, 2].map(|i| mix(b[i], -a[i])), c];
            let turned = Similarity { rotation: turned, ..best.clone() };
            for other in [scaled, shifted, turned] {
                assert!(cost(&other) > cost(&best));
            }
        }
    }

    #[test]
    fn degenerate_lists_are_rejected() {
        let same = [(Position::ORIGIN, Position::new(1.0, 2.0, 0.0)); 5];
        assert!(matches!(Similarity::fit(&same, Reflection::Allowed), Err(AlignmentError::Coincide(_))));
        let collapsed: Vec<_> = places(1, 5, 0.0).into_iter().map(|p| (Position::ORIGIN, p)).collect();
        assert_eq!(Similarity::fit(&collapsed, Reflection::Allowed), Err(AlignmentError::Coincide("mapped")));
        assert_eq!(
            Similarity::fit(&same[..2], Reflection::Allowed),
            Err(AlignmentError::TooFew { found: 2, needed: 3 })
        );
        let lost = [(Position::new(f64::NAN, 0.0, 0.0), Position::ORIGIN); 3];
        assert_eq!(Similarity::fit(&lost, Reflection::Allowed), Err(AlignmentError::NotFinite));
    }
}
