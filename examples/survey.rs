//! Runs a scenario from Rust: with another setting and seed, watched by an observer of its own, without any file.
//!
//! `cargo run --release -p sextant --example survey`

use std::io::Write;

use sextant::channel::Position;
use sextant::kernel::SimTime;
use sextant::run::SurveyEnd;
use sextant::sim::Observer;
use sextant::{RunError, RunObserver, Scenario, Unwatched};

/// Adds up how far the robots drive.
#[derive(Default)]
struct Odometer {
    last: Option<Position>,
    driven_m: f64,
    heard: usize,
}

impl Observer for Odometer {
    fn moved(&mut self, _robot: usize, _time: SimTime, position: Position) {
        self.driven_m += self.last.map_or(0.0, |last| last.distance_m(position));
        self.last = Some(position);
    }
}

impl RunObserver for Odometer {
    fn survey_finished(&mut self, end: &SurveyEnd<'_>) -> Result<(), RunError> {
        self.heard = end.simulated.survey.logs.first().receptions().len();
        Ok(())
    }
}

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/smoke.toml");
    let scenario = Scenario::load(file)?.with("seed", 3)?.with("robots.0.listen_s", 2.4)?;
    let mut odometer = Odometer::default();
    let run = sextant::run(&scenario, &mut odometer, &Unwatched)?;
    let mut out = std::io::stdout().lock();
    writeln!(
        out,
        "{}: driven {:.0} m, {} pairs of stop and node",
        scenario.name(),
        odometer.driven_m,
        odometer.heard
    )?;
    for map in &run.summary().maps {
        let error = map.position_error_m.ok_or("the true places are known")?;
        writeln!(out, "{}: {:.2} m mean error, {:.2} m at most", map.algorithm, error.mean, error.max)?;
    }
    Ok(())
}
