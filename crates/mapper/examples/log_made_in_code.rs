//! A reception log made in code, and the map of its nodes: needs no Cargo feature of the crate.
//!
//! `cargo run -p sextant-mapper --no-default-features --example log_made_in_code`

use std::io::Write;

use sextant_channel::{Position, Reception, ReceptionLog, Stop};
use sextant_kernel::{NodeId, RobotId, SimTime, Unwatched};
use sextant_mapper::{Auto, AutoConfig, Region};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A robot listens every 2 m on a square of 12 m. Each of three nodes sends ten packets at each stop, of which fewer
    // arrive the farther away it is.
    let nodes = [("kitchen", 3.1, 2.4), ("hall", 7.7, 6.2), ("workshop", 10.3, 1.8)];
    let stops: Vec<Stop> = (0..49)
        .map(|i| Position::new(2.0 * f64::from(i % 7), 2.0 * f64::from(i / 7), 0.0))
        .map(|position| Stop { robot: RobotId(0), time: SimTime::ZERO, position, heading_rad: None })
        .collect();
    let mut receptions = Vec::new();
    for (node, (_, x_m, y_m)) in (0..).zip(nodes) {
        for (number, stop) in (0..).zip(&stops) {
            let apart_m = stop.position.distance_m(Position::new(x_m, y_m, 0.0));
            let received = (0..10).filter(|i| apart_m < 2.0 + 0.4 * f64::from(*i)).count().try_into()?;
            let (sector, rssi_dbm, snr_db) = (None, None, None);
            receptions.push(Reception {
                node: NodeId(node),
                stop: number,
                received,
                sent: 10,
                sector,
                rssi_dbm,
                snr_db,
            });
        }
    }
    let names = nodes.map(|(name, ..)| name.to_owned()).to_vec();
    let log = ReceptionLog::new(names, stops, receptions, Vec::new())?;

    let (map, _) = Auto::try_from(AutoConfig::default())?.map(&log, None, &Unwatched)?;
    let mut out = std::io::stdout().lock();
    for ((name, x_m, y_m), estimate) in nodes.iter().zip(&map.estimates) {
        let estimate = estimate.as_ref().ok_or("each node was heard")?;
        let place = estimate.position;
        let error_m = place.distance_m(Position::new(*x_m, *y_m, 0.0));
        let area_m2 = Region::of_95(estimate).map_or(f64::NAN, |region| region.size());
        writeln!(
            out,
            "{name}: {:.2} m, {:.2} m; {error_m:.2} m off; with 95 % within {area_m2:.1} m²",
            place.x_m, place.y_m
        )?;
        if error_m > 1.5 {
            return Err(format!("{name} is {error_m:.2} m off").into());
        }
    }
    Ok(())
}
