//! The search for a track: places, laws of errors, motion and height in turn.

use nalgebra::{DVector, Vector4};
use sextant_channel::{Position, RangeErrorLaw};
use sextant_kernel::{Interrupted, Watch};

use super::epochs::{EpochReading, Epochs};
use super::heights::{self, Heights, Knots, WANDERS};
use super::motion::{FreeMotion, Motion};
use super::problem::{Border, LEAST_GAIN, STEPS, TrackPoint, TrackProblem, path_loss};
use super::regions::is_among;
use super::side::Line;
use super::strengths::{EXPONENT, StrengthErrors};
use super::{AMONG, BESIDE, Sought, TrackSettings, exponent};
use crate::joint_path::PathError;
use crate::joint_path::climb::{Top, climb};
use crate::joint_path::odometry::{FACTORS, Leg, Odometry};
use crate::numerics::median;
use crate::range_ml::error_law;

/// The noise of ranges in turn (m), and the width of the law of strengths (dB).
const NOISES: [(f64, f64); 2] = [(3.0, 12.0), (1.0, 7.0)];
/// Power spectral densities of the acceleration that are tried (m²/s³): from a trolley to a runner.
const ACCELERATIONS: [f64; 4] = [0.01, 0.05, 0.25, 1.25];
/// How well the first pose of odometry is known in the frame of the receivers (m, rad).
const FIRST: [f64; 2] = [300.0, 6.0];

/// A climb that did not end goes on so many times; it has ended if it gains less than this each time (nats).
const MORE_CLIMBS: u32 = 3;
const NOTABLE_GAIN: f64 = 0.5;
/// A height that wanders is searched from so far above and below the usual one as well (m).
const HEIGHTS_M: [f64; 3] = [0.0, -0.7, 0.7];
/// A height wanders if that is more probable by so much (nats).
const CLEAR: f64 = 5.0;

/// What a track is sought from.
#[derive(Clone, Copy)]
pub(super) struct Search<'a> {
    pub(super) receivers: &'a [Position],
    pub(super) epochs: &'a Epochs,
    /// Where it begins: a place (m) for each epoch.
    pub(super) start: &'a [[f64; 2]],
    /// Times from each epoch to the next (s), and the legs of odometry.
    pub(super) steps_s: &'a [f64],
    pub(super) legs: &'a [Leg],
    /// The first pose of odometry.
    pub(super) firsts: &'a [(usize, [f64; 2])],
    pub(super) line: Option<&'a Line>,
    /// What is known of the height: its mean and standard deviation (m).
    pub(super) height_m: [f64; 2],
    pub(super) settings: TrackSettings,
    pub(super) watch: &'a dyn Watch,
}

/// The top of a search, with the problem whose top it is.
pub(super) struct Found<'a> {
    pub(super) problem: TrackProblem<'a>,
    pub(super) top: Top<TrackPoint>,
}

impl<'a> Search<'a> {
    fn is_driven(&self) -> bool {
        !self.firsts.is_empty()
    }

    /// The track with one height, or with one that wanders if that is clearly more probable. With odometry, there is one height.
    pub(super) fn of_most_likely_height(
        &self,
        knots: &'a Knots,
        sought: Sought,
    ) -> Result<Option<Found<'a>>, Interrupted> {
        let Some(constant) = self.found(Heights::Constant)? else { return Ok(None) };
        let has_ranges = self.epochs.readings.iter().any(|reading| !reading.is_strength);
        let is_told = self.settings.height_m.is_none() && heights::tell_height(self.receivers);
        let is_told = is_told && sought == Sought::AnyHeight;
        if self.is_driven() || !has_ranges || !is_told {
            return Ok(Some(constant));
        }
        let mut wandering: Option<(f64, Found<'a>)> = None;
        for (deviation_m, memory_s) in WANDERS {
            let Some(found) = self.found(Heights::Wandering { knots, deviation_m, memory_s })? else { continue };
            // A wrong height makes errors alike for long: what a range is worth with it is no measure for the other.
            let worth = found.problem.worth.max(constant.problem.worth);
            let gain = self.log_evidence(&found, worth)? - self.log_evidence(&constant, worth)?;
            if wandering.as_ref().is_none_or(|(best, _)| gain > *best) {
                wandering = Some((gain, found));
            }
        }
        let wandering = wandering.filter(|&(gain, _)| gain > CLEAR).map(|(_, found)| found);
        Ok(Some(wandering.unwrap_or(constant)))
    }

    /// The logarithm of the marginal likelihood if a range is worth so many independent ones.
    fn log_evidence(&self, found: &Found<'a>, worth: f64) -> Result<f64, Interrupted> {
        let problem = TrackProblem { worth, ..found.problem.clone() };
        let top = climb(&problem, found.top.point.clone(), STEPS, LEAST_GAIN, self.watch)?;
        Ok(problem.log_widths() + top.log_evidence())
    }

    /// The motions among which the marginal likelihood chooses; the search begins with the one of this number.
    fn motions(&self, border: Border) -> (Vec<Motion<'a>>, usize) {
        if !self.is_driven() {
            let steps_s = self.steps_s;
            return (
                ACCELERATIONS.map(|acceleration| Motion::Free(FreeMotion { steps_s, acceleration })).to_vec(),
                1,
            );
        }
        let driven = |error: PathError| {
            Motion::Driven(Odometry {
                legs: self.legs,
                error,
                firsts: self.firsts,
                first_deviation: FIRST,
                scale: border.odometry_scale(),
                drift: border.odometry_drift(),
            })
        };
        let motions = FACTORS.map(|factor| driven(self.settings.odometry.wandering(factor))).to_vec();
        let last = motions.len() - 1;
        (motions, last)
    }

    /// The track with such heights.
    fn found(&self, heights: Heights<'a>) -> Result<Option<Found<'a>>, Interrupted> {
        let Self { receivers, epochs, start, line, height_m, watch, .. } = *self;
        let has_strengths = epochs.readings.iter().any(|reading| reading.is_strength);
        let border =
            Border { knots: heights.knots(), receivers: receivers.len(), is_driven: self.is_driven(), has_strengths };
        let (motions, first) = self.motions(border);
        let mut problem = TrackProblem {
            receivers,
            readings: &epochs.readings,
            motion: motions[first],
            border,
            law: RangeErrorLaw::of([0.0; 4]),
            worth: 1.0,
            strengths: StrengthErrors { width_db: NOISES[0].1, worth: 1.0 },
            exponent: EXPONENT,
            // Where the height wanders, a bias would climb and sink with it.
            calibration: match heights {
                Heights::Constant if is_among(receivers, start) => AMONG,
                Heights::Constant | Heights::Wandering { .. } => BESIDE,
            },
            height_m,
            heights,
        };
        let states: Vec<Vec<Vector4<f64>>> = if self.is_driven() {
            epochs.aligned(start, line)
        } else {
            vec![start.iter().map(|&[x, y]| Vector4::new(x, y, 0.0, 0.0)).collect()]
        };
        let side = line.filter(|_| self.settings.side.is_some());
        let Some(mut top) = first_top(&mut problem, states, side, watch)? else { return Ok(None) };
        loop {
            for _ in 0..2 {
                take_laws(&mut problem, &top.point);
                top = chosen(&mut problem, &motions, &top.point, watch)?;
                if has_strengths {
                    top = exponent::most_likely(&problem, top, watch)?;
                }
            }
            // Slow at the end, or without an end.
            for _ in 0..MORE_CLIMBS {
                if top.settled || has_strengths {
                    break;
                }
                let more = climb(&problem, top.point.clone(), STEPS, LEAST_GAIN, watch)?;
                let is_slow = more.value - top.value < NOTABLE_GAIN;
                top = Top { settled: more.settled || is_slow, ..more };
            }
            // A track that ends beside the receivers does not tell the calibration, whatever it began with.
            let track: Vec<[f64; 2]> = top.point.states.iter().map(|state| [state[0], state[1]]).collect();
            if problem.calibration == BESIDE || is_among(receivers, &track) {
                return Ok(Some(Found { problem, top }));
            }
            problem.calibration = BESIDE;
        }
    }
}

/// The highest top from these starts on that side, by laws of much noise and then of less.
fn first_top(
    problem: &mut TrackProblem<'_>,
    starts: Vec<Vec<Vector4<f64>>>,
    side: Option<&Line>,
    watch: &dyn Watch,
) -> Result<Option<Top<TrackPoint>>, Interrupted> {
    let mut best: Option<Top<TrackPoint>> = None;
    let heights_m: &[f64] = if problem.border.knots > 0 { &HEIGHTS_M } else { &HEIGHTS_M[..1] };
    for (states, &height_m) in
        starts.iter().flat_map(|states| heights_m.iter().map(move |height_m| (states, height_m)))
    {
        let mut point = TrackPoint { border: first_border(problem, height_m), states: states.clone() };
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

/// What is taken of the laws before anything is known, and of a height so far above the usual one (m).
fn first_border(problem: &TrackProblem<'_>, above_m: f64) -> DVector<f64> {
    let at = problem.border;
    let mut border = DVector::zeros(at.width());
    border.rows_mut(0, at.knots).fill(problem.height_m[0] + above_m);
    border[at.height()] = problem.height_m[0] + above_m;
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
    let of =
        |reading: &EpochReading| reading.value + EXPONENT[0] * path_loss(problem.sight(reading, point).distance_m);
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
) -> Result<Top<TrackPoint>, Interrupted> {
    let mut best: Option<(f64, Motion<'a>, Top<TrackPoint>)> = None;
    for &motion in motions {
        let tried = TrackProblem { motion, ..problem.clone() };
        let top = climb(&tried, start.clone(), STEPS, LEAST_GAIN, watch)?;
        let log_evidence = motion.log_widths() + top.log_evidence();
        if best.as_ref().is_none_or(|(best, ..)| log_evidence > *best) {
            best = Some((log_evidence, motion, top));
        }
    }
    let (_, motion, top) = best.expect("there are motions");
    problem.motion = motion;
    Ok(top)
}
