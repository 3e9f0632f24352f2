//! The survey and the discovery before it: packets, paths and energy. With sector sweeps, a packet of a node is its answer
//! to one sweep of a robot, from all its sectors. Numbers of packets are over all networks.

use serde::Serialize;
use sextant_channel::{Position, ReceptionLog};
use sextant_sim::Packets;

use super::log_counts::LogCounts;
use super::robots::RobotSummary;

/// The survey: packets, paths and energy.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct GatheringSummary {
    /// Places where robots listened.
    pub stops: usize,
    /// Sector sweeps of the robots. Absent without them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sweeps: Option<u64>,
    /// What became of the reports of all sectors that robots asked for. Absent if they asked for none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sector_reports: Option<SectorReportsSummary>,
    /// Pairs of a stop and a node from which at least one packet was received there, in each network.
    pub receptions: usize,
    /// Ranges that robots measured, in all networks. Absent without them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ranges: Option<usize>,
    /// Length of the robots' paths through all their known positions (m). A run and its recording know each turn; a log
    /// without paths knows the stops only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path_length_m: Option<f64>,
    /// Whether the way of a robot between its stops is not known: the length is that of straight lines then.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub path_is_by_stops: bool,
    /// Time from the start until the last robot finished (s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration_s: Option<f64>,
    /// Packets that were due while nobody who listens was near, and therefore not simulated. They are among those offered, and
    /// what became of them and the energy that they took are estimates. Absent if all was simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub packets_not_simulated: Option<u64>,
    /// Packets that nodes wanted to send.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub packets_offered: Option<u64>,
    /// Packets that went on air.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub packets_sent: Option<u64>,
    /// Packets that were received; a packet counts once, even if several robots or copies of it were received. Absent in
    /// the map of a log of several robots, because the log does not tell whether two robots received the same packet.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub packets_received: Option<u64>,
    /// Packets that each robot received, added up: a packet that two robots received counts twice. Present in the map of a log
    /// of several robots alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub packets_received_by_robots: Option<u64>,
    /// Packets lost by collision while a robot listened.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost_collision: Option<u64>,
    /// Packets dropped because the channel was busy.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost_channel_access: Option<u64>,
    /// Packets whose signal was too weak, although a robot listened in range.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost_signal: Option<u64>,
    /// Packets replaced by newer ones before they were sent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost_queue: Option<u64>,
    /// Packets sent out of range of all robots that listened.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub out_of_range: Option<u64>,
    /// Packets sent while no robot listened.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_listened: Option<u64>,
    /// The same by the reason why none did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_listened_by: Option<NotListenedSummary>,
    /// Packets still pending when their node died. Absent if there are none.
    #[serde(skip_serializing_if = "is_none")]
    pub died: u64,
    /// Packets still pending at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pending: Option<u64>,
    /// Energy of the radios of all nodes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_j: Option<EnergySummary>,
    /// The robots.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub robots: Vec<RobotSummary>,
    /// Whether the user interrupted the simulation.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub interrupted: bool,
}

impl GatheringSummary {
    /// Number of ranges in `logs`; `None` without them.
    pub(crate) fn ranges_of<'a>(logs: impl IntoIterator<Item = &'a ReceptionLog>) -> Option<usize> {
        let count: usize = logs.into_iter().map(|log| log.ranges().len()).sum();
        (count > 0).then_some(count)
    }

    /// The summary of a log and of the known `paths` of its robots, by name.
    pub(crate) fn of_log(log: &ReceptionLog, counts: &LogCounts, paths: &[(String, Vec<Position>)]) -> Self {
        let mut robots = vec![RobotSummary::default(); log.robot_count()];
        for stop in log.stops() {
            robots[stop.robot.index()].stops += 1;
        }
        for drive in log.drives() {
            robots[drive.robot.index()].path_length_m += drive.length_m();
        }
        let is_known = |name: &String| paths.iter().any(|(other, _)| other == name);
        let path_is_by_stops = !log.robots().iter().all(is_known) || log.robots().is_empty();
        for (robot, name) in robots.iter_mut().zip(log.robots()) {
            robot.name.clone_from(name);
            if let Some((_, places)) = paths.iter().find(|(other, _)| other == name) {
                robot.path_length_m = places.windows(2).map(|pair| pair[0].distance_m(pair[1])).sum();
            }
        }
        Self {
            stops: log.stops().len(),
            receptions: usize::try_from(counts.receptions).unwrap_or(usize::MAX),
            ranges: Self::ranges_of([log]),
            path_is_by_stops,
            path_length_m: Some(robots.iter().map(|robot| robot.path_length_m).sum()),
            packets_received: (robots.len() == 1).then_some(counts.received),
            packets_received_by_robots: (robots.len() > 1).then_some(counts.received),
            robots: if log.robots().is_empty() { Vec::new() } else { robots },
            ..Self::default()
        }
    }
}

/// Reports of all sectors in sector sweeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SectorReportsSummary {
    /// Reports that robots asked for.
    pub asked: u64,
    /// Those that robots received; the others were lost.
    pub received: u64,
}

/// Packets to which no receiver listened, by the reason. Of several receivers, the one that was nearest to listening counts:
/// one that transmits before one that is asleep before one that is off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct NotListenedSummary {
    /// The receiver sent something itself, such as an acknowledgement, or turned around for that.
    pub transmitting: u64,
    /// The receiver was asleep or idle.
    pub asleep: u64,
    /// The receiver was not in use: a robot between its stops, a station that died, or no receiver at all.
    pub off: u64,
}

impl From<&Packets> for NotListenedSummary {
    fn from(packets: &Packets) -> Self {
        Self {
            transmitting: packets.not_listened_transmitting,
            asleep: packets.not_listened_asleep,
            off: packets.not_listened_off,
        }
    }
}

/// Energy of the radios of all nodes (J).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct EnergySummary {
    /// Transmitting (J).
    pub tx: f64,
    /// Receiving and listening (J).
    pub rx: f64,
    /// Idle or asleep (J).
    pub idle: f64,
}

/// Discovery before the survey.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct DiscoverySummary {
    /// The round in which all nodes broadcast hello packets.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub neighbours: Option<RoundSummary>,
    /// The round in which the anchors broadcast.
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
    /// Packets dropped because the channel was busy.
    pub packets_unsent: u64,
    /// Pairs of a listener and a sender that it heard.
    pub links: usize,
    /// Time from the start to the end of the last packet (s).
    pub duration_s: f64,
    /// Energy of the radios of all nodes, with receivers always on.
    pub energy_j: EnergySummary,
}

/// Whether no packet counts: the key is absent then.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
pub(super) fn is_none(packets: &u64) -> bool {
    *packets == 0
}
