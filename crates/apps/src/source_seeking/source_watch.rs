//! When a robot that follows the gradient has come to the source.

use std::collections::VecDeque;

use sextant_channel::Position;
use sextant_kernel::SimTime;

use super::local_fit::LocalFit;

/// A direction is known if the gradient along it is so many standard deviations.
const KNOWN: f64 = 2.0;
/// The robot has climbed if the gradient was so many.
const CLIMBED: f64 = 5.0;

/// Watches whether a robot has come to the source, by the gradient of the plane through all readings around it. It has
/// arrived if that was clear on its way, and now
///
/// - the plane is flat: its gradient is no more than two standard deviations; or
/// - the source is behind it: on the way from a place that it left half a turn ago or later, the gradient at that place
///   pointed ahead and now points back, each by more than two standard deviations. That ends circles around a source that
///   is nearer than the robot can turn.
#[derive(Clone, Debug, Default)]
pub(super) struct SourceWatch {
    has_climbed: bool,
    /// Where it was, and the gradient there.
    before: VecDeque<(SimTime, Position, LocalFit)>,
}

impl SourceWatch {
    /// Whether the robot arrives now at `place` on the map (m), where the plane is `plane`. It turns by half a turn in the
    /// time `half_turn_s` (s) at best.
    pub(super) fn arrives(&mut self, plane: LocalFit, place: Position, now: SimTime, half_turn_s: f64) -> bool {
        let steepness = plane.gradient.length_m();
        self.has_climbed |= steepness >= CLIMBED * plane.gradient_sigma;
        let is_flat = steepness <= KNOWN * plane.gradient_sigma;
        self.before.retain(|(time, ..)| now.saturating_since(*time).as_secs_f64() <= half_turn_s);
        let is_behind = self.before.iter().any(|(_, from, ahead)| {
            let way = place - *from;
            let known = |plane: &LocalFit| KNOWN * plane.gradient_sigma * way.length_m();
            ahead.gradient.dot(way) > known(ahead) && plane.gradient.dot(way) < -known(&plane)
        });
        self.before.push_back((now, place, plane));
        self.has_climbed && (is_flat || is_behind)
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::super::local_fit::Degree;
    use super::*;

    /// The plane at x on a way along x.
    fn plane(slope: f64, sigma: f64) -> LocalFit {
        let gradient = Position::new(slope, 0.0, 0.0);
        LocalFit { degree: Degree::Linear, value: 0.0, gradient, gradient_sigma: sigma }
    }

    /// The steps at which a robot arrives that sees these slopes, one a metre and a second.
    fn arrivals(slopes: &[f64], sigma: f64) -> Vec<usize> {
        let mut watch = SourceWatch::default();
        let at = |i: usize| SimTime::ZERO + Duration::from_secs(i as u64);
        let arrives = |&i: &usize| {
            let place = Position::new(i as f64, 0.0, 0.0);
            watch.arrives(plane(slopes[i], sigma), place, at(i), 3.0)
        };
        (0..slopes.len()).filter(arrives).collect()
    }

    #[test]
    fn a_plane_that_is_flat_after_a_climb_is_the_source() {
        // Two standard deviations are 0.2, and five are 0.5.
        assert_eq!(arrivals(&[0.1, 0.3, 0.1, 0.6, 0.3, 0.1], 0.1), [5]);
        assert_eq!(arrivals(&[0.1, 0.3, 0.1, 0.4, 0.0], 0.1), [0; 0], "it has never climbed");
    }

    #[test]
    fn a_gradient_that_points_back_is_the_source() {
        assert_eq!(arrivals(&[0.6, 0.6, -0.3], 0.1), [2]);
        // What was ahead is longer ago than half a turn, and the way since then leads down.
        assert_eq!(arrivals(&[0.5, -0.3], 0.01), [1]);
        assert_eq!(arrivals(&[-0.5, -0.5, -0.4, -0.3], 0.01), [0; 0]);
    }
}
