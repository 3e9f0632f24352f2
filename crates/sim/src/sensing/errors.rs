//! The errors of sensors: passages that they miss, and false alarms.

use std::time::Duration;

use sextant_kernel::{NodeId, Seed};

use crate::purpose;
use crate::service::sensed::TargetId;
use crate::world::sensors::TargetSensor;

/// The addresses of the time until a false alarm and of what it names, where passages have their target.
const INTERVAL: u64 = u64::MAX;
const NAME: u64 = u64::MAX - 1;

/// The longest time until a false alarm (s).
const LONGEST_S: f64 = 1e9;

/// The errors of the sensors of targets. Each draw has an address of its own, so that none changes another.
#[derive(Clone, Copy, Debug)]
pub(super) struct SensorErrors {
    sensor: TargetSensor,
    /// Number of targets.
    targets: usize,
    seed: Seed,
}

impl SensorErrors {
    pub(super) fn new(sensor: TargetSensor, targets: usize, seed: Seed) -> Self {
        Self { sensor, targets, seed }
    }

    /// Whether there are missed passages.
    pub(super) fn miss(&self) -> bool {
        self.sensor.miss_probability > 0.0
    }

    /// Whether there are false alarms.
    pub(super) fn raise_alarms(&self) -> bool {
        self.sensor.false_alarms_per_s > 0.0
    }

    /// How long a false alarm lasts.
    pub(super) fn alarm_lasts(&self) -> Duration {
        self.sensor.false_alarm
    }

    /// Whether a node misses a passage of a target: `number` passages were before it.
    pub(super) fn misses(&self, node: NodeId, target: TargetId, number: u64) -> bool {
        let address = [node.0.into(), target.0.into(), number];
        self.seed.uniform(purpose::SENSOR_ERRORS, address) < self.sensor.miss_probability
    }

    /// Time from the false alarm before `number` of a node, or from the start, until this one: exponentially distributed.
    pub(super) fn until_alarm(&self, node: NodeId, number: u64) -> Duration {
        let draw = self.seed.uniform(purpose::SENSOR_ERRORS, [node.0.into(), INTERVAL, number]);
        let seconds = -libm::log1p(-draw) / self.sensor.false_alarms_per_s;
        Duration::from_secs_f64(seconds.min(LONGEST_S))
    }

    /// The target that the false alarm `number` of a node names: each is as likely.
    pub(super) fn named(&self, node: NodeId, number: u64) -> TargetId {
        let draw = self.seed.uniform(purpose::SENSOR_ERRORS, [node.0.into(), NAME, number]);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a number of targets")]
        let index = (draw * self.targets as f64) as usize;
        TargetId::from_index(index.min(self.targets - 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::sensors::TargetSensorConfig;

    fn errors(config: TargetSensorConfig) -> SensorErrors {
        SensorErrors::new(config.try_into().unwrap(), 3, Seed(5))
    }

    #[test]
    fn false_alarms_are_a_poisson_process() {
        // 2000 nodes for an hour at 30 an hour. The standard error of the mean count is √(30 / 2000) = 0.12, and that of
        // its variance about 30 · √(2 / 2000) = 0.95: with four of them, a false failure has odds of 1 to 10 000.
        let errors = errors(TargetSensorConfig { false_alarms_per_h: 30.0, ..TargetSensorConfig::perfect(1.0) });
        let counts: Vec<f64> = (0..2000)
            .map(|node| {
                let (mut time_s, mut number) = (0.0, 0);
                loop {
                    time_s += errors.until_alarm(NodeId(node), number).as_secs_f64();
                    if time_s > 3600.0 {
                        break number as f64;
                    }
                    number += 1;
                }
            })
            .collect();
        let mean = counts.iter().sum::<f64>() / 2000.0;
        let variance = counts.iter().map(|count| (count - mean).powi(2)).sum::<f64>() / 1999.0;
        assert!((mean - 30.0).abs() < 0.48, "mean {mean}");
        assert!((variance - 30.0).abs() < 3.8, "variance {variance}");
    }

    #[test]
    fn each_target_is_named_as_often() {
        let errors = errors(TargetSensorConfig { false_alarms_per_h: 1.0, ..TargetSensorConfig::perfect(1.0) });
        let mut counts = [0_i32; 3];
        for number in 0..9000 {
            counts[errors.named(NodeId(7), number).index()] += 1;
        }
        // The standard deviation is √(9000 · 1/3 · 2/3) = 45.
        assert!(counts.iter().all(|count| (count - 3000).abs() < 180), "{counts:?}");
    }

    #[test]
    fn the_share_of_missed_passages_is_their_probability() {
        for miss_probability in [0.0, 0.3, 0.6] {
            let errors = errors(TargetSensorConfig { miss_probability, ..TargetSensorConfig::perfect(1.0) });
            let passages = (0..100).flat_map(|node| (0..100).map(move |number| (NodeId(node), number)));
            let missed = passages.filter(|&(node, number)| errors.misses(node, TargetId(1), number)).count();
            // The standard deviation is at most 50.
            assert!((missed as f64 - 10_000.0 * miss_probability).abs() < 200.0 * miss_probability.sqrt() + 1e-9);
        }
    }
}
