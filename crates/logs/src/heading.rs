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
