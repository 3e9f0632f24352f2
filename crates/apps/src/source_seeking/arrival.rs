//! When a robot has arrived at a level.

use sextant_kernel::SimTime;

use super::goal::Level;

/// Watches whether a robot has arrived at a level.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ArrivalWatch {
    /// Since when the field is within the tolerance of the level.
    within_since: Option<SimTime>,
    /// After an arrival, until the field has fallen well below the level.
    is_there: bool,
}

impl ArrivalWatch {
    /// Whether the robot arrives now, where the field is `value`.
    pub(super) fn arrives(&mut self, level: Level, value: f64, now: SimTime) -> bool {
        let Level { value: level, tolerance, hold } = level;
        if self.is_there {
            self.is_there = value >= level - 2.0 * tolerance;
            return false;
        }
        let is_within = if hold.is_zero() { value >= level - tolerance } else { (value - level).abs() <= tolerance };
        if !is_within {
            self.within_since = None;
            return false;
        }
        let since = *self.within_since.get_or_insert(now);
        self.is_there = now.saturating_since(since) >= hold;
        self.is_there
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn arrivals(hold: Duration, values: &[f64]) -> Vec<usize> {
        let level = Level { value: 9.0, tolerance: 0.1, hold };
        let mut watch = ArrivalWatch::default();
        let at = |i: usize| SimTime::ZERO + Duration::from_secs(i as u64);
        (0..values.len()).filter(|&i| watch.arrives(level, values[i], at(i))).collect()
    }

    #[test]
    fn a_crossing_is_one_arrival_until_the_field_has_fallen() {
        let values = [8.0, 8.95, 9.3, 8.85, 9.1, 8.7, 8.95];
        assert_eq!(arrivals(Duration::ZERO, &values), [1, 6]);
    }

    #[test]
    fn a_robot_that_runs_past_the_level_has_not_held_it() {
        assert_eq!(arrivals(Duration::from_secs(2), &[8.95, 9.0, 9.2, 9.05, 9.0, 8.95, 9.0]), [5]);
    }
}
