//! Ranges and strengths between moving tags and fixed receivers, without a path that is trusted.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path as FilePath;

use sextant_channel::Position;
use sextant_kernel::text::{are, counted, listed};
use sextant_mapper::{TagReading, TagValue};

use super::reading_table::{Odometry, ReadingTables};
use super::repeated;
use crate::csv::memory_table::MemoryTable;
use crate::csv::table_source::TableSource;
use crate::csv::written::Written;
use crate::error::log_part::{LogPart, RowAddress};
use crate::error::robot_log_error::RobotLogError;
use crate::log::file_names;
use crate::log::form::{self, Form, PathKind};
use crate::log::layout;
use crate::log::recognition;
use crate::options::read_options::ReadOptions;
use crate::path::headings::{self, PathHeadings};
use crate::path::path_file;
use crate::path::robot_path::Path;
use crate::path::tum;
use crate::ranges::dwm1001;
use crate::ranges::levers::{Levers, TagPlaces};

/// The name of the robot that carries the tags.
const ROBOT: &str = "robot";

/// What was measured between tags and receivers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TagReadings {
    /// The readings of each tag by its name; the receivers have the numbers of the places that were given. A log without a column of
    /// tags has one, called `tag`. With odometry, all tags are on one robot, called `robot`.
    pub tags: BTreeMap<String, Vec<TagReading>>,
    /// What the user should know.
    pub notes: Vec<String>,
}

/// Tables in memory with what was measured between tags and receivers.
#[derive(Clone, Debug, Default)]
pub struct TagTables<'a> {
    /// Ranges, with strengths beside them where there are any.
    pub ranges: Option<MemoryTable<'a>>,
    /// Packets with strengths.
    pub packets: Option<MemoryTable<'a>>,
    /// The path of the robot that carries the tags, by odometry that drifts.
    pub odometry: Option<MemoryTable<'a>>,
    /// Where the tags are on it.
    pub tags: Option<MemoryTable<'a>>,
}

/// The parts of a log of tags.
#[derive(Default)]
struct Parts<'a> {
    ranges: Option<TableSource<'a>>,
    packets: Option<TableSource<'a>>,
    odometry: Option<TableSource<'a>>,
    tags: Option<TableSource<'a>>,
}

/// Whether the folder or the file `path` has ranges or packets of tags, and no stops.
#[must_use]
pub fn has_tag_readings(path: &FilePath) -> bool {
    if !path.is_dir() {
        return true;
    }
    let has = |name: &str| path.join(name).exists();
    !has(file_names::STOPS)
        && !has(file_names::RECEPTIONS)
        && (layout::ranges_of(path).is_some() || has(file_names::PACKETS))
}

/// Reads what was measured between tags and receivers at `known` places, by name: the tables of ranges and packets in the folder
/// `path`, or the table `path`, with the columns `t_s,node,range_m[,tag]` or `t_s,node,rssi_dbm[,tag]`, or
/// `t_s,receiver,node,rssi_dbm`. `odometry.csv`, and where the tags are on the robot (`tags.csv`), are used if they are there.
///
/// # Errors
/// If there is no such table, it has an invalid row, nothing is of a known receiver, or `options` are for another form of log.
pub fn read_tag_readings(
    path: &FilePath,
    known: &BTreeMap<String, Position>,
    options: &ReadOptions,
) -> Result<TagReadings, RobotLogError> {
    form::refuse(&path.into(), Form::Tags, options)?;
    std::fs::metadata(path).map_err(|why| RobotLogError::read(path, why))?;
    let mut parts = Parts { packets: options.form.packets.clone().map(TableSource::from), ..Parts::default() };
    if path.is_dir() {
        let file = |name: &str| Some(path.join(name)).filter(|file| file.exists()).map(TableSource::from);
        parts.ranges = layout::ranges_of(path).map(TableSource::from);
        parts.packets = parts.packets.or_else(|| file(file_names::PACKETS));
        parts.odometry = file(file_names::ODOMETRY);
        parts.tags = file(file_names::TAGS);
        if parts.ranges.is_none() && parts.packets.is_none() {
            return Err(RobotLogError::NoLog { path: path.to_owned(), found: Vec::new() });
        }
    } else {
        recognition::refuse_foreign(path)?;
        parts.ranges = Some(path.into());
    }
    if let Some(file) = &options.form.path {
        parts.odometry = Some(file.clone().into());
    }
    read_parts(parts, &path.display().to_string(), known, options)
}

/// The same of tables in memory.
///
/// # Errors
/// If a table has an invalid row, nothing is of a known receiver, or `options` are for another form of log.
pub fn read_tag_tables(
    tables: &TagTables<'_>,
    known: &BTreeMap<String, Position>,
    options: &ReadOptions,
) -> Result<TagReadings, RobotLogError> {
    form::refuse(&LogPart::Table("ranges".to_owned()), Form::Tags, options)?;
    let parts = Parts {
        ranges: tables.ranges.as_ref().map(TableSource::from),
        packets: tables.packets.as_ref().map(TableSource::from),
        odometry: tables.odometry.as_ref().map(TableSource::from),
        tags: tables.tags.as_ref().map(TableSource::from),
    };
    read_parts(parts, "the log", known, options)
}

fn read_parts(
    parts: Parts<'_>,
    name: &str,
    known: &BTreeMap<String, Position>,
    options: &ReadOptions,
) -> Result<TagReadings, RobotLogError> {
    let mut notes = Vec::new();
    let odometry = read_odometry(&parts, options, &mut notes)?;
    let mut tables = ReadingTables::new(known, options, odometry.as_ref());
    if let Some(ranges) = parts.ranges {
        match &ranges {
            TableSource::File(file) if dwm1001::is_output(file) => {
                let table = dwm1001::read(file, options.form.time_zone)?;
                tables.read(TableSource::from(&table), &Written::default())?;
            }
            _ => tables.read(ranges, &Written::of_ranges(&options.form))?,
        }
    }
    if let Some(packets) = parts.packets {
        tables.read(packets, &Written::of_packets(&options.form))?;
    }
    tables.finish()?;
    let ReadingTables { mut tags, notes: more, .. } = tables;
    notes.extend(more);
    if tags.is_empty() {
        let names = listed(&known.keys().collect::<Vec<_>>());
        let problem = format!("it has no range and no strength of a receiver with a known place; those are {names}");
        return Err(RobotLogError::NoRanges { name: name.to_owned(), problem });
    }
    if let Some(odometry) = &odometry {
        if odometry.levers.is_none() && tags.len() > 1 {
            let names = listed(&tags.keys().collect::<Vec<_>>());
            let problem = format!(
                "{} is the path of one robot, and there are several tags: {names}; tags.csv (tag,x_m,y_m[,z_m]) says where they \
                 are on it",
                odometry.name
            );
            return Err(RobotLogError::Form { problem });
        }
        notes.push(format!("{} is the path by odometry, which is corrected", odometry.name));
        let all = tags.into_values().flatten().collect();
        tags = BTreeMap::from([(ROBOT.to_owned(), all)]);
    }
    Ok(TagReadings { tags, notes }.ready())
}

/// The path of the robot that carries the tags, and where they are on it.
fn read_odometry(
    parts: &Parts<'_>,
    options: &ReadOptions,
    notes: &mut Vec<String>,
) -> Result<Option<Odometry>, RobotLogError> {
    let tags = parts.tags.clone().map(|tags| TagPlaces::read(tags, notes)).transpose()?;
    let Some(source) = &parts.odometry else {
        return match &parts.tags {
            Some(tags) => Err(wrong_part(
                tags.part(),
                "it says where tags are on a robot, but there is no path with its headings; allowed: beside odometry.csv with the \
                 column heading_rad or heading_deg",
            )),
            None => Ok(None),
        };
    };
    let written = Written::of_places(&options.form);
    let skips_no_fix = options.repair.skip_no_fix;
    let paths = match source {
        TableSource::File(file) if recognition::path_kind(file) == PathKind::Tum => {
            tum::read(file, skips_no_fix, notes)?
        }
        TableSource::File(file) if recognition::path_kind(file) != PathKind::Csv => {
            return Err(wrong_part(
                source.part(),
                "found a path that is no odometry; allowed: CSV (t_s,x_m,y_m) or TUM",
            ));
        }
        _ => path_file::read(source.clone(), &written, skips_no_fix, notes)?,
    };
    let name = source.part().name();
    let count = paths.paths.len();
    let Ok([path]) = <[Path; 1]>::try_from(paths.paths) else {
        return Err(wrong_part(
            source.part(),
            format!("found the paths of {count} robots; allowed: one, that carries the tags"),
        ));
    };
    if paths.plane.is_some() {
        return Err(wrong_part(source.part(), "found latitudes and longitudes; allowed: x_m,y_m, in any frame"));
    }
    let levers = match tags {
        Some(tags) => Some(Levers { tags, headings: PathHeadings::read(source.clone(), &written)?.of_one() }),
        None => {
            notes.extend(paths.headings.map(|column| headings::unused_note(&name, column)));
            None
        }
    };
    Ok(Some(Odometry { path, name, levers }))
}

/// The error that a part of the log is not what is needed.
fn wrong_part(part: LogPart, problem: impl Into<String>) -> RobotLogError {
    let at = match part {
        LogPart::File(path) => RowAddress::File { path, line: 1 },
        LogPart::Table(name) => RowAddress::Table { name, row: None },
    };
    RobotLogError::Row { at, problem: problem.into() }
}

impl TagReadings {
    /// The readings that are used: ranges, and the strengths of receivers to which a tag has no ranges; strengths add nothing to
    /// ranges.
    pub(super) fn ready(mut self) -> Self {
        self.notes.extend(self.tags.iter().filter_map(|(tag, readings)| repeated::note(tag, readings)));
        let mut left_out = 0_usize;
        for readings in self.tags.values_mut() {
            let is_range = |reading: &TagReading| matches!(reading.value, TagValue::Range(_));
            let ranged: BTreeSet<usize> =
                readings.iter().filter(|reading| is_range(reading)).map(|reading| reading.receiver).collect();
            let before = readings.len();
            readings.retain(|reading| is_range(reading) || !ranged.contains(&reading.receiver));
            left_out += before - readings.len();
        }
        if left_out > 0 {
            self.notes.push(format!(
                "{} of receivers with ranges {} not used, because ranges say more",
                counted(left_out, "strength"),
                are(left_out)
            ));
        }
        self
    }
}

/// Reads the true path of a tag, to compare a track with: `t_s,x_m,y_m[,z_m]`.
///
/// # Errors
/// If the file cannot be read, or has an invalid row.
pub fn read_true_path(
    path: &FilePath,
    options: &ReadOptions,
    notes: &mut Vec<String>,
) -> Result<Path, RobotLogError> {
    only_path(path.into(), options, notes)
}

/// The same of a table in memory.
///
/// # Errors
/// If the table has an invalid row.
pub fn read_true_path_table(
    table: &MemoryTable<'_>,
    options: &ReadOptions,
    notes: &mut Vec<String>,
) -> Result<Path, RobotLogError> {
    only_path(table.into(), options, notes)
}

fn only_path(source: TableSource<'_>, options: &ReadOptions, notes: &mut Vec<String>) -> Result<Path, RobotLogError> {
    let part = source.part();
    let paths = path_file::read(source, &Written::of_places(&options.form), false, notes)?;
    let count = paths.paths.len();
    let Ok([path]) = <[Path; 1]>::try_from(paths.paths) else {
        return Err(wrong_part(part, format!("found the paths of {}; allowed: one", counted(count, "robot"))));
    };
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::folder_of;

    #[test]
    fn ranges_of_two_tags_are_told_apart_and_strangers_are_named() {
        let text = "t_s,tag,node,range_cm\n0,x,a,100\n0,y,b,200\n1,x,b,\n1,x,c,5\n-1,x,a,7\n";
        let folder = folder_of([("ranges.csv", text)]);
        let known: BTreeMap<String, Position> =
            ["a", "b"].map(|name| (name.to_owned(), Position::ORIGIN)).into_iter().collect();
        let found = read_tag_readings(folder.path(), &known, &ReadOptions::default()).unwrap();
        assert_eq!(found.tags.keys().collect::<Vec<_>>(), ["x", "y"]);
        assert_eq!(
            found.tags["y"].iter().map(|range| (range.receiver, range.value)).collect::<Vec<_>>(),
            [(1, TagValue::Range(2.0))]
        );
        for part in ["failed tries", "below 0", "without a known place is not used: c"] {
            assert!(found.notes.iter().any(|note| note.contains(part)), "{part}: {:?}", found.notes);
        }
        let none = BTreeMap::from([("z".to_owned(), Position::ORIGIN)]);
        let why = read_tag_readings(folder.path(), &none, &ReadOptions::default()).unwrap_err();
        assert!(why.to_string().contains("those are z"), "{why}");
    }
}
