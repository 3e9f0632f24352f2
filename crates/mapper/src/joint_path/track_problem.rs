//! A moving tag among receivers whose places are known, as one problem.

use nalgebra::{DVector, Vector4};
use sextant_channel::{Position, RangeErrorLaw};

use super::chain::{ChainStep, ChainSystem};
use super::climb::Hill;

/// A range from a receiver at one of the times of a track.
#[derive(Clone, Copy, Debug)]
pub(super) struct EpochRange {
    pub(super) epoch: usize,
    pub(super) receiver: usize,
    /// How much later than the time of the epoch it was measured (s).
    pub(super) after_s: f64,
    pub(super) range_m: f64,
}

/// What is sought: a place and a velocity at each time, and the border.
#[derive(Clone, Debug)]
pub(super) struct TrackPoint {
    /// x, y (m), and the velocity along them (m/s).
    pub(super) states: Vec<Vector4<f64>>,
    /// The bias of each receiver (m); bias and scale of all ranges; the height of the tag (m).
    pub(super) border: DVector<f64>,
}

/// How well the ranges are calibrated: standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Calibration {
    pub(super) bias_m: f64,
    pub(super) scale: f64,
    pub(super) receiver_bias_m: f64,
}

/// A track.
#[derive(Clone, Debug)]
pub(super) struct TrackProblem<'a> {
    pub(super) receivers: &'a [Position],
    /// Times from each epoch to the next (s).
    pub(super) steps_s: &'a [f64],
    pub(super) ranges: &'a [EpochRange],
    pub(super) law: RangeErrorLaw,
    pub(super) worth: f64,
    pub(super) calibration: Calibration,
    /// Power spectral density of the acceleration, which is white (m²/s³).
    pub(super) acceleration: f64,
    /// The height of the tag that is most likely, and its standard deviation (m).
    pub(super) height_m: [f64; 2],
}

const BIAS: usize = 0;
const SCALE: usize = 1;
const HEIGHT: usize = 2;
pub(super) const AFTER_RECEIVERS: usize = 3;
/// Usual speeds are up to a few metres a second.
const SPEED_M_PER_S: f64 = 20.0;

impl TrackProblem<'_> {
    fn shared(&self, which: usize) -> usize {
        self.receivers.len() + which
    }

    /// From the tag to the receiver of a range (m), and the distance.
    pub(super) fn apart(&self, range: &EpochRange, at: &TrackPoint) -> ([f64; 3], f64) {
        let state = &at.states[range.epoch];
        let receiver = self.receivers[range.receiver];
        let apart = [
            receiver.x_m - state[0] - range.after_s * state[2],
            receiver.y_m - state[1] - range.after_s * state[3],
            receiver.z_m - at.border[self.shared(HEIGHT)],
        ];
        (apart, (apart.iter().map(|along| along * along).sum::<f64>() + 1e-12).sqrt())
    }

    fn error_m(&self, range: &EpochRange, distance_m: f64, border: &DVector<f64>) -> f64 {
        let longer = 1.0 + border[self.shared(SCALE)];
        range.range_m - longer * distance_m - border[self.shared(BIAS)] - border[range.receiver]
    }

    pub(super) fn errors_m(&self, at: &TrackPoint) -> Vec<f64> {
        self.ranges.iter().map(|range| self.error_m(range, self.apart(range, at).1, &at.border)).collect()
    }

    /// The residuals of a step along x (0) or y (1): of the velocity, and of the place that two velocities do not explain; with
    /// their variances. They are independent.
    fn of_step(&self, step_s: f64, axis: usize, from: &Vector4<f64>, to: &Vector4<f64>) -> [(f64, f64); 2] {
        let velocity = to[2 + axis] - from[2 + axis];
        let place = to[axis] - from[axis] - 0.5 * step_s * (to[2 + axis] + from[2 + axis]);
        [(velocity, self.acceleration * step_s), (place, self.acceleration * step_s.powi(3) / 12.0)]
    }

    fn priors(&self) -> impl Iterator<Item = (usize, f64, f64)> {
        let Calibration { bias_m, scale, receiver_bias_m } = self.calibration;
        let of_receivers = (0..self.receivers.len()).map(move |receiver| (receiver, 0.0, receiver_bias_m));
        let [height_m, deviation_m] = self.height_m;
        of_receivers.chain([
            (self.shared(BIAS), 0.0, bias_m),
            (self.shared(SCALE), 0.0, scale),
            (self.shared(HEIGHT), height_m, deviation_m),
        ])
    }

    /// What the width of the prior of motion adds to the logarithm of the marginal likelihood.
    pub(super) fn log_widths(&self) -> f64 {
        -2.0 * self.steps_s.len() as f64 * libm::log(self.acceleration)
    }
}

impl Hill for TrackProblem<'_> {
    type Point = TrackPoint;

    fn value(&self, at: &TrackPoint) -> f64 {
        let law = self.law.prepared();
        let of_range = |error_m: f64| law.log_density(error_m);
        let mut value: f64 = self.worth * self.errors_m(at).into_iter().map(of_range).sum::<f64>();
        for (pair, &step_s) in at.states.windows(2).zip(self.steps_s) {
            for axis in 0..2 {
                let residuals = self.of_step(step_s, axis, &pair[0], &pair[1]);
                value -=
                    residuals.iter().map(|(residual, variance)| 0.5 * residual * residual / variance).sum::<f64>();
            }
        }
        for state in &at.states {
            value -= 0.5 * (state[2].powi(2) + state[3].powi(2)) / SPEED_M_PER_S.powi(2);
        }
        for (entry, mean, deviation) in self.priors() {
            value -= 0.5 * ((at.border[entry] - mean) / deviation).powi(2);
        }
        value
    }

    fn system(&self, at: &TrackPoint) -> ChainSystem {
        let mut system = ChainSystem::zeros(at.states.len(), at.border.len());
        let law = self.law.prepared();
        for range in self.ranges {
            let (apart, distance_m) = self.apart(range, at);
            let density = law.density(self.error_m(range, distance_m, &at.border));
            let longer = (1.0 + at.border[self.shared(SCALE)]) / distance_m;
            let [x, y] = [longer * apart[0], longer * apart[1]];
            let by_state = Vector4::new(x, y, x * range.after_s, y * range.after_s);
            let by_border = [
                (range.receiver, -1.0),
                (self.shared(BIAS), -1.0),
                (self.shared(SCALE), -distance_m),
                (self.shared(HEIGHT), longer * apart[2]),
            ];
            let (weight, slope) = (self.worth * density.stiffness, self.worth * density.by_error);
            system.add(range.epoch, by_state, None, &by_border, weight, slope);
        }
        for (number, (pair, &step_s)) in at.states.windows(2).zip(self.steps_s).enumerate() {
            for axis in 0..2 {
                let unit = |entry: usize, value: f64| {
                    let mut vector = Vector4::zeros();
                    vector[entry] = value;
                    vector
                };
                let rows = [
                    (unit(2 + axis, -1.0), unit(2 + axis, 1.0)),
                    (
                        unit(axis, -1.0) + unit(2 + axis, -0.5 * step_s),
                        unit(axis, 1.0) + unit(2 + axis, -0.5 * step_s),
                    ),
                ];
                for ((by_from, by_to), (residual, variance)) in
                    rows.into_iter().zip(self.of_step(step_s, axis, &pair[0], &pair[1]))
                {
                    system.add(number, by_from, Some(by_to), &[], 1.0 / variance, -residual / variance);
                }
            }
        }
        let slowness = SPEED_M_PER_S.powi(-2);
        for ((curvature, slope), state) in system.states.iter_mut().zip(&mut system.slopes).zip(&at.states) {
            for entry in [2, 3] {
                curvature[(entry, entry)] += slowness;
                slope[entry] -= slowness * state[entry];
            }
        }
        for (entry, mean, deviation) in self.priors() {
            system.border[(entry, entry)] += deviation.powi(-2);
            system.border_slope[entry] -= (at.border[entry] - mean) / deviation.powi(2);
        }
        system
    }

    fn moved(&self, at: &TrackPoint, step: &ChainStep) -> TrackPoint {
        TrackPoint {
            states: at.states.iter().zip(&step.states).map(|(state, step)| state + step).collect(),
            border: &at.border + &step.border,
        }
    }
}
