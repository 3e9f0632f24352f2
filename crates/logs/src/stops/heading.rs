//! How the antenna of the robot is turned at each stop: one of two columns of `stops.csv`.

use crate::csv::table::{Column, Table, TableRow};
use crate::error::robot_log_error::RobotLogError;
use crate::path::headings::COLUMNS;

/// The column with the headings: of all rows, or of none.
pub(crate) struct Headings {
    unit: HeadingColumn,
    /// Whether the first row has one.
    given: Option<bool>,
}

/// The unit of the column.
#[derive(Clone, Copy)]
enum HeadingColumn {
    /// The file has none: the antenna does not turn, or has no sectors.
    Absent,
    Radians(Column),
    Degrees(Column),
}

impl Headings {
    /// The column of `table`. Of both, the one in radians counts; then `notes` says so.
    pub(crate) fn find(table: &Table<'_>, notes: &mut Vec<String>) -> Self {
        let [radians, degrees] = COLUMNS.map(|name| table.column(name));
        let unit = match (radians.exists(), degrees.exists()) {
            (false, false) => HeadingColumn::Absent,
            (false, true) => HeadingColumn::Degrees(degrees),
            (true, has_degrees) => {
                let [used, unused] = COLUMNS;
                notes.extend(has_degrees.then(|| table.ignored_beside(unused, "the headings", used)));
                HeadingColumn::Radians(radians)
            }
        };
        Self { unit, given: None }
    }

    /// The heading of the next row (rad), counterclockwise from x; `None` if the file has none.
    ///
    /// # Errors
    /// If the cell is no finite number, or this row has a heading and the first one has not, or the other way round.
    pub(crate) fn read(&mut self, row: &TableRow<'_>) -> Result<Option<f64>, RobotLogError> {
        let (column, factor) = match self.unit {
            HeadingColumn::Absent => return Ok(None),
            HeadingColumn::Radians(column) => (column, 1.0),
            HeadingColumn::Degrees(column) => (column, 1.0_f64.to_radians()),
        };
        let heading = row.finite(column)?;
        if *self.given.get_or_insert(heading.is_some()) != heading.is_some() {
            return Err(row.wrong(column, "a heading at each stop, or at none"));
        }
        Ok(heading.map(|heading| heading * factor))
    }
}

#[cfg(test)]
mod tests {
    use sextant_channel::ReceptionLog;

    use crate::ReadOptions;
    use crate::RobotLog;
    use crate::test_kit::folder_of;
    use crate::write;

    fn read(stops: &str) -> Result<RobotLog, String> {
        let folder = folder_of([("stops.csv", stops), ("receptions.csv", "node,stop,received\nlamp,A,1\n")]);
        let read = crate::read(folder.path(), &ReadOptions::default());
        read.map_err(|why| why.to_string().replace(&format!("{}/", folder.path().display()), ""))
    }

    fn headings(log: &ReceptionLog) -> Vec<Option<f64>> {
        log.stops().iter().map(|stop| stop.heading_rad).collect()
    }

    #[test]
    fn headings_are_radians_or_degrees_and_are_written_back_exactly() {
        let radians = read("stop,x_m,y_m,heading_rad\nA,0,0,0.1\nB,1,0,-2.5\n").unwrap().log;
        assert_eq!(headings(&radians), [Some(0.1), Some(-2.5)]);
        let degrees = read("stop,x_m,y_m,heading_deg\nA,0,0,90\nB,1,0,-12.3\n").unwrap().log;
        let right = std::f64::consts::FRAC_PI_2;
        assert!((degrees.stops()[0].heading_rad.unwrap() - right).abs() < 1e-15);
        for log in [radians, degrees] {
            let folder = tempfile::tempdir().unwrap();
            write(folder.path(), &log).unwrap();
            let again = crate::read(folder.path(), &ReadOptions::default()).unwrap().log;
            assert!(again.has_headings() && headings(&again) == headings(&log));
        }
        for none in ["stop,x_m,y_m\nA,0,0\nB,1,0\n", "stop,x_m,y_m,heading_rad\nA,0,0,\nB,1,0,\n"] {
            let none = read(none).unwrap().log;
            assert!(!none.has_headings() && headings(&none) == [None, None]);
        }
        let both = read("stop,x_m,y_m,heading_deg,heading_rad\nA,0,0,90,0.5\n").unwrap();
        assert_eq!(headings(&both.log), [Some(0.5)]);
        assert!(both.notes.iter().any(|note| note.contains("heading_deg") && note.contains("heading_rad")));
    }

    #[test]
    fn a_stop_without_a_heading_among_others_is_refused() {
        let refused = read("stop,x_m,y_m,heading_rad\nA,0,0,0.1\nB,1,0,\n").unwrap_err();
        assert!(refused.contains("stops.csv") && refused.contains("a heading at each stop, or at none"), "{refused}");
        let refused = read("stop,x_m,y_m,heading_rad\nA,0,0,inf\nB,1,0,1\n").unwrap_err();
        assert!(refused.contains("heading_rad") && refused.contains("a finite number"), "{refused}");
    }
}
