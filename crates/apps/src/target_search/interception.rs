//! Where and when a robot can meet a target whose way is predicted.

use std::time::Duration;

use sextant_channel::Position;

/// A robot that goes to meet a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pursuit {
    /// Where the robot is (m).
    pub start: Position,
    /// Its speed (m/s).
    pub speed_m_per_s: f64,
    /// It meets the target at this distance (m).
    pub reach_m: f64,
    /// It may take this long.
    pub horizon: Duration,
    /// The prediction is looked at this often. Not zero. A meeting that is possible for a shorter time may be missed.
    pub scan: Duration,
}

/// A meeting of a robot and a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Meeting {
    /// Time until then.
    pub after: Duration,
    /// Where the target will be (m).
    pub place: Position,
}

impl Pursuit {
    /// The earliest meeting with a target that is at `target(t)` after t, if the robot goes straight to it; `None` if
    /// there is none within the horizon.
    pub(crate) fn earliest(&self, target: impl Fn(Duration) -> Position) -> Option<Meeting> {
        let meets = |after: Duration| {
            let place = target(after);
            let way_m = self.speed_m_per_s * after.as_secs_f64() + self.reach_m;
            (place.distance_m(self.start) <= way_m).then_some(Meeting { after, place })
        };
        let mut earlier = Duration::ZERO;
        let mut meeting = meets(earlier);
        while meeting.is_none() && earlier < self.horizon {
            let later = earlier.saturating_add(self.scan).min(self.horizon);
            meeting = meets(later);
            if meeting.is_none() {
                earlier = later;
            }
        }
        let mut meeting = meeting?;
        while meeting.after.saturating_sub(earlier) > Duration::from_nanos(1) {
            let middle = earlier + (meeting.after - earlier) / 2;
            match meets(middle) {
                Some(sooner) => meeting = sooner,
                None => earlier = middle,
            }
        }
        Some(meeting)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const PURSUIT: Pursuit = Pursuit {
        start: Position::ORIGIN,
        speed_m_per_s: 2.0,
        reach_m: 0.5,
        horizon: Duration::from_secs(100),
        scan: Duration::from_millis(50),
    };

    /// The least t ≥ 0 with |p + w t| = v t + r: a quadratic equation in t.
    fn straight_line_s(p: Position, w: Position, v: f64, r: f64) -> Option<f64> {
        if p.length_m() <= r {
            return Some(0.0);
        }
        let (a, b, c) = (w.dot(w) - v * v, p.dot(w) - v * r, p.dot(p) - r * r);
        let root = (b * b - a * c).sqrt();
        [(-b - root) / a, (-b + root) / a].into_iter().filter(|t| *t >= 0.0).min_by(f64::total_cmp)
    }

    proptest! {
        #[test]
        fn a_target_on_a_straight_line_is_met_when_the_quadratic_equation_says(
            x in -40.0..40.0_f64, y in -40.0..40.0_f64, vx in -3.0..3.0_f64, vy in -3.0..3.0_f64,
        ) {
            let (p, w) = (Position::new(x, y, 0.0), Position::new(vx, vy, 0.0));
            let meeting = PURSUIT.earliest(|after| p + w * after.as_secs_f64());
            let expected = straight_line_s(p, w, PURSUIT.speed_m_per_s, PURSUIT.reach_m).filter(|&t| t <= 100.0);
            match (meeting, expected) {
                (Some(meeting), Some(expected)) => {
                    prop_assert!((meeting.after.as_secs_f64() - expected).abs() < 1e-6, "{meeting:?} for {expected}");
                    prop_assert!(meeting.place.distance_m(p + w * expected) < 1e-5);
                }
                (None, None) => {}
                // The line passes the robot's reach for less than a scan, or the horizon is met within rounding.
                (found, expected) => {
                    let passes_s = straight_line_s(p, w, PURSUIT.speed_m_per_s, PURSUIT.reach_m + 0.05);
                    let grazes = w.length_m() >= PURSUIT.speed_m_per_s && passes_s.is_some();
                    prop_assert!(found.is_none() && (grazes || expected > Some(99.9)), "{found:?} for {expected:?}");
                }
            }
        }
    }

    #[test]
    fn a_faster_target_that_goes_away_is_not_met() {
        let away = |after: Duration| Position::new(10.0 + 2.5 * after.as_secs_f64(), 0.0, 0.0);
        assert_eq!(PURSUIT.earliest(away), None);
        let slow = |after: Duration| Position::new(10.0 + 1.99 * after.as_secs_f64(), 0.0, 0.0);
        assert_eq!(PURSUIT.earliest(slow), None, "only after 950 s");
    }

    #[test]
    fn a_target_that_comes_back_is_met_where_it_comes_near() {
        // Away to x = 40 at 4 m/s and back: it passes the robot on its way back, 8 m before its start.
        let there_and_back = |after: Duration| {
            let t = after.as_secs_f64();
            Position::new(10.0 + if t < 7.5 { 4.0 * t } else { 60.0 - 4.0 * t }, 0.0, 0.0)
        };
        let meeting = PURSUIT.earliest(there_and_back).expect("a meeting");
        // 70 - 4 t = 2 t + 0.5
        assert!((meeting.after.as_secs_f64() - 69.5 / 6.0).abs() < 1e-6, "{meeting:?}");
    }

    #[test]
    fn a_target_within_reach_is_met_at_once() {
        let here = Position::new(0.3, 0.4, 0.0);
        assert_eq!(PURSUIT.earliest(|_| here), Some(Meeting { after: Duration::ZERO, place: here }));
    }
}
