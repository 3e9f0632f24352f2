//! What steers a robot where nothing is in the way.

use sextant_channel::Position;

use super::field_estimate::FieldEstimate;
use super::level_set::{HigherField, Sliding};
use super::moving_frame::MovingFrame;
use super::rate::Rate;
use super::settings::{Guidance, Torsion};

/// Time constant in which the steepest climb is averaged (s).
const STEEPEST_S: f64 = 1.0;

/// What steers a robot where nothing is in the way.
#[derive(Debug)]
pub(super) enum Steering {
    LevelSet(Box<LevelSetSteering>),
    Gradient { gain_per_s: f64, plane_reach_m: Option<f64> },
}

/// The law of a level set with what it needs to know.
#[derive(Debug)]
pub(super) struct LevelSetSteering {
    sliding: Sliding,
    higher: HigherField,
    rate: Rate,
    /// The steepest climb around the robot (1/s), averaged.
    steepest: Option<f64>,
    /// Of a robot that moves in space.
    pub(super) space: Option<SpatialCourse>,
}

/// The course of a robot that moves in space: the law bends its path in the plane of `frame`, to the side where the field
/// is lower or higher, and the torsion turns that plane, so that it comes to hold every direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpatialCourse {
    pub(super) torsion_per_m: f64,
    pub(super) frame: MovingFrame,
}

impl Steering {
    /// Of a robot that moves at `speed_m_per_s`.
    pub(super) fn new(guidance: &Guidance, speed_m_per_s: f64) -> Self {
        match *guidance {
            Guidance::Gradient { gain_per_s, plane_reach_m } => Self::Gradient { gain_per_s, plane_reach_m },
            Guidance::LevelSet { law, rate, higher, torsion } => Self::LevelSet(Box::new(LevelSetSteering {
                sliding: Sliding::new(law),
                higher,
                rate: Rate::new(rate),
                steepest: None,
                space: torsion.map(|torsion| SpatialCourse {
                    torsion_per_m: match torsion {
                        Torsion::LikeCurvature => law.turn_rate_max / speed_m_per_s,
                        Torsion::PerMetre(torsion_per_m) => torsion_per_m,
                    },
                    frame: MovingFrame::level(0.0),
                }),
            })),
        }
    }

    pub(super) fn is_spatial(&self) -> bool {
        matches!(self, Self::LevelSet(steering) if steering.space.is_some())
    }

    /// The robot looks level into `heading_rad` after something else than this has steered it.
    pub(super) fn take_over(&mut self, heading_rad: f64) {
        if let Self::LevelSet(steering) = self {
            steering.rate.clear();
            if let Some(course) = &mut steering.space {
                course.frame = MovingFrame::level(heading_rad);
            }
        }
    }

    /// The robot seeks something else from now on.
    pub(super) fn restart(&mut self) {
        if let Self::LevelSet(steering) = self {
            steering.sliding.restart();
        }
    }
}

impl LevelSetSteering {
    /// The turn rate (rad/s) for the next `span_s`: counterclockwise, or in space to the normal of the frame. The field is
    /// like this, and `slope` is its gradient by odometry (1/m), if it is known.
    pub(super) fn turn_rate(
        &mut self,
        time_s: f64,
        field: &FieldEstimate,
        slope: Option<Position>,
        speed_m_per_s: f64,
        span_s: f64,
    ) -> f64 {
        let now = speed_m_per_s * slope.map_or(0.0, Position::length_m);
        let keep = libm::exp(-span_s / STEEPEST_S);
        let steepest = self.steepest.map_or(now, |before| keep * before + (1.0 - keep) * now);
        self.steepest = Some(steepest);
        let Some(rate) = self.rate.sample(time_s, field.smooth) else { return 0.0 };
        let away = match &self.space {
            None => self.higher.away(),
            Some(course) if slope.is_some_and(|slope| slope.dot(course.frame.normal) > 0.0) => -1.0,
            Some(_) => 1.0,
        };
        away * self.sliding.turn_rate(field.smooth, rate, steepest, span_s)
    }
}

#[cfg(test)]
mod tests {
    use super::super::level_set::{Climb, LevelSet, Patience};
    use super::super::rate::RateConfig;
    use super::*;

    const SPAN_S: f64 = 0.1;
    const SPEED_M_PER_S: f64 = 0.5;

    /// The places of a robot in space in the field -r, which it knows exactly, with the level -2.
    fn dive(start: Position, heading_rad: f64, seconds: f64) -> Vec<Position> {
        let law = LevelSet {
            level: -2.0,
            turn_rate_max: 1.0,
            gamma_per_s: 1.0,
            climb: Climb::Share(0.7),
            boundary_layer: 0.5,
            patience: Patience::TwoTurns,
        };
        let guidance = Guidance::LevelSet {
            law,
            rate: RateConfig::LeastSquares { samples: 5 },
            higher: HigherField::Right,
            torsion: Some(Torsion::LikeCurvature),
        };
        let mut steering = Steering::new(&guidance, SPEED_M_PER_S);
        steering.take_over(heading_rad);
        let Steering::LevelSet(mut steering) = steering else { unreachable!("the law of a level set") };
        let mut places = vec![start];
        let mut time_s = 0.0;
        while time_s < seconds {
            let place = places[places.len() - 1];
            let value = -place.length_m();
            let slope = place * (1.0 / value);
            let field = FieldEstimate { value, smooth: value, gradient: Some(slope) };
            let turn_rate = steering.turn_rate(time_s, &field, Some(slope), SPEED_M_PER_S, SPAN_S);
            let course = steering.space.as_mut().expect("a course in space");
            let step = course.frame.advance(SPEED_M_PER_S * SPAN_S, turn_rate / SPEED_M_PER_S, course.torsion_per_m);
            places.push(place + step);
            time_s += SPAN_S;
        }
        places
    }

    #[test]
    fn a_robot_in_space_reaches_the_level_from_all_sides_and_stays_there() {
        for start in [[10.0, 0.0, 0.0], [0.0, 0.0, -10.0], [6.0, 0.0, -8.0], [0.0, -6.0, 8.0]] {
            for heading_rad in [-2.0, 0.0, 1.0, 3.0] {
                let places = dive(start.into(), heading_rad, 120.0);
                let reached = places.iter().position(|place| place.length_m() < 2.1).expect("it reaches the level");
                // 8 m at 0.7 of 0.5 m/s are 23 s, and a turn in space.
                assert!((16.0..45.0).contains(&(reached as f64 * SPAN_S)), "{start:?}, {heading_rad}: {reached}");
                let late = &places[900..];
                assert!(late.iter().all(|place| (1.0..3.5).contains(&place.length_m())), "{start:?}, {heading_rad}");
            }
        }
    }
}
