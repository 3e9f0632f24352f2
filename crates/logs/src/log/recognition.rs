//! What a file of a log is, by its name and its first lines.

use std::path::Path;

use sextant_kernel::{FileForm, root_of_xml};

use super::form::PathKind;
use crate::csv::header::{KnownColumns, Others};
use crate::csv::table::Table;
use crate::error::robot_log_error::RobotLogError;
use crate::options::field_names::FieldNames;
use crate::options::form_options::FormOptions;
use crate::path::nmea;
use crate::path::tum;
use crate::ranges::units::RANGE_COLUMNS;

/// Whether the file `path` can be part of a log: a table, or a path.
pub(crate) fn is_part(path: &Path) -> bool {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    let is_table = || ["csv", "tsv", "txt"].iter().any(|&known| extension.as_deref() == Some(known));
    path.is_file() && (is_table() || path_kind(path) != PathKind::Csv || begins_as_table(path))
}

/// Whether a text with any name begins as a table does: its first two lines have equally many cells, more than one.
fn begins_as_table(path: &Path) -> bool {
    if FileForm::of_file(path).is_some() {
        return false;
    }
    let start = start(path);
    let mut lines = start.lines().filter(|line| !line.trim().is_empty());
    let (Some(header), Some(row)) = (lines.next(), lines.next()) else { return false };
    let is_text = !start.contains(['\0', char::REPLACEMENT_CHARACTER]);
    let cells = |line: &str, separator: char| line.matches(separator).count();
    is_text && [',', ';', '\t'].iter().any(|&sign| cells(header, sign) > 0 && cells(header, sign) == cells(row, sign))
}

/// Refuses a file that no reader of logs reads, and says what it is.
pub(crate) fn refuse_foreign(file: &Path) -> Result<(), RobotLogError> {
    match FileForm::of_file(file) {
        Some(form) => Err(RobotLogError::Foreign { path: file.to_owned(), told: form.told(file) }),
        None => Ok(()),
    }
}

/// Whether a table in a folder has distances to nodes, and not packets: its name or its columns say so.
pub(crate) fn are_ranges(file: &Path) -> bool {
    /// What columns of distances are called.
    const RANGES: [&str; 5] = ["range", "ranges", "distance", "distance_m", "distance_mm"];
    let stem = file.file_stem().unwrap_or_default().to_string_lossy().to_lowercase();
    if ["range", "ranges", "ranging"].contains(&stem.as_str()) {
        return true;
    }
    let none = FieldNames::default();
    let known = KnownColumns { required: &[], optional: &[], names: &none, others: Others::Ignored };
    let table = Table::open_known(file, known);
    table.is_ok_and(|table| {
        let names: Vec<String> = table.unknown().map(|(_, name)| name.to_lowercase()).collect();
        let has = |wanted: &[&str]| names.iter().any(|name| wanted.contains(&name.as_str()));
        (has(&RANGES) || has(&RANGE_COLUMNS))
            && has(&["node", "anchor", "beacon", "tag"])
            && !has(&["rssi_dbm", "rssi"])
    })
}

/// What the file is by its first lines, if it is no bag.
pub(crate) fn path_kind(file: &Path) -> PathKind {
    let start = start(file);
    let text = start.trim_start_matches('\u{feff}').trim_start();
    if root_of_xml(text).is_some_and(|root| root == "gpx") {
        return PathKind::Gpx;
    }
    if text.lines().any(nmea::is_sentence) {
        return PathKind::Nmea;
    }
    match text.lines().find(|line| !tum::is_blank(line)) {
        Some(line) if tum::is_pose(line) => PathKind::Tum,
        _ => PathKind::Csv,
    }
}

/// The first octets of a file as text, up to the last whole line of these; empty if it cannot be read.
fn start(file: &Path) -> String {
    use std::io::Read;
    const LONGEST: u64 = 1 << 14;
    let mut octets = Vec::new();
    let read = std::fs::File::open(file).and_then(|file| file.take(LONGEST).read_to_end(&mut octets));
    if read.is_err() {
        return String::new();
    }
    if octets.len() as u64 == LONGEST {
        octets.truncate(octets.iter().rposition(|&octet| octet == b'\n').unwrap_or(octets.len()));
    }
    String::from_utf8_lossy(&octets).into_owned()
}

/// Whether a CSV file has a column with the names of nodes.
pub(crate) fn names_nodes(file: &Path, form: &FormOptions) -> bool {
    let none = FieldNames::default();
    let known = KnownColumns { required: &[], optional: &[], names: &none, others: Others::Ignored };
    let given = |key: &str| form.packet_fields.as_ref().and_then(|names| names.name(key));
    if form.packet_fields.as_ref().is_some_and(FieldNames::has_numbers) {
        return given("node").or_else(|| given("receiver")).is_some();
    }
    let is_node = |name: &str| ["node", "receiver"].iter().any(|&key| name == given(key).unwrap_or(key));
    Table::open_known(file, known).is_ok_and(|table| table.unknown().any(|(_, name)| is_node(name)))
}
