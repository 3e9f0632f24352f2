//! What is measured: the numbers of a run, of a map and of an application, by path, in the order of the columns of tables.
//! A path leads through the keys of the summary, or is a name that [`derived`](super::derived) works out.

use std::sync::LazyLock;

use super::derived::SCATTERING_EDGES;
use super::unit::Unit::{
    self, BitPerSecond, Count, Degree, Joule, MeanCount, Metre, Outcome, PerSecond, Plain, Second, Share,
};
use crate::summary::{NODE_ERRORS, POSITION_ERRORS_M, SEARCH_INSTANTS_S};

/// Of a run as a whole.
pub(super) const RUN: &[(&str, Unit)] = &[
    ("simulation.nodes", Count),
    ("simulation.obstacles", Count),
    ("gathering.stops", Count),
    ("gathering.path_length_m", Metre),
    ("gathering.duration_s", Second),
    ("gathering.packets_offered", Count),
    ("gathering.packets_sent", Count),
    ("gathering.packets_received", Count),
    ("gathering.lost_collision", Count),
    ("gathering.lost_channel_access", Count),
    ("gathering.lost_signal", Count),
    ("gathering.energy_j.tx", Joule),
    ("gathering.energy_j.rx", Joule),
    ("gathering.energy_j.idle", Joule),
    ("simulation.events", Count),
    ("discovery.neighbours.energy_j.tx", Joule),
    ("discovery.neighbours.energy_j.rx", Joule),
    ("discovery.anchors.energy_j.tx", Joule),
    ("mac.offered", Count),
    ("mac.sent", Count),
    ("mac.delivered", Count),
    ("mac.prr", Share),
    ("mac.delivered_of_sent", Share),
    ("mac.throughput_bit_per_s", BitPerSecond),
    ("mac.delay_s.mean", Second),
    ("mac.delay_s.p50", Second),
    ("mac.delay_s.p90", Second),
    ("mac.delay_s.p99", Second),
    ("mac.transmissions", Count),
    ("mac.retries", Count),
    ("mac.backoffs", Count),
    ("mac.no_acknowledgement", Count),
    ("mac.channel_access_failures", Count),
    ("mac.lost_collision", Count),
    ("mac.lost_channel_access", Count),
    ("mac.lost_queue", Count),
    ("mac.lost_signal", Count),
    ("mac.pending", Count),
    ("mac.energy_j.tx", Joule),
    ("mac.energy_j.rx", Joule),
    ("mac.energy_j.idle", Joule),
    ("sensing.detections", Count),
    ("sensing.samples", Count),
    ("mac.out_of_range", Count),
    ("mac.not_listened", Count),
    ("mac.not_listened_by.transmitting", Count),
    ("mac.not_listened_by.asleep", Count),
    ("mac.not_listened_by.off", Count),
    ("gathering.lost_queue", Count),
    ("gathering.out_of_range", Count),
    ("gathering.not_listened", Count),
    ("gathering.not_listened_by.transmitting", Count),
    ("gathering.not_listened_by.asleep", Count),
    ("gathering.not_listened_by.off", Count),
    ("gathering.pending", Count),
    ("discovery.anchors.energy_j.rx", Joule),
];

/// Of a run as a whole, if nodes compute a map.
pub(super) const RUN_WITH_MAPS_BY_NODES: &[(&str, Unit)] = &[("simulation.sim_time_s", Second)];

/// Of a map.
pub(super) const MAP: &[(&str, Unit)] = &[
    ("mapped", Count),
    ("unmapped", Count),
    ("infeasible", Count),
    ("ambiguous", Count),
    ("connectivity_error", Share),
    ("connectivity_errors.1.connectivity_error", Share),
    ("connectivity_errors.1.nodes_within_0_2", Share),
    ("connectivity_errors.2.connectivity_error", Share),
    ("connectivity_errors.2.nodes_within_0_2", Share),
    ("connectivity_error_end_points", Share),
    ("connectivity_error_per_node", Share),
    ("symmetric_loss", Share),
    ("false_neighbour_rate", Share),
    ("position_error_m.mean", Metre),
    ("position_error_m.median", Metre),
    ("position_error_m.p90", Metre),
    ("position_error_m.p95", Metre),
    ("position_error_m.max", Metre),
    ("aligned_error_m.mean", Metre),
    ("posterior_bound_m", Metre),
    ("coverage_95", Share),
    ("vertices_evaluated", Count),
    ("topology_preservation_error", Share),
    ("message_energy_j", Joule),
    ("position_error_m.p80", Metre),
    ("sector_displacement.0", Share),
    ("sector_displacement.1", Share),
    ("sector_displacement.2", Share),
    ("sector_displacement.3", Share),
    ("sector_displacement.4", Share),
    ("sector_displacement_of_pairs.0", Share),
    ("nodes_within_0_2", Share),
];

/// Of a map that nodes compute.
pub(super) const BY_NODES: &[(&str, Unit)] = &[
    ("distributed.iterations", Count),
    ("distributed.converged", Share),
    ("distributed.bad", Count),
    ("distributed.unplaced", Count),
    ("distributed.anchors.initial", Count),
    ("distributed.anchors.new", Count),
    ("distributed.anchors.gave_up", Count),
    ("distributed.anchors.without_directions", Count),
    ("distributed.orientation_error_deg.mean", Degree),
    ("distributed.messages.mean_per_node", MeanCount),
    ("distributed.messages.octets", Count),
    ("distributed.frames_received_mean", MeanCount),
    ("distributed.mobile.heard_share", Share),
    ("distributed.mobile.stops_heard_mean", MeanCount),
    ("distributed.vertices_mean", MeanCount),
    ("distributed.memory_octets.mean", MeanCount),
    ("distributed.radio_energy_j.total", Joule),
    ("distributed.radio_energy_j.mean", Joule),
];

/// Of an application.
pub(super) const APPLICATION: &[(&str, Unit)] = &[
    ("captured", Outcome),
    ("arrived", Outcome),
    ("time_s", Second),
    ("sim_time_s", Second),
    ("captures", Count),
    ("map_error_m", Metre),
    ("prediction_error_m.mean", Metre),
    ("prediction_error_m.median", Metre),
    ("prediction_error_m.p90", Metre),
    ("own_place_error_m.mean", Metre),
    ("field_error.mean", Plain),
    ("level", Plain),
    ("largest_value", Plain),
    ("arrivals", Count),
    ("arrived_twice", Outcome),
    ("second_arrival_s", Second),
    ("least_arrival_value", Plain),
    ("law_minimum_s", Second),
    ("path_length_m", Metre),
    ("messages.sent", Count),
    ("messages.sent_per_s", PerSecond),
    ("messages.octets", Count),
    ("energy_j.total", Joule),
    ("energy_j.tx", Joule),
    ("energy_j.rx", Joule),
];

/// The distributions of the errors of a map: the shares of its nodes whose error is at most each limit.
pub(super) static DISTRIBUTIONS: LazyLock<Vec<(String, Unit)>> = LazyLock::new(|| {
    let lost = NODE_ERRORS.iter().map(|limit| (format!("node_error_cdf_{limit}"), Share));
    let far = POSITION_ERRORS_M.iter().map(|limit_m| (format!("position_error_cdf_{limit_m}"), Share));
    lost.chain(far).collect()
});

/// Of a map that nodes compute: the position errors by the error of neighbour scattering.
pub(super) static SCATTERING: LazyLock<Vec<(String, Unit)>> = LazyLock::new(|| {
    let up_to = [("nodes", Share), ("position_error_m.mean", Metre)];
    let up_to = up_to.into_iter().flat_map(|(what, unit)| {
        ["0.1", "0.2"].map(|edge| (format!("distributed.scattering_up_to_{edge}.{what}"), unit))
    });
    let bins = ["mean", "p90"].into_iter().flat_map(|what| {
        SCATTERING_EDGES.map(|edge| (format!("distributed.scattering_{edge}.position_error_m.{what}"), Metre))
    });
    up_to.chain(bins).collect()
});

/// Of a search for targets: its course, at each of the instants.
pub(super) static COURSE: LazyLock<Vec<(String, Unit)>> = LazyLock::new(|| {
    let numbers = ["distance_to_target_m", "prediction_error_m"].into_iter();
    numbers.flat_map(|what| SEARCH_INSTANTS_S.map(|time_s| (format!("{what}.at_{time_s}_s"), Metre))).collect()
});

/// All of a map that may be computed by nodes.
pub(super) fn of_map(is_by_nodes: bool) -> impl Iterator<Item = (&'static str, Unit)> {
    let (work, scattering) = if is_by_nodes { (BY_NODES, SCATTERING.as_slice()) } else { Default::default() };
    named(MAP, &DISTRIBUTIONS).chain(named(work, scattering))
}

/// All of an application that may be a search for targets.
pub(super) fn of_application(is_search: bool) -> impl Iterator<Item = (&'static str, Unit)> {
    named(APPLICATION, if is_search { COURSE.as_slice() } else { Default::default() })
}

/// All of a run in which nodes may compute a map.
pub(super) fn of_run(has_maps_by_nodes: bool) -> impl Iterator<Item = (&'static str, Unit)> {
    RUN.iter().chain(if has_maps_by_nodes { RUN_WITH_MAPS_BY_NODES } else { &[] }).copied()
}

fn named(
    written: &'static [(&'static str, Unit)],
    made: &'static [(String, Unit)],
) -> impl Iterator<Item = (&'static str, Unit)> {
    written.iter().copied().chain(made.iter().map(|(path, unit)| (path.as_str(), *unit)))
}
