//! The tables of a recording, row by row: what its messages say, under the names and units of the CSV formats.

mod declared;
mod drawn;
mod row;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::error::RecordingError;
use super::messages;
use super::names::LogTopics;
use super::reader::sound;
use crate::mcap_file::Piece;
use declared::Columns;
use prost::Message as _;

pub use row::{Cell, CellKind, TableColumn, TableRow};

/// What a recording has, besides its tables.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LeftOut {
    /// Topics that are no tables, such as meshes of obstacles.
    pub topics: BTreeSet<String>,
}

/// What is in a recording, in the order of the file.
#[derive(Debug)]
pub enum TablePiece<'a> {
    /// A row of a table.
    Row(TableRow<'a>),
    /// A file within the recording.
    Attachment {
        /// Its name.
        name: &'a str,
        /// Its octets.
        data: &'a [u8],
    },
}

/// Calls `visit` with each row of each table of the recording `path`, and with each file in it, in the order of the file.
/// One chunk is in memory at a time. In the table of receptions, the first stop has a row for each node, so that the nodes
/// are known, in their order.
///
/// # Errors
/// If the file cannot be read or is damaged, or the first error of `visit`.
pub fn read_tables(
    path: &Path,
    visit: &mut dyn FnMut(TablePiece<'_>) -> Result<(), RecordingError>,
) -> Result<LeftOut, RecordingError> {
    let mut reading = Reading::default();
    sound(path, &mut |piece| match piece {
        Piece::Message { channel, header, data } => {
            let schema = channel.schema.as_ref().map_or("", |schema| schema.name.as_str());
            let message = Message { topic: &channel.topic, schema, time_ns: header.log_time, data };
            let problem = |problem| RecordingError::message(path, &channel.topic, problem);
            let rows = reading.rows(&message).map_err(problem)?;
            for (table, columns, cells) in &rows {
                visit(TablePiece::Row(TableRow { table, columns, cells }))?;
            }
            Ok(())
        }
        Piece::Attachment { name, data, .. } => visit(TablePiece::Attachment { name, data }),
        Piece::Header { .. } | Piece::Metadata(_) => Ok(()),
    })?;
    // The first stop of a recording that was cut may be incomplete.
    for (table, columns, cells) in reading.first_stop() {
        visit(TablePiece::Row(TableRow { table: &table, columns: &columns, cells: &cells }))?;
    }
    Ok(reading.left_out)
}

/// A message of a recording.
struct Message<'a> {
    topic: &'a str,
    schema: &'a str,
    time_ns: u64,
    data: &'a [u8],
}

/// A row with the name of its table and its columns.
pub type OwnedRow = (String, Vec<TableColumn>, Vec<Cell>);

/// The row of a station, whose index other tables have: nodes come first, then robots, then sinks. `kind` is `node`, `robot`
/// or `sink`.
#[must_use]
pub fn station(index: usize, kind: &str, name: &str) -> OwnedRow {
    let columns = [("index", CellKind::Integer), ("kind", CellKind::Text), ("name", CellKind::Text)];
    let index = i64::try_from(index).map_or(Cell::Missing, Cell::Integer);
    let cells = vec![index, Cell::Text(kind.to_owned()), Cell::Text(name.to_owned())];
    ("stations".to_owned(), columns.map(|(name, kind)| TableColumn::new(name, kind)).to_vec(), cells)
}

/// What was read so far.
#[derive(Default)]
struct Reading {
    names: Vec<String>,
    /// The first stop of the log of the first network, until all its receptions are read.
    first: FirstStop,
    columns: Columns,
    left_out: LeftOut,
}

/// The first stop of a log.
#[derive(Default)]
enum FirstStop {
    /// It comes later.
    #[default]
    Ahead,
    /// So many receptions are missing; those that were read, by node.
    Open { stop: u32, owed: u32, rows: BTreeMap<u32, OwnedRow> },
    /// It was passed on.
    Passed,
}

impl Reading {
    /// The rows that a message is.
    fn rows(&mut self, message: &Message<'_>) -> Result<Vec<OwnedRow>, String> {
        if message.schema == "sextant.Nodes" {
            let nodes = messages::NodesMessage::decode(message.data).map_err(|why| why.to_string())?;
            let first = self.names.len();
            self.names.extend(nodes.names);
            let row = |(index, name): (usize, &String)| station(index, "node", name);
            return Ok(self.names.iter().enumerate().skip(first).map(row).collect());
        }
        if let Some(name) = message.schema.strip_prefix("sextant.") {
            if let Some(row) = self.columns.row(name, message, &self.names)? {
                return self.in_order(message, row);
            }
        } else if let Some(rows) = drawn::rows(message, &self.names)? {
            return Ok(rows);
        }
        self.left_out.topics.insert(message.topic.to_owned());
        Ok(Vec::new())
    }

    /// The rows that follow now that `row` was read: receptions at the first stop wait for each other.
    fn in_order(&mut self, message: &Message<'_>, row: OwnedRow) -> Result<Vec<OwnedRow>, String> {
        if matches!(self.first, FirstStop::Passed) || LogTopics::network(message.topic).is_some() {
            return Ok(vec![row]);
        }
        match (message.schema, &mut self.first) {
            ("sextant.Stop", FirstStop::Ahead) => {
                let stop = messages::StopMessage::decode(message.data).map_err(|why| why.to_string())?;
                self.first = FirstStop::Open { stop: stop.stop, owed: stop.receptions, rows: BTreeMap::new() };
                let after = if stop.receptions == 0 { self.first_stop() } else { Vec::new() };
                Ok([vec![row], after].concat())
            }
            ("sextant.Reception", FirstStop::Open { owed, rows, .. }) => {
                let reception = messages::ReceptionMessage::decode(message.data).map_err(|why| why.to_string())?;
                rows.insert(reception.node, row);
                *owed = owed.saturating_sub(1);
                Ok(if *owed == 0 { self.first_stop() } else { Vec::new() })
            }
            _ => Ok(vec![row]),
        }
    }

    /// The receptions at the first stop: a row for each node. A node that was not heard has one without a packet.
    fn first_stop(&mut self) -> Vec<OwnedRow> {
        let FirstStop::Open { stop, mut rows, .. } = std::mem::replace(&mut self.first, FirstStop::Passed) else {
            return Vec::new();
        };
        let columns = declared::RECEPTION_COLUMNS.map(|(name, kind)| TableColumn::new(name, kind));
        let silent = |name: &String| {
            let mut cells = vec![Cell::Text(name.clone()), Cell::Integer(stop.into()), Cell::Integer(0)];
            cells.resize(columns.len(), Cell::Missing);
            ("receptions".to_owned(), columns.to_vec(), cells)
        };
        let nodes = (0..).zip(&self.names);
        nodes.map(|(node, name)| rows.remove(&node).unwrap_or_else(|| silent(name))).collect()
    }
}
