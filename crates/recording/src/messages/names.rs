//! Names of topics, attachments and metadata records.

use std::borrow::Cow;

/// Name of the attachment with the text of the scenario.
pub const SCENARIO_ATTACHMENT: &str = "scenario.toml";
/// The names of attachments with files that the scenario names begin with this; the path as written there follows.
pub const FILES_ATTACHMENTS: &str = "files/";
/// Name of the attachment with the summary.
pub const SUMMARY_ATTACHMENT: &str = "summary.json";
/// Name of the metadata record with `seed`, `version` and `scenario`.
pub const ORIGIN_METADATA: &str = "sextant";
/// Name of the metadata record that says what a compact recording leaves out.
pub(crate) const DETAIL_METADATA: &str = "detail";
/// Name of the metadata record with the phases of a run that has applications.
pub(crate) const PHASES_METADATA: &str = "phases";
/// Key of the metadata record with the name of a topic of links that has none: their number, 0.
pub(crate) const LINKS_KEY: &str = "links";
/// Topic of receptions between nodes.
pub(crate) const NEIGHBOURS_TOPIC: &str = "/neighbours";
/// Topic of receptions of the anchors' packets by nodes.
pub(crate) const BEACONS_TOPIC: &str = "/beacons";
/// Topic of the nodes that know their position.
pub(crate) const ANCHORS_TOPIC: &str = "/anchors";
/// Topic of what nodes found that computed a map themselves.
pub(crate) const MAPPED_NODES_TOPIC: &str = "/distributed/nodes";
/// Topic of the sensors that the nodes have.
pub(crate) const SENSORS_TOPIC: &str = "/sensors";
/// Topic of every frame on air.
pub(crate) const FRAMES_TOPIC: &str = "/mac/frames";
/// Topic of the packets that stations offered.
pub(crate) const PACKETS_TOPIC: &str = "/mac/packets";
/// Topic of the assessments of the channel for these packets.
pub(crate) const ASSESSMENTS_TOPIC: &str = "/mac/assessments";
/// Topic of the transmissions of these packets.
pub(crate) const TRANSMISSIONS_TOPIC: &str = "/mac/transmissions";
/// Topic of the hops of these packets, if they go over several.
pub(crate) const HOPS_TOPIC: &str = "/routing/hops";
/// Topic of the tree along which packets go, at the end.
pub(crate) const TREE_TOPIC: &str = "/routing/tree";
/// Topic of the parents that nodes chose.
pub(crate) const PARENT_CHANGES_TOPIC: &str = "/routing/changes";
/// Topic of the cells in the schedules of stations.
pub(crate) const CELLS_TOPIC: &str = "/mac/cells";
/// Topic of the checks of the channel of stations that sleep.
pub(crate) const CHECKS_TOPIC: &str = "/mac/checks";
/// Topic of the batteries of the nodes, at the end.
pub(crate) const BATTERIES_TOPIC: &str = "/batteries";
/// Topic of what sensors said.
pub(crate) const SENSED_TOPIC: &str = "/sensed";
/// Start of the topics of targets; their names follow.
pub(crate) const TARGETS_TOPICS: &str = "/world/targets/";
/// Start of the topics of fields; their names follow.
pub(crate) const FIELDS_TOPICS: &str = "/world/fields/";
/// Topic of the true positions of the nodes.
pub(crate) const WORLD_NODES_TOPIC: &str = "/world/nodes";
/// Topic of the positions of the sinks.
pub(crate) const WORLD_SINKS_TOPIC: &str = "/world/sinks";
/// Topic of the names of the nodes, at their true positions.
pub(crate) const WORLD_NAMES_TOPIC: &str = "/world/names";
/// Topic of the frames on air as lines.
pub(crate) const AIR_TOPIC: &str = "/mac/air";
/// Name of the metadata record of a recovered recording.
pub(crate) const RECOVERED_METADATA: &str = "recovered";
/// Start of the names of metadata records that stand where messages were lost; their numbers follow, from 1.
pub(crate) const GAP_METADATA: &str = "gap/";
/// Topic of the names of the surveyed networks.
pub(crate) const NETWORKS_TOPIC: &str = "/networks";
/// Start of the topics of networks; their names follow.
const NETWORKS_TOPICS: &str = "/networks/";
/// Topics of a reception log.
const STOPS_TOPIC: &str = "/stops";
const RECEPTIONS_TOPIC: &str = "/receptions";
const SECTORS_TOPIC: &str = "/sectors";
const SECTOR_GAINS_TOPIC: &str = "/sector_gains";
const SECTOR_SNRS_TOPIC: &str = "/sector_snrs";
const RANGES_TOPIC: &str = "/ranges";
/// Their ends, of any network.
const LOG_TOPICS: [&str; 6] =
    [STOPS_TOPIC, RECEPTIONS_TOPIC, SECTORS_TOPIC, SECTOR_GAINS_TOPIC, SECTOR_SNRS_TOPIC, RANGES_TOPIC];

/// The topics of the reception log of one network.
pub(crate) struct LogTopics {
    pub(crate) stops: Cow<'static, str>,
    pub(crate) receptions: Cow<'static, str>,
    pub(crate) sectors: Cow<'static, str>,
    pub(crate) sector_gains: Cow<'static, str>,
    pub(crate) sector_snrs: Cow<'static, str>,
    pub(crate) ranges: Cow<'static, str>,
}

impl LogTopics {
    /// The topics of the first surveyed network, or those of the `other` one.
    pub(crate) fn new(other: Option<&str>) -> Self {
        let topic = |topic: &'static str| match other {
            None => Cow::Borrowed(topic),
            Some(name) => Cow::Owned(format!("{NETWORKS_TOPICS}{name}{topic}")),
        };
        Self {
            stops: topic(STOPS_TOPIC),
            receptions: topic(RECEPTIONS_TOPIC),
            sectors: topic(SECTORS_TOPIC),
            sector_gains: topic(SECTOR_GAINS_TOPIC),
            sector_snrs: topic(SECTOR_SNRS_TOPIC),
            ranges: topic(RANGES_TOPIC),
        }
    }

    /// Name of the network to whose log `topic` belongs; `None` for the first one.
    pub(crate) fn network(topic: &str) -> Option<&str> {
        let rest = topic.strip_prefix(NETWORKS_TOPICS)?;
        LOG_TOPICS.iter().find_map(|end| rest.strip_suffix(end))
    }
}

/// Start of the topics of applications; their names follow.
const APPLICATION_TOPICS: &str = "/application/";

/// The topics of an application.
pub(crate) struct ApplicationTopics {
    /// What it is.
    pub(crate) description: String,
    pub(crate) estimates: String,
    pub(crate) captures: String,
    /// Start of the topics of the paths of its robots; their names follow.
    pub(crate) paths: String,
    /// The captured targets as marks.
    pub(crate) captured: String,
    /// Start of the topics of estimated places; station and kind follow.
    pub(crate) places: String,
}

impl ApplicationTopics {
    /// Those of the application called `name`.
    pub(crate) fn new(name: &str) -> Self {
        let topic = |end: &str| format!("{APPLICATION_TOPICS}{name}{end}");
        Self {
            description: topic(""),
            estimates: topic("/estimates"),
            captures: topic("/captures"),
            paths: topic("/path/"),
            captured: topic("/captured"),
            places: topic("/places/"),
        }
    }

    /// Name of the application to which `topic` belongs, and the rest of the topic.
    pub(crate) fn application(topic: &str) -> Option<(&str, &str)> {
        let rest = topic.strip_prefix(APPLICATION_TOPICS)?;
        Some(rest.split_once('/').unwrap_or((rest, "")))
    }
}

/// The topics of the way of a robot, as viewers draw it while a recording plays.
pub(crate) struct WayTopics {
    /// The whole way so far.
    pub(crate) way: String,
    /// The legs since the last message on `way`.
    pub(crate) legs: String,
}

impl WayTopics {
    /// Those of `robot` in the survey, or in the `application`.
    pub(crate) fn new(application: Option<&str>, robot: &str) -> Self {
        match application {
            None => Self { way: format!("/robot/{robot}/way"), legs: format!("/robot/{robot}/legs") },
            Some(name) => Self {
                way: format!("{APPLICATION_TOPICS}{name}/way/{robot}"),
                legs: format!("{APPLICATION_TOPICS}{name}/legs/{robot}"),
            },
        }
    }
}
