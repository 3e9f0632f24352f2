use nalgebra::{DMatrix, DVector, Vector4};
use sextant_kernel::{Purpose, Seed};

use super::ChainSystem;

/// A chain with `states` states and a border in which the first entries are touched by a few states each, all states touch the two
/// after them, and none the last; with the whole matrix and the whole slope.
fn drawn(states: usize, local: usize) -> (ChainSystem, DMatrix<f64>, DVector<f64>) {
    let border = local + 3;
    let draw = |a: usize, b: usize| Seed(3).normal(Purpose::new(8), [a as u64, b as u64, 0]);
    let mut system = ChainSystem::zeros(states, border);
    let size = 4 * states + border;
    let (mut whole, mut slope) = (DMatrix::zeros(size, size), DVector::zeros(size));
    for residual in 0..16 * states {
        let at = residual % states;
        let vector = |shift: usize| Vector4::from_fn(|row, _| draw(residual, shift + row));
        let next = (at + 1 < states).then(|| vector(10));
        let near = (at * local / states + residual % 2) % local;
        let by_border = [
            (near, draw(residual, 20)),
            (local + residual % 2, draw(residual, 21)),
            ((near + 1) % local, draw(residual, 22)),
        ];
        let by_border = &by_border[..if local == 1 { 2 } else { 3 }];
        let (weight, by) = (1.0 + draw(residual, 30).abs(), draw(residual, 31));
        system.add(at, vector(0), next, by_border, weight, by);
        let mut row = DVector::zeros(size);
        row.rows_mut(4 * at, 4).copy_from(&vector(0));
        if let Some(next) = next {
            row.rows_mut(4 * at + 4, 4).copy_from(&next);
        }
        for &(entry, value) in by_border {
            row[4 * states + entry] += value;
        }
        whole += &row * row.transpose() * weight;
        slope += row * by;
    }
    system.add_to_border(border - 1, border - 1, 2.0);
    whole[(size - 1, size - 1)] += 2.0;
    system.border_slope[border - 1] = 3.0;
    slope[size - 1] = 3.0;
    (system, whole, slope)
}

#[test]
fn step_and_covariances_are_those_of_the_whole_matrix() {
    for (states, local) in [(1, 1), (2, 1), (5, 2), (23, 7), (64, 20), (300, 9)] {
        let (system, whole, slope) = drawn(states, local);
        let inverse = whole.clone().try_inverse().unwrap();
        let expected = &inverse * slope;
        let factor = system.factor(0.0).unwrap();
        let step = system.step(&factor);
        for (at, state) in step.states.iter().enumerate() {
            assert!((state - expected.rows(4 * at, 4)).norm() < 1e-7);
        }
        assert!((&step.border - expected.rows(4 * states, local + 3)).norm() < 1e-7, "{states} {local}");
        let log_determinant = 2.0 * whole.cholesky().unwrap().l().diagonal().map(libm::log).sum();
        assert!((factor.log_determinant - log_determinant).abs() < 1e-7);
        for (at, state) in factor.covariances().iter().enumerate() {
            assert!((state - inverse.view((4 * at, 4 * at), (4, 4))).norm() < 1e-7, "{at} of {states}");
        }
        for (one, other) in [(0, 0), (0, local), (local, local + 1), (local + 2, local + 2)] {
            let found = factor.covariance_of_border(one, other);
            assert!((found - inverse[(4 * states + one, 4 * states + other)]).abs() < 1e-7);
        }
    }
}

#[test]
fn damping_enlarges_the_diagonal() {
    let (system, mut whole, slope) = drawn(23, 7);
    for at in 0..whole.nrows() {
        whole[(at, at)] *= 1.5;
    }
    let expected = whole.cholesky().unwrap().solve(&slope);
    let step = system.step(&system.factor(0.5).unwrap());
    assert!((step.border - expected.rows(4 * 23, 10)).norm() < 1e-7);
}

#[test]
fn a_curvature_that_is_not_positive_has_no_factor() {
    let (mut system, ..) = drawn(23, 7);
    system.states[11][(2, 2)] -= 1e6;
    assert!(system.factor(0.0).is_none());
}
