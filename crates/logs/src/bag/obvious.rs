//! The fields of a packet that are obvious from their names.

use super::definition::Definitions;
use super::field_path::{Element, FieldPath, FieldStep};
use super::leaves::{Content, Leaf, leaves};
use super::packet_fields::PacketFields;

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

/// Names of fields that are obviously the signal-to-noise ratio.
const SNR_NAMES: [&str; 2] = ["snr_db", "snr"];

/// Names of fields that are obviously the sector of an antenna.
const SECTOR_NAMES: [&str; 2] = ["sector", "sector_id"];

/// Where messages have their stamp.
const STAMPS: [&str; 2] = ["header.stamp", "stamp"];

/// The fields of a packet by their names, if exactly one part of the message has an obvious node. A part with an RSSI beside
/// it is preferred.
pub(super) fn obvious_fields(definitions: &Definitions) -> Option<PacketFields> {
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
        sender: None,
        rssi_dbm: beside(&leaf.path, &RSSI_NAMES, &[Content::Integer, Content::Real]),
        snr_db: beside(&leaf.path, &SNR_NAMES, &[Content::Integer, Content::Real]),
        sector: beside(&leaf.path, &SECTOR_NAMES, &[Content::Integer]),
        range: None,
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

fn last(path: &FieldPath) -> Option<&FieldStep> {
    path.0.last().filter(|step| step.element == Element::Whole)
}

fn is_named(step: &FieldStep, name: &str) -> bool {
    step.name.eq_ignore_ascii_case(name)
}

/// The stamp of a packet: that beside its node, or that of the whole message.
pub(super) fn stamp_beside(definitions: &Definitions, node: &FieldPath) -> Option<FieldPath> {
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
    use super::super::packet_fields::TimeUnit;
    use super::*;

    /// The obvious fields of a message, and its stamp.
    fn obvious(text: &str) -> Option<String> {
        let definitions = Definitions::parse(Dialect::Ros2, "radio/msg/Heard", text).unwrap();
        let fields = obvious_fields(&definitions)?;
        let time = stamp_beside(&definitions, &fields.node).map(|path| (TimeUnit::Seconds, path));
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
