//! A study of one setting, in memory: the error of the map against the spacing of the robot's lanes, with intervals.
//!
//! `cargo run --release -p sextant-study --example sweep`

use std::io::Write;

use sextant::{Scenario, Unwatched};
use sextant_study::sweep::Mean;

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/smoke.toml");
    let scenario = Scenario::load(file)?;
    let mut out = std::io::stdout().lock();
    for lane_spacing_m in [2.0, 3.0, 4.0] {
        let mut errors_m = Vec::new();
        let lanes = scenario.with("robots.0.controller.s_path.lane_spacing_m", lane_spacing_m)?;
        for seed in 1..=3 {
            let run = sextant::run(&lanes.with("seed", seed)?, &mut (), &Unwatched)?;
            errors_m.extend(run.summary().maps[0].position_error_m.map(|error| error.mean));
        }
        let mean = Mean::of(&errors_m).ok_or("each run has a map")?;
        let interval_m = mean.half_width_95.ok_or("there are several runs")?;
        writeln!(out, "lanes {lane_spacing_m} m apart: {:.2} ± {interval_m:.2} m", mean.mean)?;
    }
    Ok(())
}
