//! A table with ranges or strengths between tags and receivers at known places.

use std::borrow::Cow;
use std::collections::BTreeMap;

use sextant_channel::{Mounting, Position};
use sextant_kernel::SimTime;
use sextant_kernel::text::{are, counted, counts, listed};
use sextant_mapper::{OnRobot, TagReading};

use crate::csv::header::{KnownColumns, Others};
use crate::csv::table::{Column, Table, TableRow};
use crate::csv::table_source::TableSource;
use crate::csv::times::Times;
use crate::csv::written::Written;
use crate::error::robot_log_error::RobotLogError;
use crate::options::read_options::ReadOptions;
use crate::packets::rssi_check::RssiCheck;
use crate::packets::strengths::{Report, Strengths};
use crate::path::robot_path::Path;
use crate::ranges::levers::Levers;
use crate::ranges::range_table::optional_range_column;
use crate::ranges::units::{OTHER_COLUMNS, RANGE_COLUMNS};
use crate::time::instant;

/// What gives the place of a robot that carries the tags.
pub(super) struct Odometry {
    pub(super) path: Path,
    /// What it is called in errors.
    pub(super) name: String,
    pub(super) levers: Option<Levers>,
}

/// What is known of receivers and tags while tables are read.
pub(super) struct ReadingTables<'a> {
    pub(super) options: &'a ReadOptions,
    numbers: BTreeMap<&'a str, usize>,
    pub(super) odometry: Option<&'a Odometry>,
    strengths: Strengths,
    check: RssiCheck,
    /// The readings of each tag.
    pub(super) tags: BTreeMap<String, Vec<TagReading>>,
    pub(super) notes: Vec<String>,
    has_strengths: bool,
}

/// The columns of a table.
struct ReadingColumns {
    /// The receiver, at a known place.
    fixed: Column,
    /// What may name the tag; the first one that does counts.
    movers: [Column; 3],
    times: Times,
    /// The range, and a metre in its unit.
    range: Option<(Column, f64)>,
    rssi: Column,
    snr: Column,
}

/// What is counted of a table.
#[derive(Default)]
struct Left<'a> {
    failed: usize,
    before: usize,
    outside: usize,
    of_others: usize,
    strangers: BTreeMap<Cow<'a, str>, usize>,
}

impl<'a> ReadingTables<'a> {
    pub(super) fn new(
        known: &'a BTreeMap<String, Position>,
        options: &'a ReadOptions,
        odometry: Option<&'a Odometry>,
    ) -> Self {
        Self {
            options,
            numbers: known.keys().enumerate().map(|(number, name)| (name.as_str(), number)).collect(),
            odometry,
            strengths: Strengths::of(&options.form),
            check: RssiCheck::new(options),
            tags: BTreeMap::new(),
            notes: Vec::new(),
            has_strengths: false,
        }
    }

    /// Reads a table with the columns `t_s`, `node`, and `range_m` or `rssi_dbm`, or both; as it is `written`. Of a column
    /// `receiver` the fixed end is that, and `node` is the tag. Otherwise `node` is the fixed end, and `tag` or `robot` the tag.
    pub(super) fn read(&mut self, source: TableSource<'_>, written: &Written) -> Result<(), RobotLogError> {
        const OPTIONAL: [&str; 6] = ["node", "receiver", "tag", "robot", "rssi_dbm", "snr_db"];
        let optional = [&instant::COLUMNS[..], &OPTIONAL, &RANGE_COLUMNS].concat();
        let known =
            KnownColumns { required: &[], optional: &optional, names: &written.names, others: Others::Ignored };
        let table = Table::open_known(source, known)?;
        self.notes.extend(table.notes());
        let name = table.name();
        let [node, receiver, tag, robot] = ["node", "receiver", "tag", "robot"].map(|name| table.column(name));
        let [rssi, snr] = ["rssi_dbm", "snr_db"].map(|name| table.column(name));
        let range = optional_range_column(&table)?;
        if !receiver.exists() && (self.options.form.reciprocal || !node.exists()) {
            let (wanted, why) = if self.options.form.reciprocal {
                ("receiver", "with option `reciprocal`, it names the fixed receiver that heard the packet of a tag")
            } else {
                ("node", "it names the receiver at a known place")
            };
            return Err(table.wrong_header(format!("column `{wanted}` is missing; {why}{}", table.hint(wanted))));
        }
        if range.is_none() && !rssi.exists() {
            return Err(table.wrong_header(format!(
                "column `range_m` is missing; a track needs ranges (range_m, or {OTHER_COLUMNS}) or strengths (rssi_dbm){}",
                table.hint("range_m")
            )));
        }
        let (fixed, movers) =
            if receiver.exists() { (receiver, [node, tag, robot]) } else { (node, [tag, robot, robot]) };
        let times = Times::of(&table, written.time_zone, &mut self.notes)?;
        if let Some(Odometry { levers: Some(levers), .. }) = self.odometry {
            levers.tags.check(&table, movers[0])?;
        }
        let mut left = Left::default();
        let columns = ReadingColumns { fixed, movers, times, range, rssi, snr };
        table.rows(|row| self.take(row, &columns, &mut left))?;
        self.tell(&name, &left);
        Ok(())
    }

    fn take(
        &mut self,
        row: &TableRow<'_>,
        columns: &ReadingColumns,
        left: &mut Left<'_>,
    ) -> Result<(), RobotLogError> {
        let &ReadingColumns { fixed, movers, times, range, rssi, snr } = columns;
        let receiver = row.node(fixed)?;
        let range_m = match range {
            Some((column, _)) if row.is_blank(column) || row.is_zero(column) => {
                left.failed += 1;
                None
            }
            Some((column, unit)) => row.finite(column)?.map(|range| range / unit),
            None => None,
        };
        let report = self.check.take(if row.is_blank(rssi) { None } else { row.finite(rssi)? });
        let rssi_dbm = match self.strengths.take(report, row.finite(snr)?) {
            Report::Heard(rssi_dbm) => rssi_dbm,
            Report::Noise => None,
        };
        if range_m.is_none() && rssi_dbm.is_none() {
            return Ok(());
        }
        if row.is_before_zero(times) {
            left.before += 1;
            return Ok(());
        }
        let time = row.instant(times)?;
        let mover = movers.iter().find_map(|&column| row.filled(column));
        if let Some(wanted) = &self.options.form.transmitter
            && mover.as_deref() != Some(wanted.as_str())
        {
            left.of_others += 1;
            return Ok(());
        }
        let Some(&receiver) = self.numbers.get(&*receiver) else {
            *left.strangers.entry(receiver.into_owned().into()).or_default() += 1;
            return Ok(());
        };
        let mover = mover.map_or_else(|| "tag".to_owned(), Cow::into_owned);
        let on_robot = match self.odometry {
            Some(odometry) => match odometry.at(row, movers[0], time)? {
                Some(on_robot) => Some(on_robot),
                None => {
                    left.outside += 1;
                    return Ok(());
                }
            },
            None => None,
        };
        let readings = self.tags.entry(mover).or_default();
        if let Some(range_m) = range_m {
            readings.push(TagReading { on_robot, ..TagReading::range(receiver, time, range_m) });
        }
        if let Some(rssi_dbm) = rssi_dbm {
            self.has_strengths = true;
            readings.push(TagReading { on_robot, ..TagReading::strength(receiver, time, rssi_dbm) });
        }
        Ok(())
    }

    /// Notes what is not used of a table.
    fn tell(&mut self, name: &str, left: &Left<'_>) {
        let Left { failed, before, outside, of_others, strangers } = left;
        for (count, why) in [
            (*failed, format!("without a range, or of exactly 0, {} as failed tries", counts(*failed))),
            (*before, format!("with a time below 0 {} not used", are(*before))),
            (
                *outside,
                format!("from before the path begins, after it ends or from gaps of it {} not used", are(*outside)),
            ),
            (*of_others, format!("of other transmitters {} not used (option `transmitter`)", are(*of_others))),
        ] {
            if count > 0 {
                self.notes.push(format!("{name}: {} {why}", counted(count, "row")));
            }
        }
        if !strangers.is_empty() {
            let names: Vec<&Cow<'_, str>> = strangers.keys().collect();
            let rows: usize = strangers.values().sum();
            self.notes.push(format!(
                "{name}: {} of receivers without a known place {} not used: {}",
                counted(rows, "row"),
                are(rows),
                listed(&names)
            ));
        }
    }

    /// Ends the reading: notes on strengths.
    pub(super) fn finish(&mut self) -> Result<(), RobotLogError> {
        let (form, repair) = (&self.options.form, &self.options.repair);
        if self.has_strengths || form.noise_floor.is_some() || form.lora {
            self.strengths.finish(&mut self.notes)?;
        }
        if !repair.rssi_missing.is_empty() {
            self.notes.extend(self.check.note());
        }
        let told = ["impossible-strengths", "silence-as-strength"];
        let findings = self.check.findings().into_iter().filter(|finding| told.contains(&finding.check));
        self.notes.extend(findings.map(|finding| finding.to_string()));
        Ok(())
    }
}

impl Odometry {
    /// Where the robot is at the time of a row, and its tag on it; `None` outside of the path.
    fn at(&self, row: &TableRow<'_>, tag: Column, time: SimTime) -> Result<Option<OnRobot>, RobotLogError> {
        let Some(believed) = self.path.at(time) else { return Ok(None) };
        let mounting = match &self.levers {
            Some(levers) => levers.of(row, tag, "", time)?,
            None => Mounting::default(),
        };
        Ok(Some(OnRobot { believed, mounting }))
    }
}
