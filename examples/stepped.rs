//! A run in steps: it is advanced 20 simulated seconds at a time, and looked at in between.
//!
//! `cargo run --release -p sextant --example stepped`

use std::io::Write;
use std::time::Duration;

use sextant::{Scenario, SteppedRun, Unwatched};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/smoke.toml");
    let scenario = Scenario::load(file)?;
    let mut run = SteppedRun::new(&scenario, (), &Unwatched)?;
    let mut out = std::io::stdout().lock();
    while !run.has_ended() {
        run.until(run.time() + Duration::from_secs(20));
        let now = run.snapshot().ok_or("a robot surveys")?;
        let (place, packets) = (now.robots[0].pose.truth.position, now.packets);
        writeln!(
            out,
            "{:.0} s: at {:.1}, {:.1}; {} stops, {} nodes heard, {} of {} packets received",
            now.time.as_secs_f64(),
            place.x_m,
            place.y_m,
            now.stops,
            now.nodes_heard,
            packets.received,
            packets.sent
        )?;
    }
    let run = run.finish()?;
    writeln!(out, "{} nodes mapped", run.summary().maps[0].mapped)?;
    Ok(())
}
