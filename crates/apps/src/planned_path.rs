//! What a robot does on a path that is planned before the start.

use sextant_channel::Position;
use sextant_kernel::SimTime;
use sextant_sim::{CommandOutcome, Controller, RobotCommand, Situation};

use crate::surroundings::Surroundings;

/// A part of a planned path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathPart {
    /// The robot drives straight.
    Drive {
        /// From here (m).
        from: Position,
        /// To there (m).
        to: Position,
    },
    /// The robot stops here and listens (m).
    Stop(Position),
}

/// Passes each part of the path of `controller` to `tell`, in order. The path is planned before the start: see
/// [`ControllerConfig::is_planned`](crate::ControllerConfig::is_planned). What another controller would do on the way is not
/// told.
pub fn drive_planned(
    mut controller: Box<dyn Controller>,
    surroundings: &Surroundings<'_>,
    mut tell: impl FnMut(PathPart),
) {
    let Surroundings { obstacles, radius_m, start, .. } = *surroundings;
    let mut place = start;
    let mut outcome = CommandOutcome::Started;
    loop {
        let situation = Situation::new(SimTime::ZERO, place, outcome, 0, obstacles, radius_m);
        match controller.decide(&situation) {
            RobotCommand::Drive(to) => {
                tell(PathPart::Drive { from: place, to });
                place = to;
                outcome = CommandOutcome::Arrived;
            }
            RobotCommand::Listen => {
                tell(PathPart::Stop(place));
                outcome = CommandOutcome::Listened(&[]);
            }
            RobotCommand::DriveArc { .. } | RobotCommand::Finish(_) => return,
        }
    }
}
