//! Ranges between moving tags and fixed receivers: `ranges.csv` without a path.

use std::collections::BTreeMap;
use std::path::Path as FilePath;

use sextant_channel::{Position, RangeSample, ReceptionLog};
use sextant_kernel::text::{counted, listed};
use sextant_mapper::TagRange;

use super::layout;
use crate::csv::header::{KnownColumns, Others};
use crate::csv::table::Table;
use crate::csv::times::Times;
use crate::csv::written::Written;
use crate::error::robot_log_error::RobotLogError;
use crate::options::form_options::FormOptions;
use crate::path::path_file;
use crate::path::robot_path::Path;
use crate::ranges::range_table::range_column;
use crate::time::instant;

/// The ranges of tags.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TagRanges {
    /// The ranges of each tag by its name; the receivers have the numbers of the places that were given. A log without a column
    /// `tag` has one, called `tag`.
    pub tags: BTreeMap<String, Vec<TagRange>>,
    /// What the user should know.
    pub notes: Vec<String>,
}

impl TagRanges {
    /// The ranges of the robots of a recorded log to its nodes, of which those at `known` places, by name, are receivers: each robot
    /// is a tag. Where it was is not looked at.
    ///
    /// # Errors
    /// If no range is to a known receiver.
    pub fn of_log(
        path: &FilePath,
        log: &ReceptionLog,
        known: &BTreeMap<String, Position>,
    ) -> Result<Self, RobotLogError> {
        let numbers: BTreeMap<&str, usize> =
            known.keys().enumerate().map(|(number, name)| (name.as_str(), number)).collect();
        let mut samples: Vec<&RangeSample> = log.ranges().iter().collect();
        samples.sort_by_key(|sample| sample.time);
        let mut found = Self::default();
        let mut strangers = 0_usize;
        for &&RangeSample { node, robot, time, range_m, .. } in &samples {
            match numbers.get(log.names()[node.index()].as_str()) {
                Some(&receiver) => {
                    let tag = log.robot_name(robot).into_owned();
                    found.tags.entry(tag).or_default().push(TagRange { receiver, time, range_m });
                }
                None => strangers += 1,
            }
        }
        if strangers > 0 {
            let rows = counted(strangers, "range");
            found.notes.push(format!("{rows} to nodes without a known place are not used"));
        }
        if found.tags.is_empty() {
            let name = path.display().to_string();
            let problem = if samples.is_empty() {
                "the recording has no ranges: a scenario with a table `[ranging]` makes them".to_owned()
            } else {
                let names = listed(&known.keys().collect::<Vec<_>>());
                format!("it has no range to a node with a known place; those are {names}")
            };
            return Err(RobotLogError::NoRanges { name, problem });
        }
        Ok(found)
    }
}

/// Reads the ranges of moving tags to receivers at `known` places, by name: the table of ranges in the folder `path`, or the file
/// `path`, with the columns `t_s,node,range_m[,tag]`. `form` gives other names of columns, and the zone of times.
///
/// # Errors
/// If there is no such table, it has an invalid row, or no range is to a known receiver.
pub fn read_tag_ranges(
    path: &FilePath,
    known: &BTreeMap<String, Position>,
    form: &FormOptions,
) -> Result<TagRanges, RobotLogError> {
    let file = if path.is_dir() { layout::ranges_of(path) } else { Some(path.to_owned()) };
    let Some(file) = file else {
        return Err(RobotLogError::NoLog { path: path.to_owned(), found: Vec::new() });
    };
    read_table(&file, known, form)
}

fn read_table(
    file: &FilePath,
    known: &BTreeMap<String, Position>,
    form: &FormOptions,
) -> Result<TagRanges, RobotLogError> {
    let written = Written::of_ranges(form);
    let optional = [&instant::COLUMNS[..], &["tag", "range_m", "range_cm", "range_mm"]].concat();
    let columns =
        KnownColumns { required: &["node"], optional: &optional, names: &written.names, others: Others::Ignored };
    let table = Table::open_known(file, columns)?;
    let mut found = TagRanges { notes: table.ignored().into_iter().collect(), ..TagRanges::default() };
    let name = table.name();
    let (range, unit) = range_column(&table)?;
    let [node, tag] = ["node", "tag"].map(|name| table.column(name));
    let times = Times::of(&table, written.time_zone, &mut found.notes)?;
    let numbers: BTreeMap<&str, usize> =
        known.keys().enumerate().map(|(number, name)| (name.as_str(), number)).collect();
    let mut strangers: BTreeMap<String, usize> = BTreeMap::new();
    let (mut failed, mut before) = (0_usize, 0_usize);
    table.rows(|row| {
        let receiver = row.node(node)?;
        if row.is_blank(range) || row.is_zero(range) {
            failed += 1;
            return Ok(());
        }
        let range_m = row.finite(range)?.unwrap_or_default() / unit;
        if row.is_before_zero(times) {
            before += 1;
            return Ok(());
        }
        let time = row.instant(times)?;
        let Some(&receiver) = numbers.get(&*receiver) else {
            *strangers.entry(receiver.into_owned()).or_default() += 1;
            return Ok(());
        };
        let tag = row.filled(tag).map_or_else(|| "tag".to_owned(), |tag| tag.into_owned());
        found.tags.entry(tag).or_default().push(TagRange { receiver, time, range_m });
        Ok(())
    })?;
    if failed > 0 {
        found.notes.push(format!(
            "{name}: {} without a range, or of exactly 0, count as failed tries",
            counted(failed, "row")
        ));
    }
    if before > 0 {
        found.notes.push(format!("{name}: {} with a time below 0 are not used", counted(before, "row")));
    }
    if !strangers.is_empty() {
        let names: Vec<&String> = strangers.keys().collect();
        let rows: usize = strangers.values().sum();
        found.notes.push(format!(
            "{name}: {} of receivers without a known place are not used: {}",
            counted(rows, "row"),
            listed(&names)
        ));
    }
    if found.tags.is_empty() {
        let problem = format!(
            "it has no range of a receiver with a known place; those are {}",
            listed(&known.keys().collect::<Vec<_>>())
        );
        return Err(RobotLogError::NoRanges { name, problem });
    }
    Ok(found)
}

/// Reads the true path of a tag, to compare a track with: `t_s,x_m,y_m[,z_m]`.
///
/// # Errors
/// If the file cannot be read, or has an invalid row.
pub fn read_true_path(path: &FilePath, form: &FormOptions, notes: &mut Vec<String>) -> Result<Path, RobotLogError> {
    let paths = path_file::read(path, &Written::of_places(form), false, notes)?;
    let mut paths = paths.paths;
    if paths.len() == 1 {
        Ok(paths.remove(0))
    } else {
        Err(RobotLogError::line(
            path,
            1,
            format!("found the paths of {}; allowed: one", counted(paths.len(), "robot")),
        ))
    }
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
        let found = read_tag_ranges(folder.path(), &known, &FormOptions::default()).unwrap();
        assert_eq!(found.tags.keys().collect::<Vec<_>>(), ["x", "y"]);
        assert_eq!(
            found.tags["y"].iter().map(|range| (range.receiver, range.range_m)).collect::<Vec<_>>(),
            [(1, 2.0)]
        );
        for part in ["failed tries", "below 0", "without a known place are not used: c"] {
            assert!(found.notes.iter().any(|note| note.contains(part)), "{part}: {:?}", found.notes);
        }
        let none = BTreeMap::from([("z".to_owned(), Position::ORIGIN)]);
        let why = read_tag_ranges(folder.path(), &none, &FormOptions::default()).unwrap_err();
        assert!(why.to_string().contains("those are z"), "{why}");
    }
}
