//! The numbers that the summary does not hold as they are: each has a name, by which it is found like a path.

use std::collections::BTreeMap;

use crate::summary::{
    ConnectivitySummary, DistributedSummary, EnergySummary, MapSummary, MissionSummary, SEARCH_INSTANTS_S,
};

/// Upper edges of the bins of the error of neighbour scattering that have columns.
pub(super) const SCATTERING_EDGES: [f64; 10] = [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5];

/// Upper edges of the bins of the error of near neighbour scattering.
pub(super) const NEAR_SCATTERING_EDGES: [f64; 5] = [0.05, 0.1, 0.2, 0.4, 1.0];

/// The error of near neighbour scattering that parts good places from bad ones.
pub(super) const NEAR_LIMIT: f64 = 0.2;

/// Numbers by name.
pub(super) type Derived = BTreeMap<String, f64>;

fn count(of: usize) -> f64 {
    of as f64
}

/// Those of a map: at its first neighbourhood, the distributions of its errors, and what nodes computed.
pub(super) fn of_map(map: &MapSummary) -> Derived {
    let mut derived = Derived::new();
    if let Some(first) = map.connectivity_errors.first() {
        of_neighbourhood(first, &mut derived);
    }
    for [limit_m, share] in map.position_error_cdf.into_iter().flatten() {
        derived.insert(format!("position_error_cdf_{limit_m}"), share);
    }
    if let Some(work) = &map.distributed {
        of_scattering(work, &mut derived);
        let total_j = work.radio_energy_j.mean * count(map.mapped + map.unmapped);
        derived.insert("distributed.radio_energy_j.total".to_owned(), total_j);
    }
    derived
}

fn of_neighbourhood(at: &ConnectivitySummary, derived: &mut Derived) {
    let shares = [
        ("connectivity_error_end_points", at.connectivity_error_end_points),
        ("connectivity_error_per_node", at.connectivity_error_per_node),
        ("symmetric_loss", at.symmetric_loss),
        ("nodes_within_0_2", at.nodes_within_0_2),
    ];
    derived.extend(shares.into_iter().filter_map(|(name, share)| Some((name.to_owned(), share?))));
    for [limit, share] in at.node_error_cdf.into_iter().flatten() {
        derived.insert(format!("node_error_cdf_{limit}"), share);
    }
}

/// The position errors by the error of neighbour scattering: of each bin, and of all bins up to an edge.
fn of_scattering(work: &DistributedSummary, derived: &mut Derived) {
    for edge in SCATTERING_EDGES {
        let bin = work.scattering.iter().find(|(other, ..)| (other - edge).abs() < 1e-6);
        if let Some(&(.., mean_m, p90_m)) = bin {
            derived.insert(format!("distributed.scattering_{edge}.position_error_m.mean"), mean_m);
            derived.insert(format!("distributed.scattering_{edge}.position_error_m.p90"), p90_m);
        }
    }
    let all: usize = work.scattering.iter().map(|&(_, nodes, ..)| nodes).sum();
    for edge in [0.1, 0.2] {
        let within = work.scattering.iter().filter(|(other, ..)| *other < edge + 1e-6);
        let (nodes, sum_m) = within.fold((0.0, 0.0), |(nodes, sum_m), &(_, in_bin, mean_m, _)| {
            (nodes + count(in_bin), sum_m + count(in_bin) * mean_m)
        });
        if nodes > 0.0 {
            derived.insert(format!("distributed.scattering_up_to_{edge}.position_error_m.mean"), sum_m / nodes);
        }
        if all > 0 {
            derived.insert(format!("distributed.scattering_up_to_{edge}.nodes"), nodes / count(all));
        }
    }
    let all: usize = work.near_scattering.iter().map(|&(_, nodes, ..)| nodes).sum();
    for edge in NEAR_SCATTERING_EDGES {
        let bin = work.near_scattering.iter().find(|(other, ..)| (other - edge).abs() < 1e-6);
        if let Some(&(_, nodes, mean_m, _)) = bin {
            derived.insert(format!("distributed.near_scattering_{edge}.position_error_m.mean"), mean_m);
            derived.insert(format!("distributed.near_scattering_{edge}.nodes"), count(nodes) / count(all));
        }
    }
    let halves = [("up_to", true), ("above", false)];
    for (name, is_within) in halves {
        let bins = work.near_scattering.iter().filter(|(edge, ..)| (*edge < NEAR_LIMIT + 1e-6) == is_within);
        let (nodes, sum_m) = bins.fold((0.0, 0.0), |(nodes, sum_m), &(_, in_bin, mean_m, _)| {
            (nodes + count(in_bin), sum_m + count(in_bin) * mean_m)
        });
        if nodes > 0.0 {
            let name = format!("distributed.near_scattering_{name}_{NEAR_LIMIT}.position_error_m.mean");
            derived.insert(name, sum_m / nodes);
        }
    }
}

/// Those of an application: counts, rates, arrivals, and the course of a search.
pub(super) fn of_mission(application: &MissionSummary) -> Derived {
    let mut derived = Derived::new();
    let mut add = |name: &str, value: Option<f64>| {
        derived.extend(value.map(|value| (name.to_owned(), value)));
    };
    let captured = application.targets.iter().filter(|target| target.captured_s.is_some()).count();
    add("captures", application.captured.map(|_| count(captured)));
    let arrivals = &application.arrivals;
    // Robots that keep a link arrive once, at the end of their way.
    let seeks = application.arrived.filter(|_| application.link.is_none());
    add("arrivals", seeks.map(|_| count(arrivals.len())));
    add("arrived_twice", seeks.map(|_| f64::from(u8::from(arrivals.len() > 1))));
    add("second_arrival_s", arrivals.get(1).map(|arrival| arrival.time_s));
    // The smallest true value of the field at an arrival.
    add("least_arrival_value", arrivals.iter().map(|arrival| arrival.value).min_by(f64::total_cmp));
    let sent = application.messages.sent as f64;
    add("messages.sent_per_s", (application.sim_time_s > 0.0).then(|| sent / application.sim_time_s));
    let EnergySummary { tx, rx, idle } = application.energy_j;
    add("energy_j.total", Some(tx + rx + idle));
    for (instant, time_s) in application.course.iter().zip(SEARCH_INSTANTS_S) {
        add(&format!("distance_to_target_m.at_{time_s}_s"), instant.distance_to_target_m);
        add(&format!("prediction_error_m.at_{time_s}_s"), instant.prediction_error_m);
    }
    derived
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::summary::{NODE_ERRORS, POSITION_ERRORS_M, SearchInstant};

    #[test]
    fn the_name_of_a_share_has_the_limit_of_the_share() {
        let share = |i: usize| 0.5 + 0.01 * i as f64;
        let lost = std::array::from_fn(|i| [NODE_ERRORS[i], share(i)]);
        let far = std::array::from_fn(|i| [POSITION_ERRORS_M[i], share(i)]);
        let connectivity = ConnectivitySummary { node_error_cdf: Some(lost), ..ConnectivitySummary::default() };
        let map = MapSummary {
            connectivity_errors: vec![connectivity],
            position_error_cdf: Some(far),
            ..MapSummary::default()
        };
        let derived = of_map(&map);
        for (i, limit) in NODE_ERRORS.into_iter().enumerate() {
            assert_eq!(derived.get(&format!("node_error_cdf_{limit}")), Some(&share(i)));
        }
        for (i, limit_m) in POSITION_ERRORS_M.into_iter().enumerate() {
            assert_eq!(derived.get(&format!("position_error_cdf_{limit_m}")), Some(&share(i)));
        }
        assert_eq!(of_map(&MapSummary::default()), Derived::new());
    }

    #[test]
    fn the_name_of_an_instant_has_its_time() {
        let instant = |i: usize| SearchInstant {
            distance_to_target_m: Some(i as f64),
            prediction_error_m: Some(100.0 + i as f64),
        };
        let course = (0..SEARCH_INSTANTS_S.len()).map(instant).collect();
        let derived = of_mission(&MissionSummary { course, ..MissionSummary::default() });
        for (i, time_s) in SEARCH_INSTANTS_S.into_iter().enumerate() {
            let found = |what: &str| derived.get(&format!("{what}.at_{time_s}_s")).copied();
            assert_eq!(found("distance_to_target_m"), Some(i as f64));
            assert_eq!(found("prediction_error_m"), Some(100.0 + i as f64));
        }
        assert!(!of_mission(&MissionSummary::default()).contains_key("distance_to_target_m.at_4_s"));
    }

    fn scattered(scattering: Vec<(f64, usize, f64, f64)>) -> Derived {
        let distributed = Some(DistributedSummary { scattering, ..DistributedSummary::default() });
        of_map(&MapSummary { distributed, ..MapSummary::default() })
    }

    #[test]
    fn the_name_of_a_bin_has_its_upper_edge() {
        let bin = |i: u32| (0.05 * f64::from(i + 1), 1, f64::from(i), 100.0 + f64::from(i));
        let derived = scattered((0..20).map(bin).collect());
        for (i, edge) in SCATTERING_EDGES.into_iter().enumerate() {
            let found =
                |what: &str| derived.get(&format!("distributed.scattering_{edge}.position_error_m.{what}")).copied();
            assert_eq!((found("mean"), found("p90")), (Some(i as f64), Some(100.0 + i as f64)));
        }
    }

    #[test]
    fn bins_of_near_neighbours_have_the_share_of_their_nodes() {
        let near_scattering = vec![(0.05, 30, 0.4, 0.6), (0.4, 10, 0.8, 0.9)];
        let distributed = Some(DistributedSummary { near_scattering, ..DistributedSummary::default() });
        let derived = of_map(&MapSummary { distributed, ..MapSummary::default() });
        let found = |name: &str| derived.get(&format!("distributed.near_scattering_{name}")).copied();
        assert_eq!((found("0.05.nodes"), found("0.4.nodes")), (Some(0.75), Some(0.25)));
        assert_eq!((found("0.4.position_error_m.mean"), found("1.nodes")), (Some(0.8), None));
        let mean = |name: &str| found(&format!("{name}_0.2.position_error_m.mean"));
        assert_eq!((mean("up_to"), mean("above")), (Some(0.4), Some(0.8)));
    }

    #[test]
    fn errors_of_several_bins_are_weighed_by_their_nodes() {
        let derived =
            scattered(vec![(0.05, 30, 0.4, 0.6), (0.1, 10, 0.8, 0.9), (0.2, 40, 1.0, 1.5), (0.3, 20, 3.0, 4.0)]);
        for (name, value) in [
            ("0.1.nodes", 0.4),
            ("0.2.nodes", 0.8),
            ("0.1.position_error_m.mean", (30.0 * 0.4 + 10.0 * 0.8) / 40.0),
            ("0.2.position_error_m.mean", (12.0 + 8.0 + 40.0) / 80.0),
        ] {
            let found = derived[&format!("distributed.scattering_up_to_{name}")];
            assert!((found - value).abs() < 1e-12, "{name}: {found}");
        }
        assert!(!derived.contains_key("distributed.scattering_0.15.position_error_m.mean"), "an empty bin");
    }
}
