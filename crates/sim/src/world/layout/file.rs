//! Nodes from a table in a file.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use sextant_channel::{ObstacleField, Position};
use sextant_kernel::text::of_cell;
use sextant_kernel::{Files, SettingError};

use super::placed::{PlacedNode, twin};
use crate::csv_rows::{cell_fault, line_of, row_fault};

/// Nodes from a table, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CsvConfig {
    /// A CSV file with the columns `node`, `x_m`, `y_m` and, optionally, `z_m`; its path is relative to the
    /// scenario's folder.
    pub file: PathBuf,
}

/// One row of the table.
#[derive(Deserialize)]
struct NodeRow {
    node: String,
    x_m: f64,
    y_m: f64,
    #[serde(default)]
    z_m: Option<f64>,
}

const COLUMNS: &str = "a header `node,x_m,y_m` or `node,x_m,y_m,z_m`, and numbers below";

impl CsvConfig {
    /// The nodes, in the order of the rows.
    pub(super) fn place(&self, obstacles: &ObstacleField, files: &Files) -> Result<Vec<PlacedNode>, SettingError> {
        let path = files.path(&self.file);
        let text = files.read_text(&self.file).map_err(|error| {
            SettingError::new("file", format!("`{}`: {error}", path.display()), "a CSV file that can be read")
        })?;
        self.parse(&text, obstacles).map_err(|error| files.discreet(&self.file, error))
    }

    fn parse(&self, text: &str, obstacles: &ObstacleField) -> Result<Vec<PlacedNode>, SettingError> {
        let refuse = |line: u64, what: String, allowed: &str| {
            SettingError::new("file", format!("`{}`, line {line}: {what}", self.file.display()), allowed)
        };
        let mut reader =
            csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
        let header = reader.headers().map_err(|error| refuse(1, error.to_string(), COLUMNS))?.clone();
        if let Some(column) = header.iter().find(|column| !matches!(*column, "node" | "x_m" | "y_m" | "z_m")) {
            return Err(refuse(1, format!("column `{column}`"), "the columns `node`, `x_m`, `y_m`, `z_m`"));
        }
        if let Some(column) = ["node", "x_m", "y_m"].into_iter().find(|&column| !header.iter().any(|it| it == column))
        {
            return Err(refuse(
                1,
                format!("no column `{column}`"),
                "the columns `node`, `x_m`, `y_m` and, optionally, `z_m`",
            ));
        }
        let (mut nodes, mut lines) = (Vec::new(), Vec::new());
        for record in reader.records() {
            let record = record.map_err(|error| {
                let line = line_of(text, error.position());
                refuse(line, row_fault(&error), COLUMNS)
            })?;
            let line = line_of(text, record.position());
            let row: NodeRow = record
                .deserialize(Some(&header))
                .map_err(|error| refuse(line, cell_fault(&error, &header, &record), COLUMNS))?;
            if row.node.is_empty() {
                return Err(refuse(line, "an empty name".into(), "a name in the column `node`"));
            }
            let position = Position::new(row.x_m, row.y_m, row.z_m.unwrap_or(0.0));
            if let Some((found, allowed)) = obstacles.fault(position) {
                return Err(refuse(line, format!("node `{}` at {found}", row.node), allowed));
            }
            nodes.push(PlacedNode { name: of_cell(&row.node).to_owned(), position });
            lines.push(line);
        }
        if let Some((before, i)) = twin(nodes.iter().map(|node| node.name.as_str())) {
            let what = format!("node `{}` again, as in line {}", nodes[i].name, lines[before]);
            return Err(refuse(lines[i], what, "a name that no other node has"));
        }
        if nodes.is_empty() {
            let found = format!("`{}`, without any rows", self.file.display());
            return Err(SettingError::new("file", found, "at least one node"));
        }
        Ok(nodes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Vec<PlacedNode>, String> {
        let config = CsvConfig { file: "nodes.csv".into() };
        config.parse(text, &ObstacleField::default()).map_err(|error| error.found().to_owned())
    }

    #[test]
    fn a_table_is_read_with_or_without_heights() {
        let nodes = parse("node,x_m,y_m\n a, 1.5 ,-2\n\nb,0,1e1\n").unwrap();
        assert_eq!(nodes[0], PlacedNode { name: "a".into(), position: Position::new(1.5, -2.0, 0.0) });
        assert_eq!(nodes[1].position, Position::new(0.0, 10.0, 0.0));
        let nodes = parse("z_m,node,y_m,x_m\n3,a,2,1\n").unwrap();
        assert_eq!(nodes[0].position, Position::new(1.0, 2.0, 3.0));
    }

    #[test]
    fn an_error_in_a_row_names_its_line() {
        let line = |text| parse(text).unwrap_err();
        assert_eq!(line("node,x_m,y_m\na,0,0\nb,zero,0\n"), "`nodes.csv`, line 3: `zero` in the column `x_m`");
        assert_eq!(line("node,x_m,y_m\n\n# b\na,0\n"), "`nodes.csv`, line 4: 2 cells for 3 columns");
        assert_eq!(line("node,x_m,y_m\na,NaN,0\n"), "`nodes.csv`, line 2: node `a` at [NaN, 0, 0]");
        assert_eq!(line("node,x_m,y_m\na,0,0\nb,1,1\na,2,2\n"), "`nodes.csv`, line 4: node `a` again, as in line 2");
        assert_eq!(line("node,x_m,height\na,0,0\n"), "`nodes.csv`, line 1: column `height`");
        assert_eq!(line("node,x_m\na,0\n"), "`nodes.csv`, line 1: no column `y_m`");
        assert_eq!(line("node,x_m,y_m\n"), "`nodes.csv`, without any rows");
    }
}
