//! A robot with a controller of its own: it drives a square spiral and listens at each corner.
//!
//! `cargo run --release -p sextant --example own_controller`

use std::io::Write;

use sextant::channel::Position;
use sextant::sim::{CommandOutcome, Controller, Ending, RobotCommand, Situation};
use sextant::{Programs, Scenario, Unwatched};

/// Drives a square spiral round a middle, and listens at each corner.
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
        let (x, y) = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)][self.corner as usize % 4];
        let radius_m = 0.12 * f64::from(self.corner);
        RobotCommand::Drive(self.middle + Position::new(x * radius_m, y * radius_m, 0.0))
    }
}

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/smoke.toml");
    let scenario = Scenario::load(file)?;
    let spiral = Spiral { middle: Position::new(6.0, 3.0, 0.0), corner: 0, corners: 40 };
    let programs = Programs::default().with_controller("surveyor", Box::new(spiral));
    let run = sextant::run_with(&scenario, programs, &mut (), &Unwatched)?;
    let stops = run.survey().ok_or("a robot surveys")?.robots[0].stops;
    for map in &run.summary().maps {
        let error = map.position_error_m.ok_or("the true places are known")?;
        writeln!(std::io::stdout(), "{stops} stops, {}: {:.2} m mean error", map.algorithm, error.mean)?;
    }
    Ok(())
}
