//! Logs that have their stops: a table of stops and one of receptions, in files or in memory, or a wide table.

use std::collections::BTreeMap;
use std::path::Path;

use sextant_channel::ReceptionLog;

use super::companions::Companions;
use super::file_names::{RECEPTIONS, STOPS};
use super::layout::StopContent;
use super::stop_files::StopFiles;
use crate::csv::table_source::TableSource;
use crate::csv::written::Written;
use crate::doctor::{self, Finding};
use crate::error::robot_log_error::RobotLogError;
use crate::options::form_options::FormOptions;
use crate::options::read_options::ReadOptions;
use crate::packets::rssi_check::RssiCheck;
use crate::place::local_plane::LocalPlane;
use crate::ranges::range_table::Whereabouts;
use crate::robot_log::RobotLog;
use crate::stops::receptions;
use crate::stops::sector_snrs;
use crate::stops::stop_table;
use crate::stops::wide;
use sextant_kernel::text::counted;
use sextant_recording::RobotNames;

/// The tables of stops and of receptions of a log, and what it has besides.
pub(crate) struct StopLog<'a> {
    pub(crate) stops: TableSource<'a>,
    /// None of a log of ranges alone.
    pub(crate) receptions: Option<TableSource<'a>>,
    pub(crate) companions: Companions<'a>,
}

impl StopLog<'_> {
    /// The files of a folder: `stops.csv` and `receptions.csv`, and `contacts.csv`, `sectors.csv`, `antenna.toml` and
    /// `sector_snrs.csv` if they exist.
    pub(crate) fn of_folder(folder: &Path, form: &FormOptions) -> Self {
        let companions = Companions::of_folder(folder, form.time_zone);
        let receptions = folder.join(RECEPTIONS);
        let has_other = companions.ranges.is_some() && !receptions.exists();
        Self { stops: folder.join(STOPS).into(), receptions: (!has_other).then(|| receptions.into()), companions }
    }
}

/// Reads a log of stops and receptions. Stops are numbered in the order of their rows, nodes in the order of their first rows.
///
/// # Errors
/// If a file is missing, cannot be read, or a table has an invalid row; the error names the row and the column.
pub(crate) fn read(log: StopLog<'_>, options: &ReadOptions) -> Result<RobotLog, RobotLogError> {
    let StopLog { stops, receptions, companions } = log;
    let mut notes = Vec::new();
    let mut robots = RobotNames::default();
    let written = Written::of_places(&options.form);
    let skips_no_fix = options.repair.skip_no_fix;
    let mut stops = stop_table::read(stops, &written, skips_no_fix, &mut robots, &mut notes)?;
    if stops.stops.is_empty() {
        return Err(RobotLogError::NoStops { part: companions.log });
    }
    let mut rssi = RssiCheck::new(options);
    let listens = receptions.is_some();
    let receptions::Receptions { name, mut names, receptions, left_out, reports } = match receptions {
        Some(receptions) => receptions::read(receptions, &stops, &options.form, &mut rssi, &mut notes)?,
        None => receptions::Receptions::none(),
    };
    notes.extend(left_out_note(&stops, &name, left_out));
    notes.extend(rssi.note());
    let plane = stops.plane;
    let contacts = companions.contacts(plane, &mut robots, &mut notes)?;
    let places = std::mem::take(&mut stops.stops);
    let whereabouts = Whereabouts::Stops { stops: &places, ids: &stops.ids };
    let ranges = companions.ranges(&options.form, whereabouts, None, &names, &mut notes)?;
    let samples = ranges.map(|ranges| {
        names.extend(ranges.strangers);
        ranges.samples
    });
    if listens && names.is_empty() && left_out == 0 {
        return Err(RobotLogError::NoPackets);
    }
    let log = receptions.build(names, places, contacts).and_then(|log| log.with_robots(robots.into_vec()));
    let log = log.and_then(|log| log.with_ranges(samples.unwrap_or_default()));
    let log = log.map_err(|why| RobotLogError::Log { part: companions.log.clone(), why })?;
    let log = companions.with_sectors(log, &mut notes)?;
    let known = sector_snrs::KnownParts { stops: &stops, receptions: &name };
    let log = companions.with_sector_snrs(log, reports, known, &mut notes)?;
    Ok(RobotLog {
        findings: findings(&log, plane.as_ref(), rssi.findings()),
        log,
        plane,
        notes,
        clock: None,
        middles: BTreeMap::new(),
        odometry: None,
    })
}

/// The note on stops that were left out, with so many rows of `receptions`.
pub(crate) fn left_out_note(stops: &stop_table::Stops, receptions: &str, left_out: usize) -> Option<String> {
    let (name, rows) = (&stops.name, counted(stops.left_out.len(), "row"));
    (!stops.left_out.is_empty()).then(|| {
        format!(
            "{name}: {rows} without a fix are left out, with {left_out} rows of {receptions} (option `skip_no_fix`)"
        )
    })
}

/// What is odd in a log of stops with places in `plane`, of whose strengths `of_rssi` is odd.
fn findings(log: &ReceptionLog, plane: Option<&LocalPlane>, of_rssi: Vec<Finding>) -> Vec<Finding> {
    let mut findings = doctor::of_stops(log, plane);
    findings.extend(of_rssi);
    findings.extend(doctor::listening::finding(log, None));
    findings
}

/// Reads a log of one file a stop in the folder `folder`.
///
/// # Errors
/// If a file cannot be read or has an invalid row.
pub(crate) fn read_stop_files(
    folder: &Path,
    files: &StopFiles,
    content: StopContent,
    options: &ReadOptions,
) -> Result<RobotLog, RobotLogError> {
    let companions = Companions::of_folder(folder, options.form.time_zone);
    let mut log = match content {
        StopContent::Scans => read_wide(TableSource::Files(files.of_scans()), &companions, options),
        StopContent::Receptions => {
            let stops = files.stops()?;
            let stops = stops.as_ref().map_or_else(|| folder.join(STOPS).into(), TableSource::from);
            read(StopLog { stops, receptions: Some(TableSource::Files(files.of_receptions())), companions }, options)
        }
    }?;
    log.notes.insert(0, files.note.clone());
    Ok(log)
}

/// Reads a wide table, and the contacts and the antenna beside it if they exist.
///
/// # Errors
/// If a file cannot be read or has an invalid row.
pub(crate) fn read_wide(
    table: TableSource<'_>,
    companions: &Companions<'_>,
    options: &ReadOptions,
) -> Result<RobotLog, RobotLogError> {
    let mut notes = Vec::new();
    let part = table.part();
    let mut wide = wide::read(table, options, &mut notes)?;
    let of_rssi = std::mem::take(&mut wide.findings);
    let plane = wide.plane;
    let contacts = companions.contacts(plane, &mut wide.robots, &mut notes)?;
    let log = wide.build(contacts).map_err(|why| RobotLogError::Log { part, why })?;
    companions.refuse_sector_snrs()?;
    let log = companions.with_sectors(log, &mut notes)?;
    Ok(RobotLog {
        findings: findings(&log, plane.as_ref(), of_rssi),
        log,
        plane,
        notes,
        clock: None,
        middles: BTreeMap::new(),
        odometry: None,
    })
}

/// The note that the signal-to-noise ratios of all sectors are not used, if the log has them, or its receptions have the
/// column.
pub(crate) fn unused_sector_snrs(companions: &Companions<'_>, has_column: bool) -> Option<String> {
    (has_column || companions.sector_snrs.is_some()).then(|| {
        "the signal-to-noise ratios of all sectors are not used, because the log is mapped part by part".to_owned()
    })
}
