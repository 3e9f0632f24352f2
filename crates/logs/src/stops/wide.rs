//! Wide tables: a row a scan, with the place of the robot, and a column a node with the strength that was measured there.

use std::collections::{BTreeMap, BTreeSet};

use sextant_channel::{Contact, LogError, Reception, ReceptionLog, ReceptionLogBuilder, Stop};
use sextant_kernel::{NodeId, RobotId, SimTime};

use super::no_nodes::is_no_node;
use crate::csv::header::{KnownColumns, Others};
use crate::csv::table::{Table, TableRow};
use crate::csv::table_source::TableSource;
use crate::csv::times::Times;
use crate::csv::written::Written;
use crate::doctor::Finding;
use crate::error::robot_log_error::RobotLogError;
use crate::options::form_options::FormOptions;
use crate::options::missing::{Missing, is_empty};
use crate::options::read_options::ReadOptions;
use crate::packets::rssi_check::RssiCheck;
use crate::packets::signal::Signal;
use crate::packets::strengths::{Report, Strengths};
use crate::place::local_plane::LocalPlane;
use crate::place::place_columns::{COLUMNS, Frame, Places};
use crate::place::without_fix::{is_origin, places_of, without_fix_m};
use crate::time::instant;
use sextant_kernel::text::{choices, counted, listed};
use sextant_recording::RobotNames;

/// Largest strength that a cell may hold (dBm); more is no power that was received.
const LARGEST_DBM: f64 = 30.0;
/// Least strength that a cell may hold (dBm).
const LEAST_DBM: f64 = -200.0;

/// What a wide table holds.
pub(crate) struct Wide {
    names: Vec<String>,
    stops: Vec<Stop>,
    receptions: ReceptionLogBuilder,
    /// The robots that it names.
    pub(crate) robots: RobotNames,
    /// The plane of the places, if they are given by latitude and longitude.
    pub(crate) plane: Option<LocalPlane>,
    /// What is odd of the strengths.
    pub(crate) findings: Vec<Finding>,
}

impl Wide {
    /// The log, with places where robots met obstacles.
    pub(crate) fn build(self, contacts: Vec<Contact>) -> Result<ReceptionLog, LogError> {
        self.receptions.build(self.names, self.stops, contacts)?.with_robots(self.robots.into_vec())
    }
}

/// What the scans at a place say of a node.
#[derive(Clone, Copy)]
struct Scans {
    received: u32,
    sent: u32,
    signal: Signal,
}

const NO_SCANS: Scans = Scans { received: 0, sent: 0, signal: Signal::NONE };

/// What is read from the rows.
struct Reading<'a> {
    nodes: Vec<usize>,
    missing: &'a [Missing],
    rssi: RssiCheck,
    strengths: Strengths,
    stops: Vec<Stop>,
    /// Of each stop, its nodes.
    scans: Vec<Vec<Scans>>,
    /// How many rows are scans at each stop.
    rows_at: Vec<u64>,
    rows: u64,
    silent: u64,
    unknown: u64,
}

/// Reads a wide table. Rows at one place are scans of one stop.
pub(crate) fn read(
    source: TableSource<'_>,
    options: &ReadOptions,
    notes: &mut Vec<String>,
) -> Result<Wide, RobotLogError> {
    let ReadOptions { form, repair, .. } = options;
    let written = Written::of_places(form);
    let part = source.part();
    let optional = [&COLUMNS[..], &instant::COLUMNS, &["robot", "stop"]].concat();
    let others = if form.node_columns.is_empty() { Others::Read } else { Others::Named };
    let known = KnownColumns { required: &[], optional: &optional, names: &written.names, others };
    let again = source.clone();
    let table = Table::open_known(source, known)?;
    let file = table.name();
    let places = Places::of(&table, Frame::Any, notes)?;
    let time = Times::find(&table, written.time_zone, notes);
    let robot = table.column("robot");
    let strengthless = if form.node_columns.is_empty() {
        strengthless(Table::open_known(again, known)?, form)?
    } else {
        BTreeSet::new()
    };
    let (nodes, node_names) = nodes(&table, &strengthless, form, notes)?;
    if table.column("stop").exists() {
        notes.push(format!("{file}: `stop` is ignored: rows at one place are one stop"));
    }
    let empty = [Missing::Empty];
    let mut reading = Reading {
        nodes,
        missing: if form.missing.is_empty() { &empty } else { &form.missing },
        rssi: RssiCheck::of_cells(options),
        strengths: Strengths::of(form),
        stops: Vec::new(),
        scans: Vec::new(),
        rows_at: Vec::new(),
        rows: 0,
        silent: 0,
        unknown: 0,
    };
    let mut plane = None;
    let mut robots = RobotNames::default();
    let mut at_place: BTreeMap<(RobotId, [u64; 3]), usize> = BTreeMap::new();
    let mut left_out = 0;
    table.rows(|row| {
        if repair.skip_no_fix && places.is_without_fix(row) {
            left_out += 1;
            return Ok(());
        }
        let robot = row.robot(robot, &mut robots)?;
        let position = places.read(row, &mut plane)?;
        let time = time.map_or(Ok(SimTime::ZERO), |time| row.instant(time))?;
        // Adding zero makes a place at -0 that at 0.
        let key = [position.x_m, position.y_m, position.z_m].map(|at| (at + 0.0).to_bits());
        let stop = *at_place.entry((robot, key)).or_insert(reading.stops.len());
        if stop == reading.stops.len() {
            reading.stops.push(Stop { robot, time, position, heading_rad: None });
            reading.scans.push(vec![NO_SCANS; reading.nodes.len()]);
            reading.rows_at.push(0);
        }
        reading.rows_at[stop] += 1;
        reading.scan(row, stop)
    })?;
    // Of degrees, the rows themselves told.
    if repair.skip_no_fix && plane.is_none() {
        left_out += reading.leave_out_origin();
    }
    if left_out > 0 {
        notes.push(format!("{file}: {left_out} rows without a fix are left out (option `skip_no_fix`)"));
    }
    if reading.stops.is_empty() {
        return Err(RobotLogError::NoStops { part });
    }
    reading.tell(&file, notes);
    reading.strengths.finish(notes)?;
    notes.extend(reading.rssi.note());
    if time.is_none() {
        notes.push(format!("no times (t_s) in {file}: the duration of the survey is unknown"));
    }
    let receptions = reading.receptions();
    Ok(Wide { names: node_names, stops: reading.stops, receptions, robots, plane, findings: reading.rssi.findings() })
}

/// The columns without any strength, which is negative in dBm, though they hold something: the number of a floor, say.
///
/// # Errors
/// If that is so of all columns.
fn strengthless(table: Table<'_>, form: &FormOptions) -> Result<BTreeSet<usize>, RobotLogError> {
    let may_be_node = |name: &str| !name.is_empty() && !is_no_node(name);
    let others: Vec<usize> = table.unknown().filter(|(_, name)| may_be_node(name)).map(|(at, _)| at).collect();
    let (mut holding, mut negative, mut is_beyond) = (BTreeSet::new(), BTreeSet::new(), false);
    let head = table.rows(|row| {
        for &at in &others {
            let text = row.text_at(at);
            let text = text.trim();
            let number = row.decimal(text);
            if is_empty(text) || form.missing.iter().any(|missing| missing.is(text, &number)) {
                continue;
            }
            holding.insert(at);
            let number: Option<f64> = number.parse().ok();
            is_beyond |= number.is_none_or(|number| number > LARGEST_DBM);
            if number.is_some_and(|number| number < 0.0) {
                negative.insert(at);
            }
        }
        Ok(())
    })?;
    // A value beyond all strengths has an error of its own.
    if negative.is_empty() && !holding.is_empty() && !is_beyond {
        return Err(head.wrong_header(
            "no column has a negative value, so none has strengths in dBm; if some are nodes all the same, name them with option \
             `node_columns`",
        ));
    }
    Ok(if negative.is_empty() { BTreeSet::new() } else { holding.difference(&negative).copied().collect() })
}

/// The columns that are nodes, and their names; those `strengthless` are none.
fn nodes(
    table: &Table<'_>,
    strengthless: &BTreeSet<usize>,
    form: &FormOptions,
    notes: &mut Vec<String>,
) -> Result<(Vec<usize>, Vec<String>), RobotLogError> {
    let others: Vec<(usize, &str)> = table.unknown().filter(|(_, name)| !name.is_empty()).collect();
    let patterns = &form.node_columns;
    if let Some(unused) = patterns.iter().find(|pattern| !others.iter().any(|(_, name)| pattern.holds(name))) {
        let names: Vec<&str> = others.iter().map(|(_, name)| *name).collect();
        let problem = format!(
            "option `node_columns` has `{unused}`, but there is no such column; the columns are: {}",
            choices(&names)
        );
        return Err(table.wrong_header(problem));
    }
    let is_node = |name: &str| patterns.is_empty() || patterns.iter().any(|pattern| pattern.holds(name));
    let is_other = |name: &str| patterns.is_empty() && is_no_node(name);
    let (by_name, others): (Vec<_>, Vec<_>) = others.into_iter().partition(|(_, name)| is_other(name));
    let (odd, others): (Vec<_>, Vec<_>) = others.into_iter().partition(|(at, _)| strengthless.contains(at));
    let (nodes, ignored): (Vec<_>, Vec<_>) = others.into_iter().partition(|(_, name)| is_node(name));
    if nodes.is_empty() {
        return Err(table.wrong_header(
            "no column is a node: a wide table has places and a column for each node, and a path needs option `packets`",
        ));
    }
    let file = table.name();
    let columns = counted(nodes.len(), "column");
    let quoted = |columns: &[(usize, &str)]| columns.iter().map(|(_, name)| format!("`{name}`")).collect::<Vec<_>>();
    let taken = listed(&quoted(&nodes));
    notes
        .push(format!("{file}: {columns} with the strengths of nodes: {taken} (option `node_columns` chooses them)"));
    let hint = " (option `node_columns` chooses nodes)";
    for (left, why, hint) in [
        (by_name, "by their names, no nodes are", hint),
        (odd, "without a negative value, and so without strengths in dBm, no nodes are", hint),
        (ignored, "ignored columns", ""),
    ] {
        if !left.is_empty() {
            notes.push(format!("{file}: {why}: {}{hint}", choices(&quoted(&left))));
        }
    }
    Ok(nodes.into_iter().map(|(at, name)| (at, name.to_owned())).unzip())
}

impl Reading<'_> {
    /// Adds a row to a stop.
    fn scan(&mut self, row: &TableRow<'_>, stop: usize) -> Result<(), RobotLogError> {
        self.rows += 1;
        for (&at, scans) in self.nodes.iter().zip(&mut self.scans[stop]) {
            let text = row.text_at(at);
            let text = text.trim();
            let number = row.decimal(text);
            let report = if self.missing.iter().any(|missing| missing.is(text, &number)) {
                self.silent += 1;
                Report::Noise
            } else if is_empty(text) {
                self.unknown += 1;
                continue;
            } else {
                let is_level =
                    |level: &f64| (LEAST_DBM..=LARGEST_DBM).contains(level) || self.rssi.is_missing(*level);
                let level = number.parse().ok().filter(is_level).ok_or_else(|| {
                    row.wrong_at(
                        at,
                        format!(
                            "a strength from {LEAST_DBM} to {LARGEST_DBM} dBm; if it means that the node was not heard, give \
                             `missing={}`; if the column is no node, name those that are with option `node_columns`",
                            if text.is_empty() { "empty" } else { text }
                        ),
                    )
                })?;
                self.strengths.take(self.rssi.take(Some(level)), None)
            };
            scans.sent += 1;
            if let Report::Heard(rssi_dbm) = report {
                scans.received += 1;
                scans.signal.add(&Signal::new(1, None, rssi_dbm, None));
            }
        }
        Ok(())
    }

    /// Leaves out the stops at x = y = 0, if that is far from all others. Returns how many rows these are.
    fn leave_out_origin(&mut self) -> u64 {
        if without_fix_m(&places_of(self.stops.iter())).is_none() {
            return 0;
        }
        let keeps: Vec<bool> = self.stops.iter().map(|stop| !is_origin(stop.position)).collect();
        let left_out = keeps.iter().zip(&self.rows_at).filter(|(keeps, _)| !**keeps).map(|(_, rows)| rows).sum();
        let mut keep = keeps.iter();
        self.stops.retain(|_| keep.next().is_some_and(|keeps| *keeps));
        let mut keep = keeps.iter();
        self.scans.retain(|_| keep.next().is_some_and(|keeps| *keeps));
        left_out
    }

    fn tell(&self, file: &str, notes: &mut Vec<String>) {
        let Self { rows, silent, unknown, .. } = *self;
        let stops = self.stops.len();
        if rows > stops as u64 {
            notes.push(format!(
                "{file}: {rows} rows are scans at {}; those at one place are one stop",
                counted(stops, "place")
            ));
        }
        let cells = rows * self.nodes.len() as u64;
        let left = if unknown > 0 { format!(", and {unknown} empty ones say nothing") } else { String::new() };
        notes.push(format!(
            "{file}: {silent} of {cells} cells say that a node was not heard{left} (option `missing` sets what they hold)"
        ));
    }

    fn receptions(&self) -> ReceptionLogBuilder {
        let mut receptions = ReceptionLogBuilder::default();
        for node in 0..self.nodes.len() {
            for (stop, scans) in (0..).zip(&self.scans) {
                let Scans { received, sent, signal } = scans[node];
                // 0 of 1 means the same as an absent pair.
                if (received, sent) != (0, 1) {
                    receptions.push(Reception {
                        node: NodeId::from_index(node),
                        stop,
                        received,
                        sent,
                        sector: None,
                        rssi_dbm: signal.rssi_dbm(),
                        snr_db: None,
                    });
                }
            }
        }
        receptions
    }
}
