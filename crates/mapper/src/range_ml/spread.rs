//! How far the errors of a log are from being independent: along the way, and by direction.

use std::f64::consts::{FRAC_PI_4, PI};

use super::error_law::{self, centred};
use super::problem::{Point, Problem, Residual};

/// Directions from a node, and the least number of groups of one that has a mean.
const DIRECTIONS: usize = 8;
const LEAST_GROUPS: usize = 3;

/// The errors of the groups of a node from their median (m), and the direction from the robot to the node of each (rad).
fn errors(problem: &Problem<'_>, point: &Point, number: usize) -> (Vec<f64>, Vec<f64>) {
    let groups = problem.groups.of_node(number);
    let residuals = groups.iter().map(|group| Residual::of(group, &point.nodes[number], &point.shared));
    let with_direction =
        residuals.map(|residual| (residual.error_m, libm::atan2(residual.apart[1], residual.apart[0])));
    let (mut errors, directions): (Vec<f64>, Vec<f64>) = with_direction.unzip();
    centred(&mut errors);
    (errors, directions)
}

/// How many groups have the information of one independent one: the autocorrelation time of the errors, at least 1.
pub(super) fn autocorrelation_time(problem: &Problem<'_>, point: &Point) -> f64 {
    let series: Vec<Vec<f64>> = (0..point.nodes.len()).map(|number| errors(problem, point, number).0).collect();
    error_law::autocorrelation_time(series.iter().map(Vec::as_slice))
}

/// Variance of the mean error over directions from a node (m²). What is behind a node in some direction lengthens all ranges from
/// there, and a place that is moved explains such an error as well, so that each place is unsure by as much.
pub(super) fn variance_over_directions(problem: &Problem<'_>, point: &Point) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0_f64);
    for number in 0..point.nodes.len() {
        let mut means = [(0.0, 0_usize); DIRECTIONS];
        let (errors, directions) = errors(problem, point, number);
        for (error_m, direction) in errors.into_iter().zip(directions) {
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
