//! Whether ranges are rather in another unit than metres: by how fast they change along the way.

use sextant_kernel::{Interrupted, Watch};

use super::Settings;
use super::explained::Explained;
use super::fit::{Fitted, fitted};
use super::groups::RangeGroups;
use super::problem::{HeightPrior, Problem};
use super::report::RangeUnit;
use super::solution::{ErrorShares, NODE_BIAS_M, by_least_squares};

/// Metres, and what ranges may be in instead. Feet and nanoseconds of light differ by less than scales do.
pub(crate) const UNITS: [RangeUnit; 7] = [
    RangeUnit { name: "metres", of_metre: 1.0 },
    RangeUnit { name: "the way there and back (halve them)", of_metre: 2.0 },
    RangeUnit { name: "kilometres (multiply them by 1000)", of_metre: 0.001 },
    RangeUnit { name: "feet (range_ft) or nanoseconds of light one way (range_ns)", of_metre: 3.308 },
    RangeUnit {
        name: "nanoseconds of light there and back (halve them, and name the column range_ns)",
        of_metre: 6.671,
    },
    RangeUnit { name: "centimetres (range_cm)", of_metre: 100.0 },
    RangeUnit { name: "millimetres (range_mm)", of_metre: 1000.0 },
];
/// Another unit is told if it is more probable than metres by so much (nats).
const CLEAR: f64 = 10.0;

/// The unit in which the ranges fit places clearly better than in metres.
pub(super) fn other_unit(
    settings: &Settings,
    groups: &RangeGroups,
    heights: HeightPrior,
    watch: &dyn Watch,
) -> Result<Option<RangeUnit>, Interrupted> {
    // A unit that needs a scale far beyond that of devices is none, and one in which a constant explains the ranges as well, or nodes
    // are so far from the way that they nearly are.
    const LARGEST_SCALE: f64 = 0.15;
    const FARTHEST: f64 = 50.0;
    let is_told = |problem: &Problem<'_>, fitted: &Fitted| {
        let is_near = problem.groups.usual_m() < FARTHEST * problem.groups.way_m();
        is_near && fitted.point.scale().abs() < LARGEST_SCALE && Explained::of(problem, &fitted.point).is_any()
    };
    let mut found = [f64::NEG_INFINITY; UNITS.len()];
    for (log_evidence, unit) in found.iter_mut().zip(UNITS) {
        let groups = groups.times(1.0 / unit.of_metre);
        let prior = settings.prior(ErrorShares::ALL);
        let problem = Problem { groups: &groups, prior, heights, node_bias_m: NODE_BIAS_M, worth: 1.0 };
        if let Some(fitted) = fitted(&problem, by_least_squares(&problem, prior.mean), watch)?
            && (unit.of_metre.total_cmp(&1.0).is_eq() || is_told(&problem, &fitted))
        {
            *log_evidence = fitted.log_evidence - groups.len() as f64 * libm::log(unit.of_metre);
        }
    }
    let best = (0..UNITS.len()).max_by(|&a, &b| found[a].total_cmp(&found[b]));
    Ok(best.filter(|&at| found[at] > found[0] + CLEAR).map(|at| UNITS[at]))
}
