//! The numbers of one map.

use super::number::{Number, Unit, count, numbers};
use crate::summary::{ConnectivitySummary, ErrorSummary, MapSummary};

fn nodes(count_of_nodes: Option<usize>) -> Option<f64> {
    count_of_nodes.map(|nodes| count(nodes as u64))
}

/// A number at the `I`-th neighbourhood of the scenario.
fn at<const I: usize>(map: &MapSummary, read: fn(&ConnectivitySummary) -> Option<f64>) -> Option<f64> {
    map.connectivity_errors.get(I).and_then(read)
}

fn error(map: &MapSummary, read: fn(&ErrorSummary) -> f64) -> Option<f64> {
    map.position_error_m.as_ref().map(read)
}

numbers! { MapSummary {
    MAPPED "mapped" Count |map| nodes(Some(map.mapped));
    UNMAPPED "unmapped" Count |map| nodes(Some(map.unmapped));
    INFEASIBLE "infeasible" Count |map| nodes(map.infeasible);
    AMBIGUOUS "ambiguous" Count |map| nodes(map.ambiguous);
    CONNECTIVITY_ERROR "connectivity_error" Share |map| map.connectivity_error;
    CONNECTIVITY_ERROR_1 "connectivity_errors.1.connectivity_error" Share |map| at::<1>(map, |at| at.connectivity_error);
    NODES_WITHIN_1 "connectivity_errors.1.nodes_within_0_2" Share |map| at::<1>(map, |at| at.nodes_within_0_2);
    CONNECTIVITY_ERROR_2 "connectivity_errors.2.connectivity_error" Share |map| at::<2>(map, |at| at.connectivity_error);
    NODES_WITHIN_2 "connectivity_errors.2.nodes_within_0_2" Share |map| at::<2>(map, |at| at.nodes_within_0_2);
    CONNECTIVITY_ERROR_END_POINTS "connectivity_error_end_points" Share
        |map| at::<0>(map, |at| at.connectivity_error_end_points);
    CONNECTIVITY_ERROR_PER_NODE "connectivity_error_per_node" Share
        |map| at::<0>(map, |at| at.connectivity_error_per_node);
    SYMMETRIC_LOSS "symmetric_loss" Share |map| at::<0>(map, |at| at.symmetric_loss);
    FALSE_NEIGHBOUR_RATE "false_neighbour_rate" Share |map| map.false_neighbour_rate;
    POSITION_ERROR_MEAN_M "position_error_m.mean" Metre |map| error(map, |error| error.mean);
    POSITION_ERROR_MEDIAN_M "position_error_m.median" Metre |map| error(map, |error| error.median);
    POSITION_ERROR_P90_M "position_error_m.p90" Metre |map| error(map, |error| error.p90);
    POSITION_ERROR_P95_M "position_error_m.p95" Metre |map| error(map, |error| error.p95);
    POSITION_ERROR_MAX_M "position_error_m.max" Metre |map| error(map, |error| error.max);
    ALIGNED_ERROR_MEAN_M "aligned_error_m.mean" Metre |map| map.aligned_error_m.map(|error| error.mean);
    POSTERIOR_BOUND_M "posterior_bound_m" Metre |map| map.posterior_bound_m;
    COVERAGE_95 "coverage_95" Share |map| map.coverage_95;
    VERTICES_EVALUATED "vertices_evaluated" Count |map| map.vertices_evaluated.map(count);
    TOPOLOGY_PRESERVATION_ERROR "topology_preservation_error" Share |map| map.topology_preservation_error;
    MESSAGE_ENERGY_J "message_energy_j" Joule |map| map.message_energy_j;
    POSITION_ERROR_P80_M "position_error_m.p80" Metre |map| error(map, |error| error.p80);
    SECTOR_DISPLACEMENT_0 "sector_displacement.0" Share |map| map.sector_displacement.first().copied();
    SECTOR_DISPLACEMENT_1 "sector_displacement.1" Share |map| map.sector_displacement.get(1).copied();
    SECTOR_DISPLACEMENT_2 "sector_displacement.2" Share |map| map.sector_displacement.get(2).copied();
    SECTOR_DISPLACEMENT_3 "sector_displacement.3" Share |map| map.sector_displacement.get(3).copied();
    SECTOR_DISPLACEMENT_4 "sector_displacement.4" Share |map| map.sector_displacement.get(4).copied();
    SECTOR_DISPLACEMENT_OF_PAIRS_0 "sector_displacement_of_pairs.0" Share
        |map| map.sector_displacement_of_pairs.first().copied();
    NODES_WITHIN "nodes_within_0_2" Share |map| at::<0>(map, |at| at.nodes_within_0_2);
}}
