//! `packets.csv`: one row for each packet that a robot heard.

use sextant_kernel::RobotId;
use sextant_kernel::text::choices;

use super::gatherer::Gatherer;
use super::packet::Packet;
use super::reciprocal::{Roles, Transmitter};
use crate::csv::header::{KnownColumns, Others};
use crate::csv::table::{Column, Table, TableRow};
use crate::csv::table_source::TableSource;
use crate::csv::times::Times;
use crate::csv::written::Written;
use crate::error::robot_log_error::RobotLogError;
use crate::ranges::range_table::optional_range_column;
use crate::ranges::units::RANGE_COLUMNS;
use crate::time::instant;

/// The robots of a log.
#[derive(Clone, Copy)]
pub(crate) struct Robots<'a> {
    /// The names of those with a path; none if there is one robot without a name.
    pub(crate) names: &'a [String],
    /// What gives their paths, for errors.
    pub(crate) path: &'a str,
}

/// Reads the packets of a table row by row into `gatherer`, as it is `written`.
pub(crate) fn read<'a>(
    source: impl Into<TableSource<'a>>,
    written: &Written,
    robots: Robots<'_>,
    roles: &mut Roles,
    gatherer: &mut Gatherer,
    notes: &mut Vec<String>,
) -> Result<(), RobotLogError> {
    let (required, ends) = match roles {
        Roles::Usual => ("node", ["robot"].as_slice()),
        Roles::Turned(_) => ("receiver", ["node"].as_slice()),
    };
    let optional = [&instant::COLUMNS[..], &["rssi_dbm", "snr_db", "sector"], &RANGE_COLUMNS, ends].concat();
    let known =
        KnownColumns { required: &[required], optional: &optional, names: &written.names, others: Others::Ignored };
    let table = Table::open_known(source, known)?;
    notes.extend(table.notes());
    let time = Times::of(&table, written.time_zone, notes)?;
    let [node, mover] = [required, ends[0]].map(|name| table.column(name));
    let [rssi, snr, sector] = ["rssi_dbm", "snr_db", "sector"].map(|name| table.column(name));
    let range = optional_range_column(&table)?;
    if snr.exists() && !rssi.exists() && !sector.exists() {
        notes.push(format!(
            "{}: without strengths (rssi_dbm), signal-to-noise ratios (snr_db) are not used: the map is made of which packets \
             were heard",
            table.name()
        ));
    }
    robots.check(&table, mover, roles)?;
    table.rows(|row| {
        let robot = match roles {
            Roles::Usual => Some(robots.of(row, mover, "the name of a robot")?),
            Roles::Turned(transmitter) => robots.transmitter(row, mover, transmitter)?,
        };
        let Some(robot) = robot else { return Ok(()) };
        let range_m = match range {
            Some((column, unit)) => row.measured(column)?.map(|range| range / unit),
            None => None,
        };
        gatherer.take(Packet {
            time: row.instant(time)?,
            robot,
            node: &row.node(node)?,
            rssi_dbm: row.measured(rssi)?,
            snr_db: row.measured(snr)?,
            sector: row.sector(sector)?,
            range_m,
        })
    })?;
    Ok(())
}

impl Robots<'_> {
    /// Refuses a table that does not fit the paths or what the user wants. `mover` is the column of who drove.
    fn check(self, table: &Table<'_>, mover: Column, roles: &Roles) -> Result<(), RobotLogError> {
        let Self { names, path } = self;
        if matches!(roles, Roles::Usual) && mover.exists() && names.is_empty() {
            return Err(table.wrong_header(format!(
                "column `robot` names the robots, but {path} has no such column: give it one, or remove this one"
            )));
        }
        if let Roles::Turned(Transmitter { wanted: Some(_), .. }) = roles
            && !mover.exists()
        {
            let problem = "column `node` is missing: option `transmitter` needs to know who sent each packet";
            return Err(table.wrong_header(format!("{problem}{}", table.hint("node"))));
        }
        if !mover.exists() && names.len() > 1 {
            let (column, robots) = (mover.name, names.len());
            return Err(table.wrong_header(format!(
                "column `{column}` is missing: {path} has the paths of {robots} robots{}",
                table.hint(column)
            )));
        }
        Ok(())
    }

    /// The robot that the cell names.
    fn of(self, row: &TableRow<'_>, mover: Column, allowed: &str) -> Result<RobotId, RobotLogError> {
        match row.filled(mover) {
            Some(name) => {
                let known = || format!("one of the robots in {}: {}", self.path, choices(self.names));
                let index = self.names.iter().position(|known| *known == name);
                Ok(RobotId::from_index(index.ok_or_else(|| row.wrong(mover, known()))?))
            }
            None if mover.exists() => Err(row.wrong(mover, allowed)),
            None => Ok(RobotId(0)),
        }
    }

    /// The path of the transmitter that the cell names; `None` if the user wants another one.
    fn transmitter(
        self,
        row: &TableRow<'_>,
        mover: Column,
        transmitter: &mut Transmitter,
    ) -> Result<Option<RobotId>, RobotLogError> {
        if !mover.exists() {
            return Ok(Some(RobotId(0)));
        }
        let name = row.name(mover, "the name of a transmitter")?;
        if self.names.is_empty() {
            let is_wanted = transmitter.is_the_one(&name);
            let is_wanted = is_wanted.map_err(|problem| row.head.wrong_row(row.offset, problem))?;
            return Ok(is_wanted.then_some(RobotId(0)));
        }
        if transmitter.is_wanted(&name) { self.of(row, mover, "").map(Some) } else { Ok(None) }
    }
}
