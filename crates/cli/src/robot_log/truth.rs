//! The true positions of nodes, `nodes.csv`: for metrics, never for a mapper.

use std::collections::BTreeMap;
use std::path::Path;

use sextant_channel::Position;

use super::error::RobotLogError;
use super::table::Table;

/// Reads the positions (m) in the file `path` (`node,x_m,y_m[,z_m]`), by name of node.
///
/// # Errors
/// If the file cannot be read or has an invalid row; the error names file, line and column.
pub fn read_truth(path: &Path) -> Result<BTreeMap<String, Position>, RobotLogError> {
    read_places(path, &["z_m"])
}

/// Reads the positions (m) in the file `path`, by name of node; columns that are `optional` and no position are ignored.
pub(super) fn read_places(
    path: &Path,
    optional: &[&'static str],
) -> Result<BTreeMap<String, Position>, RobotLogError> {
    let table = Table::read(path, &["node", "x_m", "y_m"], optional)?;
    let node = table.column("node");
    let place = ["x_m", "y_m", "z_m"].map(|name| table.column(name));
    let mut places = BTreeMap::new();
    table.rows(|row| {
        let name = row.text(node);
        if name.is_empty() {
            return Err(row.wrong(node, "the name of a node"));
        }
        if places.insert(name.to_owned(), row.position(place)?).is_some() {
            return Err(row.wrong(node, "each node once; this node is already given above"));
        }
        Ok(())
    })?;
    Ok(places)
}
