//! Maps a log that was made in code: a robot stands at a few places and counts the packets of two nodes.
//!
//! `cargo run --release -p sextant --example map_log`

use std::io::Write;

use sextant::Unwatched;
use sextant::channel::{Position, Reception, ReceptionLog, Stop};
use sextant::kernel::{NodeId, RobotId, SimTime};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let nodes = [("lamp", Position::new(2.0, 3.0, 0.0)), ("door", Position::new(8.0, 6.0, 0.0))];
    // A stop every two metres; each node sends ten packets at each, of which fewer arrive from farther away.
    let places = (0..30).map(|i| Position::new(f64::from(i % 6) * 2.0, f64::from(i / 6) * 2.0, 0.0));
    let stops: Vec<Stop> =
        places.map(|position| Stop { robot: RobotId(0), time: SimTime::ZERO, position, heading_rad: None }).collect();
    let mut receptions = Vec::new();
    for (node, (_, place)) in (0..).zip(&nodes) {
        for (stop, at) in (0..).zip(&stops) {
            let reach_m = |packet: u32| 2.5 + 0.5 * f64::from(packet);
            let received = u32::try_from((0..10).filter(|&i| at.position.distance_m(*place) < reach_m(i)).count())?;
            let (node, sector, rssi_dbm, snr_db) = (NodeId(node), None, None, None);
            receptions.push(Reception { node, stop, received, sent: 10, sector, rssi_dbm, snr_db });
        }
    }
    let names = nodes.iter().map(|(name, _)| (*name).to_owned()).collect();
    let log = ReceptionLog::new(names, stops, receptions, Vec::new())?;

    let found = sextant::map_log(&log, "auto".parse()?, &Unwatched)?;
    let mut out = std::io::stdout().lock();
    for ((name, place), estimate) in nodes.iter().zip(&found.map.estimates) {
        let estimate = estimate.as_ref().ok_or("each node was heard")?;
        let error_m = estimate.position.distance_m(*place);
        let concern = estimate.concern.map_or_else(String::new, |concern| format!(" ({concern:?})"));
        writeln!(
            out,
            "{name}: {:.2}, {:.2}; {error_m:.2} m off{concern}",
            estimate.position.x_m, estimate.position.y_m
        )?;
    }
    Ok(())
}
