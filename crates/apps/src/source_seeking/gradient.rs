//! The gradient of a plane through readings, and how a robot follows it (after Rosero and Werner 2014, "Cooperative source
//! seeking via gradient estimation and formation control", UKACC Control; a single robot among static sensors).

use std::f64::consts::{PI, TAU};

use sextant_channel::Position;

use super::local_fit::{Axes, Degree, Fitting, LocalFit, Sample};

/// What keeps the fit solvable, as a share of the mean spread of the places.
const RIDGE: f64 = 1e-6;
/// Nodes whose spread across their line is a smaller share of that along it do not determine a plane.
const LEAST_SPREAD: f64 = 1e-3;

/// The plane of least squares, with an intercept: the value at the robot itself is not known. Its value is that at the
/// centre of the places. `None` unless there are three nodes that are not in a line.
///
/// If readings have independent errors of variance σ², its covariance is σ² (Σ (q - q̄)(q - q̄)ᵀ)⁻¹ with the places q.
pub(super) fn plane(samples: &[Sample]) -> Option<LocalFit> {
    if samples.len() < 3 {
        return None;
    }
    let count = samples.len() as f64;
    let center = samples.iter().fold(Position::ORIGIN, |sum, sample| sum + sample.offset) * (1.0 / count);
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for sample in samples {
        let Position { x_m: x, y_m: y, .. } = sample.offset - center;
        xx += x * x;
        xy += x * y;
        yy += y * y;
    }
    let (middle, half) = (0.5 * (xx + yy), 0.5 * libm::hypot(xx - yy, 2.0 * xy));
    if middle <= 0.0 || middle - half < LEAST_SPREAD * LEAST_SPREAD * (middle + half) {
        return None;
    }
    let scale_m = (middle / count).sqrt();
    // About the centre, so that the ridge is that of the places and not of the robot's distance from them.
    let centered: Vec<Sample> =
        samples.iter().map(|sample| Sample { offset: sample.offset - center, weight: 1.0, ..*sample }).collect();
    let fitting = Fitting { axes: Axes::Plane, degree: Degree::Linear, scale_m, ridge: RIDGE };
    fitting.exactly(&centered, Degree::Linear)
}

/// The turn rate (rad/s) of a robot that looks into `heading_rad` and should look into `course_rad`: `gain_per_s` times the
/// angle between them, at most `turn_rate_max` (rad/s).
pub(super) fn turn_rate(heading_rad: f64, course_rad: f64, gain_per_s: f64, turn_rate_max: f64) -> f64 {
    (gain_per_s * wrapped(course_rad - heading_rad)).clamp(-turn_rate_max, turn_rate_max)
}

/// The same angle in (-π, π].
pub(super) fn wrapped(angle_rad: f64) -> f64 {
    let turn = angle_rad.rem_euclid(TAU);
    if turn > PI { turn - TAU } else { turn }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use sextant_kernel::{Purpose, Seed};

    use super::*;

    const PLACES: [[f64; 2]; 6] = [[0.0, 0.0], [3.0, 1.0], [-2.0, 2.0], [1.0, -4.0], [5.0, 5.0], [-1.0, -1.5]];

    fn samples(field: impl Fn(usize, f64, f64) -> f64) -> Vec<Sample> {
        let sample = |(i, &[x, y]): (usize, &[f64; 2])| Sample {
            offset: Position::new(x, y, 0.7),
            value: field(i, x, y),
            weight: 1.0,
        };
        PLACES.iter().enumerate().map(sample).collect()
    }

    proptest! {
        #[test]
        fn the_gradient_of_a_plane_is_found(a in -5.0..5.0_f64, gx in -3.0..3.0_f64, gy in -3.0..3.0_f64) {
            let found = plane(&samples(|_, x, y| a + gx * x + gy * y)).unwrap().gradient;
            // The ridge holds it down by a millionth or so.
            prop_assert!(found.distance_m(Position::new(gx, gy, 0.0)) < 1e-5, "{found}");
        }

        #[test]
        fn angles_are_wrapped_to_the_nearest_turn(angle_rad in -50.0..50.0_f64) {
            let found = wrapped(angle_rad);
            prop_assert!(found.abs() <= PI && (angle_rad - found).rem_euclid(TAU).min(TAU - (angle_rad - found).rem_euclid(TAU)) < 1e-9);
        }
    }

    #[test]
    fn three_nodes_in_a_line_are_no_plane() {
        let all = samples(|_, x, _| x);
        assert_eq!(plane(&all[..2]), None);
        let line: Vec<Sample> = (0..5)
            .map(|i| Sample { offset: Position::new(f64::from(i), 2.0 * f64::from(i), 0.0), value: 1.0, weight: 1.0 })
            .collect();
        assert_eq!(plane(&line), None);
    }

    #[test]
    fn its_errors_have_the_covariance_of_least_squares() {
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        let count = PLACES.len() as f64;
        let [mx, my] = [0, 1].map(|axis| PLACES.iter().map(|place| place[axis]).sum::<f64>() / count);
        for [x, y] in PLACES {
            xx += (x - mx) * (x - mx);
            xy += (x - mx) * (y - my);
            yy += (y - my) * (y - my);
        }
        let determinant = xx * yy - xy * xy;
        let (sigma, runs) = (0.3, 20_000_u32);
        let expected = [yy, xx, -xy].map(|entry| sigma * sigma * entry / determinant);
        let mut found = [0.0; 3];
        for run in 0..runs {
            let noise = |i: usize| sigma * Seed(5).normal(Purpose::new(1001), [run.into(), i as u64, 0]);
            let Position { x_m: x, y_m: y, .. } = plane(&samples(|i, _, _| noise(i))).unwrap().gradient;
            found = [found[0] + x * x, found[1] + y * y, found[2] + x * y];
        }
        for (found, expected) in found.into_iter().zip(expected) {
            // The relative standard error of a variance is sqrt(2 / runs) = 1 %.
            let (found, scale) = (found / f64::from(runs), (expected.abs()).max(1e-4));
            assert!((found - expected).abs() < 0.05 * scale, "{found}, not {expected}");
        }
    }

    #[test]
    fn the_turn_rate_is_proportional_and_limited() {
        assert!((turn_rate(0.1, 0.3, 2.0, 1.0) - 0.4).abs() < 1e-12);
        assert!((turn_rate(3.0, -3.0, 2.0, 1.0) - 2.0 * (TAU - 6.0)).abs() < 1e-12);
        assert!((turn_rate(0.0, -2.0, 2.0, 1.0) + 1.0).abs() < 1e-12);
    }
}
