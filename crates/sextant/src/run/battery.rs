//! The batteries of a run, as a summary and as messages of a recording.

use sextant_kernel::SimTime;
use sextant_recording::messages::BatteryMessage;
use sextant_scenario::Scenario;
use sextant_sim::{BatteryRecord, Survey};

use crate::summary::{BatteryNodeSummary, BatterySummary, LifetimeSummary};

const SECONDS_OF_A_DAY: f64 = 86_400.0;

/// The batteries of the nodes, if they have any.
pub(super) fn of(scenario: &Scenario, survey: &Survey) -> Option<BatterySummary> {
    let records = &survey.batteries;
    if records.is_empty() {
        return None;
    }
    let mut deaths_s: Vec<f64> = records.iter().filter_map(depleted_s).collect();
    deaths_s.sort_by(f64::total_cmp);
    let node = |(placed, record): (&sextant_sim::layout::PlacedNode, &BatteryRecord)| BatteryNodeSummary {
        name: placed.name.clone(),
        capacity_j: record.capacity_j,
        left_j: record.left_j,
        mean_power_w: record.mean_power_w(),
        lifetime_d: lifetime_d(record),
        depleted_s: depleted_s(record),
    };
    Some(BatterySummary {
        lifetime_d: lifetimes(records),
        depleted: deaths_s.len(),
        first_death_s: deaths_s.first().copied(),
        half_death_s: deaths_s.get(records.len().div_ceil(2) - 1).copied(),
        nodes: scenario.world().nodes.iter().zip(records).map(node).collect(),
    })
}

/// The batteries at the end, for a recording.
pub(super) fn messages(survey: &Survey) -> Vec<BatteryMessage> {
    let message = |(node, record): (u32, &BatteryRecord)| BatteryMessage {
        node,
        capacity_j: record.capacity_j,
        left_j: record.left_j,
        mean_power_w: record.mean_power_w(),
        lifetime_d: lifetime_d(record),
        depleted_ns: record.depleted.map(SimTime::as_nanos),
    };
    (0..).zip(&survey.batteries).map(message).collect()
}

fn depleted_s(record: &BatteryRecord) -> Option<f64> {
    record.depleted.map(SimTime::as_secs_f64)
}

fn lifetime_d(record: &BatteryRecord) -> Option<f64> {
    Some(record.lifetime_s / SECONDS_OF_A_DAY).filter(|days| days.is_finite())
}

/// The lifetimes of some nodes, of which some may have no end; `None` if all of them have none.
pub(super) fn lifetimes<'a>(records: impl IntoIterator<Item = &'a BatteryRecord>) -> Option<LifetimeSummary> {
    let days = |d: f64| Some(d).filter(|d| d.is_finite());
    let mut sorted_d: Vec<f64> = records.into_iter().map(|record| record.lifetime_s / SECONDS_OF_A_DAY).collect();
    sorted_d.sort_by(f64::total_cmp);
    let (&min, &max) = (sorted_d.first()?, sorted_d.last()?);
    let middle = sorted_d.len() / 2;
    let median =
        if sorted_d.len() % 2 == 1 { sorted_d[middle] } else { 0.5 * (sorted_d[middle - 1] + sorted_d[middle]) };
    let endless = sorted_d.iter().filter(|d| !d.is_finite()).count();
    Some(LifetimeSummary {
        min: days(min)?,
        median: days(median),
        max: days(max),
        endless: Some(endless).filter(|&count| count > 0),
    })
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn nodes_without_a_load_last_longer_than_all_others() {
        let found = |days: &[f64]| {
            let record = |days: &f64| BatteryRecord {
                capacity_j: 1.0,
                left_j: 1.0,
                used_j: 0.0,
                used_for: Duration::ZERO,
                depleted: None,
                lifetime_s: days * SECONDS_OF_A_DAY,
            };
            let records: Vec<BatteryRecord> = days.iter().map(record).collect();
            lifetimes(&records).map(|found| (found.min, found.median, found.max, found.endless))
        };
        let never = f64::INFINITY;
        assert_eq!(found(&[3.0, 1.0, 2.0]), Some((1.0, Some(2.0), Some(3.0), None)));
        assert_eq!(found(&[never, 1.0, 2.0]), Some((1.0, Some(2.0), None, Some(1))));
        assert_eq!(found(&[never, 1.0]), Some((1.0, None, None, Some(1))));
        assert_eq!(found(&[never]), None);
    }
}
