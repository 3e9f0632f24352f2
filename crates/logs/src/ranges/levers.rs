//! `tags.csv`: where the tags are on a robot.

use std::collections::BTreeMap;

use sextant_channel::{Mounting, Position};
use sextant_kernel::SimTime;
use sextant_kernel::text::choices;

use crate::csv::table::{Column, Table, TableRow};
use crate::csv::table_source::TableSource;
use crate::error::robot_log_error::RobotLogError;
use crate::path::headings::PathHeadings;

/// Where each tag is in the frame of the robot (m): x ahead, y to the left, z up, from the place that the path is of.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct TagPlaces {
    places: BTreeMap<String, Position>,
}

/// Tags on robots whose headings are known.
#[derive(Clone, Debug)]
pub(crate) struct Levers {
    pub(crate) tags: TagPlaces,
    pub(crate) headings: PathHeadings,
}

impl TagPlaces {
    /// Reads the places in a table: `tag,x_m,y_m[,z_m]`.
    ///
    /// # Errors
    /// If a tag is there twice, a place is not finite, or there is none.
    pub(crate) fn read(source: TableSource<'_>, notes: &mut Vec<String>) -> Result<Self, RobotLogError> {
        /// No robot is longer (m).
        const LONGEST_M: f64 = 100.0;
        let table = Table::open(source, &["tag", "x_m", "y_m"], &["z_m"])?;
        notes.extend(table.notes());
        let tag = table.column("tag");
        let axes = ["x_m", "y_m", "z_m"].map(|name| table.column(name));
        let name = table.name();
        let mut places = BTreeMap::new();
        let head = table.rows(|row| {
            let of = |column: Column| -> Result<f64, RobotLogError> {
                let allowed = || row.wrong(column, format!("metres from -{LONGEST_M} to {LONGEST_M}"));
                let along_m = match row.finite(column)? {
                    Some(along_m) => along_m,
                    None if column.name == "z_m" => 0.0,
                    None => return Err(allowed()),
                };
                if along_m.abs() > LONGEST_M { Err(allowed()) } else { Ok(along_m) }
            };
            let place = Position::new(of(axes[0])?, of(axes[1])?, of(axes[2])?);
            let own = row.name(tag, "the name of a tag")?;
            if places.insert(own.into_owned(), place).is_some() {
                return Err(row.wrong(tag, "each tag once; this one is already given above"));
            }
            Ok(())
        })?;
        if places.is_empty() {
            return Err(head.wrong_header("it has no tags; allowed: a row for each tag: tag,x_m,y_m[,z_m]"));
        }
        notes.push(format!("{name}: {} of tags on the robot", sextant_kernel::text::counted(places.len(), "place")));
        Ok(Self { places })
    }

    /// The number of the tag that a row of ranges or strengths is of, and its place. A row need not name the only one.
    pub(crate) fn of(&self, row: &TableRow<'_>, tag: Column) -> Result<(u32, Position), RobotLogError> {
        let known = || (0..).zip(&self.places);
        let found = match row.filled(tag) {
            Some(name) => known().find(|(_, (known, _))| **known == *name),
            None => known().next().filter(|_| self.places.len() == 1),
        };
        let (number, (_, &place)) = found.ok_or_else(|| {
            let names: Vec<&String> = self.places.keys().collect();
            row.wrong(tag, format!("a tag of tags.csv: {}", choices(&names)))
        })?;
        Ok((number, place))
    }

    /// Refuses a table that does not say which of several tags a row is of.
    pub(crate) fn check(&self, table: &Table<'_>, tag: Column) -> Result<(), RobotLogError> {
        if self.places.len() > 1 && !tag.exists() {
            return Err(table.wrong_header(format!(
                "column `tag` is missing: tags.csv has {} tags{}",
                self.places.len(),
                table.hint("tag")
            )));
        }
        Ok(())
    }
}

impl Levers {
    /// The tag of a row that was measured at `time` on this robot; an arm is turned as the robot is.
    pub(crate) fn of(
        &self,
        row: &TableRow<'_>,
        tag: Column,
        robot: &str,
        time: SimTime,
    ) -> Result<Mounting, RobotLogError> {
        let (antenna, place) = self.tags.of(row, tag)?;
        let heading_rad = self.headings.at(robot, time);
        let heading_rad = heading_rad.ok_or_else(|| row.wrong(tag, "a tag on a robot with headings on its path"))?;
        Ok(Mounting { antenna, arm: place.turned(heading_rad) })
    }
}
