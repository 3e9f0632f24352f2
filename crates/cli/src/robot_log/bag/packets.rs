//! The packets that the robot received, from a topic of any message type.

use std::fmt::Write as _;

use super::super::bag_error::BagError;
use super::super::bag_options::{BagClock, BagOptions, PacketFields};
use super::super::field_path::{Element, FieldPath, Step};
use super::clock::Moment;
use super::definition::Definitions;
use super::leaves::{Content, Leaf, leaves, listing};
use super::selection::{Selection, Value};
use super::topics::{Bag, Topic};

/// Names of fields that are obviously the node that sent a packet; of several in one message, the first of these is taken.
const NODE_NAMES: [&str; 17] = [
    "node",
    "node_id",
    "source",
    "src",
    "source_address",
    "src_address",
    "src_addr",
    "sender",
    "sender_id",
    "address",
    "addr",
    "mac",
    "mac_address",
    "beacon_id",
    "tag_id",
    "device_id",
    "id",
];

/// Names of fields that are obviously the received signal strength.
const RSSI_NAMES: [&str; 4] = ["rssi_dbm", "rssi", "rss_dbm", "rss"];

/// Names of fields that are obviously the sector of an antenna.
const SECTOR_NAMES: [&str; 2] = ["sector", "sector_id"];

/// Where messages have their stamp.
const STAMPS: [&str; 2] = ["header.stamp", "stamp"];

/// What gives the packets.
#[derive(Clone, Debug)]
pub(super) struct PacketSource<'a> {
    pub(super) topic: &'a Topic,
    pub(super) fields: PacketFields,
    selection: Selection,
    /// Where in a row the optional values are.
    rssi: Option<usize>,
    sector: Option<usize>,
    stamp: Option<usize>,
}

/// A packet in a bag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BagPacket<'a> {
    pub(super) moment: Moment,
    /// Empty if the message has none.
    pub(super) node: &'a str,
    pub(super) rssi_dbm: Option<f64>,
    pub(super) sector: Option<u8>,
}

impl<'a> PacketSource<'a> {
    /// What `options` name, or the only topic whose messages have an obvious node and RSSI.
    ///
    /// # Errors
    /// If there is no such topic, several, or it lacks a field.
    pub(super) fn choose(bag: &'a Bag, options: &BagOptions) -> Result<Self, BagError> {
        let named = |name: &String| {
            bag.topic(name).ok_or_else(|| {
                bag.problem(format!(
                    "it has no topic `{name}` with messages; its topics: {}",
                    Bag::list(bag.topics())
                ))
            })
        };
        let (topic, fields) = match (&options.packet_topic, &options.packet_fields) {
            (Some(name), Some(fields)) => (named(name)?, fields.clone()),
            (Some(name), None) => {
                let topic = named(name)?;
                let definitions = topic.definitions().map_err(|problem| bag.topic_problem(name, problem))?;
                let fields = obvious_fields(&definitions).ok_or_else(|| {
                    let problem = format!(
                        "its messages ({}) have no obvious field with the node that sent the packet; give \
                         `--packet-fields node=PATH[,rssi_dbm=PATH]`; their fields: {}",
                        topic.message_type,
                        listing(&definitions)
                    );
                    bag.topic_problem(name, problem)
                })?;
                (topic, fields)
            }
            (None, fields) => {
                let of = |topic: &'a Topic| {
                    let definitions = topic.definitions().ok()?;
                    let found = match fields {
                        Some(fields) => Selection::new(definitions, std::slice::from_ref(&fields.node))
                            .ok()
                            .map(|_| fields.clone()),
                        None => obvious_fields(&definitions).filter(|fields| fields.rssi_dbm.is_some()),
                    };
                    Some((topic, found?))
                };
                let found: Vec<_> = bag.topics().filter_map(of).collect();
                match found.as_slice() {
                    [(topic, fields)] => (*topic, fields.clone()),
                    [] => {
                        let missing = match fields {
                            Some(fields) => format!("the field `{}`", fields.node),
                            None => "an obvious node and RSSI".to_owned(),
                        };
                        let topics = Bag::list(bag.topics());
                        let problem = format!(
                            "no topic has messages with {missing}; name that of the packets with `--packet-topic`; its \
                             topics: {topics}"
                        );
                        return Err(bag.problem(problem));
                    }
                    several => {
                        let topics = Bag::list(several.iter().map(|(topic, _)| *topic));
                        let problem = format!(
                            "several topics can have the packets; choose one with `--packet-topic`: {topics}"
                        );
                        return Err(bag.problem(problem));
                    }
                }
            }
        };
        Self::new(topic, fields).map_err(|problem| bag.topic_problem(&topic.name, problem))
    }

    fn new(topic: &'a Topic, mut fields: PacketFields) -> Result<Self, String> {
        let definitions = topic.definitions()?;
        if fields.time.is_none() {
            fields.time = stamp_beside(&definitions, &fields.node);
        }
        let mut paths = vec![fields.node.clone()];
        let mut slot = |path: &Option<FieldPath>| {
            path.as_ref().map(|path| {
                paths.push(path.clone());
                paths.len() - 1
            })
        };
        let [rssi, sector, stamp] = [slot(&fields.rssi_dbm), slot(&fields.sector), slot(&fields.time)];
        let selection = Selection::new(definitions, &paths)?;
        let number: &[Content] = &[Content::Integer, Content::Real];
        for (key, slot, allowed, words) in [
            (
                "node",
                Some(0),
                &[Content::Integer, Content::Text, Content::Octets][..],
                "an integer, a string or octets",
            ),
            ("rssi_dbm", rssi, number, "a number"),
            ("sector", sector, &[Content::Integer], "an integer"),
            ("t_s", stamp, &[Content::Instant, Content::Real], "a time or a real number of seconds"),
        ] {
            if let Some(slot) = slot
                && !allowed.contains(&selection.contents()[slot])
            {
                let found = selection.contents()[slot].name();
                return Err(format!("`{key}` is the field `{}`, which is {found}; allowed: {words}", paths[slot]));
            }
        }
        Ok(Self { topic, fields, selection, rssi, sector, stamp })
    }

    /// Whether the packets have stamps: the first message has none that was never set.
    pub(super) fn has_stamps(&self) -> bool {
        let mut first = None;
        let read = self.packets(0, &self.topic.first, |packet| {
            first = first.or(Some(packet.moment));
            Ok::<(), String>(())
        });
        self.stamp.is_some() && read.is_ok() && first.is_none_or(|moment| moment.time(BagClock::Stamp).is_some())
    }

    /// Calls `visit` with each packet of the message `data`, which was recorded at `log_ns`.
    ///
    /// # Errors
    /// If the message does not fit its definition, or has an invalid value; the inner error is that of `visit`.
    pub(super) fn packets<E>(
        &self,
        log_ns: u64,
        data: &[u8],
        mut visit: impl FnMut(BagPacket<'_>) -> Result<(), E>,
    ) -> Result<Result<(), E>, String> {
        let mut name = String::new();
        let mut invalid = None;
        let visited = self.selection.rows(data, |row| {
            let packet = match self.packet(log_ns, row, &mut name) {
                Ok(packet) => packet,
                Err(problem) => {
                    invalid = Some(problem);
                    return Err(None);
                }
            };
            visit(packet).map_err(Some)
        })?;
        match (visited, invalid) {
            (_, Some(problem)) => Err(problem),
            (Err(Some(error)), None) => Ok(Err(error)),
            _ => Ok(Ok(())),
        }
    }

    fn packet<'n>(&self, log_ns: u64, row: &[Value<'_>], name: &'n mut String) -> Result<BagPacket<'n>, String> {
        name.clear();
        match row[0] {
            Value::Integer(number) => write!(name, "{number}").expect("a string grows"),
            Value::Text(text) => name.push_str(text.trim()),
            Value::Octets(octets) => {
                for (index, octet) in octets.iter().enumerate() {
                    let colon = if index == 0 { "" } else { ":" };
                    write!(name, "{colon}{octet:02x}").expect("a string grows");
                }
            }
            Value::Absent | Value::Real(_) | Value::Instant(_) => {}
        }
        let rssi_dbm = self.rssi.and_then(|slot| match row[slot] {
            Value::Real(level) => Some(level).filter(|level| level.is_finite()),
            Value::Integer(level) => Some(level as f64),
            _ => None,
        });
        let sector = match self.sector.map(|slot| row[slot]) {
            Some(Value::Integer(sector)) => {
                Some(u8::try_from(sector).map_err(|_| format!("its sector is {sector}; allowed: 0 to 255"))?)
            }
            _ => None,
        };
        let stamp_ns = self.stamp.and_then(|slot| match row[slot] {
            Value::Instant(ns) => Some(ns),
            #[expect(clippy::cast_possible_truncation, reason = "checked to be in range")]
            Value::Real(seconds) => Some(seconds * 1e9).filter(|ns| ns.abs() < 9e18).map(|ns| ns.round() as i64),
            _ => None,
        });
        Ok(BagPacket { moment: Moment { stamp_ns, log_ns }, node: name, rssi_dbm, sector })
    }
}

/// The fields of a packet by their names, if exactly one part of the message has an obvious node. A part with an RSSI beside
/// it is preferred.
fn obvious_fields(definitions: &Definitions) -> Option<PacketFields> {
    let leaves = leaves(definitions);
    let beside = |node: &FieldPath, names: &[&str], contents: &[Content]| {
        let is_beside = |leaf: &&Leaf| leaf.path.0[..leaf.path.0.len() - 1] == node.0[..node.0.len() - 1];
        let mut found = names.iter().filter_map(|name| {
            let is_called = |leaf: &&Leaf| last(&leaf.path).is_some_and(|step| is_named(step, name));
            let is_fit = |leaf: &&Leaf| contents.contains(&leaf.content);
            leaves.iter().find(|leaf| is_beside(leaf) && is_called(leaf) && is_fit(leaf))
        });
        found.next().map(|leaf| leaf.path.clone())
    };
    let fields = |leaf: &Leaf| PacketFields {
        node: leaf.path.clone(),
        rssi_dbm: beside(&leaf.path, &RSSI_NAMES, &[Content::Integer, Content::Real]),
        sector: beside(&leaf.path, &SECTOR_NAMES, &[Content::Integer]),
        time: None,
    };
    let is_node = |leaf: &&Leaf, name: &str| {
        let is_fit = matches!(leaf.content, Content::Integer | Content::Text | Content::Octets);
        is_fit && last(&leaf.path).is_some_and(|step| is_named(step, name))
    };
    let of_name = |name: &&str| leaves.iter().filter(|leaf| is_node(leaf, name)).map(fields).collect::<Vec<_>>();
    let found: Vec<PacketFields> = NODE_NAMES.iter().flat_map(of_name).collect();
    let has_rssi = |fields: &&PacketFields| fields.rssi_dbm.is_some();
    let preferred: Vec<_> = if found.iter().any(|fields| has_rssi(&fields)) {
        found.iter().filter(has_rssi).collect()
    } else {
        found.iter().collect()
    };
    let first = preferred.first()?;
    let part = |fields: &PacketFields| fields.node.0[..fields.node.0.len() - 1].to_vec();
    preferred.iter().all(|fields| part(fields) == part(first)).then(|| (*first).clone())
}

fn last(path: &FieldPath) -> Option<&Step> {
    path.0.last().filter(|step| step.element == Element::Whole)
}

fn is_named(step: &Step, name: &str) -> bool {
    step.name.eq_ignore_ascii_case(name)
}

/// The stamp of a packet: that beside its node, or that of the whole message.
fn stamp_beside(definitions: &Definitions, node: &FieldPath) -> Option<FieldPath> {
    let leaves = leaves(definitions);
    let outer = &node.0[..node.0.len() - 1];
    let candidates = [outer, &[]].into_iter().flat_map(|outer| STAMPS.map(|stamp| (outer, stamp)));
    let paths = candidates.filter_map(|(outer, stamp)| {
        let stamp = FieldPath::parse(stamp).ok()?;
        Some(FieldPath(outer.iter().cloned().chain(stamp.0).collect()))
    });
    let is_stamp = |path: &FieldPath| {
        // An element of a list has the type of each.
        let generic = |path: &FieldPath| -> Vec<(String, bool)> {
            path.0.iter().map(|step| (step.name.clone(), step.element != Element::Whole)).collect()
        };
        leaves.iter().any(|leaf| leaf.content == Content::Instant && generic(&leaf.path) == generic(path))
    };
    paths.into_iter().find(is_stamp)
}

#[cfg(test)]
mod tests {
    use super::super::definition::Dialect;
    use super::*;

    /// The obvious fields of a message, and its stamp.
    fn obvious(text: &str) -> Option<String> {
        let definitions = Definitions::parse(Dialect::Ros2, "radio/msg/Heard", text).unwrap();
        let fields = obvious_fields(&definitions)?;
        let time = stamp_beside(&definitions, &fields.node);
        Some(PacketFields { time, ..fields }.to_string())
    }

    #[test]
    fn obvious_fields_are_found_by_their_names() {
        let beacon = "===\nMSG: radio/Beacon\nbuiltin_interfaces/Time stamp\nuint8[6] Address\nint8 rssi\n";
        for (text, expected) in [
            ("string node\nfloat32 rssi_dbm\nuint8 sector", Some("node=node,rssi_dbm=rssi_dbm,sector=sector")),
            // The first name of the list counts, and the sector must be an integer.
            ("uint8 id\nuint16 src\nint8 RSSI\nstring sector", Some("node=src,rssi_dbm=RSSI")),
            ("float64 node\nuint16 source\nint8 rssi", Some("node=source,rssi_dbm=rssi")),
            (
                &format!("builtin_interfaces/Time stamp\nuint32 id\nBeacon[] heard\n{beacon}"),
                Some("node=heard[].Address,rssi_dbm=heard[].rssi,t_s=heard[].stamp"),
            ),
            // Without a level, a node alone is obvious only if there is no other one.
            ("uint32 id\nbuiltin_interfaces/Time stamp", Some("node=id,t_s=stamp")),
            (&format!("Beacon first\nBeacon second\n{beacon}"), None),
            ("float32 temperature", None),
        ] {
            assert_eq!(obvious(text).as_deref(), expected, "{text}");
        }
    }
}
