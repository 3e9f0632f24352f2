//! The folder of a log: its files by their names, and logs that have their stops.

use std::path::Path;

use sextant_channel::ReceptionLog;

use super::doctor::{self, Finding};
use super::error::RobotLogError;
use super::field_names::FieldNames;
use super::log::RobotLog;
use super::options::ReadOptions;
use super::rssi_check::RssiCheck;
use super::{receptions, sectors, stops, wide};
use sextant_kernel::text::counted;
use sextant_recording::RobotNames;

pub(super) const STOPS: &str = "stops.csv";
pub(super) const RECEPTIONS: &str = "receptions.csv";
pub(super) const CONTACTS: &str = "contacts.csv";
pub(super) const SECTORS: &str = "sectors.csv";
pub(super) const PACKETS: &str = "packets.csv";
pub(super) const PATH: &str = "path.csv";

/// The true places of nodes, and other names of them: for scores only.
pub(super) const NODES: &str = "nodes.csv";
pub(super) const NAMES: &str = "names.csv";

/// Reads the log in `folder`: `stops.csv` and `receptions.csv`, and `contacts.csv` and `sectors.csv` if they exist. Stops are
/// numbered in the order of `stops.csv`, nodes in the order of their first rows.
///
/// # Errors
/// If a file is missing, cannot be read, or has an invalid row; the error names file, line and column.
pub(super) fn read(folder: &Path, options: &ReadOptions) -> Result<RobotLog, RobotLogError> {
    let mut notes = Vec::new();
    let mut robots = RobotNames::default();
    let names = FieldNames::of_places(options.form.path_fields.as_ref());
    let skips_no_fix = options.repair.skip_no_fix;
    let stops = stops::read(&folder.join(STOPS), &names, skips_no_fix, &mut robots, &mut notes)?;
    if stops.stops.is_empty() {
        return Err(RobotLogError::NoStops { path: folder.to_owned() });
    }
    let mut rssi = RssiCheck::new(&options.repair.rssi_missing);
    let receptions::Receptions { names, receptions, left_out } =
        receptions::read(&folder.join(RECEPTIONS), &stops, &options.form, &mut rssi, &mut notes)?;
    notes.extend(left_out_note(&stops, left_out));
    notes.extend(rssi.note());
    let plane = stops.plane;
    let contacts = stops::read_contacts(&folder.join(CONTACTS), plane, &mut robots, &mut notes)?;
    let log = receptions.build(names, stops.stops, contacts).and_then(|log| log.with_robots(robots.into_vec()));
    let log = log.map_err(|why| RobotLogError::Log { path: folder.to_owned(), why })?;
    let log = with_sectors(folder, log, &mut notes)?;
    Ok(RobotLog { findings: findings(&log, rssi.findings()), log, plane, notes, clock: None })
}

/// The note on stops that were left out, with so many rows of receptions.
pub(super) fn left_out_note(stops: &stops::Stops, left_out: usize) -> Option<String> {
    let rows = counted(stops.left_out.len(), "row");
    (!stops.left_out.is_empty()).then(|| {
        format!("stops.csv: {rows} without a fix are left out, with {left_out} rows of receptions.csv (option `skip_no_fix`)")
    })
}

/// What is odd in a log of stops, of whose strengths `of_rssi` is odd.
fn findings(log: &ReceptionLog, of_rssi: Vec<Finding>) -> Vec<Finding> {
    let mut findings = doctor::of_stops(log);
    findings.extend(of_rssi);
    findings.extend(doctor::listening::finding(log, None));
    findings
}

/// Reads a wide table, and `contacts.csv` and `sectors.csv` of its folder if they exist.
///
/// # Errors
/// If a file cannot be read or has an invalid row.
pub(super) fn read_wide(
    table: &Path,
    folder: Option<&Path>,
    options: &ReadOptions,
) -> Result<RobotLog, RobotLogError> {
    let mut notes = Vec::new();
    let mut wide = wide::read(table, options, &mut notes)?;
    let of_rssi = std::mem::take(&mut wide.findings);
    let plane = wide.plane;
    let contacts = match folder {
        Some(folder) => stops::read_contacts(&folder.join(CONTACTS), plane, &mut wide.robots, &mut notes)?,
        None => Vec::new(),
    };
    let log = wide.build(contacts).map_err(|why| RobotLogError::Log { path: table.to_owned(), why })?;
    let log = match folder {
        Some(folder) => with_sectors(folder, log, &mut notes)?,
        None => log,
    };
    Ok(RobotLog { findings: findings(&log, of_rssi), log, plane, notes, clock: None })
}

/// The log with the sectors in the folder, if it has any.
pub(super) fn with_sectors(
    folder: &Path,
    log: ReceptionLog,
    notes: &mut Vec<String>,
) -> Result<ReceptionLog, RobotLogError> {
    let path = folder.join(SECTORS);
    if !path.exists() {
        return Ok(log);
    }
    let sectors = sectors::read(&path, notes)?;
    log.with_sectors(sectors).map_err(|why| RobotLogError::Log { path: folder.to_owned(), why })
}
