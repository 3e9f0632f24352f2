//! Whether a robot still comes nearer to its goal.

/// Way without a higher value after which a robot is stuck, as a multiple of the distance from which nodes answer.
const STUCK_REACHES: f64 = 3.0;

/// A higher value counts if it is so much nearer to the level, as a share of what was missing.
const LEAST_GAIN: f64 = 0.005;

/// The highest value of the field so far, and the way since then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Progress {
    best: f64,
    way_m: f64,
}

impl Default for Progress {
    fn default() -> Self {
        Self { best: f64::NEG_INFINITY, way_m: 0.0 }
    }
}

impl Progress {
    /// The robot drives `step_m` on from where the field is `value`, and seeks `level`. Returns whether it is stuck: noise, or a maximum below
    /// the level, holds it. Then a new count begins.
    pub(super) fn is_stuck(&mut self, [value, level]: [f64; 2], step_m: f64, reach_m: f64) -> bool {
        if self.best.is_infinite() || value > self.best + LEAST_GAIN * (level - self.best).abs() {
            *self = Self { best: value, way_m: 0.0 };
            return false;
        }
        self.way_m += step_m;
        let is_stuck = self.way_m > STUCK_REACHES * reach_m;
        if is_stuck {
            *self = Self::default();
        }
        is_stuck
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_robot_is_stuck_when_nothing_was_higher_on_a_long_way() {
        let mut progress = Progress::default();
        let stuck = |progress: &mut Progress, values: &[f64]| {
            values.iter().map(|&value| progress.is_stuck([value, 11.0], 1.0, 1.0)).collect::<Vec<_>>()
        };
        assert_eq!(stuck(&mut progress, &[1.0, 0.5, 0.9, 1.1, 1.0]), [false; 5]);
        assert_eq!(stuck(&mut progress, &[1.0, 1.14, 1.0]), [false, false, true]);
        // It begins again from wherever it is then.
        assert_eq!(stuck(&mut progress, &[0.2, 0.1, 0.1, 0.1, 0.1]), [false, false, false, false, true]);
    }
}
