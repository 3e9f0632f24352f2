//! What theory says of the cells of a sweep, where its assumptions hold.

use std::collections::{BTreeMap, BTreeSet};

use sextant_channel::Db;
use sextant_figure::Series;
use sextant_mac::csma::CsmaSettings;
use sextant_mac::csma::analysis::{lone_saturated_period, one_shot};
use sextant_scenario::Scenario;
use sextant_sim::{Ieee802154, Mac, Network, ReceptionModel, TrafficConfig};

use super::Drawn;
use super::groups::{Curve, Groups};
use crate::sweep::finished_table::FinishedTable;

/// A link on which as many frames arrive counts as one without losses.
const LOSSLESS: f64 = 1.0 - 1e-9;

/// A value of theory, and where it comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Theory {
    source: &'static str,
    value: f64,
}

/// What theory says of a measure in the cells of `scenario`, as curves.
pub(super) fn curves(table: &FinishedTable, scenario: &Scenario, across: usize, drawn: &Drawn) -> Vec<Series> {
    let groups = Groups::new(table, drawn.column, &[across]);
    let mut curves: BTreeMap<Curve, Vec<(f64, f64)>> = BTreeMap::new();
    let mut known = BTreeSet::new();
    for &row in table.runs() {
        let settings: Vec<String> = table.settings().map(|setting| table.cell(row, setting).to_owned()).collect();
        if !known.insert(settings) {
            continue;
        }
        let cell = table.settings().try_fold(scenario.clone(), |cell, setting| {
            cell.with(&table.columns()[setting], table.cell(row, setting)).ok()
        });
        let found = cell.and_then(|cell| of(&cell, &table.columns()[drawn.column]));
        if let (Some(x), Some(Theory { source, value })) = (table.number(row, across), found) {
            curves.entry(groups.of(row).noted(source)).or_default().push((x, drawn.factor * value));
        }
    }
    let series = |(curve, mut points): (Curve, Vec<(f64, f64)>)| {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Series { name: curve.name(""), points, intervals: Vec::new() }
    };
    curves.into_iter().map(series).collect()
}

/// Nodes that all hear each other and one sink, send by unslotted CSMA-CA, and lose frames that overlap and no others.
struct Star<'a> {
    network: &'a Network,
    links: &'a Ieee802154,
    csma: CsmaSettings,
}

impl<'a> Star<'a> {
    /// `None` if the scenario is something else.
    fn of(scenario: &'a Scenario) -> Option<Self> {
        let (config, world) = (scenario.config(), scenario.world());
        let [network] = scenario.networks() else { return None };
        let links = network.technology.ieee802154()?;
        let Mac::CsmaUnslotted(csma) = links.mac else { return None };
        let has_groups = config.radio.as_ref().is_some_and(|radio| !radio.groups.is_empty());
        let is_disturbed = !world.interferers.is_empty() || config.faults != sextant_sim::FaultsConfig::default();
        let [sink] = &config.sinks[..] else { return None };
        let has_walls = !world.obstacles.obstacles().is_empty();
        let others = !config.robots.is_empty() || has_groups || is_disturbed || has_walls;
        if others || links.radio.reception() != ReceptionModel::Overlap || network.members.is_some() {
            return None;
        }
        let radio = &links.radio;
        let (sensitivity, threshold) = (radio.sensitivity(), radio.cca_threshold());
        let needed = if threshold > sensitivity { threshold } else { sensitivity };
        let hears = |distance_m: f64| {
            distance_m <= network.channel.max_range_m()
                && network.channel.reception_probability(radio.tx_power(), needed, distance_m, Db(0.0)) >= LOSSLESS
        };
        let places: Vec<_> = world.nodes.iter().map(|node| node.position).chain([sink.position_m]).collect();
        let farthest = places.iter().flat_map(|a| places.iter().map(|b| a.distance_m(*b))).fold(0.0, f64::max);
        hears(farthest).then_some(Self { network, links, csma })
    }
}

/// What theory says of a measure of a scenario; `None` where no assumptions hold that are known here.
fn of(scenario: &Scenario, measure: &str) -> Option<Theory> {
    let star = Star::of(scenario)?;
    let (phy, nodes) = (star.links.radio.phy(), scenario.world().nodes.len());
    match (measure, scenario.config().traffic.as_ref()?) {
        ("mac.prr", TrafficConfig::Once(once) | TrafficConfig::Query(once)) if !once.acknowledged => {
            let found = one_shot(nodes, &star.csma, phy, once.mpdu_octets)?;
            Some(Theory { source: "exact, by all backoff draws", value: found.received })
        }
        ("mac.throughput_bit_per_s", TrafficConfig::Saturated(saturated)) if nodes == 1 => {
            let octets = saturated.mpdu_octets;
            let period = lone_saturated_period(&star.csma, phy, octets, saturated.acknowledged);
            let payload = u16::from(octets).checked_sub(star.network.technology.frame_octets(0))?;
            let value = 8.0 * f64::from(payload) / period.as_secs_f64();
            Some(Theory { source: "exact, one saturated node", value })
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shipped(name: &str) -> Scenario {
        let path = format!("{}/../../scenarios/mac/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        Scenario::load(path).expect("a shipped scenario")
    }

    #[test]
    fn two_nodes_that_answer_at_once_collide_once_in_eight_times() {
        let two = shipped("one-shot-star").with("world.nodes.random.count", 2).unwrap();
        let theory = of(&two, "mac.prr").expect("its assumptions hold");
        assert!((theory.value - 0.874_999_8).abs() < 1e-7);
        assert_eq!(of(&two, "mac.throughput_bit_per_s"), None);
    }

    #[test]
    fn one_saturated_node_brings_146_kbit_per_s() {
        let one = shipped("saturated-star").with("world.nodes.random.count", 1).unwrap();
        let theory = of(&one, "mac.throughput_bit_per_s").expect("its assumptions hold");
        assert!((theory.value - 8.0 * 116.0 / 6.336e-3).abs() < 1e-6, "{theory:?}");
        assert_eq!(of(&one.with("world.nodes.random.count", 2).unwrap(), "mac.throughput_bit_per_s"), None);
    }

    #[test]
    fn nothing_is_said_where_the_assumptions_do_not_hold() {
        let two = shipped("one-shot-star").with("world.nodes.random.count", 2).unwrap();
        for (key, value) in [
            ("channel.max_range_m", "1.0"),
            ("channel.path_loss.log_distance.exponent", "6.0"),
            ("channel.shadowing.sigma_db", "8.0"),
            ("traffic.once.acknowledged", "true"),
            ("world.nodes.random.count", "10"),
        ] {
            let other = two.with(key, value).unwrap_or_else(|errors| panic!("{key}: {errors}"));
            assert_eq!(of(&other, "mac.prr"), None, "{key} = {value}");
        }
    }
}
