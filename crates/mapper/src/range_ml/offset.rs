//! Whether all ranges are longer by far than devices have it, as by a delay of antennas that nobody took off.

use sextant_kernel::{Interrupted, Watch};

use super::Settings;
use super::explained::Explained;
use super::fit::fitted;
use super::groups::RangeGroups;
use super::problem::{HeightPrior, Problem};
use super::solution::{ErrorShares, NODE_BIAS_M, by_least_squares};
use super::spread::autocorrelation_time;

/// An offset is less than the shortest ranges: it is sought where these are at least so long (m), at these shares of them.
const LEAST_RANGE_M: f64 = 6.0;
const SHARES: [f64; 8] = [0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 0.995];
/// One range in so many may be shorter.
const ONE_IN: usize = 20;
/// Fits from where the last one has the bias.
const ROUNDS: u32 = 4;
/// An offset is told if it is more probable than none by so much (nats).
const CLEAR: f64 = 8.0;

/// By how much all ranges are longer (m), if that is clearly more probable than a bias that devices have.
pub(super) fn offset_m(
    settings: &Settings,
    groups: &RangeGroups,
    heights: HeightPrior,
    watch: &dyn Watch,
) -> Result<Option<f64>, Interrupted> {
    let shortest_m = groups.short_m(ONE_IN);
    if shortest_m < LEAST_RANGE_M {
        return Ok(None);
    }
    let usual_m = settings.prior(ErrorShares::ALL).deviation[0];
    let Some(usual) = Tried::of(settings, groups, heights, watch)? else { return Ok(None) };
    let mut best: Option<(f64, Tried)> = None;
    for share in SHARES {
        let mut offset_m = share * shortest_m;
        for _ in 0..ROUNDS {
            let shorter = groups.longer_by(-offset_m);
            let Some(tried) = Tried::of(settings, &shorter, heights, watch)? else { break };
            let more_m = tried.bias_m;
            if tried.is_explained && best.as_ref().is_none_or(|(_, best)| tried.log_evidence > best.log_evidence) {
                best = Some((offset_m, tried));
            }
            if more_m.abs() < 0.1 * usual_m {
                break;
            }
            offset_m += more_m;
        }
    }
    let is_clear = |(offset_m, tried): &(f64, Tried)| {
        *offset_m > usual_m && tried.worth * (tried.log_evidence - usual.log_evidence) > CLEAR
    };
    Ok(best.filter(is_clear).map(|(offset_m, _)| offset_m))
}

/// A fit from plain least squares.
struct Tried {
    log_evidence: f64,
    bias_m: f64,
    /// How many independent ranges one is worth.
    worth: f64,
    /// Whether places explain the ranges better than a constant.
    is_explained: bool,
}

impl Tried {
    fn of(
        settings: &Settings,
        groups: &RangeGroups,
        heights: HeightPrior,
        watch: &dyn Watch,
    ) -> Result<Option<Self>, Interrupted> {
        let prior = settings.prior(ErrorShares::ALL);
        let problem = Problem { groups, prior, heights, node_bias_m: NODE_BIAS_M, worth: 1.0 };
        let found = fitted(&problem, by_least_squares(&problem, prior.mean), watch)?;
        Ok(found.map(|fitted| Self {
            log_evidence: fitted.log_evidence,
            bias_m: fitted.point.bias_m(),
            worth: 1.0 / autocorrelation_time(&problem, &fitted.point),
            is_explained: Explained::of(&problem, &fitted.point).is_any(),
        }))
    }
}
