//! How robots were turned along their paths: a column of the table with the paths.

use std::collections::BTreeMap;

use sextant_kernel::SimTime;

use crate::csv::header::{KnownColumns, Others};
use crate::csv::table::Table;
use crate::csv::table_source::TableSource;
use crate::csv::times::Times;
use crate::csv::written::Written;
use crate::error::robot_log_error::RobotLogError;
use crate::place::place_columns;
use crate::time::instant;

/// The columns of a heading that a file may have: radians and degrees.
pub(crate) const COLUMNS: [&str; 2] = ["heading_rad", "heading_deg"];

/// A note that the headings in `column` of the table `name` with paths are not used.
pub(crate) fn unused_note(name: &str, column: &str) -> String {
    format!("{name}: {column} is not used: on a path, headings only say where the tags on a robot are (tags.csv)")
}

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
        let optional = [&instant::COLUMNS[..], &COLUMNS, &place_columns::COLUMNS, &["robot"]].concat();
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

#[cfg(test)]
mod tests {
    use crate::options::field_names::FieldNames;
    use crate::test_kit::folder_of;
    use crate::{ReadOptions, RobotLog, read};

    const RANGES: (&str, &str) = ("ranges.csv", "t_s,node,range_m\n1,a,9\n4.5,a,5\n");
    const TAGS: (&str, &str) = ("tags.csv", "tag,x_m,y_m\nfront,1,0\n");

    fn log(files: &[(&str, &str)], options: &ReadOptions) -> RobotLog {
        read(folder_of(files.iter().copied()).path(), options).unwrap()
    }

    fn places(log: &RobotLog) -> Vec<f64> {
        log.log.ranges().iter().map(|range| range.position.x_m).collect()
    }

    /// The notes on headings.
    fn told(log: &RobotLog) -> Vec<&str> {
        log.notes.iter().map(String::as_str).filter(|note| note.contains("heading")).collect()
    }

    #[test]
    fn headings_that_are_used_are_not_called_ignored_and_others_are_explained() {
        let path = ("path.csv", "t_s,x_m,y_m,heading_rad,wheel\n0,0,0,0,1\n10,20,0,0,1\n");
        let options = ReadOptions::default();
        let used = log(&[path, RANGES, TAGS], &options);
        assert_eq!((places(&used), told(&used)), (vec![3.0, 10.0], vec![]));
        assert!(used.notes.contains(&"path.csv: ignored columns: `wheel`".to_owned()), "{:?}", used.notes);
        let unused = log(&[path, RANGES], &options);
        assert_eq!(places(&unused), [2.0, 9.0]);
        let expected = "path.csv: heading_rad is not used: on a path, headings only say where the tags on a robot are (tags.csv)";
        assert_eq!(told(&unused), [expected]);
    }

    #[test]
    fn headings_and_places_have_the_names_of_the_user() {
        let mut options = ReadOptions::default();
        options.form.path_fields = Some(FieldNames::parse_places("x_m=east,heading_deg=yaw").unwrap());
        let path = ("path.csv", "t_s,east,y_m,yaw\n0,0,0,180\n10,20,0,180\n");
        let found = log(&[path, RANGES, TAGS], &options);
        assert!(
            places(&found).iter().zip([1.0, 8.0]).all(|(found, known)| (found - known).abs() < 1e-9),
            "{found:?}"
        );
    }

    #[test]
    fn columns_that_look_like_headings_do_no_harm() {
        let path = ("path.csv", "t_s,x_m,y_m,heading\n0,0,0,0\n10,20,0,0\n");
        let found = log(&[path, RANGES], &ReadOptions::default());
        assert!(found.notes.contains(&"path.csv: ignored columns: `heading`".to_owned()), "{:?}", found.notes);
    }
}
