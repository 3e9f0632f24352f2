//! Missions as a printed table.

use std::io::{self, Write};

use super::links::LinkSummary;
use super::missions::{ArrivalSummary, MissionSummary, MissionTarget};
use super::sensing::SensorErrorCounts;
use crate::columns::{Align, columns};

/// Writes one row for each mission, and what it took below.
pub(super) fn write(missions: &[MissionSummary], out: &mut impl Write) -> io::Result<()> {
    let header =
        ["application", "algorithm", "map", "map error", "result", "time", "prediction error", "path", "energy"];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    for mission in missions {
        let metres = |length_m: Option<f64>| length_m.map_or_else(|| "-".to_owned(), |m| format!("{m:.2} m"));
        let seconds = mission.time_s.map_or_else(|| "-".to_owned(), |time_s| format!("{time_s:.1} s"));
        let energy = mission.energy_j;
        rows.push(vec![
            mission.name.clone(),
            mission.algorithm.to_owned(),
            mission.map.clone(),
            metres(mission.map_error_m),
            result(mission),
            seconds,
            metres(mission.prediction_error_m.map(|error| error.mean)),
            format!("{:.1} m", mission.path_length_m),
            format!("{:.1} J", energy.tx + energy.rx + energy.idle),
        ]);
    }
    let align = [
        Align::Left,
        Align::Left,
        Align::Left,
        Align::Right,
        Align::Left,
        Align::Right,
        Align::Right,
        Align::Right,
        Align::Right,
    ];
    columns(&rows, &align, out)?;
    for mission in missions {
        details(mission, out)?;
    }
    writeln!(out)
}

/// What it came to, in words.
fn result(mission: &MissionSummary) -> String {
    let captured = mission.targets.iter().filter(|target| target.captured_s.is_some()).count();
    match (mission.captured, mission.arrived) {
        (Some(_), _) => format!("{captured} of {} captured", mission.targets.len()),
        (None, Some(true)) => "arrived".to_owned(),
        (None, Some(false)) => "did not arrive".to_owned(),
        (None, None) => "-".to_owned(),
    }
}

/// Robots, captures, arrivals and messages, one line each.
fn details(mission: &MissionSummary, out: &mut impl Write) -> io::Result<()> {
    let name = &mission.name;
    writeln!(out, "{name}: {}", mission.participants())?;
    for target in &mission.targets {
        writeln!(out, "{name}: {} {}", target.name, fate(target))?;
    }
    for arrival in &mission.arrivals {
        let ArrivalSummary { robot, time_s, believed, value, source_m } = arrival;
        let source = source_m.map_or_else(String::new, |source_m| format!(", {source_m:.2} m from the source"));
        writeln!(out, "{name}: {robot} arrived after {time_s:.1} s, at {value:.2} (believed {believed:.2}){source}")?;
    }
    if let Some(largest) = mission.largest_value {
        let sought = mission.level.map_or_else(|| "the source".to_owned(), |level| format!("{level:.2}"));
        let least = mission.law_minimum_s.map_or_else(String::new, |least_s| {
            format!(", which the control law reaches in the exact field in no less than {least_s:.1} s")
        });
        writeln!(out, "{name}: sought {sought}{least}; largest value on the way {largest:.2}")?;
    }
    if let Some(SensorErrorCounts { missed_detections, false_detections }) = mission.sensor_errors {
        writeln!(out, "{name}: sensors: {missed_detections} missed and {false_detections} false detections")?;
    }
    if let Some(link) = &mission.link {
        write_link(name, link, out)?;
    }
    let kinds: Vec<String> =
        mission.messages.kinds.iter().map(|(kind, count)| format!("{count} {}", kind.replace('_', " "))).collect();
    if !kinds.is_empty() {
        writeln!(out, "{name}: messages: {}", kinds.join(", "))?;
    }
    Ok(())
}

/// The link that its robots kept, and how near it came to the best one.
fn write_link(name: &str, link: &LinkSummary, out: &mut impl Write) -> io::Result<()> {
    let giga = |bit_per_s: f64| bit_per_s * 1e-9;
    writeln!(
        out,
        "{name}: {:.3} Gbit/s of {:.3} with the best sectors at any time; outage {:.2} % of {:.2} %",
        giga(link.throughput_bit_per_s),
        giga(link.ideal_throughput_bit_per_s),
        100.0 * link.outage,
        100.0 * link.ideal_outage
    )?;
    let loss =
        link.snr_loss_db.map_or_else(String::new, |loss_db| format!("; {loss_db:.2} dB below the best sectors"));
    writeln!(
        out,
        "{name}: training took {:.2} % of the time: {} with all sectors, {} round a predicted one, {} handovers{loss}",
        100.0 * link.overhead,
        link.searches,
        link.near_trainings,
        link.handovers
    )
}

/// What became of a target.
fn fate(target: &MissionTarget) -> String {
    match (target.captured_s, target.left_s) {
        (Some(time_s), _) => {
            let by = target.robot.as_ref().map_or_else(String::new, |robot| format!(" by {robot}"));
            format!("was captured{by} after {time_s:.1} s")
        }
        (None, Some(time_s)) => format!("left the world after {time_s:.1} s"),
        (None, None) => "was not captured".to_owned(),
    }
}
