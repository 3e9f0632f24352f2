//! What the parts of a recording are called.

/// Name of the attachment with the scenario as it was read.
pub const SCENARIO_ATTACHMENT: &str = "scenario.toml";
/// Name of the attachment with the summary.
pub const SUMMARY_ATTACHMENT: &str = "summary.json";
/// Name of the metadata record with `seed`, `version` and `scenario`.
pub const ORIGIN_METADATA: &str = "sextant";
/// Topic of what nodes heard of each other.
pub(super) const NEIGHBOURS_TOPIC: &str = "/neighbours";
/// Topic of what nodes heard of the anchors.
pub(super) const BEACONS_TOPIC: &str = "/beacons";
/// Topic of the nodes that know their place.
pub(super) const ANCHORS_TOPIC: &str = "/anchors";
/// Topic of the true nodes.
pub(super) const WORLD_NODES_TOPIC: &str = "/world/nodes";
/// Name of the metadata record that a recovered recording has.
pub(super) const RECOVERED_METADATA: &str = "recovered";
