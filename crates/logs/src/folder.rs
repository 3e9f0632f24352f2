//! The folder of a log: its files by their names, and logs that have their stops.

use std::path::Path;

use sextant_channel::{ReceptionLog, SectorReport, SectorTable};

use super::doctor::{self, Finding};
use super::error::RobotLogError;
use super::field_names::FieldNames;
use super::log::RobotLog;
use super::options::ReadOptions;
use super::rssi_check::RssiCheck;
use super::{antenna_file, receptions, sector_snrs, sectors, stops, wide};
use sextant_kernel::text::counted;
use sextant_recording::RobotNames;

pub(super) const STOPS: &str = "stops.csv";
pub(super) const RECEPTIONS: &str = "receptions.csv";
pub(super) const CONTACTS: &str = "contacts.csv";
pub(super) const SECTORS: &str = "sectors.csv";
pub(super) const ANTENNA: &str = "antenna.toml";
pub(super) const SECTOR_SNRS: &str = "sector_snrs.csv";
pub(super) const PACKETS: &str = "packets.csv";
pub(super) const PATH: &str = "path.csv";

/// The true places of nodes, and other names of them: for scores only.
pub(super) const NODES: &str = "nodes.csv";
pub(super) const NAMES: &str = "names.csv";

/// Reads the log in `folder`: `stops.csv` and `receptions.csv`, and `contacts.csv`, `sectors.csv`, `antenna.toml` and
/// `sector_snrs.csv` if they exist. Stops are numbered in the order of `stops.csv`, nodes in the order of their first rows.
///
/// # Errors
/// If a file is missing, cannot be read, or has an invalid row; the error names file, line and column.
pub(super) fn read(folder: &Path, options: &ReadOptions) -> Result<RobotLog, RobotLogError> {
    let mut notes = Vec::new();
    let mut robots = RobotNames::default();
    let names = FieldNames::of_places(options.form.path_fields.as_ref());
    let skips_no_fix = options.repair.skip_no_fix;
    let mut stops = stops::read(&folder.join(STOPS), &names, skips_no_fix, &mut robots, &mut notes)?;
    if stops.stops.is_empty() {
        return Err(RobotLogError::NoStops { path: folder.to_owned() });
    }
    let mut rssi = RssiCheck::new(&options.repair.rssi_missing);
    let receptions::Receptions { names, receptions, left_out, reports } =
        receptions::read(&folder.join(RECEPTIONS), &stops, &options.form, &mut rssi, &mut notes)?;
    notes.extend(left_out_note(&stops, left_out));
    notes.extend(rssi.note());
    let plane = stops.plane;
    let contacts = stops::read_contacts(&folder.join(CONTACTS), plane, &mut robots, &mut notes)?;
    let places = std::mem::take(&mut stops.stops);
    let log = receptions.build(names, places, contacts).and_then(|log| log.with_robots(robots.into_vec()));
    let log = log.map_err(|why| RobotLogError::Log { path: folder.to_owned(), why })?;
    let log = with_sectors(folder, log, &mut notes)?;
    let log = with_sector_snrs(folder, log, &stops, reports, &mut notes)?;
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

/// Reads a wide table, and `contacts.csv`, `sectors.csv` and `antenna.toml` of its folder if they exist.
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
        Some(folder) => {
            refuse_sector_snrs(folder)?;
            with_sectors(folder, log, &mut notes)?
        }
        None => log,
    };
    Ok(RobotLog { findings: findings(&log, of_rssi), log, plane, notes, clock: None })
}

/// The log with the sectors in the folder, if it has any: their directions in `sectors.csv`, their gains in `antenna.toml`.
/// Without `sectors.csv` the directions are those where each sector has the greatest gain.
pub(super) fn with_sectors(
    folder: &Path,
    log: ReceptionLog,
    notes: &mut Vec<String>,
) -> Result<ReceptionLog, RobotLogError> {
    let (sectors, antenna) = (folder.join(SECTORS), folder.join(ANTENNA));
    let directions = if sectors.exists() { Some(sectors::read(&sectors, notes)?) } else { None };
    let gains = if antenna.exists() { Some(antenna_file::read(&antenna, notes)?) } else { None };
    let table = match (directions, gains) {
        (None, None) => return Ok(log),
        (Some(table), None) => table,
        (None, Some(gains)) => SectorTable::from(gains),
        (Some(table), Some(gains)) => {
            table.with_gains(gains).map_err(|why| antenna_file::other_sectors(&antenna, &why))?
        }
    };
    log.with_sectors(table).map_err(|why| RobotLogError::Log { path: folder.to_owned(), why })
}

/// The log with the signal-to-noise ratios of all sectors: the `reports` of `receptions.csv`, if it has a column for them, or
/// those of `sector_snrs.csv`. Repeated ones are averaged.
fn with_sector_snrs(
    folder: &Path,
    log: ReceptionLog,
    stops: &stops::Stops,
    reports: Option<Vec<SectorReport>>,
    notes: &mut Vec<String>,
) -> Result<ReceptionLog, RobotLogError> {
    let path = folder.join(SECTOR_SNRS);
    let reports = match (reports, path.exists()) {
        (None, false) => return Ok(log),
        (Some(reports), false) => reports,
        (None, true) => sector_snrs::read(&path, &log, stops, notes)?,
        (Some(_), true) => {
            let column = sector_snrs::COLUMN;
            let problem = format!("receptions.csv has the column `{column}` too; remove the column, or this file");
            return Err(RobotLogError::Row { path, line: 1, problem });
        }
    };
    let log = log.with_sector_snrs(SectorReport::averaged(reports));
    log.map_err(|why| RobotLogError::Log { path: folder.to_owned(), why })
}

/// Refuses `sector_snrs.csv` beside a log whose stops have no names.
pub(super) fn refuse_sector_snrs(folder: &Path) -> Result<(), RobotLogError> {
    let path = folder.join(SECTOR_SNRS);
    if !path.exists() {
        return Ok(());
    }
    let problem = "found beside a log without stops.csv, so that its stops have no names; allowed: beside stops.csv \
                   and receptions.csv";
    Err(RobotLogError::Row { path, line: 1, problem: problem.to_owned() })
}

/// The note that the signal-to-noise ratios of all sectors are not used, if the folder has them, or `receptions.csv` has the
/// column.
pub(super) fn unused_sector_snrs(folder: &Path, has_column: bool) -> Option<String> {
    (has_column || folder.join(SECTOR_SNRS).exists()).then(|| {
        "the signal-to-noise ratios of all sectors are not used, because the log is mapped part by part".to_owned()
    })
}
