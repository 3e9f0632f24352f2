//! The results of a command as a printed table.

use std::io::{self, Write};

use sextant_mapper::Section;

use super::battery;
use super::distributed_table;
use super::gathering::{DiscoverySummary, EnergySummary, GatheringSummary};
use super::mac_table;
use super::map::{AlignmentSummary, ErrorSummary, MapSummary};
use super::map_judgement::{self, Subject};
use super::missions_table;
use super::results::{RegionSummary, Summary};
use super::routing_table;
use super::timing::Timing;
use super::tracks;
use crate::columns::{Align, columns};
use sextant_kernel::text::{counted, listed};

/// Writes `summary` as a table.
///
/// # Errors
/// If `out` cannot be written.
pub fn write(summary: &Summary, out: &mut impl Write) -> io::Result<()> {
    if let Some(scenario) = &summary.scenario {
        write!(out, "{} (seed {})", scenario.name, scenario.seed)?;
        if let Some(simulation) = &summary.simulation {
            let (nodes, obstacles) = (simulation.nodes, simulation.obstacles);
            write!(out, ": {}", counted(nodes, "node"))?;
            if let Some(moving) = simulation.moving_nodes {
                write!(out, " ({moving} of them {})", if moving == 1 { "moves" } else { "move" })?;
            }
            write!(out, ", {}", counted(obstacles, "obstacle"))?;
        }
        writeln!(out, "\n")?;
    }
    if let Some(gathering) = &summary.gathering {
        columns(&gathering_rows(gathering), &[Align::Left, Align::Right, Align::Left], out)?;
        let region = summary.simulation.as_ref().and_then(|simulation| simulation.region.as_ref());
        if let Some(&RegionSummary { halo_m: Some(halo_m), share, .. }) = region {
            writeln!(
                out,
                "simulated: nodes within {halo_m:.1} m of those who listen, {} of the packets",
                format_args!("{:.1} %", 100.0 * share)
            )?;
        }
        let nodes = summary.simulation.as_ref().map_or(0, |simulation| simulation.nodes);
        for robot in &gathering.robots {
            if let Some(end) = robot.end(nodes) {
                writeln!(out, "{}: {end}", robot.name)?;
            }
        }
        writeln!(out)?;
    }
    tracks::write(&summary.tracks, out)?;
    if let Some(routing) = &summary.routing {
        routing_table::write(routing, out)?;
        writeln!(out, "each hop of nodes: beacons, and packets to the next station")?;
    }
    for mac in summary.mac.iter().chain(&summary.other_networks) {
        if summary.gathering.is_some() && mac.network.is_none() {
            writeln!(out, "traffic to sinks")?;
        }
        mac_table::write(mac, out)?;
    }
    // Those of logs are told beside their table.
    for note in summary.notes.iter().filter(|_| summary.simulation.is_some()) {
        writeln!(out, "warning: {note}\n")?;
    }
    let deaths = summary.faults.as_ref().and_then(|faults| faults.deaths.as_ref());
    if let Some(deaths) = deaths.filter(|deaths| !deaths.is_empty()) {
        let (nodes, who) = (counted(deaths.len(), "node"), listed(deaths));
        writeln!(out, "{nodes} died, and offered no packets from then on: {who}\n")?;
    }
    if let Some(battery) = &summary.battery {
        battery::write(battery, out)?;
    }
    if let Some(sensing) = &summary.sensing {
        let (targets, fields) = (counted(sensing.targets, "target"), counted(sensing.fields, "field"));
        let (detections, samples) = (sensing.detections, sensing.samples);
        writeln!(out, "sensors: {targets}, {fields}, {detections} detections, {samples} samples\n")?;
    }
    if let Some(discovery) = &summary.discovery {
        discovery_lines(discovery, out)?;
    }
    if !summary.maps.is_empty() {
        maps(&summary.maps, out)?;
        say(&summary.maps, [Subject::Measured], out)?;
        bounds(&summary.maps, out)?;
        let learned = Section::ALL.into_iter().filter(|section| *section != Section::Warnings).map(Subject::Learned);
        say(&summary.maps, learned.chain([Subject::Infeasible, Subject::Coincident, Subject::Displacements]), out)?;
        distributed_table::write(&summary.maps, summary.interrupted, out)?;
        say(&summary.maps, [Subject::Concerns, Subject::Heights], out)?;
        writeln!(out)?;
    }
    if !summary.applications.is_empty() {
        missions_table::write(&summary.applications, out)?;
    }
    if let Some(timing) = &summary.timing {
        writeln!(out, "{}", timing_line(timing))?;
    }
    Ok(())
}

fn gathering_rows(gathering: &GatheringSummary) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    let mut row = |name: &str, value: Option<String>, note: &str| {
        if let Some(value) = value {
            rows.push(vec![name.to_owned(), value, note.to_owned()]);
        }
    };
    let count = |count: Option<u64>| count.map(|count| count.to_string());
    row("stops", Some(gathering.stops.to_string()), "");
    let metres = if gathering.path_is_by_stops { "m, straight from stop to stop" } else { "m" };
    row("path length", gathering.path_length_m.map(|length_m| format!("{length_m:.1}")), metres);
    row("duration", gathering.duration_s.map(|duration_s| format!("{duration_s:.1}")), "s");
    row("sector sweeps of robots", count(gathering.sweeps), "");
    let reports = gathering.sector_reports.map(|reports| (reports.received.to_string(), reports.asked));
    let asked = reports.as_ref().map(|(_, asked)| format!("of {asked} that were asked for")).unwrap_or_default();
    row("reports of all sectors", reports.map(|(received, _)| received), &asked);
    row("packets offered", count(gathering.packets_offered), "");
    let estimated = "of those offered; nobody who listens was near, and what became of them is estimated";
    row("packets not simulated", count(gathering.packets_not_simulated), estimated);
    row("packets sent", count(gathering.packets_sent), "");
    row("packets received", count(gathering.packets_received), "");
    let by_robots = count(gathering.packets_received_by_robots);
    row("packets received", by_robots, "by all robots together; one that two of them received counts twice");
    row("receptions", Some(gathering.receptions.to_string()), "pairs of a stop and a node heard there");
    row("ranges", gathering.ranges.map(|ranges| ranges.to_string()), "that robots measured");
    row("lost to collisions", count(gathering.lost_collision), "");
    let (unsent, why) = match gathering.sweeps {
        Some(_) => ("lost before sending", "the window for answers ended; without sweeps, the channel was busy"),
        None => ("lost to a busy channel", ""),
    };
    row(unsent, count(gathering.lost_channel_access), why);
    row("lost to a weak signal", count(gathering.lost_signal), "");
    row("sent out of range", count(gathering.out_of_range), "");
    row("lost to a full queue", count(gathering.lost_queue), "");
    if let Some(unheard) = &gathering.not_listened_by {
        row("receiver transmitting", Some(unheard.transmitting.to_string()), "sent while no receiver listened");
        row("receiver asleep", Some(unheard.asleep.to_string()), "sent while no receiver listened");
        row("receiver off", Some(unheard.off.to_string()), "sent while no receiver listened");
    }
    let died = Some(gathering.died).filter(|&packets| packets > 0);
    row("lost in dead nodes", count(died), "they waited in their node");
    row("pending", count(gathering.pending), "");
    if let Some(energy) = &gathering.energy_j {
        let is_estimated = gathering.packets_not_simulated.is_some_and(|packets| packets > 0);
        let unit = if is_estimated { "J, with an estimate for the packets not simulated" } else { "J" };
        row("energy of the nodes", Some(format!("{:.1}", energy.tx + energy.rx + energy.idle)), unit);
    }
    if gathering.robots.len() > 1 {
        for robot in &gathering.robots {
            let duration = robot.duration_s.map(|duration_s| format!(" in {duration_s:.1} s")).unwrap_or_default();
            let note = format!("m{duration}, {}", counted(robot.stops, "stop"));
            row(&format!("path of {}", robot.name), Some(format!("{:.1}", robot.path_length_m)), &note);
        }
    }
    rows
}

fn maps(maps: &[MapSummary], out: &mut impl Write) -> io::Result<()> {
    let measured = maps.iter().any(|map| map.position_error_m.is_some());
    let mut header = vec!["map", "mapped"];
    let bounded = maps.iter().any(|map| map.posterior_bound_m.is_some());
    let covered = maps.iter().any(|map| map.coverage_95.is_some());
    let errors = ["mean", "median", "p90", "p95", "max", "aligned mean", "connectivity error", "false neighbours"];
    if measured {
        header.extend(errors);
    }
    if bounded {
        header.push("bound");
    }
    if covered {
        header.push("in 95 % region");
    }
    let tells = maps.iter().any(|map| !map.knowledge.is_empty());
    if tells {
        header.push("knows");
    }
    let mut rows = vec![header.into_iter().map(str::to_owned).collect::<Vec<_>>()];
    for map in maps {
        let name = map.name.clone().unwrap_or_else(|| map.algorithm.clone());
        let mut row = vec![name, format!("{}/{}", map.mapped, map.mapped + map.unmapped)];
        let share = |share: Option<f64>| share.map_or_else(|| "-".to_owned(), |x| format!("{:.1} %", 100.0 * x));
        if measured {
            let metres = |pick: fn(&ErrorSummary) -> f64, error: &Option<ErrorSummary>| {
                error.as_ref().map_or_else(|| "-".to_owned(), |error| format!("{:.2} m", pick(error)))
            };
            let share = |share: Option<f64>| share.map_or_else(|| "-".to_owned(), |x| format!("{:.1} %", 100.0 * x));
            row.push(metres(|error| error.mean, &map.position_error_m));
            row.push(metres(|error| error.median, &map.position_error_m));
            row.push(metres(|error| error.p90, &map.position_error_m));
            row.push(metres(|error| error.p95, &map.position_error_m));
            row.push(metres(|error| error.max, &map.position_error_m));
            row.push(metres(|error| error.mean, &map.aligned_error_m));
            row.push(share(map.connectivity_error));
            row.push(share(map.false_neighbour_rate));
        }
        if bounded {
            row.push(map.posterior_bound_m.map_or_else(|| "-".to_owned(), |bound_m| format!("{bound_m:.2} m")));
        }
        if covered {
            row.push(share(map.coverage_95));
        }
        if tells {
            row.push(knowledge(map));
        }
        rows.push(row);
    }
    let mut align = vec![Align::Right; rows[0].len()];
    align[0] = Align::Left;
    if tells {
        align[rows[0].len() - 1] = Align::Left;
    }
    columns(&rows, &align, out)
}

/// What there is to know of the maps, subject by subject.
fn say(maps: &[MapSummary], subjects: impl IntoIterator<Item = Subject>, out: &mut impl Write) -> io::Result<()> {
    let lines =
        subjects.into_iter().flat_map(|subject| maps.iter().flat_map(move |map| map_judgement::on(map, subject)));
    lines.map(|line| line.text).try_for_each(|text| writeln!(out, "{text}"))
}

/// Why maps have no bound: one line for each reason.
fn bounds(maps: &[MapSummary], out: &mut impl Write) -> io::Result<()> {
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for map in maps {
        let Some(why) = map.posterior_bound_absent.as_deref() else { continue };
        let name = map.name.as_ref().unwrap_or(&map.algorithm).as_str();
        match reasons.iter_mut().find(|(other, _)| *other == why) {
            Some((_, names)) => names.push(name),
            None => reasons.push((why, vec![name])),
        }
    }
    reasons.iter().try_for_each(|(why, names)| writeln!(out, "{}: no bound: {why}", names.join(", ")))
}

fn discovery_lines(discovery: &DiscoverySummary, out: &mut impl Write) -> io::Result<()> {
    for (who, round) in [("nodes", &discovery.neighbours), ("anchors", &discovery.anchors)] {
        let Some(round) = round else { continue };
        let EnergySummary { tx, rx, idle } = round.energy_j;
        writeln!(
            out,
            "discovery: {} {who} sent {} packets in {:.1} s, {} links, {:.1} J",
            round.senders,
            round.packets_sent,
            round.duration_s,
            round.links,
            tx + rx + idle
        )?;
    }
    writeln!(out)
}

/// The knowledge that a map uses, in words, and whether it was aligned to the truth.
fn knowledge(map: &MapSummary) -> String {
    let mut words: Vec<_> = map.knowledge.iter().map(|kind| kind.name()).collect();
    if map.alignment == Some(AlignmentSummary::Truth) {
        words.push("(aligned to the truth)");
    }
    words.join(", ").replace(", (", " (")
}

fn timing_line(timing: &Timing) -> String {
    let mut parts = Vec::new();
    if let Some(gather_s) = timing.gather_s {
        parts.push(format!("gathering {gather_s:.2} s"));
    }
    if let Some(map_s) = timing.map_s {
        parts.push(format!("mapping {map_s:.2} s"));
    }
    if let Some(events_per_s) = timing.events_per_s {
        parts.push(format!("{:.2} million events/s", events_per_s / 1e6));
    }
    let parts = if parts.is_empty() { String::new() } else { format!(" ({})", parts.join(", ")) };
    format!("time {:.2} s{parts}", timing.wall_s)
}

#[cfg(test)]
mod tests {
    use super::super::results::{ScenarioSummary, SimulationSummary};
    use super::*;

    #[test]
    fn the_table_is_aligned_in_columns() {
        let error = ErrorSummary { mean: 0.71, median: 0.6, p80: 1.1, p90: 1.4, p95: 1.75, max: 12.25 };
        let summary = Summary {
            scenario: Some(ScenarioSummary { name: "circular".into(), seed: 1, ..ScenarioSummary::default() }),
            simulation: Some(SimulationSummary { nodes: 496, obstacles: 1, ..SimulationSummary::default() }),
            gathering: Some(GatheringSummary {
                stops: 444,
                path_length_m: Some(443.96),
                packets_offered: Some(481_120),
                receptions: 4_321,
                packets_received: Some(10_234),
                ..GatheringSummary::default()
            }),
            maps: vec![
                MapSummary {
                    algorithm: "ml-tm".into(),
                    mapped: 490,
                    unmapped: 6,
                    position_error_m: Some(error),
                    connectivity_error: Some(0.051),
                    ..MapSummary::default()
                },
                MapSummary { name: Some("coarse".into()), ..MapSummary::default() },
            ],
            timing: Some(Timing { wall_s: 1.234, gather_s: Some(0.6), ..Timing::default() }),
            ..Summary::default()
        };
        let mut out = Vec::new();
        write(&summary, &mut out).unwrap();
        insta::assert_snapshot!(String::from_utf8(out).unwrap(), @r"
        circular (seed 1): 496 nodes, 1 obstacle

        stops                444
        path length        444.0  m
        packets offered   481120
        packets received   10234
        receptions          4321  pairs of a stop and a node heard there

        map      mapped    mean  median     p90     p95      max  aligned mean  connectivity error  false neighbours
        ml-tm   490/496  0.71 m  0.60 m  1.40 m  1.75 m  12.25 m             -               5.1 %                 -
        coarse      0/0       -       -       -       -        -             -                   -                 -

        time 1.23 s (gathering 0.60 s)
        ");
    }
}
