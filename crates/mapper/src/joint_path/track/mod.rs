//! The way of a moving tag among receivers whose places are known.

mod check;
mod driven;
mod epochs;
mod exponent;
mod moments;
mod motion;
mod outcome;
mod problem;
mod reading;
mod regions;
mod report;
mod side;
mod start;
mod strengths;

use nalgebra::{DVector, Vector4};
use sextant_channel::{Position, RangeErrorLaw};
use sextant_kernel::Watch;

use super::PathError;
use super::climb::{Top, climb};
use super::odometry::{FACTORS, Odometry};
use crate::error::MapError;
use crate::numerics::median;
use crate::range_ml::error_law;
use check::Check;
use epochs::Epochs;
use motion::{FreeMotion, Motion};
use outcome::tracked;
use problem::{Border, Calibration, TrackPoint, TrackProblem, path_loss};
pub use reading::{OnRobot, TagReading, TagValue};
use regions::is_among;
pub use report::{
    DoubtedReceiver, RangeFault, Track, TrackFit, TrackMotion, TrackPose, TrackRangeLaw, TrackStrengthLaw,
};
use side::Line;
use strengths::{EXPONENT, StrengthErrors};

/// Most steps of a climb, and the gain that ends it.
const STEPS: u32 = 60;
const LEAST_GAIN: f64 = 1e-3;
/// The noise of ranges in turn (m), and the width of the law of strengths (dB).
const NOISES: [(f64, f64); 2] = [(3.0, 12.0), (1.0, 7.0)];
/// Power spectral densities of the acceleration that are tried (m²/s³): from a trolley to a runner.
const ACCELERATIONS: [f64; 4] = [0.01, 0.05, 0.25, 1.25];
/// What is known of the calibration where the tag is among the receivers, and where it is beside them: there a bias moves the whole
/// track, and nothing tells it.
const AMONG: Calibration = Calibration { bias_m: 3.0, scale: 0.05, receiver_bias_m: 0.2 };
const BESIDE: Calibration = Calibration { bias_m: 0.05, scale: 0.003, receiver_bias_m: 0.03 };
/// How well the first pose of odometry is known in the frame of the receivers (m, rad).
const FIRST: [f64; 2] = [300.0, 6.0];

/// What is known of a tag.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrackSettings {
    /// Its height (m). If absent, it is estimated where the receivers have different heights, and is theirs otherwise.
    pub height_m: Option<f64>,
    /// A place (m) on that side of a line of receivers on which it is.
    pub side: Option<[f64; 2]>,
    /// How wrong odometry is, where there is some.
    pub odometry: PathError,
}

/// The track of a tag from `readings` between it and `receivers` at known places (m), in the plane: ranges, or strengths, or both.
///
/// Without odometry, the tag moves with an acceleration that is white noise, whose strength the marginal likelihood chooses. With
/// odometry, the robot that carries it moves as that says, but for scale, drift and noise. Track, law of ranges, law of strengths and
/// height are one problem. The law of errors of ranges is that of [`RangeErrorLaw`], and strengths fall with the logarithm of the
/// distance, with errors of Student's law. Each is raised to one over its autocorrelation time.
///
/// # Errors
/// If there are fewer than three receivers, too few readings, a side is given of receivers that are not on a line, some readings have
/// odometry and others have not, or `watch` ends the work.
pub fn track(
    receivers: &[Position],
    readings: &[TagReading],
    settings: TrackSettings,
    watch: &dyn Watch,
) -> Result<Track, MapError> {
    let found = tracked_as_given(receivers, readings, settings, watch)?;
    let fault = Check { found: &found, receivers, readings, settings, watch }.fault()?;
    Ok(Track { fault, ..found })
}

/// The track, with ranges taken as metres.
fn tracked_as_given(
    receivers: &[Position],
    readings: &[TagReading],
    settings: TrackSettings,
    watch: &dyn Watch,
) -> Result<Track, MapError> {
    let heard: Vec<Position> = (0..receivers.len())
        .filter(|&receiver| readings.iter().any(|reading| reading.receiver == receiver))
        .map(|receiver| receivers[receiver])
        .collect();
    let line = Line::of(&heard, settings.side);
    if settings.side.is_some() && line.is_none() {
        return Err(MapError::Missing {
            algorithm: "track",
            what: "receivers on a straight line for a side of it",
            remedy: "the receivers that were heard are not on a line, so that they tell the side themselves",
        });
    }
    let is_driven = readings.iter().any(|reading| reading.on_robot.is_some());
    if is_driven && readings.iter().any(|reading| reading.on_robot.is_none()) {
        return Err(MapError::Missing {
            algorithm: "track",
            what: "odometry for all readings",
            remedy: "leave out the readings from outside of the path",
        });
    }
    let missing = MapError::Missing {
        algorithm: "track",
        what: "ranges to three receivers with known places within two seconds, or strengths",
        remedy: "`ranges.csv` has the ranges, `packets.csv` the strengths, each with its time, and option `known` the places",
    };
    let epochs = Epochs::of(readings);
    let height_m = height_m(receivers, settings.height_m);
    let needed = if is_driven { 2 } else { 3 };
    if heard.len() < needed {
        return Err(MapError::TooFewReceivers { found: heard.len(), needed });
    }
    let start = match epochs.start(receivers, height_m[0], line.as_ref()) {
        Some(start) => start,
        None if is_driven && epochs.times_s.len() >= 3 => epochs.around_middle(&heard),
        None => return Err(missing),
    };
    let has_strengths = readings.iter().any(|reading| matches!(reading.value, TagValue::Strength(_)));
    let is_among = is_among(receivers, &start);
    let border = Border { receivers: receivers.len(), is_driven, has_strengths };
    let (steps_s, legs) = (epochs.steps_s(), epochs.legs());
    let firsts: Vec<(usize, [f64; 2])> =
        epochs.believed.first().map(|first| (0, [first.x_m, first.y_m])).into_iter().collect();
    let motions: Vec<Motion<'_>> = if is_driven {
        let driven = |error: PathError| {
            Motion::Driven(Odometry {
                legs: &legs,
                error,
                firsts: &firsts,
                first_deviation: FIRST,
                scale: border.odometry_scale(),
                drift: border.odometry_drift(),
            })
        };
        FACTORS.map(|factor| driven(settings.odometry.wandering(factor))).to_vec()
    } else {
        ACCELERATIONS.map(|acceleration| Motion::Free(FreeMotion { steps_s: &steps_s, acceleration })).to_vec()
    };
    let mut problem = TrackProblem {
        receivers,
        readings: &epochs.readings,
        motion: if is_driven { motions[motions.len() - 1] } else { motions[1] },
        border,
        law: RangeErrorLaw::of([0.0; 4]),
        worth: 1.0,
        strengths: StrengthErrors { width_db: NOISES[0].1, worth: 1.0 },
        exponent: EXPONENT,
        calibration: if is_among { AMONG } else { BESIDE },
        height_m,
    };
    let states: Vec<Vec<Vector4<f64>>> = if is_driven {
        epochs.aligned(&start, line.as_ref())
    } else {
        vec![start.iter().map(|&[x, y]| Vector4::new(x, y, 0.0, 0.0)).collect()]
    };
    let side = line.filter(|_| settings.side.is_some());
    let best = first_top(&mut problem, states, side.as_ref(), watch)?;
    let Some(mut top) = best else { return Err(missing) };
    for _ in 0..2 {
        take_laws(&mut problem, &top.point);
        top = chosen(&mut problem, &motions, &top.point, watch)?;
        if has_strengths {
            top = exponent::most_likely(&problem, top, watch)?;
        }
    }
    let may_be_mirrored = line.is_some() && settings.side.is_none() && !is_driven;
    Ok(tracked(&epochs, &problem, &top, is_among, may_be_mirrored))
}

/// What is known of the height of the tag: its mean and standard deviation (m).
fn height_m(receivers: &[Position], given_m: Option<f64>) -> [f64; 2] {
    let levels = receivers.iter().map(|receiver| receiver.z_m);
    let low = levels.clone().fold(f64::INFINITY, f64::min);
    let high = levels.fold(f64::NEG_INFINITY, f64::max);
    match given_m {
        Some(height_m) => [height_m, 1e-4],
        None => [0.5 * (low + high), if high - low > 1e-3 { 1.0 } else { 1e-4 }],
    }
}

/// The highest top from these starts on that side, by laws of much noise and then of less.
fn first_top(
    problem: &mut TrackProblem<'_>,
    starts: Vec<Vec<Vector4<f64>>>,
    side: Option<&Line>,
    watch: &dyn Watch,
) -> Result<Option<Top<TrackPoint>>, MapError> {
    let mut best: Option<Top<TrackPoint>> = None;
    for states in starts {
        let mut point = TrackPoint { border: first_border(problem), states };
        take_power(problem, &mut point);
        let mut top = None;
        for (noise_m, width_db) in NOISES {
            problem.law = error_law::noisy(noise_m);
            problem.strengths = StrengthErrors { width_db, worth: 1.0 };
            let found = climb(problem, point, STEPS, LEAST_GAIN, watch)?;
            point = found.point.clone();
            top = Some(found);
        }
        let found = top.expect("there are noises");
        let is_there = side.is_none_or(|side| is_on_side(side, &found.point));
        if is_there && best.as_ref().is_none_or(|best| found.value > best.value) {
            best = Some(found);
        }
    }
    Ok(best)
}

/// Whether most of a track is on the side of a line that is wanted.
fn is_on_side(line: &Line, point: &TrackPoint) -> bool {
    point.states.iter().map(|state| line.across_m([state[0], state[1]])).sum::<f64>() >= 0.0
}

/// What is taken of the laws before anything is known.
fn first_border(problem: &TrackProblem<'_>) -> DVector<f64> {
    let at = problem.border;
    let mut border = DVector::zeros(at.width());
    border[at.height()] = problem.height_m[0];
    if at.has_strengths {
        border[at.exponent()] = EXPONENT[0];
    }
    border
}

/// Takes the power that suits the strengths at a point.
fn take_power(problem: &TrackProblem<'_>, point: &mut TrackPoint) {
    let at = problem.border;
    if !at.has_strengths {
        return;
    }
    let of = |reading: &epochs::EpochReading| {
        reading.value + EXPONENT[0] * path_loss(problem.sight(reading, point).distance_m)
    };
    let mut powers: Vec<f64> = problem.readings.iter().filter(|reading| reading.is_strength).map(of).collect();
    point.border[at.power()] = median(&mut powers);
}

/// Takes the laws of the errors at a point, and how similar neighbouring ones are.
fn take_laws(problem: &mut TrackProblem<'_>, point: &TrackPoint) {
    let receivers = problem.receivers.len();
    let errors = problem.errors(point, false);
    if !errors.is_empty() {
        problem.law = error_law::of_errors(&errors.iter().map(|&(_, error_m)| error_m).collect::<Vec<_>>());
        problem.worth = error_law::worth(receivers, errors.into_iter());
    }
    let errors = problem.errors(point, true);
    if !errors.is_empty() {
        let all: Vec<f64> = errors.iter().map(|&(_, error_db)| error_db).collect();
        problem.strengths = StrengthErrors::of_errors(&all, error_law::worth(receivers, errors.into_iter()));
    }
}

/// The climb with the motion that the marginal likelihood prefers, which the problem takes.
fn chosen<'a>(
    problem: &mut TrackProblem<'a>,
    motions: &[Motion<'a>],
    start: &TrackPoint,
    watch: &dyn Watch,
) -> Result<Top<TrackPoint>, MapError> {
    let mut best: Option<(f64, Motion<'a>, Top<TrackPoint>)> = None;
    for &motion in motions {
        let tried = TrackProblem { motion, ..problem.clone() };
        let top = climb(&tried, start.clone(), STEPS, LEAST_GAIN, watch)?;
        let log_evidence = motion.log_widths() + log_evidence(&top);
        if best.as_ref().is_none_or(|(best, ..)| log_evidence > *best) {
            best = Some((log_evidence, motion, top));
        }
    }
    let (_, motion, top) = best.expect("there are motions");
    problem.motion = motion;
    Ok(top)
}

/// The logarithm of the marginal likelihood (Laplace), but for what does not depend on the laws.
fn log_evidence(top: &Top<TrackPoint>) -> f64 {
    top.curvature.as_ref().map_or(f64::NEG_INFINITY, |curvature| top.value - 0.5 * curvature.log_determinant)
}

#[cfg(test)]
mod tests;
