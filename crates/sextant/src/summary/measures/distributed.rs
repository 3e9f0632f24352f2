//! The numbers of a map that nodes computed themselves.

use super::number::{Number, Unit, count, numbers};
use crate::summary::{DistributedSummary, MapSummary, MobileAnchorsSummary};

/// A number of the work of the nodes.
fn of(map: &MapSummary, read: fn(&DistributedSummary) -> f64) -> Option<f64> {
    map.distributed.as_ref().map(read)
}

/// A number of the mobile anchors.
fn of_mobile(map: &MapSummary, read: fn(&MobileAnchorsSummary) -> f64) -> Option<f64> {
    map.distributed.as_ref()?.mobile.as_ref().map(read)
}

fn nodes(count_of_nodes: usize) -> f64 {
    count(count_of_nodes as u64)
}

numbers! { MapSummary {
    ITERATIONS "distributed.iterations" Count |map| of(map, |nodes| f64::from(nodes.iterations));
    CONVERGED "distributed.converged" Share |map| of(map, |nodes| f64::from(u8::from(nodes.converged)));
    BAD "distributed.bad" Count |map| of(map, |of| nodes(of.bad));
    UNPLACED "distributed.unplaced" Count |map| of(map, |of| nodes(of.unplaced.len()));
    ANCHORS_INITIAL "distributed.anchors.initial" Count |map| of(map, |of| nodes(of.anchors.initial));
    ANCHORS_NEW "distributed.anchors.new" Count |map| of(map, |of| nodes(of.anchors.new));
    ANCHORS_THAT_GAVE_UP "distributed.anchors.gave_up" Count |map| Some(nodes(map.distributed.as_ref()?.anchors.gave_up));
    ANCHORS_WITHOUT_DIRECTIONS "distributed.anchors.without_directions" Count
        |map| map.distributed.as_ref()?.anchors.without_directions.map(nodes);
    ORIENTATION_ERROR_MEAN_DEG "distributed.orientation_error_deg.mean" Degree
        |map| Some(map.distributed.as_ref()?.orientation_error_deg?.mean);
    MESSAGES_MEAN "distributed.messages.mean_per_node" MeanCount |map| of(map, |of| of.messages.mean_per_node);
    MESSAGES_OCTETS "distributed.messages.octets" Count |map| of(map, |of| count(of.messages.octets));
    FRAMES_RECEIVED_MEAN "distributed.frames_received_mean" MeanCount |map| of(map, |of| of.frames_received_mean);
    HEARD_SHARE "distributed.mobile.heard_share" Share |map| of_mobile(map, |mobile| mobile.heard_share);
    STOPS_HEARD_MEAN "distributed.mobile.stops_heard_mean" MeanCount |map| of_mobile(map, |mobile| mobile.stops_heard_mean);
    VERTICES_MEAN "distributed.vertices_mean" MeanCount |map| map.distributed.as_ref()?.vertices_mean;
    MEMORY_MEAN "distributed.memory_octets.mean" MeanCount |map| of(map, |of| of.memory_octets.mean);
    RADIO_ENERGY_TOTAL_J "distributed.radio_energy_j.total" Joule
        |map| of(map, |of| of.radio_energy_j.mean).map(|mean_j| mean_j * nodes(map.mapped + map.unmapped));
    RADIO_ENERGY_MEAN_J "distributed.radio_energy_j.mean" Joule |map| of(map, |of| of.radio_energy_j.mean);
}}
