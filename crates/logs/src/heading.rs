//! How the antenna of the robot is turned at each stop: one of two columns of `stops.csv`.

use super::error::RobotLogError;
use super::table::{Column, Row, Table};

/// The columns of a heading that a file may have: radians and degrees.
pub(super) const COLUMNS: [&str; 2] = ["heading_rad", "heading_deg"];

/// The column with the headings.
#[derive(Clone, Copy)]
pub(super) enum Headings {
    /// The file has none: the antenna does not turn, or has no sectors.
    Absent,
    /// In radians.
    Radians(Column),
    /// In degrees.
    Degrees(Column),
}

impl Headings {
    /// The column of `table`. Of both, the one in radians counts; then `notes` says so.
    pub(super) fn find(table: &Table, notes: &mut Vec<String>) -> Self {
        let [radians, degrees] = COLUMNS.map(|name| table.column(name));
        match (radians.exists(), degrees.exists()) {
            (false, false) => Self::Absent,
            (false, true) => Self::Degrees(degrees),
            (true, has_degrees) => {
                let [used, unused] = COLUMNS;
                notes.extend(has_degrees.then(|| table.ignored_beside(unused, "the headings", used)));
                Self::Radians(radians)
            }
        }
    }

    /// The heading of a row (rad), counterclockwise from x; `None` if the file has none.
    ///
    /// # Errors
    /// If the cell is empty or no finite number.
    pub(super) fn read(self, row: &Row<'_>) -> Result<Option<f64>, RobotLogError> {
        let (column, unit) = match self {
            Self::Absent => return Ok(None),
            Self::Radians(column) => (column, 1.0),
            Self::Degrees(column) => (column, 1.0_f64.to_radians()),
        };
        let heading = row.finite(column)?;
        let heading =
            heading.ok_or_else(|| row.wrong(column, "a heading at each stop, if one stop has a heading"))?;
        Ok(Some(heading * unit))
    }
}

#[cfg(test)]
mod tests {
    use sextant_channel::ReceptionLog;

    use crate::{ReadOptions, RobotLog, write};

    fn read(stops: &str) -> Result<RobotLog, String> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("stops.csv"), stops).unwrap();
        std::fs::write(folder.path().join("receptions.csv"), "node,stop,received\nlamp,A,1\n").unwrap();
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
        let none = read("stop,x_m,y_m\nA,0,0\nB,1,0\n").unwrap().log;
        assert!(!none.has_headings() && headings(&none) == [None, None]);
        let both = read("stop,x_m,y_m,heading_deg,heading_rad\nA,0,0,90,0.5\n").unwrap();
        assert_eq!(headings(&both.log), [Some(0.5)]);
        assert!(both.notes.iter().any(|note| note.contains("heading_deg") && note.contains("heading_rad")));
    }

    #[test]
    fn a_stop_without_a_heading_among_others_is_refused() {
        let refused = read("stop,x_m,y_m,heading_rad\nA,0,0,0.1\nB,1,0,\n").unwrap_err();
        assert!(refused.contains("stops.csv") && refused.contains("a heading at each stop"), "{refused}");
        let refused = read("stop,x_m,y_m,heading_rad\nA,0,0,inf\nB,1,0,1\n").unwrap_err();
        assert!(refused.contains("heading_rad") && refused.contains("a finite number"), "{refused}");
    }
}
