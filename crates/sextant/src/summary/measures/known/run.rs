//! The numbers of a run as a whole.

use super::{Count, Joule, KnownMeasure, MeanCount, Second, Share, known};
use crate::summary::Unit::{Ampere, BitPerSecond, Day, Metre, Watt};

/// Of any run.
pub(super) const RUN: &[KnownMeasure<'static>] = &[
    known("simulation.nodes", Count, "nodes"),
    known("simulation.obstacles", Count, "obstacles"),
    known("gathering.stops", Count, "stops: places where robots listened"),
    known("gathering.path_length_m", Metre, "length of the paths of all robots"),
    known("gathering.duration_s", Second, "duration of the survey"),
    known("gathering.packets_offered", Count, "packets offered during the survey"),
    known("gathering.packets_sent", Count, "packets sent during the survey: on air at least once"),
    known("gathering.packets_received", Count, "packets received by robots: each counts once"),
    known("gathering.lost_collision", Count, "packets lost to collisions at robots"),
    known(
        "gathering.lost_channel_access",
        Count,
        "packets never sent during the survey: the channel was busy, or the window for answers to a sweep ended",
    ),
    known("gathering.lost_signal", Count, "packets too weak at robots in range"),
    known("gathering.ranges", Count, "ranges that robots measured"),
    known("gathering.sector_reports.asked", Count, "reports of all sectors that robots asked for in sector sweeps"),
    known("gathering.sector_reports.received", Count, "reports of all sectors that robots received"),
    known("gathering.energy_j.tx", Joule, "energy of nodes for transmitting during the survey"),
    known("gathering.energy_j.rx", Joule, "energy of nodes for receiving during the survey"),
    known("gathering.energy_j.idle", Joule, "energy of idle nodes during the survey"),
    known("simulation.events", Count, "events of the simulation: a measure of work"),
    known("discovery.neighbours.energy_j.tx", Joule, "energy for transmitting in the discovery of neighbours"),
    known("discovery.neighbours.energy_j.rx", Joule, "energy for receiving in the discovery of neighbours"),
    known("discovery.anchors.energy_j.tx", Joule, "energy for transmitting in the flood of anchors"),
    known("mac.offered", Count, "packets offered to sinks"),
    known("mac.sent", Count, "packets sent to sinks: on air at least once"),
    known("mac.delivered", Count, "packets delivered to sinks"),
    known("mac.prr", Share, "packet reception ratio: delivered over offered, without pending packets"),
    known("mac.delivered_of_sent", Share, "share of sent packets that were delivered"),
    known("mac.throughput_bit_per_s", BitPerSecond, "throughput: payload delivered per second"),
    known("mac.delay_s.mean", Second, "mean delay: from the offer of a packet to its first reception"),
    known("mac.delay_s.p50", Second, "median of the delay"),
    known("mac.delay_s.p90", Second, "90th percentile of the delay"),
    known("mac.delay_s.p99", Second, "99th percentile of the delay"),
    known("mac.transmissions", Count, "transmissions: how often packets were sent"),
    known("mac.retries", Count, "retries: transmissions of a packet after its first one"),
    known("mac.backoffs", Count, "backoffs: random waits before an assessment of the channel"),
    known("mac.no_acknowledgement", Count, "packets without an acknowledgement after all retries"),
    known("mac.channel_access_failures", Count, "packets given up because the channel was busy"),
    known("mac.lost_collision", Count, "packets lost to collisions at sinks"),
    known("mac.lost_channel_access", Count, "packets never sent to sinks: the channel was busy"),
    known("mac.lost_queue", Count, "packets replaced by newer ones before they were sent to sinks"),
    known("mac.lost_signal", Count, "packets too weak at sinks in range"),
    known("mac.pending", Count, "packets to sinks that wait or are on air at the end"),
    known("mac.energy_j.tx", Joule, "energy of nodes for transmitting"),
    known("mac.energy_j.rx", Joule, "energy of nodes for receiving"),
    known("mac.energy_j.idle", Joule, "energy of idle nodes"),
    known("sensing.detections", Count, "detections of targets"),
    known("sensing.missed_detections", Count, "passages of targets that sensors missed"),
    known("sensing.false_detections", Count, "detections of targets that were not there"),
    known("sensing.samples", Count, "samples of fields"),
    known("mac.out_of_range", Count, "packets out of the range of their sink"),
    known("mac.not_listened", Count, "packets sent while their sink did not listen"),
    known("mac.not_listened_by.transmitting", Count, "packets sent while their sink transmitted"),
    known("mac.not_listened_by.asleep", Count, "packets sent while their sink was asleep"),
    known("mac.not_listened_by.off", Count, "packets sent while their sink was off"),
    known("gathering.lost_queue", Count, "packets of the survey replaced by newer ones before they were sent"),
    known("gathering.out_of_range", Count, "packets out of the range of all robots that listened"),
    known("gathering.not_listened", Count, "packets sent while no robot listened"),
    known("gathering.not_listened_by.transmitting", Count, "packets sent while robots transmitted"),
    known("gathering.not_listened_by.asleep", Count, "packets sent while robots were asleep"),
    known("gathering.not_listened_by.off", Count, "packets sent while robots were off"),
    known("gathering.pending", Count, "packets that wait or are on air at the end of the survey"),
    known("discovery.anchors.energy_j.rx", Joule, "energy for receiving in the flood of anchors"),
];

/// Of a run whose network has slots.
pub(super) const WITH_SLOTS: &[KnownMeasure<'static>] = &[
    known(
        "mac.slots.duty_cycle",
        Share,
        "duty cycle of a node: share of the time in which its radio sends or listens",
    ),
    known("mac.slots.sink_duty_cycle", Share, "duty cycle of a sink"),
    known("mac.slots.idle_listen", Count, "slots in which nodes listened in vain"),
    known("mac.slots.transmit_acknowledged", Count, "slots in which nodes sent and were acknowledged"),
    known("mac.slots.transmit_unacknowledged", Count, "slots in which nodes sent and were not acknowledged"),
    known("mac.slots.transmit", Count, "slots in which nodes sent to all"),
    known("mac.slots.receive_acknowledge", Count, "slots in which nodes received and acknowledged"),
    known("mac.slots.receive", Count, "slots in which nodes received without acknowledging"),
    known("mac.slots.mean_current_a", Ampere, "mean current of a node by published charges of slots"),
    known("mac.slots.joined", Count, "nodes that are in the network at the end"),
    known("mac.slots.lost", Count, "times that nodes lost the network"),
    known("mac.slots.joined_by_scan", Count, "nodes that joined by a scan: the mean time until then is of these"),
    known("mac.slots.join_s", Second, "mean time until a node that scans has joined"),
];

/// Of a run whose stations agree on cells.
pub(super) const WITH_NEGOTIATED_CELLS: &[KnownMeasure<'static>] = &[
    known("mac.slots.negotiated.mean_cells", Count, "negotiated cells in which a node sends, on average"),
    known("mac.slots.negotiated.cells", Count, "negotiated cells in which a node of the network sends at the end"),
    known("mac.slots.negotiated.transactions", Count, "transactions of the 6top protocol that nodes began"),
    known("mac.slots.negotiated.failures", Count, "transactions of the 6top protocol that failed"),
    known("mac.slots.negotiated.relocations", Count, "negotiated cells that were relocated"),
];

/// Of a run whose nodes have batteries.
pub(super) const WITH_BATTERIES: &[KnownMeasure<'static>] = &[
    known("battery.lifetime_d.min", Day, "battery lifetime, first node: from the mean power of the run"),
    known("battery.lifetime_d.median", Day, "battery lifetime, median of the nodes"),
    known("battery.lifetime_d.max", Day, "battery lifetime, last node"),
    known("battery.depleted", Count, "nodes whose battery is empty at the end"),
    known("battery.first_death_s", Second, "time until the first battery is empty"),
    known("battery.half_death_s", Second, "time until the batteries of half of the nodes are empty"),
    known("mac.died", Count, "packets lost in nodes that died"),
];

/// Of a run whose stations sleep between checks of the channel.
pub(super) const WITH_SLEEP: &[KnownMeasure<'static>] = &[
    known(
        "mac.sleep.duty_cycle",
        Share,
        "duty cycle of a node that sleeps: share of the time in which its radio is on",
    ),
    known("mac.sleep.worst_duty_cycle", Share, "largest duty cycle of a node that sleeps"),
    known("mac.sleep.sink_duty_cycle", Share, "duty cycle of a sink beside nodes that sleep"),
    known("mac.sleep.checks", Count, "checks of the channel by nodes that sleep"),
    known("mac.sleep.strobes", Count, "frames that nodes sent to wake others"),
    known("mac.sleep.strobes_per_packet", MeanCount, "frames to wake a receiver for each packet, answered or not"),
    known("mac.sleep.mean_power_w", Watt, "mean power of the radio of a node that sleeps"),
    known("mac.sleep.asleep_j", Joule, "energy of nodes asleep"),
];

/// Of a run in which nodes compute a map.
pub(super) const WITH_MAPS_BY_NODES: &[KnownMeasure<'static>] =
    &[known("simulation.sim_time_s", Second, "simulated time until the last event")];

/// The numbers of a run in which packets go down from a sink.
pub(super) const WITH_WAY_DOWN: &[KnownMeasure<'static>] = &[
    known("routing.no_route", Count, "packets for which a sink knew no way down"),
    known("routing.answers.offered", Count, "answers of sinks to packets over several hops"),
    known("routing.answers.delivered", Count, "answers of sinks that reached their node"),
    known("routing.answers.delivery", Share, "delivery of answers: delivered over offered, without pending ones"),
    known("routing.answers.delay_s.mean", Second, "mean delay of answers: from the sink to the node"),
    known("routing.answers.hops.mean", MeanCount, "mean hops of answers that reached their node"),
];

/// Of a run in which packets go over several hops.
pub(super) const WITH_ROUTING: &[KnownMeasure<'static>] = &[
    known("routing.offered", Count, "packets that nodes had for a sink over several hops"),
    known("routing.delivered", Count, "packets that reached a sink over several hops"),
    known("routing.delivery", Share, "delivery over several hops: delivered over offered, without pending packets"),
    known("routing.pending", Count, "packets in queues of routing at the end"),
    known("routing.died", Count, "packets in queues of routing of nodes that died"),
    known("routing.lost", Count, "packets lost on the way over several hops"),
    known("routing.delay_s.mean", Second, "mean delay end to end: from the offer to the arrival at the sink"),
    known("routing.delay_s.p50", Second, "median of the delay end to end"),
    known("routing.delay_s.p90", Second, "90th percentile of the delay end to end"),
    known("routing.delay_s.p99", Second, "99th percentile of the delay end to end"),
    known("routing.hops.mean", MeanCount, "mean hops of packets that reached a sink"),
    known("routing.hops.max", Count, "most hops of a packet that reached a sink"),
    known("routing.stretch", MeanCount, "stretch: hops over those of the shortest way of usable links"),
    known(
        "routing.transmissions_per_delivery",
        MeanCount,
        "transmissions of all hops for each packet that arrived, answers too",
    ),
    known("routing.parent_changes_per_node_h", MeanCount, "churn: changes of the parent per node and hour"),
    known("routing.duplicates", Count, "copies of packets that stations dropped"),
    known("routing.loops", Count, "loops: times that a packet came to a node again after more hops"),
    known("routing.queue_drops", Count, "packets that found the queue of routing full"),
    known("routing.given_up", Count, "packets given up on a hop after all tries"),
    known("routing.hop_limit_drops", Count, "packets dropped after too many hops"),
    known("routing.beacons", Count, "beacons of routing"),
    known("routing.without_way", Count, "living nodes without a way over living ones to a sink at the end"),
    known("routing.depth", Count, "depth of the tree at the end: most hops of a living node with a way"),
];

/// Of a run whose packets go in fragments.
pub(super) const WITH_FRAGMENTS: &[KnownMeasure<'static>] = &[
    known("routing.fragments.fragments", Count, "frames with fragments, without retries"),
    known("routing.fragments.reassembly_failures", Count, "packets that a station could not put together"),
];

/// Of a run with a tree of RPL.
pub(super) const WITH_RPL: &[KnownMeasure<'static>] = &[
    known("routing.rpl.dio", Count, "DIOs of RPL to all"),
    known("routing.rpl.dio_left_out", Count, "DIOs of RPL that were left out"),
    known("routing.rpl.unicast_dio", Count, "DIOs of RPL to one neighbour"),
    known("routing.rpl.dis", Count, "DISs of RPL"),
    known("routing.rpl.dao", Count, "DAOs of RPL on all hops"),
    known("routing.rpl.dao_ack", Count, "answers to DAOs of RPL on all hops"),
    known("routing.rpl.dao_transmissions", Count, "transmissions of DAOs of RPL and their answers"),
    known("routing.rpl.dao_lost", Count, "DAOs of RPL and their answers that were lost in queues or given up"),
    known("routing.rpl.rank_errors", Count, "rank errors of RPL: packets from a station that is not farther away"),
    known("routing.rpl.rank_error_drops", Count, "packets dropped for a rank error of RPL"),
    known("routing.rpl.full_tables", Count, "DAOs of RPL that found a table full"),
    known("routing.rpl.local_repairs", Count, "local repairs of RPL"),
    known("routing.rpl.routes_known_s", Second, "time until the roots of RPL had learned ways to all nodes"),
    known("routing.rpl.most_routes", Count, "most ways down that a station of RPL keeps at the end"),
    known("routing.rpl.healing.orphans", Count, "nodes of RPL whose parent died"),
    known("routing.rpl.healing.healed", Count, "nodes of RPL whose parent died and that had a way to a sink again"),
    known("routing.rpl.healing.mean_s", Second, "mean time from the death of a parent to a way to a sink"),
    known("routing.rpl.healing.max_s", Second, "longest time from the death of a parent to a way to a sink"),
];
