//! What steers a robot where nothing is in the way.

use super::field_estimate::FieldEstimate;
use super::level_set::Sliding;
use super::moving_frame::MovingFrame;
use super::rate::Rate;
use super::settings::Guidance;

/// Time constant in which the steepest climb is averaged (s).
const STEEPEST_S: f64 = 1.0;

/// What steers a robot where nothing is in the way.
#[derive(Debug)]
pub(super) enum Steering {
    LevelSet(Box<LevelSetSteering>),
    Gradient { gain_per_s: f64 },
}

/// The law of a level set with what it needs to know.
#[derive(Debug)]
pub(super) struct LevelSetSteering {
    sliding: Sliding,
    rate: Rate,
    /// The steepest climb around the robot (1/s), averaged.
    steepest: Option<f64>,
    /// Of a robot that moves in space.
    pub(super) space: Option<SpatialCourse>,
}

/// The course of a robot that moves in space.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpatialCourse {
    pub(super) torsion_per_m: f64,
    pub(super) frame: MovingFrame,
}

impl Steering {
    pub(super) fn new(guidance: &Guidance) -> Self {
        match *guidance {
            Guidance::Gradient { gain_per_s } => Self::Gradient { gain_per_s },
            Guidance::LevelSet { law, rate, torsion_per_m } => Self::LevelSet(Box::new(LevelSetSteering {
                sliding: Sliding::new(law),
                rate: Rate::new(rate),
                steepest: None,
                space: torsion_per_m
                    .map(|torsion_per_m| SpatialCourse { torsion_per_m, frame: MovingFrame::level(0.0) }),
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
    /// The turn rate (rad/s) for the next `span_s`, where the field is like this. The robot moves at `map_speed_per_s` on the
    /// map.
    pub(super) fn turn_rate(&mut self, time_s: f64, field: &FieldEstimate, map_speed_per_s: f64, span_s: f64) -> f64 {
        let now = map_speed_per_s * field.slope_per_m.unwrap_or(0.0);
        let keep = libm::exp(-span_s / STEEPEST_S);
        let steepest = self.steepest.map_or(now, |before| keep * before + (1.0 - keep) * now);
        self.steepest = Some(steepest);
        let rate = self.rate.sample(time_s, field.smooth);
        rate.map_or(0.0, |rate| self.sliding.turn_rate(field.smooth, rate, steepest, span_s))
    }
}
