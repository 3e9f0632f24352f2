//! `ranges.csv`: one row for each distance that a robot measured, at a stop or on its path.

use std::collections::BTreeMap;
use std::fmt::Write;

use sextant_channel::{Mounting, Position, RangeSample, ReceptionLog, Stop};
use sextant_kernel::text::{are, counted, counts};
use sextant_kernel::{NodeId, RobotId, SimTime};

use super::levers::Levers;
use super::odd_values;
use super::units::{OTHER_COLUMNS, RANGE_COLUMNS, RANGES};
use crate::csv::header::{KnownColumns, Others};
use crate::csv::output::Output;
use crate::csv::table::{Column, Table, TableRow};
use crate::csv::table_source::TableSource;
use crate::csv::times::Times;
use crate::csv::written::Written;
use crate::error::robot_log_error::RobotLogError;
use crate::path::robot_path::{Path, span_of};
use crate::time::instant;

/// The columns of ranges as [`write`] writes them: with the robot's own place and velocity.
const WRITTEN: [&str; 10] =
    ["stop", "t_s", "node", "range_m", "x_m", "y_m", "z_m", "vx_m_per_s", "vy_m_per_s", "vz_m_per_s"];
/// Those of them that say where and how fast.
const OWN_PLACE: [&str; 6] = ["x_m", "y_m", "z_m", "vx_m_per_s", "vy_m_per_s", "vz_m_per_s"];
/// The longest range that a device of a robot can have measured (m).
pub(crate) const LONGEST_M: f64 = 1e6;

/// Where robots were when they measured.
#[derive(Clone, Copy)]
pub(crate) enum Whereabouts<'a> {
    /// At stops with these names.
    Stops { stops: &'a [Stop], ids: &'a BTreeMap<String, u32> },
    /// On paths, of the robots with these names; no names of one robot. The times of the ranges are late by so much (s).
    Paths { paths: &'a [&'a Path], robots: &'a [String], delay_s: f64 },
}

/// Ranges that were read.
pub(crate) struct ReadRanges {
    pub(crate) samples: Vec<RangeSample>,
    /// The names of the nodes in the samples that were not known before, in the order of their numbers.
    pub(crate) strangers: Vec<String>,
}

/// Where a robot was, and how fast.
struct Pose {
    robot: RobotId,
    time: SimTime,
    position: Position,
    velocity: Position,
}

/// The columns that say where a range was measured.
struct Placing<'a> {
    whereabouts: Whereabouts<'a>,
    stop: Column,
    time: Option<Times>,
    robot: Column,
    /// The columns of places and velocities of the rows themselves; `None` if a log of stops has not all of them, and times.
    own: Option<[Column; 6]>,
}

/// Reads the ranges in a table, as it is `written`, to nodes of which those in `known` have numbers already. Of tags on robots, each was
/// measured where its tag was.
pub(crate) fn read(
    source: TableSource<'_>,
    written: &Written,
    levers: Option<&Levers>,
    whereabouts: Whereabouts<'_>,
    known: &[String],
    notes: &mut Vec<String>,
) -> Result<ReadRanges, RobotLogError> {
    let optional = [&instant::COLUMNS[..], &["stop", "robot", "tag"], &OWN_PLACE, &RANGE_COLUMNS].concat();
    let columns =
        KnownColumns { required: &["node"], optional: &optional, names: &written.names, others: Others::Ignored };
    let table = Table::open_known(source, columns)?;
    notes.extend(table.notes());
    let name = table.name();
    let (range, unit) = range_column(&table)?;
    let node = table.column("node");
    let tag = table.column("tag");
    if let Some(levers) = levers {
        levers.tags.check(&table, tag)?;
    }
    let placing = Placing::of(whereabouts, &table, written, notes)?;
    let mut numbers: BTreeMap<String, NodeId> =
        known.iter().enumerate().map(|(number, name)| (name.clone(), NodeId::from_index(number))).collect();
    let mut read = ReadRanges { samples: Vec::new(), strangers: Vec::new() };
    let (mut failed, mut zero, mut outside, mut span) = (0_usize, 0_usize, 0_usize, None::<(SimTime, SimTime)>);
    table.rows(|row| {
        let name = row.node(node)?;
        if row.is_blank(range) {
            failed += 1;
            return Ok(());
        }
        let range_m = row.finite(range)?.unwrap_or_default() / unit;
        if range_m.abs() > LONGEST_M {
            return Err(row.wrong(range, format!("a range of at most {LONGEST_M} m")));
        }
        if row.is_zero(range) {
            zero += 1;
            return Ok(());
        }
        let Some(Pose { robot, time, position, velocity }) = placing.pose(row)? else {
            outside += 1;
            if let Some(time) = placing.time_of(row)? {
                let (first, last) = span.unwrap_or((time, time));
                span = Some((first.min(time), last.max(time)));
            }
            return Ok(());
        };
        let next = NodeId::from_index(known.len() + read.strangers.len());
        let node = *numbers.entry(name.clone().into_owned()).or_insert(next);
        if node == next {
            read.strangers.push(name.into_owned());
        }
        let mounting = match levers {
            Some(levers) => levers.of(row, tag, placing.robot_name(robot), time)?,
            None => Mounting::default(),
        };
        let position = position + mounting.arm;
        read.samples.push(RangeSample { node, robot, time, position, mounting, velocity, range_m });
        Ok(())
    })?;
    let nodes = read.samples.iter().map(|sample| sample.node).collect::<std::collections::BTreeSet<_>>().len();
    notes.push(format!("{name}: {} to {}", counted(read.samples.len(), "range"), counted(nodes, "node")));
    if failed > 0 {
        notes.push(format!("{name}: {} without a range {} as failed tries", counted(failed, "row"), counts(failed)));
    }
    if zero > 0 {
        notes.push(format!("{name}: {} of exactly 0 {} as failed tries", counted(zero, "range"), counts(zero)));
    }
    if outside > 0 {
        notes.push(format!(
            "{name}: {} from before the path begins, after it ends or from gaps of it {} not used",
            counted(outside, "range"),
            are(outside)
        ));
    }
    notes.extend(odd_values::notes(&name, &read.samples));
    if read.samples.is_empty() {
        let mut problem =
            format!("{} have no range on the path or at a stop", counted(failed + zero + outside, "row"));
        if let (Some((first, last)), Whereabouts::Paths { paths, .. }) = (span, whereabouts) {
            let (begin, end) = span_of(paths.iter().copied());
            let [first, last, begin, end] = [first, last, begin, end].map(instant::format);
            let _ = write!(
                problem,
                ": ranges outside of the path are from {first} s to {last} s, the path is from {begin} s to {end} s; both need times of \
                 the same clock, and columns of the unit of their times (t_s, t_ms, t_ns)"
            );
        }
        return Err(RobotLogError::NoRanges { name, problem });
    }
    read.samples.sort_by_key(|sample| sample.time);
    Ok(read)
}

/// Writes the ranges of `log` to the file `path`.
pub(crate) fn write(path: &std::path::Path, log: &ReceptionLog) -> Result<(), RobotLogError> {
    let mut output = Output::new(&WRITTEN);
    for (stop, sample) in log.stops_of_ranges().into_iter().zip(log.ranges()) {
        let &RangeSample { node, time, position, velocity, range_m, robot: _, mounting: _ } = sample;
        output.text(&stop.to_string()).instant(time).text(&log.names()[node.index()]).number(range_m);
        output.position(position).position(velocity).end();
    }
    output.save(path)
}

/// The column of ranges of a table, and a metre in its unit.
pub(crate) fn range_column(table: &Table<'_>) -> Result<(Column, f64), RobotLogError> {
    optional_range_column(table)?.ok_or_else(|| {
        let hint = table.hint("range_m");
        table.wrong_header(format!("column `range_m` is missing; ranges need it (or {OTHER_COLUMNS}){hint}"))
    })
}

/// The same of a table that may have none.
pub(crate) fn optional_range_column(table: &Table<'_>) -> Result<Option<(Column, f64)>, RobotLogError> {
    let all = RANGES.into_iter().map(|(name, unit)| (table.column(name), unit));
    let found: Vec<(Column, f64)> = all.filter(|(column, _)| column.exists()).collect();
    match found.as_slice() {
        [] => Ok(None),
        &[only] => Ok(Some(only)),
        _ => {
            Err(table
                .wrong_header(format!("found ranges in several units; allowed: one of range_m, {OTHER_COLUMNS}")))
        }
    }
}

impl<'a> Placing<'a> {
    fn of(
        whereabouts: Whereabouts<'a>,
        table: &Table<'_>,
        written: &Written,
        notes: &mut Vec<String>,
    ) -> Result<Self, RobotLogError> {
        let [stop, robot] = ["stop", "robot"].map(|name| table.column(name));
        let own = OWN_PLACE.map(|name| table.column(name));
        let has_time = instant::COLUMNS.iter().any(|name| table.column(name).exists());
        let is_own = has_time && own.iter().all(|column| column.exists());
        let own = Some(own).filter(|_| is_own && matches!(whereabouts, Whereabouts::Stops { .. }));
        let unused = OWN_PLACE.iter().filter(|name| own.is_none() && table.column(name).exists());
        let unused: Vec<&str> = unused.copied().collect();
        if !unused.is_empty() {
            let used = match whereabouts {
                Whereabouts::Stops { .. } => "the places of the stops count, unless all of these and t_s are there",
                Whereabouts::Paths { .. } => "the places on the path count",
            };
            let (name, unused, of) = (table.name(), unused.join(", "), OWN_PLACE.join(", "));
            let of =
                if matches!(whereabouts, Whereabouts::Stops { .. }) { format!(" ({of})") } else { String::new() };
            notes.push(format!("{name}: {unused} are not used: {used}{of}"));
        }
        let time = match whereabouts {
            Whereabouts::Stops { .. } if !stop.exists() => {
                return Err(table.wrong_header(format!(
                    "column `stop` is missing: the log has stops, and each range needs the one at which it was measured{}",
                    table.hint("stop")
                )));
            }
            Whereabouts::Stops { .. } => {
                own.is_some().then(|| Times::of(table, written.time_zone, notes)).transpose()?
            }
            Whereabouts::Paths { .. } => Some(Times::of(table, written.time_zone, notes)?),
        };
        if let Whereabouts::Paths { paths, .. } = whereabouts
            && paths.len() > 1
            && !robot.exists()
        {
            let robots = paths.len();
            return Err(table.wrong_header(format!(
                "column `robot` is missing: the log has the paths of {robots} robots{}",
                table.hint("robot")
            )));
        }
        Ok(Self { whereabouts, stop, time, robot, own })
    }

    /// The name of a robot on a path; empty if it has none.
    fn robot_name(&self, robot: RobotId) -> &str {
        match self.whereabouts {
            Whereabouts::Paths { robots, .. } => robots.get(robot.index()).map_or("", String::as_str),
            Whereabouts::Stops { .. } => "",
        }
    }

    /// The time of a row, if it has one from 0 on.
    fn time_of(&self, row: &TableRow<'_>) -> Result<Option<SimTime>, RobotLogError> {
        self.time.filter(|&times| !row.is_before_zero(times)).map(|times| row.instant(times)).transpose()
    }

    /// Where the robot was when it measured the range of a row; `None` if that is not known.
    fn pose(&self, row: &TableRow<'_>) -> Result<Option<Pose>, RobotLogError> {
        match (self.whereabouts, self.time) {
            (Whereabouts::Stops { stops, ids }, _) => {
                let name = row.name(self.stop, "the name of a stop")?;
                let number =
                    ids.get(&*name).ok_or_else(|| row.wrong(self.stop, "the name of a stop in stops.csv"))?;
                let Stop { robot, time, position, .. } = stops[*number as usize];
                if let (Some(own), Some(times)) = (self.own, self.time) {
                    let mut values = [0.0; 6];
                    for (value, column) in values.iter_mut().zip(own) {
                        *value = row.finite(column)?.ok_or_else(|| row.wrong(column, "a finite number"))?;
                    }
                    let [x_m, y_m, z_m, vx, vy, vz] = values;
                    let (position, velocity) = (Position::new(x_m, y_m, z_m), Position::new(vx, vy, vz));
                    return Ok(Some(Pose { robot, time: row.instant(times)?, position, velocity }));
                }
                Ok(Some(Pose { robot, time, position, velocity: Position::ORIGIN }))
            }
            (Whereabouts::Paths { paths, robots, delay_s }, Some(times)) => {
                let number = match row.filled(self.robot).filter(|_| !robots.is_empty()) {
                    Some(name) => {
                        let known = robots.iter().position(|known| *known == name);
                        known.ok_or_else(|| row.wrong(self.robot, "the name of a robot with a path"))?
                    }
                    None => 0,
                };
                if row.is_before_zero(times) {
                    return Ok(None);
                }
                let Some(time) = instant::shifted(row.instant(times)?, -delay_s) else { return Ok(None) };
                let path = paths[number];
                let pose = path.at(time).map(|position| Pose {
                    robot: RobotId::from_index(number),
                    time,
                    position,
                    velocity: path.velocity_m_per_s(time),
                });
                Ok(pose)
            }
            (Whereabouts::Paths { .. }, None) => unreachable!("a path has times"),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::test_kit::folder_of;
    use crate::{ReadOptions, read};

    #[test]
    fn ranges_on_a_path_have_its_places_and_velocities() {
        let folder = folder_of([
            ("path.csv", "t_s,x_m,y_m\n0,0,0\n10,20,0\n"),
            ("ranges.csv", "t_s,node,range_mm\n-1,a,900\n2.5,a,5100\n5,b,\n7.5,b,0\n8,b,-20\n99,a,1\n"),
        ]);
        let found = read(folder.path(), &ReadOptions::default()).unwrap();
        assert_eq!(found.log.names(), ["a", "b"]);
        let ranges: Vec<_> =
            found.log.ranges().iter().map(|range| (range.node.0, range.position.x_m, range.range_m)).collect();
        assert_eq!(ranges, [(0, 5.0, 5.1), (1, 16.0, -0.02)]);
        assert!(found.log.ranges().iter().all(|range| (range.velocity.x_m - 2.0).abs() < 1e-12));
        for note in ["1 row without a range", "1 range of exactly 0", "2 ranges from before", "1 range below 0"] {
            assert!(found.notes.iter().any(|known| known.contains(note)), "{note}: {:?}", found.notes);
        }
    }

    #[test]
    fn ranges_of_another_clock_say_both_spans() {
        let folder = folder_of([
            ("path.csv", "t_s,x_m,y_m\n0,0,0\n10,20,0\n"),
            ("ranges.csv", "t_s,node,range_m\n1700000000,a,5\n1700000009,a,6\n"),
        ]);
        let error = read(folder.path(), &ReadOptions::default()).unwrap_err().to_string();
        assert!(error.contains("from 1700000000 s to 1700000009 s, the path is from 0 s to 10 s"), "{error}");
    }

    #[test]
    fn a_value_for_failed_tries_is_told_and_coarse_steps_are_not() {
        // 120 ranges at places far apart, in steps of a metre; then with a sixth of them as 6 m.
        let rows = |range_m: &dyn Fn(usize) -> String| {
            let row = |at: usize| format!("{},a,{}\n", 0.05 * at as f64, range_m(at));
            format!("t_s,node,range_m\n{}", (0..120).map(row).collect::<String>())
        };
        let is_told = |ranges: &str| {
            let folder = folder_of([("path.csv", "t_s,x_m,y_m\n0,0,0\n10,20,0\n"), ("ranges.csv", ranges)]);
            let notes = read(folder.path(), &ReadOptions::default()).unwrap().notes;
            notes.iter().any(|note| note.contains("are exactly 6 m"))
        };
        assert!(!is_told(&rows(&|at| (3 + at % 7 % 5).to_string())));
        assert!(is_told(&rows(&|at| if at % 6 == 0 {
            "6".to_owned()
        } else {
            format!("{}", 3.0 + 0.013 * at as f64)
        })));
    }

    #[test]
    fn a_delay_is_taken_off_the_times_of_ranges() {
        let folder = folder_of([
            ("path.csv", "t_s,x_m,y_m\n0,0,0\n10,20,0\n"),
            ("ranges.csv", "t_s,node,range_m\n1,a,9\n4.5,a,5\n11.5,a,7\n"),
        ]);
        let mut options = ReadOptions::default();
        options.repair.packet_delay = crate::PacketDelay::Seconds(2.0);
        let found = read(folder.path(), &options).unwrap();
        let ranges: Vec<_> = found.log.ranges().iter().map(|range| (range.position.x_m, range.range_m)).collect();
        assert_eq!(ranges, [(5.0, 5.0), (19.0, 7.0)]);
        options.repair.packet_delay = crate::PacketDelay::Estimated;
        let notes = read(folder.path(), &options).unwrap().notes;
        assert!(notes.iter().any(|note| note.contains("a map by ranges estimates")), "{notes:?}");
    }

    #[test]
    fn a_range_beside_a_packet_is_both() {
        let folder = folder_of([
            ("path.csv", "t_s,x_m,y_m\n0,0,0\n10,20,0\n"),
            ("packets.csv", "t_s,node,rssi_dbm,range_mm\n2.5,a,-50,5100\n5,b,-60,\n7.5,b,-61,0\n99,a,-70,1\n"),
        ]);
        let found = read(folder.path(), &ReadOptions::default()).unwrap();
        let ranges: Vec<_> = found.log.ranges().iter().map(|range| (range.position.x_m, range.range_m)).collect();
        assert_eq!(ranges, [(5.0, 5.1)]);
        assert_eq!(found.log.receptions().iter().map(|reception| reception.received).sum::<u32>(), 3);
        for note in ["3 ranges were measured, of which 1 count", "1 range without a number, or of exactly 0"] {
            assert!(found.notes.iter().any(|known| known.contains(note)), "{note}: {:?}", found.notes);
        }
        let both = ("packets.csv", "t_s,node,range_m,range_mm\n2.5,a,5,5100\n");
        let why =
            read(folder_of([("path.csv", "t_s,x_m,y_m\n0,0,0\n10,20,0\n"), both]).path(), &ReadOptions::default());
        assert!(why.unwrap_err().to_string().contains("several units"));
    }

    #[test]
    fn feet_and_nanoseconds_of_light_are_metres() {
        for (column, range_m) in [("range_ft", 3.048), ("range_ns", 2.997_924_58)] {
            let stops = ("stops.csv", "stop,x_m,y_m\nA,0,0\nB,4,0\n");
            let ranges = format!("node,stop,{column}\nlamp,A,10\n");
            let log = read(folder_of([stops, ("ranges.csv", &ranges)]).path(), &ReadOptions::default()).unwrap().log;
            assert!((log.ranges()[0].range_m - range_m).abs() < 1e-9, "{column}");
        }
    }

    #[test]
    fn ranges_at_stops_need_no_receptions() {
        let stops = ("stops.csv", "stop,x_m,y_m\nA,0,0\nB,4,0\n");
        let folder = folder_of([stops, ("ranges.csv", "node,stop,range_m\nlamp,B,2\nlamp,A,3\n")]);
        let log = read(folder.path(), &ReadOptions::default()).unwrap().log;
        let ranges: Vec<_> = log.ranges().iter().map(|range| (range.position.x_m, range.range_m)).collect();
        assert_eq!(ranges, [(4.0, 2.0), (0.0, 3.0)]);
        assert_eq!(log.receptions().len(), 0);
        for (text, problem) in [
            ("node,stop,range_m\nlamp,C,2\n", "allowed: the name of a stop in stops.csv"),
            ("node,t_s,range_m\nlamp,1,2\n", "column `stop` is missing"),
            ("node,stop,distance\nlamp,A,2\n", "column `range_m` is missing"),
            ("node,stop,range_m,range_mm\nlamp,A,2,2\n", "several units"),
            ("node,stop,range_m\nlamp,A,2 m\n", "allowed: a finite number"),
            ("node,stop,range_m\nlamp,A,\n", "no range"),
        ] {
            let why = read(folder_of([stops, ("ranges.csv", text)]).path(), &ReadOptions::default()).unwrap_err();
            assert!(why.to_string().contains(problem), "{why}");
        }
    }

    #[test]
    fn ranges_with_places_of_their_own_are_read_back_equal() {
        use sextant_channel::{Mounting, Position, RangeSample};
        use sextant_kernel::{NodeId, RobotId, SimTime};

        let stops = "stop,t_s,x_m,y_m,robot\nA,0,0,0,r\nB,10,4,0,r\nC,5,1,1,s\n";
        let receptions = "node,stop,received,sent\nlamp,A,1,1\nfan,C,1,1\n";
        let folder = folder_of([("stops.csv", stops), ("receptions.csv", receptions)]);
        let log = read(folder.path(), &ReadOptions::default()).unwrap().log;
        let sample = |node, robot, nanos, x_m| RangeSample {
            mounting: Mounting::default(),
            node: NodeId(node),
            robot: RobotId(robot),
            time: SimTime::from_nanos(nanos),
            position: Position::new(x_m, 0.25, 1.0),
            velocity: Position::new(0.5, -0.125, 0.0),
            range_m: x_m - 0.3,
        };
        // The second one is from before the first stop of its robot.
        let ranges = vec![
            sample(0, 0, 7_000_000_001, 3.0),
            sample(1, 1, 1_000_000_000, 0.1),
            sample(0, 0, 12_000_000_000, 5.0),
        ];
        let log = log.with_ranges(ranges).unwrap();
        assert_eq!(log.stops_of_ranges(), [0, 1, 2]);
        let parent = tempfile::tempdir().unwrap();
        crate::write(&parent.path().join("log"), &log).unwrap();
        let again = read(&parent.path().join("log"), &ReadOptions::default()).unwrap();
        assert_eq!(again.log, log, "{:?}", again.notes);

        // Without all of these columns the places are those of the stops, and a note says so.
        let partly = ("ranges.csv", "node,stop,range_m,x_m,y_m\nlamp,B,2,9,9\n");
        let found = read(folder_of([("stops.csv", stops), partly]).path(), &ReadOptions::default()).unwrap();
        assert!((found.log.ranges()[0].position.x_m - 4.0).abs() < 1e-12);
        assert!(found.notes.iter().any(|note| note.contains("x_m, y_m are not used")), "{:?}", found.notes);
    }
}
