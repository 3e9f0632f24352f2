//! What the robots gathered and the nodes found out, and at what price.

use serde::Serialize;
use sextant_channel::{Position, ReceptionLog};

/// What the robots gathered, and at what price.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct GatheringSummary {
    /// Places where robots listened.
    pub stops: usize,
    /// Pairs of a stop and a node of which at least one packet arrived there.
    pub receptions: usize,
    /// Length of the robots' paths, along all places that are known of them: where each turned, in a run and its
    /// recording; its stops, in a log that has no more (m).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path_length_m: Option<f64>,
    /// From the start to the end of the last robot (s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration_s: Option<f64>,
    /// Packets that nodes wanted to send.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub packets_offered: Option<u64>,
    /// Packets that went on air.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub packets_sent: Option<u64>,
    /// Packets that a robot received, each once, however many robots and copies. Absent in the map of a log of several
    /// robots, which does not tell which of them heard the same packet.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub packets_received: Option<u64>,
    /// Packets lost to other packets while a robot listened.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost_collision: Option<u64>,
    /// Packets given up because the channel was busy.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost_channel_access: Option<u64>,
    /// Packets too weak while a robot listened in range.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost_signal: Option<u64>,
    /// Packets replaced before they were sent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost_queue: Option<u64>,
    /// Packets sent beyond the radius of communication of all robots that listened.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub out_of_range: Option<u64>,
    /// Packets sent while no robot listened.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_listened: Option<u64>,
    /// Packets still on their way at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pending: Option<u64>,
    /// Energy that all nodes' radios took.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_j: Option<EnergySummary>,
    /// What each robot did.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub robots: Vec<RobotSummary>,
    /// Whether the user ended the simulation early.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub interrupted: bool,
}

impl GatheringSummary {
    /// What the log alone tells, and the `paths` that are known of its robots, by name.
    pub(crate) fn of_log(log: &ReceptionLog, paths: &[(String, Vec<Position>)]) -> Self {
        let mut robots = vec![RobotSummary::default(); log.robot_count()];
        for stop in log.stops() {
            robots[stop.robot.index()].stops += 1;
        }
        for drive in log.drives() {
            robots[drive.robot.index()].path_length_m += drive.length_m();
        }
        for (robot, name) in robots.iter_mut().zip(log.robots()) {
            robot.name.clone_from(name);
            if let Some((_, places)) = paths.iter().find(|(other, _)| other == name) {
                robot.path_length_m = places.windows(2).map(|pair| pair[0].distance_m(pair[1])).sum();
            }
        }
        let received = || log.receptions().iter().map(|reception| reception.received);
        Self {
            stops: log.stops().len(),
            receptions: received().filter(|&received| received > 0).count(),
            path_length_m: Some(robots.iter().map(|robot| robot.path_length_m).sum()),
            packets_received: (robots.len() == 1).then(|| received().map(u64::from).sum()),
            robots: if log.robots().is_empty() { Vec::new() } else { robots },
            ..Self::default()
        }
    }
}

/// Energy that all nodes' radios took (J).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct EnergySummary {
    /// Transmitting (J).
    pub tx: f64,
    /// Receiving and listening (J).
    pub rx: f64,
    /// Idle or asleep (J).
    pub idle: f64,
}

/// What the nodes found out of each other before the survey.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct DiscoverySummary {
    /// All nodes broadcast hello packets.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub neighbours: Option<RoundSummary>,
    /// The anchors broadcast.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub anchors: Option<RoundSummary>,
}

/// One round of broadcasts.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RoundSummary {
    /// Nodes that broadcast.
    pub senders: usize,
    /// Packets that went on air.
    pub packets_sent: u64,
    /// Packets given up because the channel was busy.
    pub packets_unsent: u64,
    /// Pairs of a node and another that it heard.
    pub links: usize,
    /// From the start to the end of the last packet (s).
    pub duration_s: f64,
    /// Energy that all nodes' radios took, receivers always on.
    pub energy_j: EnergySummary,
}

/// What one robot did.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RobotSummary {
    /// Name of the robot.
    pub name: String,
    /// Places where it listened.
    pub stops: usize,
    /// Length of its path, along all places that are known of it (m).
    pub path_length_m: f64,
    /// Why it finished: `complete`, `steps_exhausted`, `stuck`; absent if it was interrupted, or if only its log is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ending: Option<&'static str>,
    /// When it had finished (s); absent if it was interrupted, or if only its log is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration_s: Option<f64>,
    /// Nodes that all robots together heard less often than this one was to hear each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unreached: Vec<String>,
}
