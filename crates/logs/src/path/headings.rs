//! How robots were turned along their paths: a column of the table with the paths.

use std::collections::BTreeMap;

use sextant_kernel::SimTime;

use crate::csv::header::{KnownColumns, Others};
use crate::csv::table::Table;
use crate::csv::table_source::TableSource;
use crate::csv::times::Times;
use crate::csv::written::Written;
use crate::error::robot_log_error::RobotLogError;
use crate::time::instant;

/// The columns of a heading that a file may have: radians and degrees.
pub(crate) const COLUMNS: [&str; 2] = ["heading_rad", "heading_deg"];

/// The headings of each robot by its name, which is empty where robots have none, in the order of time (rad, counterclockwise from x).
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct PathHeadings {
    of_robots: BTreeMap<String, Vec<(SimTime, f64)>>,
}

impl PathHeadings {
    /// Reads the headings in a table with paths, as it is `written`.
    ///
    /// # Errors
    /// If it has no column of headings, or one is not a number.
    pub(crate) fn read(source: TableSource<'_>, written: &Written) -> Result<Self, RobotLogError> {
        let optional = [&instant::COLUMNS[..], &COLUMNS, &["robot"]].concat();
        let known =
            KnownColumns { required: &[], optional: &optional, names: &written.names, others: Others::Ignored };
        let table = Table::open_known(source, known)?;
        let times = Times::of(&table, written.time_zone, &mut Vec::new())?;
        let [radians, degrees] = COLUMNS.map(|name| table.column(name));
        let (column, factor) = if radians.exists() { (radians, 1.0) } else { (degrees, 1.0_f64.to_radians()) };
        if !column.exists() {
            return Err(table.wrong_header(
                "column `heading_rad` is missing; lever arms of tags need the heading of the robot: heading_rad or heading_deg, \
                 counterclockwise from x",
            ));
        }
        let robot = table.column("robot");
        let mut found = Self::default();
        table.rows(|row| {
            // Of poses without a place there is no heading either.
            let Some(turn) = row.finite(column)? else { return Ok(()) };
            let name = row.filled(robot).map_or_else(String::new, |name| name.into_owned());
            found.of_robots.entry(name).or_default().push((row.instant(times)?, turn * factor));
            Ok(())
        })?;
        found.of_robots.values_mut().for_each(|headings| headings.sort_by_key(|&(time, _)| time));
        Ok(found)
    }

    /// The headings of the only robot, whatever its name is.
    pub(crate) fn of_one(self) -> Self {
        Self { of_robots: self.of_robots.into_values().map(|headings| (String::new(), headings)).collect() }
    }

    /// How the robot was turned at a time: between two headings by the shorter arc, and as the nearest one before the first and
    /// after the last. `None` if it has none.
    pub(crate) fn at(&self, robot: &str, time: SimTime) -> Option<f64> {
        let headings = self.of_robots.get(robot)?;
        let after = headings.partition_point(|&(known, _)| known <= time);
        match (after.checked_sub(1).map(|before| headings[before]), headings.get(after)) {
            (Some((from, before_rad)), Some(&(to, after_rad))) => {
                let share = time.saturating_since(from).as_secs_f64() / to.saturating_since(from).as_secs_f64();
                let (sin, cos) = libm::sincos(after_rad - before_rad);
                Some(before_rad + share * libm::atan2(sin, cos))
            }
            (Some((_, only)), None) | (None, Some(&(_, only))) => Some(only),
            (None, None) => None,
        }
    }
}
