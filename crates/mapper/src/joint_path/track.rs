//! The way of a moving tag among receivers whose places are known.

use nalgebra::{DVector, Matrix2, Vector2, Vector4};
use sextant_channel::{Position, RangeErrorLaw};
use sextant_kernel::{SimTime, Watch};

use super::climb::{Top, climb};
use super::track_problem::{AFTER_RECEIVERS, Calibration, EpochRange, TrackPoint, TrackProblem};
use crate::comparators::lateration::{Range, refine};
use crate::error::MapError;
use crate::numerics::convex_hull::{hull, turn};
use crate::numerics::median;
use crate::range_ml::error_law;

/// Ranges within this time are one epoch (s).
const EPOCH_S: f64 = 0.25;
/// The search begins with places from ranges within this time before and after (s).
const WINDOW_S: f64 = 1.0;
/// Most steps of a climb, and the gain that ends it.
const STEPS: u32 = 60;
const LEAST_GAIN: f64 = 1e-3;
/// The noise of ranges in turn (m).
const NOISES_M: [f64; 2] = [3.0, 1.0];
/// Power spectral densities of the acceleration that are tried (m²/s³): from a trolley to a runner.
const ACCELERATIONS: [f64; 4] = [0.01, 0.05, 0.25, 1.25];
/// Clocks of ranges and of whoever uses the track differ by about that (s).
const CLOCK_S: f64 = 0.15;
/// What is known of the calibration where the tag is among the receivers, and where it is beside them: there a bias moves the whole
/// track, and nothing tells it.
const AMONG: Calibration = Calibration { bias_m: 3.0, scale: 0.05, receiver_bias_m: 0.2 };
const BESIDE: Calibration = Calibration { bias_m: 0.05, scale: 0.003, receiver_bias_m: 0.03 };

/// A range between a receiver and a tag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TagRange {
    /// The number of the receiver.
    pub receiver: usize,
    /// When it was measured.
    pub time: SimTime,
    /// The distance that was measured (m).
    pub range_m: f64,
}

/// What is known of a tag.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrackSettings {
    /// Its height (m). If absent, it is estimated where the receivers have different heights, and is theirs otherwise.
    pub height_m: Option<f64>,
}

/// Where a tag was at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackPose {
    /// When.
    pub time: SimTime,
    /// Where (m).
    pub position: Position,
    /// Covariance of x and y (m²). It holds errors of ranges that stay the same for a while, and a clock that is wrong by 0.15 s.
    pub covariance: [[f64; 2]; 2],
    /// Velocity along x and y (m/s).
    pub velocity_m_per_s: [f64; 2],
}

/// The track of a tag.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Its poses, in the order of time.
    pub poses: Vec<TrackPose>,
    /// What was learned with it.
    pub fit: TrackFit,
}

/// What was learned of ranges and motion with a track.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackFit {
    /// Number of ranges that were used: of those of one receiver in a quarter of a second, the median.
    pub ranges: usize,
    /// Whether the tag was among the receivers, so that biases and scale could be estimated.
    pub is_among_receivers: bool,
    /// By how much all ranges are too long (m).
    pub bias_m: f64,
    /// The share by which all ranges are too long.
    pub scale: f64,
    /// The height of the tag (m).
    pub height_m: f64,
    /// Power spectral density of its acceleration (m²/s³).
    pub acceleration: f64,
    /// The law of the errors of ranges.
    pub errors: RangeErrorLaw,
    /// How many independent ranges one is worth.
    pub worth: f64,
    /// Whether the search ended by itself.
    pub settled: bool,
}

/// The track of a tag from its `ranges` to `receivers` at known places (m), in the plane.
///
/// The tag moves with an acceleration that is white noise, whose strength the marginal likelihood chooses. Track, biases, scale and
/// height are one problem; the law of errors is that of [`RangeErrorLaw`], raised to one over the autocorrelation time.
///
/// # Errors
/// If there are fewer than three receivers or no moment with ranges to three of them, or `watch` ends the work.
pub fn track(
    receivers: &[Position],
    ranges: &[TagRange],
    settings: TrackSettings,
    watch: &dyn Watch,
) -> Result<Track, MapError> {
    let missing = MapError::Missing {
        algorithm: "track",
        what: "ranges to three receivers with known places within two seconds",
        remedy: "`ranges.csv` has the ranges, each with its time, and `--known` the places",
    };
    let epochs = Epochs::of(ranges);
    let levels = receivers.iter().map(|receiver| receiver.z_m);
    let low = levels.clone().fold(f64::INFINITY, f64::min);
    let high = levels.fold(f64::NEG_INFINITY, f64::max);
    let height_m = match settings.height_m {
        Some(height_m) => [height_m, 1e-4],
        None => [0.5 * (low + high), if high - low > 1e-3 { 1.0 } else { 1e-4 }],
    };
    let steps_s: Vec<f64> = epochs.times_s.windows(2).map(|pair| (pair[1] - pair[0]).max(1e-3)).collect();
    let mut problem = TrackProblem {
        receivers,
        steps_s: &steps_s,
        ranges: &epochs.ranges,
        law: RangeErrorLaw::of([0.0; 4]),
        worth: 1.0,
        calibration: AMONG,
        acceleration: ACCELERATIONS[1],
        height_m,
    };
    let Some(start) = epochs.start(receivers, height_m[0]) else { return Err(missing) };
    let is_among = is_among(receivers, &start);
    problem.calibration = if is_among { AMONG } else { BESIDE };
    let mut border = DVector::zeros(receivers.len() + AFTER_RECEIVERS);
    border[receivers.len() + 2] = height_m[0];
    let states = start.iter().map(|&[x, y]| Vector4::new(x, y, 0.0, 0.0)).collect();
    let mut point = TrackPoint { states, border };
    for noise_m in NOISES_M {
        problem.law = error_law::noisy(noise_m);
        point = climb(&problem, point, STEPS, LEAST_GAIN, watch)?.point;
    }
    let mut top = None;
    for _ in 0..2 {
        take_law(&mut problem, &point);
        let (acceleration, found) = chosen(&problem, &point, watch)?;
        problem.acceleration = acceleration;
        point = found.point.clone();
        top = Some(found);
    }
    let top = top.expect("there were rounds");
    Ok(epochs.track(&problem, &top, is_among))
}

/// Takes the law of the errors at a point, and how similar neighbouring ones are.
fn take_law(problem: &mut TrackProblem<'_>, point: &TrackPoint) {
    let errors = problem.errors_m(point);
    problem.law = error_law::of_errors(&errors);
    let of_receivers = problem.ranges.iter().map(|range| range.receiver);
    problem.worth = error_law::worth(problem.receivers.len(), of_receivers.zip(errors));
}

/// The climb with the acceleration that the marginal likelihood prefers.
fn chosen(
    problem: &TrackProblem<'_>,
    start: &TrackPoint,
    watch: &dyn Watch,
) -> Result<(f64, Top<TrackPoint>), MapError> {
    let mut best: Option<(f64, f64, Top<TrackPoint>)> = None;
    for acceleration in ACCELERATIONS {
        let tried = TrackProblem { acceleration, ..problem.clone() };
        let top = climb(&tried, start.clone(), STEPS, LEAST_GAIN, watch)?;
        let log_evidence = match &top.curvature {
            Some(curvature) => top.value + tried.log_widths() - 0.5 * curvature.log_determinant,
            None => f64::NEG_INFINITY,
        };
        if best.as_ref().is_none_or(|(best, ..)| log_evidence > *best) {
            best = Some((log_evidence, acceleration, top));
        }
    }
    let (_, acceleration, top) = best.expect("there are accelerations");
    Ok((acceleration, top))
}

/// The ranges of a tag by epoch.
struct Epochs {
    /// Middle times (s), and as instants.
    times_s: Vec<f64>,
    times: Vec<SimTime>,
    ranges: Vec<EpochRange>,
}

impl Epochs {
    fn of(samples: &[TagRange]) -> Self {
        let mut samples = samples.to_vec();
        samples.sort_by_key(|sample| sample.time);
        let second = |sample: &TagRange| sample.time.as_secs_f64();
        let mut found = Self { times_s: Vec::new(), times: Vec::new(), ranges: Vec::new() };
        let mut rest = samples.as_slice();
        while let Some(first) = rest.first() {
            let length = rest.partition_point(|sample| second(sample) < second(first) + EPOCH_S).max(1);
            let (epoch, after) = rest.split_at(length);
            rest = after;
            let time_s = epoch.iter().map(second).sum::<f64>() / epoch.len() as f64;
            let number = found.times_s.len();
            let mut by_receiver = epoch.to_vec();
            by_receiver.sort_by_key(|sample| sample.receiver);
            for of_receiver in by_receiver.chunk_by(|one, other| one.receiver == other.receiver) {
                let mean_s = of_receiver.iter().map(second).sum::<f64>() / of_receiver.len() as f64;
                let range_m = median(&mut of_receiver.iter().map(|sample| sample.range_m).collect::<Vec<_>>());
                let receiver = of_receiver[0].receiver;
                found.ranges.push(EpochRange { epoch: number, receiver, after_s: mean_s - time_s, range_m });
            }
            found.times_s.push(time_s);
            found.times.push(epoch[epoch.len() / 2].time);
        }
        found
    }

    /// A place for each epoch from the ranges around it; `None` if no moment has ranges to three receivers.
    fn start(&self, receivers: &[Position], height_m: f64) -> Option<Vec<[f64; 2]>> {
        let middle =
            receivers.iter().fold(Position::ORIGIN, |sum, &place| sum + place) * (1.0 / receivers.len() as f64);
        let mut last = middle;
        let mut known: Vec<(f64, [f64; 2])> = Vec::new();
        let (mut from, mut to) = (0, 0);
        for &time_s in &self.times_s {
            let time_of = |range: &EpochRange| self.times_s[range.epoch];
            while from < self.ranges.len() && time_of(&self.ranges[from]) < time_s - WINDOW_S {
                from += 1;
            }
            while to < self.ranges.len() && time_of(&self.ranges[to]) <= time_s + WINDOW_S {
                to += 1;
            }
            let near = &self.ranges[from..to];
            let mut by_receiver: Vec<Vec<f64>> = vec![Vec::new(); receivers.len()];
            near.iter().for_each(|range| by_receiver[range.receiver].push(range.range_m));
            let flat: Vec<Range> = by_receiver
                .iter_mut()
                .zip(receivers)
                .filter(|(ranges, _)| !ranges.is_empty())
                .map(|(ranges, receiver)| {
                    let up_m = receiver.z_m - height_m;
                    Range::new(*receiver, (median(ranges).powi(2) - up_m * up_m).max(0.0).sqrt())
                })
                .collect();
            if flat.len() < 3 {
                continue;
            }
            let usual_m = median(&mut flat.iter().map(|range| range.distance_m).collect::<Vec<_>>());
            let around = [[1.0, 0.2], [-0.2, 1.0], [-1.0, -0.2], [0.2, -1.0]]
                .map(|[x, y]| middle + Position::new(x * usual_m, y * usual_m, 0.0));
            let misfit = |place: &Position| -> f64 {
                flat.iter()
                    .map(|range| {
                        let apart = *place - range.anchor;
                        (libm::hypot(apart.x_m, apart.y_m) - range.distance_m).abs()
                    })
                    .sum()
            };
            // A place near the last one is preferred where two fit alike.
            let starts = std::iter::once(last).chain(around).chain([middle + Position::new(0.01, 0.02, 0.0)]);
            let found = starts.map(|start| refine(start, &flat, 2));
            let cost =
                |place: &Position| misfit(place) + 0.05 * libm::hypot(place.x_m - last.x_m, place.y_m - last.y_m);
            let best = found.min_by(|a, b| cost(a).total_cmp(&cost(b)))?;
            last = best;
            known.push((time_s, [best.x_m, best.y_m]));
        }
        if known.is_empty() {
            return None;
        }
        let at = |time_s: f64| {
            let after = known.partition_point(|&(known_s, _)| known_s < time_s);
            match (after.checked_sub(1).map(|before| known[before]), known.get(after)) {
                (Some((before_s, before)), Some(&(after_s, place))) if after_s > before_s => {
                    let share = (time_s - before_s) / (after_s - before_s);
                    [0, 1].map(|axis| before[axis] + share * (place[axis] - before[axis]))
                }
                (_, Some(&(_, place))) | (Some((_, place)), None) => place,
                (None, None) => [middle.x_m, middle.y_m],
            }
        };
        Some(self.times_s.iter().map(|&time_s| at(time_s)).collect())
    }

    fn track(&self, problem: &TrackProblem<'_>, top: &Top<TrackPoint>, is_among: bool) -> Track {
        let covariances = top.curvature.as_ref().map(|curvature| curvature.covariances().0);
        let by_place = by_place(problem, &top.point);
        let border = &top.point.border;
        let after = problem.receivers.len();
        let height_m = border[after + 2];
        let pose = |(at, (state, &time)): (usize, (&Vector4<f64>, &SimTime))| TrackPose {
            time,
            position: Position::new(state[0], state[1], height_m),
            covariance: covariances.as_ref().map_or([[0.0; 2]; 2], |states| {
                let (mean, state, more) = (state, &states[at], by_place[at]);
                let by_clock = |row: usize, column: usize| CLOCK_S * CLOCK_S * mean[2 + row] * mean[2 + column];
                let entry =
                    |row: usize, column: usize| state[(row, column)] + more[(row, column)] + by_clock(row, column);
                [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]]
            }),
            velocity_m_per_s: [state[2], state[3]],
        };
        Track {
            poses: top.point.states.iter().zip(&self.times).enumerate().map(pose).collect(),
            fit: TrackFit {
                ranges: self.ranges.len(),
                is_among_receivers: is_among,
                bias_m: border[after],
                scale: border[after + 1],
                height_m,
                acceleration: problem.acceleration,
                errors: problem.law,
                worth: problem.worth,
                settled: top.settled && covariances.is_some(),
            },
        }
    }
}

/// What the errors of ranges that stay the same for a while add to the covariance of each place (m²): what stands in the way of a
/// receiver lengthens its ranges until the tag has moved on, so that the ranges of a place share it, whatever their number.
fn by_place(problem: &TrackProblem<'_>, point: &TrackPoint) -> Vec<Matrix2<f64>> {
    /// So many ranges in a row have nearly the same error.
    const ROW: usize = 20;
    let errors = problem.errors_m(point);
    let mut series = vec![Vec::new(); problem.receivers.len()];
    for (range, &error_m) in problem.ranges.iter().zip(&errors) {
        series[range.receiver].push(error_m);
    }
    let (mut sum, mut count) = (0.0, 0.0_f64);
    for row in series.iter().flat_map(|errors| errors.chunks_exact(ROW)) {
        sum += median(&mut row.to_vec()).powi(2);
        count += 1.0;
    }
    let variance = sum / count.max(1.0);
    let mut directions = vec![Matrix2::zeros(); point.states.len()];
    for range in problem.ranges {
        let (apart, distance_m) = problem.apart(range, point);
        let along = Vector2::new(apart[0], apart[1]) / distance_m;
        directions[range.epoch] += along * along.transpose();
    }
    // Receivers that are not heard in an epoch are in others nearby.
    let around = |at: usize| {
        let near = &directions[at.saturating_sub(2)..(at + 3).min(directions.len())];
        near.iter().sum::<Matrix2<f64>>() / near.len() as f64 + Matrix2::identity() * 0.05
    };
    (0..directions.len()).map(|at| around(at).try_inverse().unwrap_or_else(Matrix2::zeros) * variance).collect()
}

/// Whether most of a track is among the receivers: within their convex hull, made larger by a fifth.
fn is_among(receivers: &[Position], track: &[[f64; 2]]) -> bool {
    let middle = receivers.iter().fold(Position::ORIGIN, |sum, &place| sum + place) * (1.0 / receivers.len() as f64);
    let larger: Vec<[f64; 2]> = receivers
        .iter()
        .map(|place| [middle.x_m + 1.2 * (place.x_m - middle.x_m), middle.y_m + 1.2 * (place.y_m - middle.y_m)])
        .collect();
    let hull = hull(larger);
    let is_inside = |place: &&[f64; 2]| {
        hull.len() >= 3 && (0..hull.len()).all(|at| turn(hull[at], hull[(at + 1) % hull.len()], **place) >= 0.0)
    };
    2 * track.iter().filter(is_inside).count() >= track.len()
}
