//! The exponent of the law of strengths, with the places integrated out.
//!
//! The largest posterior of track and law together has too steep a law and too small a track: a steeper law makes each place sharper,
//! and there are many places. The marginal likelihood takes that back.

use sextant_kernel::{Interrupted, Watch};

use super::problem::{LEAST_GAIN, STEPS, TrackPoint, TrackProblem};
use super::strengths::EXPONENT;
use crate::joint_path::climb::{Hill, Top, climb};

/// The search goes by this step of the logarithm of the exponent, at most so many times.
const STEP: f64 = 0.15;
const MOST_STEPS: u32 = 8;
/// An exponent that is tried is known to this standard deviation.
const TRIED: f64 = 1e-5;

/// The top at the exponent of the highest marginal likelihood near that of a top.
pub(super) fn most_likely(
    problem: &TrackProblem<'_>,
    top: Top<TrackPoint>,
    watch: &dyn Watch,
) -> Result<Top<TrackPoint>, Interrupted> {
    let entry = problem.border.exponent();
    let tried = |log_exponent: f64, from: &TrackPoint| {
        let exponent = libm::exp(log_exponent);
        let mut point = from.clone();
        point.border[entry] = exponent;
        let found =
            climb(&TrackProblem { exponent: [exponent, TRIED], ..problem.clone() }, point, STEPS, LEAST_GAIN, watch)?;
        let value = found.log_evidence() - 0.5 * ((exponent - EXPONENT[0]) / EXPONENT[1]).powi(2);
        Ok::<_, Interrupted>((value, found))
    };
    let mut middle = libm::log(top.point.border[entry].max(0.1));
    let mut at_middle = tried(middle, &top.point)?;
    let mut below = tried(middle - STEP, &at_middle.1.point)?;
    let mut above = tried(middle + STEP, &at_middle.1.point)?;
    for _ in 0..MOST_STEPS {
        if below.0 > at_middle.0 && below.0 >= above.0 {
            middle -= STEP;
            let next = tried(middle - STEP, &below.1.point)?;
            (above, at_middle, below) = (at_middle, below, next);
        } else if above.0 > at_middle.0 {
            middle += STEP;
            let next = tried(middle + STEP, &above.1.point)?;
            (below, at_middle, above) = (at_middle, above, next);
        } else {
            break;
        }
    }
    let bend = below.0 - 2.0 * at_middle.0 + above.0;
    let is_top = at_middle.0 >= below.0.max(above.0) && bend < 0.0;
    let best = middle + if is_top { 0.5 * STEP * (below.0 - above.0) / bend } else { 0.0 };
    let (_, found) = tried(best, &at_middle.1.point)?;
    // What is not known of the exponent is part of what is not known of the track.
    let curvature = problem.system(&found.point).factor(0.0);
    Ok(Top { curvature, settled: found.settled && is_top, ..found })
}
