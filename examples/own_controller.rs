//! A robot with a controller of its own: it drives a spiral and listens at each corner.
//!
//! `cargo run --release -p sextant --example own_controller`

use std::io::Write;

use sextant::{Scenario, Unwatched};
use sextant_channel::Position;
use sextant_sim::{CommandOutcome, Controller, Ending, RobotCommand, RobotTask, Simulation, Situation};

/// Drives a spiral of straight legs round a middle, and listens at the end of each.
#[derive(Clone)]
struct Spiral {
    middle: Position,
    corner: u32,
    corners: u32,
}

impl Controller for Spiral {
    fn decide(&mut self, situation: &Situation<'_>) -> RobotCommand {
        // It listens where a leg ended, also where an obstacle ended it.
        if matches!(situation.outcome, CommandOutcome::Arrived | CommandOutcome::Blocked(_)) {
            return RobotCommand::Listen;
        }
        if self.corner == self.corners {
            return RobotCommand::Finish(Ending::Complete);
        }
        self.corner += 1;
        let (angle, radius_m) = (0.9 * f64::from(self.corner), 0.15 * f64::from(self.corner));
        RobotCommand::Drive(
            self.middle + Position::new(radius_m * libm::cos(angle), radius_m * libm::sin(angle), 0.0),
        )
    }
}

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/smoke.toml");
    let mut setup = Scenario::load(file)?.setup();
    let spiral = Spiral { middle: Position::new(6.0, 3.0, 0.0), corner: 0, corners: 40 };
    setup.robots[0].task = RobotTask::Survey(Box::new(spiral));
    let survey = Simulation::new(setup)?.run(&mut ());
    let log = survey.logs.first();
    let map = sextant::map_log(log, "link-model".parse()?, &Unwatched)?;
    let (stops, mapped, nodes) = (log.stops().len(), map.summary.mapped, log.node_count());
    writeln!(std::io::stdout(), "{stops} stops, {mapped} of {nodes} nodes mapped")?;
    Ok(())
}
