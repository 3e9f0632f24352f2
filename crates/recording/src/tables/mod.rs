//! The tables of a recording, row by row: what its messages say, under the names and units of the CSV formats.

mod declared;
mod drawn;
mod row;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::antenna_text;
use super::error::RecordingError;
use super::messages;
use crate::mcap_file::Piece;
use crate::messages::names::{GAP_METADATA, LogTopics, RECOVERED_METADATA};
use crate::reader::run::{concern, sound};
use declared::Columns;
use prost::Message as _;

pub use row::{Cell, CellKind, TableColumn, TableRow};

/// What a recording has, besides its tables.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LeftOut {
    /// Topics that are no tables, such as meshes of obstacles.
    pub topics: BTreeSet<String>,
    /// What the user should know if the recording is incomplete: how many stops are missing, and whether it was recovered.
    pub concern: Option<String>,
}

/// What is in a recording, in the order of the file.
#[derive(Debug)]
pub enum TablePiece<'a> {
    /// A row of a table.
    Row(TableRow<'a>),
    /// A file within the recording, or the robots' antenna as a file.
    Attachment {
        /// Its name.
        name: &'a str,
        /// Its octets.
        data: &'a [u8],
    },
}

/// Calls `visit` with each row of each table of the recording `path`, and with each file in it, in the order of the file.
/// One chunk is in memory at a time. In the table of receptions, the first stop has a row for each node, so that the nodes
/// are known, in their order. A stop of which receptions are missing is left out.
///
/// # Errors
/// If the file cannot be read or is damaged, or the first error of `visit`.
pub fn read_tables(
    path: &Path,
    visit: &mut dyn FnMut(TablePiece<'_>) -> Result<(), RecordingError>,
) -> Result<LeftOut, RecordingError> {
    let mut reading = Reading::default();
    let show = |rows: &TableRows, visit: &mut dyn FnMut(TablePiece<'_>) -> Result<(), RecordingError>| {
        let TableRows { table, columns, cells } = rows;
        cells.iter().try_for_each(|cells| visit(TablePiece::Row(TableRow { table, columns, cells })))
    };
    sound(path, &mut |piece| match piece {
        Piece::Message { channel, header, data } => {
            let schema = channel.schema.as_ref().map_or("", |schema| schema.name.as_str());
            let message = Message { topic: &channel.topic, schema, time_ns: header.log_time, data };
            let problem = |problem| RecordingError::message(path, &channel.topic, problem);
            if schema == "sextant.SectorGains" {
                let text = antenna(data).map_err(problem)?;
                let name = declared::network_table(ANTENNA_FILE, &channel.topic);
                return visit(TablePiece::Attachment { name: &name, data: text.as_bytes() });
            }
            reading.rows(&message).map_err(problem)?.iter().try_for_each(|rows| show(rows, visit))
        }
        Piece::Attachment { name, data, .. } => visit(TablePiece::Attachment { name, data }),
        Piece::Metadata(record) if record.name.starts_with(GAP_METADATA) => {
            reading.logs.values_mut().for_each(LogTables::gap);
            Ok(())
        }
        Piece::Metadata(record) if record.name == RECOVERED_METADATA => {
            reading.recovered = Some(record.metadata.clone());
            Ok(())
        }
        Piece::Header { .. } | Piece::Metadata(_) => Ok(()),
    })?;
    reading.logs.values_mut().for_each(LogTables::gap);
    let missing_stops = reading.logs.values().map(|log| log.missing_stops).sum();
    let concern = concern(missing_stops, reading.recovered.as_ref());
    Ok(LeftOut { concern, ..reading.left_out })
}

/// Name of the file with the robots' antenna: that of the folder of a log.
const ANTENNA_FILE: &str = "antenna.toml";

/// The text of the file with the robots' antenna that a message has.
fn antenna(data: &[u8]) -> Result<String, String> {
    let message = messages::SectorGainsMessage::decode(data).map_err(|why| why.to_string())?;
    antenna_text::write(&message.gains()?).ok_or_else(|| "an antenna without sectors".to_owned())
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

/// Rows of one table.
struct TableRows {
    table: String,
    columns: Vec<TableColumn>,
    cells: Vec<Vec<Cell>>,
}

impl From<OwnedRow> for TableRows {
    fn from((table, columns, cells): OwnedRow) -> Self {
        Self { table, columns, cells: vec![cells] }
    }
}

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
    /// The logs of the networks, by their names.
    logs: BTreeMap<Option<String>, LogTables>,
    columns: Columns,
    left_out: LeftOut,
    /// How the recording was damaged, if it was recovered.
    recovered: Option<BTreeMap<String, String>>,
}

/// The log of a network, while its tables are read.
#[derive(Default)]
struct LogTables {
    /// The last stop, until all its receptions are read.
    open: Option<OpenStop>,
    /// The last stop that was passed on.
    last: Option<u32>,
    /// Whether messages are missing.
    has_gap: bool,
    /// The number of the next stop in the file.
    next: u32,
    /// Number of stops that are left out, or are missing between others.
    missing_stops: usize,
}

/// A stop of which receptions are missing.
struct OpenStop {
    stop: u32,
    owed: u32,
    row: Option<TableRows>,
    /// The receptions that were read, by node.
    receptions: Vec<(u32, Vec<Cell>)>,
}

impl LogTables {
    /// Messages are missing here: a stop that is not complete is left out.
    fn gap(&mut self) {
        self.missing_stops += usize::from(self.open.take().is_some());
        self.has_gap = true;
    }

    /// Whether rows of this stop are left out, with the stop.
    fn leaves_out(&self, stop: u32) -> bool {
        self.has_gap && self.last != Some(stop) && self.open.as_ref().is_none_or(|open| open.stop != stop)
    }
}

impl Reading {
    /// The rows that a message is.
    fn rows(&mut self, message: &Message<'_>) -> Result<Vec<TableRows>, String> {
        match message.schema {
            "sextant.Nodes" => {
                let nodes = messages::NodesMessage::decode(message.data).map_err(|why| why.to_string())?;
                let first = self.names.len();
                self.names.extend(nodes.names);
                let rows = (first..).zip(&self.names[first..]);
                let cells = rows.map(|(index, name)| station(index, "node", name).2).collect();
                let (table, columns, _) = station(first, "node", "");
                return Ok(vec![TableRows { table, columns, cells }]);
            }
            "sextant.Stop" => {
                let stop = messages::StopMessage::decode(message.data).map_err(|why| why.to_string())?;
                let row = self.columns.row("Stop", message, &self.names)?.map(TableRows::from);
                let open = OpenStop { stop: stop.stop, owed: stop.receptions, row, receptions: Vec::new() };
                let log = self.log(message);
                log.missing_stops += open.stop.saturating_sub(log.next) as usize;
                log.next = open.stop.saturating_add(1);
                log.open = Some(open);
                return Ok(self.closed(message));
            }
            "sextant.Reception" => {
                let reception = messages::ReceptionMessage::decode(message.data).map_err(|why| why.to_string())?;
                let Some((table, columns, cells)) = self.columns.row("Reception", message, &self.names)? else {
                    return Ok(Vec::new());
                };
                let rows = TableRows { table, columns, cells: vec![cells] };
                return Ok(self.receptions(message, reception.stop, rows, &[reception.node]));
            }
            "sextant.StopReceptions" => {
                let stop = messages::StopReceptionsMessage::decode(message.data).map_err(|why| why.to_string())?;
                let cells = stop.rows()?.map(|(reception, lqi)| declared::cells_of(&reception, lqi, &self.names));
                let table = declared::network_table("receptions", message.topic);
                let rows = TableRows { table, columns: declared::reception_columns(), cells: cells.collect() };
                return Ok(self.receptions(message, stop.stop, rows, &stop.node));
            }
            "sextant.SectorSnrs" => {
                let stop = messages::SectorSnrsMessage::decode(message.data).map_err(|why| why.to_string())?;
                if self.log(message).leaves_out(stop.stop) {
                    return Ok(Vec::new());
                }
                let cells = stop.reports()?.map(|report| declared::cells_of_report(&report, &self.names)).collect();
                let table = declared::network_table("sector_snrs", message.topic);
                return Ok(vec![TableRows { table, columns: declared::report_columns(), cells }]);
            }
            _ => {}
        }
        if let Some(name) = message.schema.strip_prefix("sextant.") {
            if let Some(row) = self.columns.row(name, message, &self.names)? {
                return Ok(vec![row.into()]);
            }
        } else if let Some(rows) = drawn::rows(message, &self.names)? {
            return Ok(vec![rows]);
        }
        self.left_out.topics.insert(message.topic.to_owned());
        Ok(Vec::new())
    }

    /// The log that a message is of.
    fn log(&mut self, message: &Message<'_>) -> &mut LogTables {
        self.logs.entry(LogTopics::network(message.topic).map(str::to_owned)).or_default()
    }

    /// The rows that follow now that receptions of `nodes` at a stop were read: they wait until all of the stop are there.
    fn receptions(&mut self, message: &Message<'_>, stop: u32, rows: TableRows, nodes: &[u32]) -> Vec<TableRows> {
        let log = self.log(message);
        if log.leaves_out(stop) {
            return Vec::new();
        }
        let Some(open) = log.open.as_mut().filter(|open| open.stop == stop) else { return vec![rows] };
        open.owed = open.owed.saturating_sub(u32::try_from(nodes.len()).unwrap_or(u32::MAX));
        open.receptions.extend(nodes.iter().copied().zip(rows.cells));
        self.closed(message)
    }

    /// The rows of the open stop, if none of its receptions is missing. Those of the first stop of the first network have a row for
    /// each node: one that was not heard has a row without a packet.
    fn closed(&mut self, message: &Message<'_>) -> Vec<TableRows> {
        let log = self.log(message);
        let is_first = log.last.is_none() && LogTopics::network(message.topic).is_none();
        let Some(OpenStop { stop, row, receptions, .. }) = log.open.take_if(|open| open.owed == 0) else {
            return Vec::new();
        };
        log.last = Some(stop);
        let columns = declared::reception_columns();
        let cells: Vec<Vec<Cell>> = if is_first {
            let silent = |name: &String| {
                // A silent node is silence of one packet, as at the stops where it has no row.
                let counts = [Cell::Integer(0), Cell::Integer(1)];
                let mut cells: Vec<Cell> = [Cell::Text(name.clone()), Cell::Integer(stop.into())].into();
                cells.extend(counts);
                cells.resize(columns.len(), Cell::Missing);
                cells
            };
            let mut heard: BTreeMap<u32, Vec<Cell>> = receptions.into_iter().collect();
            let nodes = (0..).zip(&self.names);
            nodes.map(|(node, name)| heard.remove(&node).unwrap_or_else(|| silent(name))).collect()
        } else {
            receptions.into_iter().map(|(_, cells)| cells).collect()
        };
        let table = declared::network_table("receptions", message.topic);
        row.into_iter().chain([TableRows { table, columns, cells }]).collect()
    }
}
