//! The random waypoint model, from its stationary state on.

use serde::{Deserialize, Serialize};
use sextant_channel::Position;
use sextant_kernel::{NodeId, Seed, SettingError, SimTime};
use std::time::Duration;

use crate::purpose;
use crate::station::{LONGEST_S, time_of};
use crate::world::target::{LEAST_LEG_M, Leg};

/// The random waypoint model as written in a scenario: a node goes straight to a place that is uniform in a rectangle, at a
/// speed that is uniform between two, waits, and goes on. It starts in the stationary state (Navidi and Camp 2004), so that
/// its speed does not fall at first. Obstacles do not stop it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RandomWaypointConfig {
    /// The smallest corner of the rectangle (m).
    pub min_m: [f64; 2],
    /// The largest corner (m).
    pub max_m: [f64; 2],
    /// Least and greatest speed (m/s). The least is above 0, because slow legs take ever longer otherwise.
    pub speed_m_per_s: [f64; 2],
    /// How long it waits at each place (s).
    #[serde(default)]
    pub pause_s: f64,
    /// Its height (m).
    #[serde(default)]
    pub height_m: f64,
}

/// A node that wanders.
#[derive(Clone, Debug)]
pub(super) struct Wanderer {
    config: RandomWaypointConfig,
    node: NodeId,
    seed: Seed,
    start: Position,
    /// The rest of the first leg or of the first wait.
    first: Option<(Position, Duration)>,
    waits: bool,
    legs: u64,
}

/// The kinds of draws.
const PLACE: u64 = 0;
const SPEED: u64 = 2;
const FIRST: u64 = 3;

impl RandomWaypointConfig {
    pub(super) fn check(&self) -> Result<(), SettingError> {
        let Self { min_m, max_m, speed_m_per_s: [slowest, fastest], pause_s, height_m } = *self;
        for axis in 0..2 {
            SettingError::finite("min_m", min_m[axis])?;
            if !(max_m[axis] - min_m[axis] >= LEAST_LEG_M && max_m[axis].is_finite()) {
                return Err(SettingError::new(
                    format!("max_m[{axis}]"),
                    max_m[axis],
                    format!("at least {LEAST_LEG_M} m above {}, as `min_m`", min_m[axis]),
                ));
            }
        }
        let diagonal_m = libm::hypot(max_m[0] - min_m[0], max_m[1] - min_m[1]);
        SettingError::in_range("speed_m_per_s[0]", slowest, (diagonal_m / LONGEST_S).max(1e-3), 1e3)?;
        SettingError::in_range("speed_m_per_s[1]", fastest, slowest, 1e3)?;
        SettingError::in_range("pause_s", pause_s, 0.0, 1e6)?;
        SettingError::finite("height_m", height_m).map(drop)
    }

    /// Mean length of a leg (m): the mean distance of two places uniform in a rectangle (Ghosh 1951).
    fn mean_leg_m(&self) -> f64 {
        let [a, b] = [0, 1].map(|axis| self.max_m[axis] - self.min_m[axis]);
        // The mean along a line: in the sum, terms of a thin rectangle would cancel out but for their rounding.
        if a.min(b) < 1e-3 * a.max(b) {
            return a.max(b) / 3.0;
        }
        let d = libm::hypot(a, b);
        let corner =
            (a.powi(3) / (b * b) + b.powi(3) / (a * a) + d * (3.0 - (a / b).powi(2) - (b / a).powi(2))) / 15.0;
        corner + (b * b / a * libm::acosh(d / b) + a * a / b * libm::acosh(d / a)) / 6.0
    }

    /// Mean time of a leg (s).
    fn mean_leg_s(&self) -> f64 {
        let [slowest, fastest] = self.speed_m_per_s;
        let per_metre =
            if fastest > slowest { libm::log(fastest / slowest) / (fastest - slowest) } else { 1.0 / slowest };
        self.mean_leg_m() * per_metre
    }
}

impl Wanderer {
    pub(super) fn new(config: RandomWaypointConfig, node: NodeId, seed: Seed) -> Self {
        let mut wanderer = Self { config, node, seed, start: Position::ORIGIN, first: None, waits: false, legs: 0 };
        let draw = |kind: u64| wanderer.draw(0, FIRST + kind);
        let pause_s = config.pause_s;
        if draw(0) * (pause_s + config.mean_leg_s()) < pause_s {
            let start = wanderer.place_of(0, FIRST + 1);
            (wanderer.start, wanderer.first) = (start, Some((start, Duration::from_secs_f64(pause_s * draw(3)))));
            return wanderer;
        }
        // A leg is met with a probability in proportion to its length, and at a speed in proportion to its inverse.
        let longest_m = libm::hypot(config.max_m[0] - config.min_m[0], config.max_m[1] - config.min_m[1]);
        let mut tries = 0;
        let (from, to) = loop {
            let at = |kind: u64| wanderer.place_of(tries, FIRST + 4 + kind);
            let (from, to) = (at(0), at(2));
            if wanderer.draw(tries, FIRST + 8) * longest_m < from.distance_m(to) {
                break (from, to);
            }
            tries += 1;
        };
        let [slowest, fastest] = config.speed_m_per_s;
        let speed = slowest * libm::pow(fastest / slowest, draw(9));
        let start = from + (to - from) * draw(10);
        (wanderer.start, wanderer.first) = (start, Some((to, time_of(start.distance_m(to), speed))));
        wanderer.waits = pause_s > 0.0;
        wanderer
    }

    pub(super) fn start(&self) -> Position {
        self.start
    }

    fn draw(&self, number: u64, kind: u64) -> f64 {
        self.seed.uniform(purpose::NODE_MOTION, [self.node.0.into(), number, kind])
    }

    /// The place that two kinds of draws from `kind` on say.
    fn place_of(&self, number: u64, kind: u64) -> Position {
        let RandomWaypointConfig { min_m, max_m, height_m, .. } = self.config;
        let along = |axis: usize| min_m[axis] + (max_m[axis] - min_m[axis]) * self.draw(number, kind + axis as u64);
        Position::new(along(0), along(1), height_m)
    }

    /// The next leg, or wait.
    pub(super) fn next_leg(&mut self, from: Position, start: SimTime) -> Leg {
        if let Some((to, span)) = self.first.take() {
            return Leg { from, to, start, end: start + span };
        }
        if std::mem::take(&mut self.waits) {
            return Leg { from, to: from, start, end: start + Duration::from_secs_f64(self.config.pause_s) };
        }
        self.legs += 1;
        let [slowest, fastest] = self.config.speed_m_per_s;
        let speed = slowest + (fastest - slowest) * self.draw(self.legs, SPEED);
        let to = self.place_of(self.legs, PLACE);
        self.waits = self.config.pause_s > 0.0;
        Leg { from, to, start, end: start + time_of(from.distance_m(to), speed) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: RandomWaypointConfig = RandomWaypointConfig {
        min_m: [0.0, 0.0],
        max_m: [1.0, 1.0],
        speed_m_per_s: [0.5, 2.0],
        pause_s: 0.0,
        height_m: 0.0,
    };

    /// Where each of many nodes is at a time (s), and its speed (m/s).
    fn states(config: RandomWaypointConfig, nodes: u32, t_s: f64) -> Vec<(Position, f64)> {
        let time = SimTime::ZERO + Duration::from_secs_f64(t_s);
        let state = |node: u32| {
            let mut wanderer = Wanderer::new(config, NodeId(node), Seed(3));
            let (mut place, mut now) = (wanderer.start(), SimTime::ZERO);
            loop {
                let leg = wanderer.next_leg(place, now);
                if leg.end > time {
                    let speed = leg.from.distance_m(leg.to) / (leg.end - leg.start).as_secs_f64();
                    return (leg.at(time), speed);
                }
                (place, now) = (leg.to, leg.end);
            }
        };
        (0..nodes).map(state).collect()
    }

    #[test]
    fn the_mean_speed_over_time_is_that_of_the_stationary_state_from_the_start_on() {
        // (v2 - v1) / ln(v2 / v1), not 1.25.
        let expected = 1.5 / 4.0_f64.ln();
        assert!((expected - 1.0820).abs() < 1e-4);
        assert!((UNIT.mean_leg_m() - 0.5214).abs() < 1e-4);
        for t_s in [0.0, 0.3, 20.0] {
            let speeds = states(UNIT, 20_000, t_s);
            let mean = speeds.iter().map(|(_, speed)| speed).sum::<f64>() / 20_000.0;
            // The standard deviation is 0.43: five standard errors.
            assert!((mean - expected).abs() < 0.0155, "{t_s}: {mean}");
        }
    }

    #[test]
    fn the_density_is_the_same_at_the_start_and_later_and_greatest_in_the_middle() {
        let waiting = RandomWaypointConfig { pause_s: 0.4, ..UNIT };
        let is_in = |place: Position, half: f64| (place.x_m - 0.5).abs() < half && (place.y_m - 0.5).abs() < half;
        for config in [UNIT, waiting] {
            let share = |t_s: f64, half: f64| {
                let places = states(config, 20_000, t_s);
                places.iter().filter(|(place, _)| is_in(*place, half)).count() as f64 / 20_000.0
            };
            for half in [0.1, 0.25, 0.4] {
                let [first, later] = [share(0.0, half), share(30.0, half)];
                // Seven standard errors of the difference of two shares: 7 sqrt(2 0.25 / 20 000).
                assert!((first - later).abs() < 0.035, "{half}: {first} {later}");
            }
        }
        // Without pauses: 36 (1/4 - x²) (1/4 - y²) about the middle, which is exact within a few percent (Bettstetter and others 2003).
        let middle =
            states(UNIT, 20_000, 0.0).iter().filter(|(place, _)| is_in(*place, 0.25)).count() as f64 / 20_000.0;
        let approximate = 36.0 * (0.125 - 2.0 * 0.25_f64.powi(3) / 3.0_f64).powi(2);
        assert!((approximate - 0.4727).abs() < 1e-3);
        assert!((middle - approximate).abs() < 0.025, "{middle} {approximate}");
    }

    #[test]
    fn the_mean_leg_of_a_thin_rectangle_is_that_of_a_line() {
        for thin_m in [1e-3, 0.1, 0.2] {
            let mean_m = RandomWaypointConfig { max_m: [150.0, thin_m], ..UNIT }.mean_leg_m();
            assert!((mean_m - 50.0).abs() < 1e-3, "{thin_m}: {mean_m}");
        }
    }

    #[test]
    fn rectangles_without_room_and_legs_that_never_end_are_refused() {
        let key = |config: RandomWaypointConfig| config.check().map_err(|error| error.key).unwrap_err();
        assert_eq!(key(RandomWaypointConfig { max_m: [1.0, 1e-4], ..UNIT }), "max_m[1]");
        assert_eq!(key(RandomWaypointConfig { max_m: [1e9, 1.0], ..UNIT }), "speed_m_per_s[0]");
    }

    #[test]
    fn a_speed_of_zero_is_refused() {
        let refused = |speed_m_per_s| RandomWaypointConfig { speed_m_per_s, ..UNIT }.check().is_err();
        assert!(refused([0.0, 2.0]) && refused([2.0, 1.0]) && !refused([1.0, 1.0]));
    }
}
