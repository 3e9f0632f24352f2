//! The folder of a log: stops and receptions, or packets and a path.

use std::path::Path;

use sextant_channel::ReceptionLog;

use super::doctor;
use super::error::RobotLogError;
use super::gatherer::Gatherer;
use super::log::RobotLog;
use super::options::{ReadOptions, StopRule};
use super::packet_delay::PacketDelay;
use super::rssi_check::RssiCheck;

use super::{packets, path_file, receptions, sectors, stops};
use crate::robot_names::RobotNames;
use crate::text::counted;

pub(super) const STOPS: &str = "stops.csv";
pub(super) const RECEPTIONS: &str = "receptions.csv";
pub(super) const CONTACTS: &str = "contacts.csv";
pub(super) const SECTORS: &str = "sectors.csv";
pub(super) const PACKETS: &str = "packets.csv";
pub(super) const PATH: &str = "path.csv";

/// Reads the log in `folder`: `stops.csv` and `receptions.csv`, or `path.csv` and `packets.csv`, and with either
/// `contacts.csv` and `sectors.csv` if they exist. Stops are numbered in the order of `stops.csv` or of time, nodes in the
/// order of their first rows.
///
/// # Errors
/// If a file is missing, cannot be read, or has an invalid row; the error names file, line and column.
pub(super) fn read(folder: &Path, options: &ReadOptions) -> Result<RobotLog, RobotLogError> {
    let has = |name: &str| folder.join(name).exists();
    let rival = [STOPS, RECEPTIONS].into_iter().find(|name| has(name));
    match (has(PACKETS), rival) {
        (true, Some(rival)) => Err(RobotLogError::TwoLogs { path: folder.to_owned(), rival }),
        (true, None) => read_packets(folder, options),
        (false, None) if has(PATH) => Err(RobotLogError::NoPacketFile { path: folder.to_owned() }),
        (false, None) => Err(RobotLogError::NoLog { path: folder.to_owned() }),
        (false, Some(_)) => {
            refuse_cutting(folder, "a folder with stops", options)?;
            read_receptions(folder, options)
        }
    }
}

/// Refuses the flags that cut a path into stops, for a log that has its stops.
pub(super) fn refuse_cutting(path: &Path, found: &'static str, options: &ReadOptions) -> Result<(), RobotLogError> {
    let flag = match (options.stop_every, options.packet_interval_s) {
        (StopRule::Automatic, None) if options.repair.packet_delay == PacketDelay::default() => return Ok(()),
        (StopRule::Automatic, None) => "--packet-delay",
        (StopRule::Automatic, Some(_)) => "--packet-interval",
        _ => "--stop-every",
    };
    Err(RobotLogError::Flag { path: path.to_owned(), flag, meant: "logs of packets and a path", found })
}

/// Reads packets and paths.
fn read_packets(folder: &Path, options: &ReadOptions) -> Result<RobotLog, RobotLogError> {
    let mut notes = Vec::new();
    let path_file::Paths { paths, mut robots, is_named, plane } =
        path_file::read(&folder.join(PATH), options.repair.skip_no_fix, &mut notes)?;
    let with_path = paths.len();
    let contacts = stops::read_contacts(&folder.join(CONTACTS), plane, &mut robots, &mut notes)?;
    let names = robots.into_vec();
    let known = if is_named { &names[..with_path] } else { &[] };
    let mut gatherer = Gatherer::of_robots(paths, names.clone(), options)?.with_contacts(contacts);
    packets::read(&folder.join(PACKETS), known, &mut gatherer, &mut notes)?;
    let gathered = gatherer.finish()?;
    let log = with_sectors(folder, gathered.log.clone(), &mut notes)?;
    notes.extend(gathered.notes.clone());
    Ok(RobotLog { log, plane, notes, ..gathered })
}

/// Reads stops and receptions.
fn read_receptions(folder: &Path, options: &ReadOptions) -> Result<RobotLog, RobotLogError> {
    let mut notes = Vec::new();
    let mut robots = RobotNames::default();
    let stops = stops::read(&folder.join(STOPS), options.repair.skip_no_fix, &mut robots, &mut notes)?;
    if stops.stops.is_empty() {
        return Err(RobotLogError::NoStops { path: folder.to_owned() });
    }
    let mut rssi = RssiCheck::new(&options.repair.rssi_missing);
    let receptions::Receptions { names, receptions, left_out } =
        receptions::read(&folder.join(RECEPTIONS), &stops, &mut rssi, &mut notes)?;
    if !stops.left_out.is_empty() {
        notes.push(format!(
            "stops.csv: {} without a fix are left out, with {left_out} rows of receptions.csv (`--skip-no-fix`)",
            counted(stops.left_out.len(), "row")
        ));
    }
    notes.extend(rssi.note());
    let plane = stops.plane;
    let contacts = stops::read_contacts(&folder.join(CONTACTS), plane, &mut robots, &mut notes)?;
    let log = receptions.build(names, stops.stops, contacts).and_then(|log| log.with_robots(robots.into_vec()));
    let log = log.map_err(|why| RobotLogError::Log { path: folder.to_owned(), why })?;
    let log = with_sectors(folder, log, &mut notes)?;
    let mut findings = doctor::of_stops(&log);
    findings.extend(rssi.findings());
    findings.extend(doctor::listening::finding(&log, None));
    Ok(RobotLog { log, plane, notes, findings, clock: None })
}

/// The log with the sectors in the folder, if it has any.
fn with_sectors(folder: &Path, log: ReceptionLog, notes: &mut Vec<String>) -> Result<ReceptionLog, RobotLogError> {
    let path = folder.join(SECTORS);
    if !path.exists() {
        return Ok(log);
    }
    let sectors = sectors::read(&path, notes)?;
    log.with_sectors(sectors).map_err(|why| RobotLogError::Log { path: folder.to_owned(), why })
}
