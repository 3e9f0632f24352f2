//! What the robot of a survey is doing.

use sextant_channel::Position;
use sextant_sim::Ending;

use super::trip::Trip;

/// What the robot is doing.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Task {
    /// Nobody was heard yet: a square spiral. Its side, and where that began.
    Search { side: u32, from: Position },
    /// Along y.
    Lane,
    /// Over to the next lane; where it left the last.
    Shift { from: Position },
    /// Back along a lane from which there was no way over, in search of one.
    Retreat,
    /// To the lane at `x_m` that an obstacle cut short.
    Behind { x_m: f64, from: Position },
    /// Up or down to another layer.
    Climb { to_z_m: f64 },
    /// Elsewhere.
    Travel(Trip),
    /// Over.
    Finish(Ending),
}

/// What comes of a task in a situation.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Step {
    /// The robot drives there.
    Drive(Position),
    /// Another task begins.
    Begin(Task),
    /// The sweep is over.
    EndSweep,
}
