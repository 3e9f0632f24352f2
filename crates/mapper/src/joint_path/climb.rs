//! Levenberg and Marquardt's method on a chain.

use sextant_kernel::{Interrupted, Watch};

use super::chain::{ChainStep, ChainSystem, Factor};

/// A log-posterior of a chain of states and a border.
pub(super) trait Hill {
    type Point: Clone;

    fn value(&self, at: &Self::Point) -> f64;

    fn system(&self, at: &Self::Point) -> ChainSystem;

    fn moved(&self, at: &Self::Point, step: &ChainStep) -> Self::Point;
}

/// The top of a hill.
pub(super) struct Top<P> {
    pub(super) point: P,
    pub(super) value: f64,
    /// The curvature there; `None` if it is not positive.
    pub(super) curvature: Option<Factor>,
    /// Whether the climb ended by itself.
    pub(super) settled: bool,
}

impl<P> Top<P> {
    /// The logarithm of the marginal likelihood (Laplace), but for what does not depend on the laws.
    pub(super) fn log_evidence(&self) -> f64 {
        self.curvature.as_ref().map_or(f64::NEG_INFINITY, |curvature| self.value - 0.5 * curvature.log_determinant)
    }
}

/// The top near `start`.
pub(super) fn climb<H: Hill>(
    hill: &H,
    start: H::Point,
    steps: u32,
    least_gain: f64,
    watch: &dyn Watch,
) -> Result<Top<H::Point>, Interrupted> {
    let (mut point, mut damping, mut settled) = (start, 1e-4, false);
    let mut value = hill.value(&point);
    let mut system = hill.system(&point);
    for _ in 0..steps {
        watch.check()?;
        let next = system.factor(damping).map(|factor| hill.moved(&point, &system.step(&factor)));
        let reached = next.as_ref().map_or(f64::NEG_INFINITY, |next| hill.value(next));
        match next {
            Some(next) if reached > value => {
                let gain = reached - value;
                (point, value) = (next, reached);
                system = hill.system(&point);
                damping = (damping * 0.2).max(1e-9);
                if gain < least_gain {
                    settled = true;
                    break;
                }
            }
            _ => {
                damping *= 6.0;
                if damping > 1e7 {
                    settled = true;
                    break;
                }
            }
        }
    }
    Ok(Top { point, value, curvature: system.factor(0.0), settled })
}
