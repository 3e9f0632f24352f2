//! The current task of a survey robot.

use sextant_channel::Position;
use sextant_sim::Ending;

use super::trip::Trip;

/// The current task of the robot.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum SurveyTask {
    /// Searches in a square spiral, because no node was heard yet. Number of the current side, and where it began.
    Search { side: u32, from: Position },
    /// Drives along a lane.
    Lane,
    /// Drives over to the next lane, from where it left the last one.
    Shift { from: Position },
    /// Drives back along a lane to find a way over to the next one.
    Retreat,
    /// Drives to the lane at `x_m` that an obstacle cut short.
    Behind { x_m: f64, from: Position },
    /// Climbs to another layer.
    Climb { to_z_m: f64 },
    /// Travels to a place off the lanes.
    Travel(Trip),
    /// Ends the survey.
    Finish(Ending),
}

/// What a task decides.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum SurveyStep {
    /// Drive to this place.
    Drive(Position),
    /// Begin another task.
    Begin(SurveyTask),
    /// End the sweep.
    EndSweep,
}
