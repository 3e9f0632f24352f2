//! The true positions of nodes, `nodes.csv`: for metrics, never for a mapper.

use std::collections::BTreeMap;
use std::path::Path;

use sextant_channel::Position;

use super::local_plane::LocalPlane;
use super::place_columns::{COLUMNS, Frame, Places};
use crate::csv::header::{KnownColumns, Others};
use crate::csv::memory_table::MemoryTable;
use crate::csv::table::Table;
use crate::csv::table_source::TableSource;
use crate::error::robot_log_error::RobotLogError;
use crate::options::field_names::FieldNames;

/// The true positions of nodes as a file or a table has them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrueNodes {
    /// The position of each node by its name (m).
    pub places: BTreeMap<String, Position>,
    /// Whether there are heights. Without, positions are at height 0.
    pub has_heights: bool,
}

/// Reads the positions (m) in the file `path`, by name of node: `node,x_m,y_m[,z_m]`, or `node,lat,lon[,alt_m]` if the log
/// has its places in `plane`; `fields` are other names of these columns. `notes` get what the user should know.
///
/// # Errors
/// If the file cannot be read or has an invalid row; the error names file, line and column.
pub fn read_truth(
    path: &Path,
    fields: Option<&FieldNames>,
    plane: Option<&LocalPlane>,
    notes: &mut Vec<String>,
) -> Result<TrueNodes, RobotLogError> {
    read_places(path, &FieldNames::of_truth(fields), plane, &[], notes)
}

/// The same of a table in memory.
///
/// # Errors
/// If the table has an invalid row; the error names table, row and column.
pub fn read_truth_table(
    table: &MemoryTable<'_>,
    fields: Option<&FieldNames>,
    plane: Option<&LocalPlane>,
    notes: &mut Vec<String>,
) -> Result<TrueNodes, RobotLogError> {
    read_places(table, &FieldNames::of_truth(fields), plane, &[], notes)
}

/// Reads the positions (m) in a table, by name of node, with `names` of the user for columns; the columns `other` are known and
/// not read.
pub(crate) fn read_places<'a>(
    source: impl Into<TableSource<'a>>,
    names: &FieldNames,
    plane: Option<&LocalPlane>,
    other: &[&'static str],
    notes: &mut Vec<String>,
) -> Result<TrueNodes, RobotLogError> {
    let optional = [&COLUMNS, other].concat();
    let known = KnownColumns { required: &["node"], optional: &optional, names, others: Others::Ignored };
    let table = Table::open_known(source, known)?;
    notes.extend(table.notes());
    let places = Places::of(&table, Frame::of(plane), notes)?;
    let node = table.column("node");
    let mut plane = plane.copied();
    let mut found = BTreeMap::new();
    table.rows(|row| {
        if found.insert(row.node(node)?.into_owned(), places.read(row, &mut plane)?).is_some() {
            return Err(row.wrong(node, "each node once; this node is already given above"));
        }
        Ok(())
    })?;
    Ok(TrueNodes { places: found, has_heights: places.has_heights() })
}
