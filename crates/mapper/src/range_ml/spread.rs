//! How far the errors of a log are from being independent: along the way, and by direction.

use std::f64::consts::{FRAC_PI_4, PI};

use super::groups::median;
use super::problem::{Point, Problem, Residual};

/// Longest lag of the autocorrelation (groups).
const LAGS: usize = 40;
/// A correlation below this one is none.
const LEAST_CORRELATION: f64 = 0.05;
/// Directions from a node, and the least number of groups of one that has a mean.
const DIRECTIONS: usize = 8;
const LEAST_GROUPS: usize = 3;
/// Errors beyond this many standard deviations are cut: one wild value says nothing of the others.
const CUT: f64 = 3.0;

/// The errors of the groups of a node from their median (m), with the direction from the robot to the node (rad).
fn errors(problem: &Problem<'_>, point: &Point, number: usize) -> Vec<(f64, f64)> {
    let groups = problem.groups.of_node(number);
    let residuals = groups.iter().map(|group| Residual::of(group, &point.nodes[number], &point.shared));
    let mut errors: Vec<(f64, f64)> =
        residuals.map(|residual| (residual.error_m, libm::atan2(residual.apart[1], residual.apart[0]))).collect();
    let middle = median(&mut errors.iter().map(|&(error_m, _)| error_m).collect::<Vec<_>>());
    let spread = 1.4826 * median(&mut errors.iter().map(|&(error_m, _)| (error_m - middle).abs()).collect::<Vec<_>>());
    let most = CUT * spread + 1e-9;
    errors.iter_mut().for_each(|(error_m, _)| *error_m = (*error_m - middle).clamp(-most, most));
    errors
}

/// How many groups have the information of one independent one: the autocorrelation time of the errors, at least 1.
pub(super) fn autocorrelation_time(problem: &Problem<'_>, point: &Point) -> f64 {
    let mut sums = [0.0; LAGS];
    for number in 0..point.nodes.len() {
        let errors = errors(problem, point, number);
        for (lag, sum) in sums.iter_mut().enumerate().take((errors.len() / 2).max(1)) {
            *sum += errors.iter().zip(&errors[lag..]).map(|(one, other)| one.0 * other.0).sum::<f64>();
        }
    }
    let of_lags = sums[1..].iter().map(|sum| sum / sums[0].max(f64::MIN_POSITIVE));
    1.0 + of_lags.take_while(|&correlation| correlation >= LEAST_CORRELATION).map(|c| 2.0 * c).sum::<f64>()
}

/// Variance of the mean error over directions from a node (m²). What is behind a node in some direction lengthens all ranges from
/// there, and a place that is moved explains such an error as well, so that each place is unsure by as much.
pub(super) fn variance_over_directions(problem: &Problem<'_>, point: &Point) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0_f64);
    for number in 0..point.nodes.len() {
        let mut means = [(0.0, 0_usize); DIRECTIONS];
        for (error_m, direction) in errors(problem, point, number) {
            let eighth = crate::numerics::whole((direction + PI) / FRAC_PI_4) % DIRECTIONS;
            means[eighth].0 += error_m;
            means[eighth].1 += 1;
        }
        for (total, groups) in means.into_iter().filter(|&(_, groups)| groups >= LEAST_GROUPS) {
            sum += (total / groups as f64).powi(2);
            count += 1.0;
        }
    }
    sum / count.max(1.0)
}
