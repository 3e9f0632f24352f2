//! The law of sliding mode that takes a robot to a level set of a field and along it (Matveev, Teimoori, Savkin 2012,
//! "Method for tracking of environmental level sets by a unicycle-like vehicle", Automatica 48 (9); thesis, chapter 7).
//!
//! A robot with constant speed v turns at the rate u = ±w sgn(S) with S = d' + χ(d - d0), where d is the value of the
//! field D at the robot, d0 the level, w the largest turn rate, and χ(p) = γ p within ±δ, ±γ δ beyond. On S = 0 the
//! value rises at the constant rate γ δ far below the level, and nears it as exp(-γ t) close to it.
//!
//! S = 0 can be reached only where γ δ < v |∇D|: otherwise the robot turns on the spot for ever. The law can be told the
//! steepest climb v |∇D| around it, and then climbs at a share of it.
//!
//! The sign of u keeps the higher field on one hand of the robot. In space there are no two hands: see
//! [`super::steering`].

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

/// On which hand of the robot the field is higher while it follows a level set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum HigherField {
    /// On the left: the robot circles a maximum counterclockwise (Matveev, Teimoori, Savkin 2012).
    Left,
    /// On the right: the robot circles a maximum clockwise (thesis, chapter 7).
    #[default]
    Right,
}

impl HigherField {
    /// Sign of a turn away from the higher field, counterclockwise.
    pub(super) fn away(self) -> f64 {
        match self {
            Self::Left => -1.0,
            Self::Right => 1.0,
        }
    }
}

/// How fast the law climbs far from the level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Climb {
    /// χ saturates at this distance δ from the level.
    Delta(f64),
    /// At this share of the steepest climb that is possible.
    Share(f64),
}

/// What happens if the robot only turns in circles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Patience {
    /// Nothing: the law as it was published.
    Endless,
    /// After two turns in one direction it climbs at half the rate.
    TwoTurns,
}

/// The settings of the law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LevelSet {
    /// The level d0, in the unit of the field.
    pub(super) level: f64,
    /// w (rad/s).
    pub(super) turn_rate_max: f64,
    /// γ (1/s).
    pub(super) gamma_per_s: f64,
    pub(super) climb: Climb,
    /// The sign of S is replaced by S / ε within ±ε, as a share of γ δ; 0 for the sign itself.
    pub(super) boundary_layer: f64,
    pub(super) patience: Patience,
}

/// The law on its way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sliding {
    law: LevelSet,
    /// By how much the climb is reduced because the robot turned in circles.
    patience: f64,
    /// Angle turned since S last changed its sign (rad).
    one_way_rad: f64,
    last_sign: f64,
}

/// Smallest factor that circles can bring the climb down to.
const LEAST_PATIENCE: f64 = 1.0 / 1024.0;

impl Sliding {
    pub(super) fn new(law: LevelSet) -> Self {
        Self { law, patience: 1.0, one_way_rad: 0.0, last_sign: 0.0 }
    }

    /// Begins again: what was learnt elsewhere does not hold here.
    pub(super) fn restart(&mut self) {
        *self = Self::new(self.law);
    }

    /// The rate γ δ of the climb far below the level (1/s), where the steepest one that is possible is `steepest`.
    fn climb_rate(&self, steepest: f64) -> f64 {
        let rate = match self.law.climb {
            Climb::Delta(delta) => self.law.gamma_per_s * delta,
            Climb::Share(share) => share * steepest,
        };
        self.patience * rate
    }

    /// The turn rate (rad/s) for the next `span_s`, away from the side where the field is higher, where the field is
    /// `value` and changes by `rate` (1/s). `steepest` is v |∇D| (1/s), the fastest change that a robot here can see.
    pub(super) fn turn_rate(&mut self, value: f64, rate: f64, steepest: f64, span_s: f64) -> f64 {
        let law = self.law;
        let climb = self.climb_rate(steepest);
        let chi = (law.gamma_per_s * (value - law.level)).clamp(-climb, climb);
        let sliding = rate + chi;
        let layer = law.boundary_layer * climb;
        let sign = if layer > 0.0 {
            (sliding / layer).clamp(-1.0, 1.0)
        } else if sliding > 0.0 {
            1.0
        } else if sliding < 0.0 {
            -1.0
        } else {
            0.0
        };
        let turn_rate = sign * law.turn_rate_max;
        self.watch(sign, turn_rate.abs() * span_s);
        turn_rate
    }

    /// Notices circles.
    fn watch(&mut self, sign: f64, turned_rad: f64) {
        if sign * self.last_sign < 0.0 {
            self.one_way_rad = 0.0;
        }
        self.last_sign = sign;
        self.one_way_rad += turned_rad;
        if self.law.patience == Patience::TwoTurns && self.one_way_rad > 4.0 * PI {
            self.one_way_rad = 0.0;
            self.patience = (0.5 * self.patience).max(LEAST_PATIENCE);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use sextant_channel::Position;
    use sextant_sim::Pose;

    use super::*;

    const SPAN_S: f64 = 0.05;
    const SPEED_M_PER_S: f64 = 1.0;

    /// A bare law: largest turn rate 1 rad/s, γ = 1/s, δ = 0.5.
    fn law(level: f64) -> LevelSet {
        LevelSet {
            level,
            turn_rate_max: 1.0,
            gamma_per_s: 1.0,
            climb: Climb::Delta(0.5),
            boundary_layer: 0.0,
            patience: Patience::Endless,
        }
    }

    /// The poses of a robot for `seconds` in a field that it knows exactly.
    fn drive(
        law: LevelSet,
        higher: HigherField,
        start: Pose,
        seconds: f64,
        field: impl Fn(Position) -> f64,
    ) -> Vec<Pose> {
        let mut sliding = Sliding::new(law);
        let mut poses = vec![start];
        let mut last = field(start.position);
        let mut passed_s = 0.0;
        while passed_s < seconds {
            let pose = poses[poses.len() - 1];
            let value = field(pose.position);
            let rate = (value - last) / SPAN_S;
            last = value;
            let turn_rad = SPAN_S * higher.away() * sliding.turn_rate(value, rate, 0.0, SPAN_S);
            poses.push(pose.after_arc(SPEED_M_PER_S * SPAN_S, turn_rad));
            passed_s += SPAN_S;
        }
        poses
    }

    fn at(x_m: f64, y_m: f64, heading_rad: f64) -> Pose {
        Pose { position: Position::new(x_m, y_m, 0.0), heading_rad }
    }

    proptest! {
        #[test]
        fn far_below_the_level_a_robot_climbs_at_gamma_delta(heading_rad in -3.1..3.1_f64) {
            let poses = drive(law(1e3), HigherField::Right, at(0.0, 0.0, heading_rad), 60.0, |place| place.x_m);
            // It turns round at most once, in 2 pi s, before it slides.
            let [early, late] = [poses[400], poses[1200]].map(|pose| pose.position.x_m);
            let rate = (late - early) / (800.0 * SPAN_S);
            // The heading chatters by one step.
            prop_assert!((rate - 0.5).abs() < 1.0 * SPAN_S, "{}", rate);
        }

        #[test]
        fn a_robot_circles_a_maximum_at_the_level(heading_rad in -3.1..3.1_f64, is_left in any::<bool>()) {
            let higher = if is_left { HigherField::Left } else { HigherField::Right };
            let poses = drive(law(-5.0), higher, at(20.0, 0.0, heading_rad), 120.0, |place| -place.length_m());
            let orbit = &poses[poses.len() - 700..];
            let mut turned_rad = 0.0;
            for two in orbit.windows(2) {
                let [here, next] = [two[0].position, two[1].position];
                let radius_m = here.length_m();
                prop_assert!((radius_m - 5.0).abs() < 2.0 * SPEED_M_PER_S * SPAN_S, "{} m", radius_m);
                turned_rad += here.cross(next).z_m / (radius_m * radius_m);
            }
            // 700 steps of 0.05 m on a circle with a radius of 5 m.
            let expected_rad = if is_left { 7.0 } else { -7.0 };
            prop_assert!((turned_rad - expected_rad).abs() < 0.3, "{} rad", turned_rad);
        }
    }

    #[test]
    fn a_climb_that_is_steeper_than_the_field_ends_in_circles_on_the_spot() {
        // The steepest climb is 0.1, and the law wants 0.5.
        let field = |place: Position| 0.1 * place.x_m;
        let poses = drive(law(1e3), HigherField::Right, at(0.0, 0.0, 0.0), 300.0, field);
        let farthest_m = poses.iter().map(|pose| pose.position.length_m()).fold(0.0, f64::max);
        assert!(farthest_m < 2.01 * SPEED_M_PER_S, "{farthest_m} m");
        // With patience it climbs at an eighth of it, 0.0625: 0.625 m/s along x.
        let patient = LevelSet { patience: Patience::TwoTurns, ..law(1e3) };
        let poses = drive(patient, HigherField::Right, at(0.0, 0.0, 0.0), 300.0, field);
        let x_m = poses[poses.len() - 1].position.x_m;
        assert!((140.0..190.0).contains(&x_m), "{x_m} m");
    }

    #[test]
    fn a_share_of_the_steepest_climb_is_climbed() {
        let mut sliding = Sliding::new(LevelSet { climb: Climb::Share(0.6), ..law(1e3) });
        // The steepest climb is 2: the law wants 1.2.
        assert!((sliding.turn_rate(0.0, 1.19, 2.0, SPAN_S) + 1.0).abs() < 1e-12);
        assert!((sliding.turn_rate(0.0, 1.21, 2.0, SPAN_S) - 1.0).abs() < 1e-12);
        // Within a boundary layer of half of it, the turn rate is proportional.
        let soft = LevelSet { climb: Climb::Share(0.6), boundary_layer: 0.5, ..law(1e3) };
        assert!((Sliding::new(soft).turn_rate(0.0, 1.35, 2.0, SPAN_S) - 0.25).abs() < 1e-12);
    }
}
