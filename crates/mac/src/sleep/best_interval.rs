//! The wake-up interval that costs a node the least power.

use std::time::Duration;

/// What the power of a node depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntervalPowers {
    /// Power with the receiver on (W).
    pub receiving_w: f64,
    /// Power while sending (W).
    pub sending_w: f64,
    /// Time with the radio on in a check.
    pub check: Duration,
    /// Mean time from one frame of a node to the next.
    pub between_frames: Duration,
}

/// The interval T that makes a/T + b T least, where a = P_rx t_c is what a check takes, and b T = P_tx T / (2 S) what it takes to wake
/// a receiver once in S: T* = sqrt(a / b) (the trade-off of Polastre, Hill and Culler, SenSys 2004, for senders that stop at
/// half an interval on average).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BestInterval {
    check_j: f64,
    strobing_w_per_s: f64,
}

impl BestInterval {
    /// For a node with these powers.
    #[must_use]
    pub fn new(powers: &IntervalPowers) -> Self {
        let IntervalPowers { receiving_w, sending_w, check, between_frames } = *powers;
        Self {
            check_j: receiving_w * check.as_secs_f64(),
            strobing_w_per_s: sending_w / (2.0 * between_frames.as_secs_f64()),
        }
    }

    /// The best interval (s).
    #[must_use]
    pub fn interval_s(&self) -> f64 {
        (self.check_j / self.strobing_w_per_s).sqrt()
    }

    /// Power for checks and for waking receivers with this interval (W).
    #[must_use]
    pub fn power_w(&self, interval_s: f64) -> f64 {
        self.check_j / interval_s + self.strobing_w_per_s * interval_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_interval_of_a_cc2420_with_two_looks_grows_with_the_root_of_the_time_between_frames() {
        // 3 V, 18.8 and 17.4 mA, 640 us; T* = sqrt(a / b), power 2 sqrt(a b), by hand.
        for (between_s, interval_s, power_uw) in [(10, 0.1176, 614.0), (60, 0.288, 250.6), (600, 0.911, 79.3)] {
            let best = BestInterval::new(&IntervalPowers {
                receiving_w: 3.0 * 18.8e-3,
                sending_w: 3.0 * 17.4e-3,
                check: Duration::from_micros(640),
                between_frames: Duration::from_secs(between_s),
            });
            let found = best.interval_s();
            assert!((found / interval_s - 1.0).abs() < 2e-3, "{found} s");
            assert!((1e6 * best.power_w(found) / power_uw - 1.0).abs() < 2e-3, "{} W", best.power_w(found));
            for other in [0.5, 2.0] {
                assert!((best.power_w(other * found) / best.power_w(found) - 1.25).abs() < 1e-9);
            }
        }
    }
}
