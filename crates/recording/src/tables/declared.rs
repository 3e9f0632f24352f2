//! Rows of own messages, by their declarations: each field is a column.

use std::collections::BTreeMap;

use prost::encoding::{DecodeContext, WireType, decode_key, decode_varint, skip_field};

use sextant_channel::{Reception, SectorReport};

use super::row::{Cell, CellKind, TableColumn};
use super::{Message, OwnedRow};
use crate::messages::declarations;
use crate::messages::descriptor::{Declaration, Field, FieldKind};
use crate::messages::names::{ApplicationTopics, LogTopics};

/// The columns of the table of receptions.
const RECEPTION_COLUMNS: [(&str, CellKind); 8] = [
    ("node", CellKind::Text),
    ("stop", CellKind::Integer),
    ("received", CellKind::Integer),
    ("sent", CellKind::Integer),
    ("sector", CellKind::Integer),
    ("rssi_dbm", CellKind::Real),
    ("snr_db", CellKind::Real),
    ("lqi", CellKind::Integer),
];

/// The columns of the table of receptions.
pub(super) fn reception_columns() -> Vec<TableColumn> {
    RECEPTION_COLUMNS.map(|(name, kind)| TableColumn::new(name, kind)).to_vec()
}

/// A row of the table of receptions.
pub(super) fn cells_of(reception: &Reception, lqi: Option<u32>, names: &[String]) -> Vec<Cell> {
    let integer = |number: u32| Cell::Integer(number.into());
    let &Reception { node, stop, received, sent, sector, rssi_dbm, snr_db } = reception;
    vec![
        Cell::Text(name_of(names, node.0.into())),
        integer(stop),
        integer(received),
        integer(sent),
        sector.map_or(Cell::Missing, |sector| integer(sector.into())),
        rssi_dbm.map_or(Cell::Missing, Cell::Real),
        snr_db.map_or(Cell::Missing, Cell::Real),
        lqi.map_or(Cell::Missing, integer),
    ]
}

/// The columns of the table of the signal-to-noise ratios of all sectors.
pub(super) fn report_columns() -> Vec<TableColumn> {
    let integers = ["stop", "sector"].map(|name| TableColumn::new(name, CellKind::Integer));
    let [stop, sector] = integers;
    vec![TableColumn::new("node", CellKind::Text), stop, sector, TableColumn::new("snr_db", CellKind::Real)]
}

/// A row of the table of the signal-to-noise ratios of all sectors.
pub(super) fn cells_of_report(report: &SectorReport, names: &[String]) -> Vec<Cell> {
    let &SectorReport { node, stop, sector, snr_db } = report;
    let name = Cell::Text(name_of(names, node.0.into()));
    vec![name, Cell::Integer(stop.into()), Cell::Integer(sector.into()), Cell::Real(snr_db)]
}

/// The table called `table` of the network that `topic` belongs to.
pub(super) fn network_table(table: &str, topic: &str) -> String {
    let network = LogTopics::network(topic);
    network.map_or_else(|| table.to_owned(), |network| format!("networks/{network}/{table}"))
}

/// The message type of stops.
const STOP: &str = "Stop";

/// The table of each message type: its name, the fields that are the index of a node, and whether the topic says more.
const TABLES: [(&str, &str, &[&str], NamedByTopic); 24] = [
    (STOP, "stops", &[], NamedByTopic::Network),
    ("Reception", "receptions", &["node"], NamedByTopic::Network),
    ("Range", "ranges", &["node"], NamedByTopic::Network),
    ("Sector", "sectors", &[], NamedByTopic::Network),
    ("Contact", "contacts", &[], NamedByTopic::Robot),
    ("Anchor", "anchors", &["node"], NamedByTopic::Topic),
    ("Link", "", &["listener", "sender"], NamedByTopic::Link),
    ("Frame", "mac_frames", &[], NamedByTopic::Topic),
    ("Packet", "mac_packets", &[], NamedByTopic::Topic),
    ("Transmission", "mac_transmissions", &[], NamedByTopic::Topic),
    ("Assessment", "mac_assessments", &[], NamedByTopic::Topic),
    ("Hop", "routing_hops", &[], NamedByTopic::Topic),
    ("TreeEdge", "routing_tree", &["node"], NamedByTopic::Topic),
    ("ParentChange", "routing_changes", &["node"], NamedByTopic::Topic),
    ("Cell", "mac_cells", &[], NamedByTopic::Topic),
    ("Check", "mac_checks", &[], NamedByTopic::Topic),
    ("Battery", "batteries", &["node"], NamedByTopic::Topic),
    ("Metric", "metrics", &[], NamedByTopic::Topic),
    ("Sensors", "sensors", &[], NamedByTopic::Topic),
    ("Sensed", "sensed", &["node"], NamedByTopic::Topic),
    ("Application", "applications", &[], NamedByTopic::Topic),
    ("Estimate", "estimates", &[], NamedByTopic::Application),
    ("Capture", "captures", &[], NamedByTopic::Application),
    ("MappedNode", "distributed_nodes", &["node"], NamedByTopic::Topic),
];

/// What the topic of a message says besides its type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum NamedByTopic {
    /// Nothing.
    Topic,
    /// The network, which is a folder of tables.
    Network,
    /// The robot.
    Robot,
    /// Who sent: a node or an anchor. It is the name of the table.
    Link,
    /// The application.
    Application,
}

/// The columns of the tables so far, by message type.
#[derive(Default)]
pub(super) struct Columns {
    by_type: BTreeMap<String, Vec<TableColumn>>,
}

impl Columns {
    /// The row of a message of the type `name`; `None` if the type has no table.
    pub(super) fn row(
        &mut self,
        name: &str,
        message: &Message<'_>,
        names: &[String],
    ) -> Result<Option<OwnedRow>, String> {
        let Some(&(_, table, nodes, origin)) = TABLES.iter().find(|table| table.0 == name) else { return Ok(None) };
        let Some(declaration) = declarations().find(|declaration| declaration.name == name) else { return Ok(None) };
        let is_node = |field: &Field| nodes.contains(&field.name);
        // The number of receptions of a stop is for readers of messages.
        let fields = || declaration.fields.iter().filter(|field| (name, field.name) != (STOP, "receptions"));
        let read = values(declaration, message.data)?;
        let mut cells: Vec<Cell> = fields()
            .map(|field| {
                let value = read.get(&field.number).cloned().unwrap_or_else(|| absent(field.kind));
                match value {
                    Cell::Integer(node) if is_node(field) => Cell::Text(name_of(names, node)),
                    Cell::Integer(nanos) if field.name.ends_with("_ns") => {
                        u64::try_from(nanos).map_or(Cell::Missing, Cell::Nanos)
                    }
                    value => value,
                }
            })
            .collect();
        let columns = self.by_type.entry(name.to_owned()).or_insert_with(|| {
            let mut columns: Vec<_> = fields().map(|field| column(field, is_node(field))).collect();
            match origin {
                NamedByTopic::Robot => columns.push(TableColumn::new("robot", CellKind::Text)),
                NamedByTopic::Application => columns.push(TableColumn::new("application", CellKind::Text)),
                NamedByTopic::Topic | NamedByTopic::Network | NamedByTopic::Link => {}
            }
            if name == STOP {
                columns.push(TableColumn::new("sent", CellKind::Integer));
            }
            columns
        });
        if name == STOP {
            // In a recording a pair of node and stop without a reception is silence of one packet.
            cells.push(Cell::Integer(1));
        }
        let mut table = table.to_owned();
        match origin {
            NamedByTopic::Topic => {}
            NamedByTopic::Network => table = network_table(&table, message.topic),
            NamedByTopic::Robot => {
                let robot = message.topic.strip_prefix("/robot/").and_then(|rest| rest.strip_suffix("/contacts"));
                cells.push(robot.map_or(Cell::Missing, |robot| Cell::Text(robot.to_owned())));
            }
            NamedByTopic::Link => table = message.topic.trim_start_matches('/').to_owned(),
            NamedByTopic::Application => {
                let application = ApplicationTopics::application(message.topic);
                cells.push(application.map_or(Cell::Missing, |(name, _)| Cell::Text(name.to_owned())));
            }
        }
        Ok(Some((table, columns.clone(), cells)))
    }
}

/// The name of the node with this index; its number if it has none.
pub(super) fn name_of(names: &[String], node: i64) -> String {
    let index = usize::try_from(node).ok();
    index.and_then(|index| names.get(index)).cloned().unwrap_or_else(|| node.to_string())
}

/// The column of a field: times are in seconds, and nodes have their names.
fn column(field: &Field, is_node: bool) -> TableColumn {
    let kind = match field.kind {
        _ if is_node => CellKind::Text,
        _ if field.name.ends_with("_ns") => CellKind::Real,
        FieldKind::Uint32
        | FieldKind::OptionalUint32
        | FieldKind::Uint64
        | FieldKind::OptionalUint64
        | FieldKind::Bool => CellKind::Integer,
        FieldKind::Double | FieldKind::OptionalDouble => CellKind::Real,
        FieldKind::String | FieldKind::Strings | FieldKind::Bytes | FieldKind::Uint32s | FieldKind::Doubles => {
            CellKind::Text
        }
    };
    match field.name.strip_suffix("_ns") {
        Some("time") => TableColumn::new("t_s", kind),
        Some(what) => TableColumn::new(format!("{what}_s"), kind),
        None => TableColumn::new(field.name, kind),
    }
}

/// The value of a field that is not in a message.
fn absent(kind: FieldKind) -> Cell {
    match kind {
        FieldKind::OptionalUint32 | FieldKind::OptionalUint64 | FieldKind::OptionalDouble => Cell::Missing,
        FieldKind::Uint32 | FieldKind::Uint64 | FieldKind::Bool => Cell::Integer(0),
        FieldKind::Double => Cell::Real(0.0),
        FieldKind::String | FieldKind::Strings | FieldKind::Bytes | FieldKind::Uint32s | FieldKind::Doubles => {
            Cell::Text(String::new())
        }
    }
}

/// The fields of a message, by number. Several texts of one field are joined by commas; octets are in hexadecimal.
fn values(declaration: &Declaration, data: &[u8]) -> Result<BTreeMap<i32, Cell>, String> {
    let mut rest = data;
    let mut values = BTreeMap::new();
    while !rest.is_empty() {
        let (tag, wire) = decode_key(&mut rest).map_err(|why| why.to_string())?;
        let field = declaration.fields.iter().find(|field| u32::try_from(field.number) == Ok(tag));
        let Some(field) = field else {
            skip_field(wire, tag, &mut rest, DecodeContext::default()).map_err(|why| why.to_string())?;
            continue;
        };
        let value = value(field, wire, &mut rest)?;
        match (values.get_mut(&field.number), value) {
            (Some(Cell::Text(text)), Cell::Text(more)) if field.kind == FieldKind::Strings => {
                text.push(',');
                text.push_str(&more);
            }
            (_, value) => {
                values.insert(field.number, value);
            }
        }
    }
    Ok(values)
}

fn value(field: &Field, wire: WireType, rest: &mut &[u8]) -> Result<Cell, String> {
    let varint = |rest: &mut &[u8]| decode_varint(rest).map_err(|why| why.to_string());
    let wrong = || format!("field {} has another type", field.name);
    match (field.kind, wire) {
        (
            FieldKind::Uint32
            | FieldKind::OptionalUint32
            | FieldKind::Uint64
            | FieldKind::OptionalUint64
            | FieldKind::Bool,
            WireType::Varint,
        ) => Ok(i64::try_from(varint(rest)?).map_or(Cell::Missing, Cell::Integer)),
        (FieldKind::Double | FieldKind::OptionalDouble, WireType::SixtyFourBit) => {
            let (octets, after) = rest.split_first_chunk().ok_or_else(wrong)?;
            *rest = after;
            Ok(Cell::Real(f64::from_le_bytes(*octets)))
        }
        (FieldKind::String | FieldKind::Strings | FieldKind::Bytes, WireType::LengthDelimited) => {
            let length = usize::try_from(varint(rest)?).map_err(|why| why.to_string())?;
            let (octets, after) = rest.split_at_checked(length).ok_or_else(wrong)?;
            *rest = after;
            Ok(Cell::Text(match field.kind {
                FieldKind::Bytes => octets.iter().map(|octet| format!("{octet:02x}")).collect(),
                _ => String::from_utf8(octets.to_vec()).map_err(|why| why.to_string())?,
            }))
        }
        _ => Err(wrong()),
    }
}

#[cfg(test)]
mod tests {
    use prost::Message as _;

    use crate::messages::FrameMessage;

    use super::*;

    #[test]
    fn receptions_have_the_columns_of_their_declaration() {
        let declaration = declarations().find(|declaration| declaration.name == "Reception").unwrap();
        let columns: Vec<_> = declaration.fields.iter().map(|field| column(field, field.name == "node")).collect();
        assert_eq!(columns, reception_columns());
    }

    #[test]
    fn every_message_type_but_lists_has_a_table() {
        let without: Vec<_> = declarations()
            .map(|declaration| declaration.name)
            .filter(|name| !TABLES.iter().any(|table| table.0 == *name))
            .collect();
        // Those of a stop are rows of the tables of receptions and of signal-to-noise ratios; gains are a file.
        assert_eq!(without, ["Nodes", "Networks", "SectorGains", "SectorSnrs", "StopReceptions"]);
    }

    #[test]
    fn a_message_is_a_row_with_names_and_seconds() {
        let frame = FrameMessage {
            start_ns: 1_500_000_000,
            airtime_ns: 832_000,
            source: 1,
            mpdu: vec![0x61, 0x88],
            outcome: "received".to_owned(),
            power_dbm: None,
            network: String::new(),
            deafness: String::new(),
        };
        let data = frame.encode_to_vec();
        let message = Message { topic: "/mac/frames", schema: "sextant.Frame", time_ns: 0, data: &data };
        let (table, columns, cells) = Columns::default().row("Frame", &message, &[]).unwrap().unwrap();
        let header: Vec<_> = columns.iter().map(|column| &*column.name).collect();
        let row: Vec<_> = cells.iter().map(Cell::to_string).collect();
        assert_eq!(table, "mac_frames");
        assert_eq!(header, ["start_s", "airtime_s", "source", "mpdu", "outcome", "power_dbm", "network", "deafness"]);
        assert_eq!(row, ["1.5", "0.000832", "1", "6188", "received", "", "", ""]);
    }
}
