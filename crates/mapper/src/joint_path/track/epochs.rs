//! Readings of a tag by epoch: those of about one moment.

use sextant_channel::Position;
use sextant_kernel::SimTime;

use super::reading::{OnRobot, TagReading, TagValue};
use crate::joint_path::odometry::{Leg, legs};
use crate::numerics::median;

/// Readings within this time are one epoch (s).
const EPOCH_S: f64 = 0.25;

/// A reading at one of the times of a track.
#[derive(Clone, Copy, Debug)]
pub(super) struct EpochReading {
    pub(super) epoch: usize,
    pub(super) receiver: usize,
    pub(super) is_strength: bool,
    /// How much later than the time of the epoch it was measured (s).
    pub(super) after_s: f64,
    /// From the robot at the epoch to the antenna (m), in the frame of odometry.
    pub(super) offset: [f64; 2],
    /// How much higher the antenna is than the robot (m).
    pub(super) up_m: f64,
    /// The range (m) or the strength (dBm).
    pub(super) value: f64,
}

/// The readings of a tag by epoch: of those of one series the median.
#[derive(Clone, Debug, Default)]
pub(super) struct Epochs {
    /// Middle times (s), and as instants.
    pub(super) times_s: Vec<f64>,
    pub(super) times: Vec<SimTime>,
    /// Where odometry has the robot (m); none without odometry.
    pub(super) believed: Vec<Position>,
    pub(super) readings: Vec<EpochReading>,
    /// Ranges and strengths of which these are the medians.
    pub(super) measured: [usize; 2],
}

impl Epochs {
    pub(super) fn of(samples: &[TagReading]) -> Self {
        let mut samples = samples.to_vec();
        samples.sort_by_key(|sample| sample.time);
        let second = |sample: &TagReading| sample.time.as_secs_f64();
        let strengths = samples.iter().filter(|sample| matches!(sample.value, TagValue::Strength(_))).count();
        let mut found = Self { measured: [samples.len() - strengths, strengths], ..Self::default() };
        let mut rest = samples.as_slice();
        while let Some(first) = rest.first() {
            let length = rest.partition_point(|sample| second(sample) < second(first) + EPOCH_S).max(1);
            let (epoch, after) = rest.split_at(length);
            rest = after;
            let time_s = epoch.iter().map(second).sum::<f64>() / epoch.len() as f64;
            let number = found.times_s.len();
            let believed = epoch[epoch.len() / 2].on_robot.map(|on_robot| on_robot.believed);
            let mut by_series = epoch.to_vec();
            by_series.sort_by_key(TagReading::series);
            for series in by_series.chunk_by(|one, other| one.series() == other.series()) {
                let count = series.len() as f64;
                let mean_s = series.iter().map(second).sum::<f64>() / count;
                let away = |on_robot: OnRobot| {
                    on_robot.mounting.arm + (on_robot.believed - believed.unwrap_or(on_robot.believed))
                };
                let offsets = series.iter().filter_map(|sample| sample.on_robot).map(away);
                let offset = offsets.fold(Position::ORIGIN, |sum, offset| sum + offset) * (1.0 / count);
                found.readings.push(EpochReading {
                    epoch: number,
                    receiver: series[0].receiver,
                    is_strength: matches!(series[0].value, TagValue::Strength(_)),
                    after_s: mean_s - time_s,
                    offset: [offset.x_m, offset.y_m],
                    up_m: offset.z_m,
                    value: median(&mut series.iter().map(TagReading::number).collect::<Vec<_>>()),
                });
            }
            found.times_s.push(time_s);
            found.times.push(epoch[epoch.len() / 2].time);
            found.believed.extend(believed);
        }
        found
    }

    /// Times from each epoch to the next (s).
    pub(super) fn steps_s(&self) -> Vec<f64> {
        self.times_s.windows(2).map(|pair| (pair[1] - pair[0]).max(1e-3)).collect()
    }

    /// The legs of odometry from each epoch to the next.
    pub(super) fn legs(&self) -> Vec<Leg> {
        legs(self.believed.iter().map(|place| ([place.x_m, place.y_m], false)))
    }
}
