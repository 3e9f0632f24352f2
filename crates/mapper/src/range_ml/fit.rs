//! The most probable places and law, and what else is nearly as probable.

use super::problem::{BIAS, Eliminated, Point, Problem, ROUNDING};
use sextant_kernel::{Interrupted, Watch};

/// Most steps of a fit.
const STEPS: u32 = 600;
/// A fit has settled if a step gains less than that.
const LEAST_GAIN: f64 = 1e-4;

/// A point at which the posterior is greatest.
pub(super) struct Fitted {
    pub(super) point: Point,
    /// Logarithm of the marginal likelihood by Laplace's method, up to what all fits have in common.
    pub(super) log_evidence: f64,
    pub(super) curvature: Eliminated,
    /// Whether the fit ended by itself.
    pub(super) settled: bool,
}

impl Fitted {
    /// The standard deviation of the bias of all ranges (m).
    pub(super) fn bias_deviation_m(&self) -> f64 {
        self.curvature.deviations()[BIAS]
    }
}

/// The point near `start` at which the posterior is greatest (Levenberg and Marquardt's method); `None` if the curvature is not
/// positive.
pub(super) fn fitted(problem: &Problem<'_>, start: Point, watch: &dyn Watch) -> Result<Option<Fitted>, Interrupted> {
    let (mut point, mut damping, mut settled) = (start, 1e-3, false);
    let mut value = problem.value(&point);
    let mut slopes = problem.slopes(&point);
    for _ in 0..STEPS {
        watch.check()?;
        let Some(eliminated) = slopes.eliminated(damping) else {
            damping *= 5.0;
            if damping > 1e9 {
                break;
            }
            continue;
        };
        let next = slopes.moved(&point, &eliminated);
        let reached = problem.value(&next);
        let gain = reached - value;
        if gain > 0.0 {
            (point, value) = (next, reached);
            damping = (damping * 0.2).max(1e-9);
            slopes = problem.slopes(&point);
            if gain < LEAST_GAIN {
                settled = true;
                break;
            }
        } else {
            damping *= 5.0;
            if damping > 1e8 {
                // No step leads up: this is the top.
                settled = true;
                break;
            }
        }
    }
    // Of a place that is far off, the curvature may be singular but for rounding.
    let Some(curvature) = slopes.eliminated(0.0).or_else(|| slopes.eliminated(ROUNDING)) else { return Ok(None) };
    let log_prior = -(point.nodes.len() as f64) * libm::log(problem.node_bias_m);
    let log_evidence = value - problem.of_places(&point.shared) + log_prior - 0.5 * curvature.log_determinant();
    Ok(Some(Fitted { point, log_evidence, curvature, settled }))
}
