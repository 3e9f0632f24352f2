//! A tree of RPL, and packets in fragments, as a summary.

use sextant_apps::routing::{ObjectiveConfig, RoutingRecord, RplConfig, RplMode};
use sextant_kernel::{SimTime, StationId};
use sextant_scenario::Scenario;
use sextant_sim::Death;

use super::simulator::Simulated;
use crate::summary::{HealingSummary, RplSummary};

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
        healing: healing(record, &simulated.survey.deaths),
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

/// How long it took until the children of dead nodes had other parents.
fn healing(record: &RoutingRecord, deaths: &[Death]) -> Option<HealingSummary> {
    let died = |station: StationId| deaths.iter().find(|death| death.node.0 == station.0).map(|death| death.time);
    let (mut orphans, mut healed_s) = (0, Vec::new());
    for (number, station) in record.stations.iter().enumerate() {
        let own_end = died(StationId::from_index(number));
        let all = &station.parents;
        for (i, change) in all.iter().enumerate() {
            let Some(death) = change.parent.and_then(died).filter(|&death| own_end.is_none_or(|own| death < own))
            else {
                continue;
            };
            let until = all.get(i + 1).map(|next| next.time);
            // It had this parent when that died, or took it afterwards.
            if until.is_some_and(|until| until <= death) || change.time > death {
                continue;
            }
            orphans += 1;
            let other = all[i + 1..]
                .iter()
                .find(|next| next.parent.is_some_and(|parent| died(parent).is_none_or(|d| d > next.time)));
            healed_s.extend(other.map(|other| (other.time - death).as_secs_f64()));
        }
    }
    let healed = healed_s.len() as u64;
    (orphans > 0).then(|| HealingSummary {
        orphans,
        healed,
        mean_s: (healed > 0).then(|| healed_s.iter().sum::<f64>() / healed as f64),
        max_s: healed_s.iter().copied().reduce(f64::max),
    })
}
