//! A moving tag among receivers whose places are known, as one problem.

use nalgebra::{DVector, Vector4};
use sextant_channel::{Position, RangeErrorLaw};

use super::epochs::EpochReading;
use super::heights::Heights;
use super::motion::Motion;
use super::strengths::{NEAREST_M, POWER_DBM, RECEIVER_DB, StrengthErrors};
use crate::joint_path::chain::{ChainStep, ChainSystem};
use crate::joint_path::climb::Hill;

/// Most steps of a climb, and the gain that ends it.
pub(super) const STEPS: u32 = 60;
pub(super) const LEAST_GAIN: f64 = 1e-3;

/// What is sought: a state at each time, and the border.
#[derive(Clone, Debug)]
pub(super) struct TrackPoint {
    /// As [`Motion`] has them.
    pub(super) states: Vec<Vector4<f64>>,
    /// As [`Border`] has it.
    pub(super) border: DVector<f64>,
}

/// How well the ranges are calibrated: standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Calibration {
    pub(super) bias_m: f64,
    pub(super) scale: f64,
    pub(super) receiver_bias_m: f64,
}

/// Where the entries of the border are: the heights at the knots (m), if the height wanders; the bias of each receiver (m); bias and
/// scale of all ranges; the height of the tag, or its middle (m); with odometry its scale and drift (rad/m); with strengths the power at
/// a metre (dBm), the exponent, and the offset of each receiver (dB).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Border {
    /// Knots of a height that wanders.
    pub(super) knots: usize,
    pub(super) receivers: usize,
    pub(super) is_driven: bool,
    pub(super) has_strengths: bool,
}

impl Border {
    pub(super) fn receiver(self, receiver: usize) -> usize {
        self.knots + receiver
    }

    pub(super) fn bias(self) -> usize {
        self.receiver(self.receivers)
    }

    pub(super) fn scale(self) -> usize {
        self.bias() + 1
    }

    pub(super) fn height(self) -> usize {
        self.bias() + 2
    }

    pub(super) fn odometry_scale(self) -> usize {
        self.bias() + 3
    }

    pub(super) fn odometry_drift(self) -> usize {
        self.bias() + 4
    }

    pub(super) fn power(self) -> usize {
        self.bias() + 3 + if self.is_driven { 2 } else { 0 }
    }

    pub(super) fn exponent(self) -> usize {
        self.power() + 1
    }

    pub(super) fn offset(self, receiver: usize) -> usize {
        self.power() + 2 + receiver
    }

    pub(super) fn width(self) -> usize {
        self.power() + if self.has_strengths { 2 + self.receivers } else { 0 }
    }
}

/// A track.
#[derive(Clone, Debug)]
pub(super) struct TrackProblem<'a> {
    pub(super) receivers: &'a [Position],
    pub(super) readings: &'a [EpochReading],
    pub(super) motion: Motion<'a>,
    pub(super) border: Border,
    /// The law of the errors of ranges, and how many independent ranges one is worth.
    pub(super) law: RangeErrorLaw,
    pub(super) worth: f64,
    pub(super) strengths: StrengthErrors,
    /// What is known of the exponent of the law of strengths: its mean and standard deviation.
    pub(super) exponent: [f64; 2],
    pub(super) calibration: Calibration,
    /// The height of the tag that is most likely, and its standard deviation (m).
    pub(super) height_m: [f64; 2],
    pub(super) heights: Heights<'a>,
}

/// A reading seen from a track: from the antenna to the receiver (m), the distance, and what the state's third and fourth entry add
/// to the place of the antenna.
pub(super) struct Sight {
    pub(super) apart: [f64; 3],
    pub(super) distance_m: f64,
    by_rest: [[f64; 2]; 2],
}

impl Sight {
    /// How an error grows with the state, if it grows by `nearer` times the distance with a shorter distance.
    fn by_state(&self, nearer: f64) -> Vector4<f64> {
        let [x, y] = [nearer * self.apart[0], nearer * self.apart[1]];
        let [[x_by_third, x_by_fourth], [y_by_third, y_by_fourth]] = self.by_rest;
        Vector4::new(x, y, x * x_by_third + y * y_by_third, x * x_by_fourth + y * y_by_fourth)
    }
}

impl TrackProblem<'_> {
    /// The height of the tag at an epoch (m).
    pub(super) fn height_m(&self, epoch: usize, border: &DVector<f64>) -> f64 {
        let entries = self.heights.entries(epoch, self.border.height());
        entries.into_iter().map(|(entry, weight)| weight * border[entry]).sum()
    }

    pub(super) fn sight(&self, reading: &EpochReading, at: &TrackPoint) -> Sight {
        let (antenna, by_rest) = self.motion.antenna(&at.states[reading.epoch], reading.after_s, reading.offset);
        let receiver = self.receivers[reading.receiver];
        let apart = [
            receiver.x_m - antenna[0],
            receiver.y_m - antenna[1],
            receiver.z_m - (self.height_m(reading.epoch, &at.border) + reading.up_m),
        ];
        let distance_m = (apart.iter().map(|along| along * along).sum::<f64>() + 1e-12).sqrt();
        Sight { apart, distance_m, by_rest }
    }

    /// How fast strengths fall at a distance (dB/m).
    pub(super) fn db_per_m(&self, distance_m: f64, at: &TrackPoint) -> f64 {
        let nearest = distance_m * distance_m + NEAREST_M * NEAREST_M;
        10.0 * at.border[self.border.exponent()] * distance_m / (std::f64::consts::LN_10 * nearest)
    }

    /// The error of a reading (m, dB).
    fn error(&self, reading: &EpochReading, sight: &Sight, border: &DVector<f64>) -> f64 {
        let at = self.border;
        if reading.is_strength {
            let lost_db = border[at.exponent()] * path_loss(sight.distance_m);
            return reading.value - (border[at.power()] + border[at.offset(reading.receiver)] - lost_db);
        }
        let longer = 1.0 + border[at.scale()];
        reading.value - longer * sight.distance_m - border[at.bias()] - border[at.receiver(reading.receiver)]
    }

    /// The errors of all ranges (m), or of all strengths (dB), each with its receiver.
    pub(super) fn errors(&self, at: &TrackPoint, of_strengths: bool) -> Vec<(usize, f64)> {
        let readings = self.readings.iter().filter(|reading| reading.is_strength == of_strengths);
        let error = |reading: &EpochReading| self.error(reading, &self.sight(reading, at), &at.border);
        readings.map(|reading| (reading.receiver, error(reading))).collect()
    }

    /// What the widths of priors that are chosen add to the logarithm of the marginal likelihood.
    pub(super) fn log_widths(&self) -> f64 {
        let Calibration { bias_m, scale, receiver_bias_m } = self.calibration;
        let of_receivers = self.border.receivers as f64 * libm::log(receiver_bias_m);
        self.motion.log_widths() + self.heights.log_widths() - libm::log(bias_m * scale) - of_receivers
    }

    fn priors(&self) -> impl Iterator<Item = (usize, f64, f64)> {
        let Calibration { bias_m, scale, receiver_bias_m } = self.calibration;
        let border = self.border;
        let of_receivers =
            (0..border.receivers).map(move |receiver| (border.receiver(receiver), 0.0, receiver_bias_m));
        let [height_m, deviation_m] = self.height_m;
        let of_ranges = of_receivers.chain([
            (border.bias(), 0.0, bias_m),
            (border.scale(), 0.0, scale),
            (border.height(), height_m, deviation_m),
        ]);
        let of_law = [(border.power(), POWER_DBM), (border.exponent(), self.exponent)];
        let of_law = of_law.map(|(entry, [mean, deviation])| (entry, mean, deviation));
        let of_offsets = (0..border.receivers).map(move |receiver| (border.offset(receiver), 0.0, RECEIVER_DB));
        of_ranges.chain(of_law.into_iter().chain(of_offsets).filter(move |_| border.has_strengths))
    }
}

/// The loss over a distance relative to a metre, for an exponent of one (dB).
pub(super) fn path_loss(distance_m: f64) -> f64 {
    5.0 * libm::log10((distance_m * distance_m + NEAREST_M * NEAREST_M).max(f64::MIN_POSITIVE))
}

impl Hill for TrackProblem<'_> {
    type Point = TrackPoint;

    fn value(&self, at: &TrackPoint) -> f64 {
        let errors_m = self.errors(at, false).into_iter().map(|(_, error_m)| error_m);
        let mut value = self.worth * self.law.prepared().log_likelihood(errors_m);
        if self.border.has_strengths {
            let errors = self.errors(at, true).into_iter();
            value += self.strengths.worth * errors.map(|(_, db)| self.strengths.log_density(db)).sum::<f64>();
        }
        value += self.motion.value(&at.states, &at.border);
        value += self.heights.value(&at.border, self.border.height());
        for (entry, mean, deviation) in self.priors() {
            value -= 0.5 * ((at.border[entry] - mean) / deviation).powi(2);
        }
        value
    }

    fn system(&self, at: &TrackPoint) -> ChainSystem {
        let mut system = ChainSystem::zeros(at.states.len(), at.border.len());
        let law = self.law.prepared();
        let border = self.border;
        for reading in self.readings {
            let sight = self.sight(reading, at);
            let error = self.error(reading, &sight, &at.border);
            let (apart, distance_m) = (sight.apart, sight.distance_m);
            let heights = self.heights.entries(reading.epoch, border.height());
            let by_heights = |nearer: f64| heights.map(|(entry, weight)| (entry, weight * nearer * apart[2]));
            if reading.is_strength {
                let nearer = -self.db_per_m(distance_m, at) / distance_m;
                let [height, next] = by_heights(nearer);
                let by_border = [
                    (border.power(), -1.0),
                    (border.offset(reading.receiver), -1.0),
                    (border.exponent(), path_loss(distance_m)),
                    height,
                    next,
                ];
                let (weight, slope) = (
                    self.strengths.worth * self.strengths.stiffness(error),
                    self.strengths.worth * self.strengths.by_error(error),
                );
                system.add(reading.epoch, sight.by_state(nearer), None, &by_border, weight, slope);
                continue;
            }
            let density = law.density(error);
            let longer = (1.0 + at.border[border.scale()]) / distance_m;
            let [height, next] = by_heights(longer);
            let by_border = [
                (border.receiver(reading.receiver), -1.0),
                (border.bias(), -1.0),
                (border.scale(), -distance_m),
                height,
                next,
            ];
            let (weight, slope) = (self.worth * density.stiffness, self.worth * density.by_error);
            system.add(reading.epoch, sight.by_state(longer), None, &by_border, weight, slope);
        }
        self.motion.add(&mut system, &at.states, &at.border);
        self.heights.add(&mut system, &at.border, border.height());
        for (entry, mean, deviation) in self.priors() {
            system.add_to_border(entry, entry, deviation.powi(-2));
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
