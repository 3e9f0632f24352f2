//! A tree of RPL, and packets in fragments, as a summary.

use sextant_apps::routing::{ObjectiveConfig, RoutingRecord, RplConfig, RplMode};
use sextant_kernel::{SimTime, StationId};
use sextant_scenario::Scenario;

use super::healing::healing;
use super::simulator::Simulated;
use crate::summary::RplSummary;

/// What a tree of RPL took.
pub(super) fn of(
    scenario: &Scenario,
    written: &RplConfig,
    record: &RoutingRecord,
    simulated: &Simulated,
) -> RplSummary {
    let counts = record.counts().rpl;
    RplSummary {
        objective: match written.objective {
            ObjectiveConfig::Of0(_) => "of0",
            ObjectiveConfig::Mrhof(_) => "mrhof",
        },
        mode: match written.mode {
            RplMode::NonStoring => "non_storing",
            RplMode::Storing => "storing",
            RplMode::None => "none",
        },
        dio: counts.dio,
        dio_left_out: counts.left_out,
        unicast_dio: counts.unicast_dio,
        dis: counts.dis,
        dao: counts.dao,
        dao_ack: counts.dao_ack,
        dao_transmissions: counts.transmissions,
        dao_lost: counts.lost,
        rank_errors: counts.rank_errors,
        rank_error_drops: counts.rank_error_drops,
        full_tables: counts.full_tables,
        local_repairs: counts.repairs,
        routes_known_s: routes_known_s(scenario, record),
        most_routes: record.stations.iter().map(|station| station.routes).max().unwrap_or(0),
        healing: healing(record, &simulated.survey.deaths, scenario.world().nodes.len()),
    }
}

/// Time at which the last node became known to a root (s), if all did.
fn routes_known_s(scenario: &Scenario, record: &RoutingRecord) -> Option<f64> {
    let nodes = scenario.world().nodes.len();
    let known = |node: usize| {
        let station = StationId::from_index(node);
        record.stations[nodes..].iter().filter_map(|root| root.known.get(&station).copied()).min()
    };
    let all = (0..nodes).map(known).collect::<Option<Vec<SimTime>>>()?;
    all.into_iter().max().map(SimTime::as_secs_f64)
}
