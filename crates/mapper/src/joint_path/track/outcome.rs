//! The track at the top of its problem.

use nalgebra::Vector4;
use sextant_channel::Position;
use sextant_kernel::SimTime;

use super::BESIDE;
use super::epochs::Epochs;
use super::heights::{self, Heights, tell_height};
use super::motion::{FreeMotion, Motion};
use super::problem::{TrackPoint, TrackProblem, path_loss};
use super::regions::{by_place, is_among};
use super::report::{Track, TrackFit, TrackHeight, TrackMotion, TrackPose, TrackRangeLaw, TrackStrengthLaw};
use super::search::Found;
use crate::joint_path::chain::Factor;

/// Clocks of ranges and of whoever uses the track differ by about that (s).
const CLOCK_S: f64 = 0.15;

/// The track at a top.
pub(super) fn tracked(
    epochs: &Epochs,
    Found { problem, top }: &Found<'_>,
    is_height_given: bool,
    may_be_mirrored: bool,
) -> Track {
    let covariances = top.curvature.as_ref().map(Factor::covariances);
    let by_place = by_place(problem, &top.point);
    let (border, at) = (&top.point.border, problem.border);
    let variances_m2 = top.curvature.as_ref().filter(|_| !is_height_given && tell_height(problem.receivers));
    let variances_m2 =
        variances_m2.map(|factor| problem.heights.variances(factor, epochs.times_s.len(), problem.border.height()));
    let velocities = velocities(epochs, problem, &top.point);
    let pose = |(at, (state, &time)): (usize, (&Vector4<f64>, &SimTime))| TrackPose {
        time,
        position: Position::new(state[0], state[1], problem.height_m(at, border)),
        height_variance_m2: variances_m2.as_ref().map(|of_epochs| of_epochs[at]),
        covariance: covariances.as_ref().map_or([[0.0; 2]; 2], |states| {
            let (velocity, state, more) = (velocities[at], &states[at], by_place[at]);
            let by_clock = |row: usize, column: usize| CLOCK_S * CLOCK_S * velocity[row] * velocity[column];
            let entry =
                |row: usize, column: usize| state[(row, column)] + more[(row, column)] + by_clock(row, column);
            [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]]
        }),
        velocity_m_per_s: velocities[at],
    };
    let poses: Vec<TrackPose> = top.point.states.iter().zip(&epochs.times).enumerate().map(pose).collect();
    let extent_m = problem.receivers.iter().map(|place| place.distance_m(problem.receivers[0])).fold(0.0, f64::max);
    let is_told =
        covariances.is_some() && 2 * poses.iter().filter(|pose| pose.spread_m() < extent_m).count() > poses.len();
    let is_height_doubtful =
        !is_height_given && poses.iter().any(|pose| heights::is_far(problem.receivers, pose.position.z_m));
    let height_m = poses.iter().map(|pose| pose.position.z_m).sum::<f64>() / poses.len() as f64;
    let strengths = epochs.readings.iter().filter(|reading| reading.is_strength).count();
    let ranges = epochs.readings.len() - strengths;
    let [measured_ranges, measured_strengths] = epochs.measured;
    let track: Vec<[f64; 2]> = top.point.states.iter().map(|state| [state[0], state[1]]).collect();
    let errors_m = problem.errors(&top.point, false).into_iter().map(|(_, error_m)| error_m);
    let of_ranges = TrackRangeLaw {
        bias_m: border[at.bias()],
        scale: border[at.scale()],
        errors: problem.law,
        worth: problem.worth,
        log_density: problem.law.prepared().log_likelihood(errors_m) / ranges.max(1) as f64,
    };
    let of_strengths = at.has_strengths.then(|| TrackStrengthLaw {
        at_1_m_dbm: border[at.power()] - border[at.exponent()] * path_loss(1.0),
        exponent: border[at.exponent()],
        width_db: problem.strengths.width_db,
        worth: problem.strengths.worth,
    });
    Track {
        doubted: super::check::doubted(problem, &top.point),
        fault: None,
        poses,
        fit: TrackFit {
            ranges,
            strengths,
            measured_ranges,
            measured_strengths,
            is_among_receivers: problem.calibration != BESIDE && is_among(problem.receivers, &track),
            may_be_mirrored,
            height_m,
            is_height_doubtful,
            height: match (problem.heights, variances_m2) {
                _ if is_height_given => TrackHeight::Given,
                (Heights::Wandering { .. }, _) => TrackHeight::Wandering,
                (Heights::Constant, Some(of_epochs)) => {
                    TrackHeight::Constant { deviation_m: of_epochs.first().map_or(0.0, |variance| variance.sqrt()) }
                }
                (Heights::Constant, None) => TrackHeight::OfReceivers,
            },
            of_ranges: (ranges > 0).then_some(of_ranges),
            of_strengths,
            motion: match problem.motion {
                Motion::Free(FreeMotion { acceleration, .. }) => TrackMotion::Free { acceleration },
                Motion::Driven(_) => TrackMotion::Driven {
                    scale: border[at.odometry_scale()],
                    drift_rad_per_m: border[at.odometry_drift()],
                },
            },
            settled: top.settled && is_told,
        },
    }
}

/// The velocity at each time (m/s): with odometry, that between the poses before and after.
fn velocities(epochs: &Epochs, problem: &TrackProblem<'_>, point: &TrackPoint) -> Vec<[f64; 2]> {
    let states = &point.states;
    let between = |at: usize| {
        let (before, after) = (at.saturating_sub(1), (at + 1).min(states.len() - 1));
        let span_s = (epochs.times_s[after] - epochs.times_s[before]).max(1e-3);
        [0, 1].map(|axis| (states[after][axis] - states[before][axis]) / span_s)
    };
    match problem.motion {
        Motion::Free(_) => states.iter().map(|state| [state[2], state[3]]).collect(),
        Motion::Driven(_) => (0..states.len()).map(between).collect(),
    }
}
