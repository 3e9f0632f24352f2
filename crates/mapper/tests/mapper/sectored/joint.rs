//! One map from two networks.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::{NodeId, Unwatched};
use sextant_mapper::{
    EstimateKind, JointConfig, JointMlTm, JointNetworkConfig, Lattice, MapError, MlTm, MlTmConfig, ProfileConfig,
    TieRule, TrapezoidConfig,
};

use super::{ARRAY, RF, Radio, lanes, mean_error_m, nodes};

const Z_RANGE_M: Option<[f64; 2]> = Some([0.0, 2.5]);

fn profile(radio: Radio) -> ProfileConfig {
    ProfileConfig::Trapezoid(TrapezoidConfig::new(0.95, 0.4 * radio.range_m, radio.range_m + 0.3))
}

fn network(name: &str, radio: Radio) -> JointNetworkConfig {
    JointNetworkConfig { network: name.into(), profile: profile(radio), counts: None, sectors: None }
}

fn config(estimate: EstimateKind) -> JointConfig {
    JointConfig {
        networks: vec![network("rf", RF), network("mmwave", ARRAY)],
        grid_step_m: 0.25,
        estimate,
        ties: TieRule::First,
        z_range_m: Z_RANGE_M,
        max_memory_mb: None,
    }
}

fn joint(config: JointConfig) -> JointMlTm {
    JointMlTm::try_from(config).expect("good settings")
}

fn single(radio: Radio, estimate: EstimateKind) -> MlTm {
    let config = MlTmConfig::new(0.25, profile(radio));
    MlTm::try_from(MlTmConfig { estimate, z_range_m: Z_RANGE_M, ..config }).expect("good settings")
}

#[test]
fn a_joint_map_is_better_than_that_of_each_network() {
    for estimate in [EstimateKind::Argmax, EstimateKind::PosteriorMean] {
        let nodes = nodes(4, 60);
        // The array listens at fewer places.
        let logs = [RF.log(1, &nodes, &lanes(1.5)), ARRAY.log(2, &nodes, &lanes(2.2))];
        let map = joint(config(estimate)).map(&[&logs[0], &logs[1]], &Unwatched).map(|(map, _)| map);
        let (joint_m, unmapped) = mean_error_m(&map, &nodes);
        assert_eq!(unmapped, 0);
        for (radio, log) in [RF, ARRAY].into_iter().zip(&logs) {
            let (alone_m, _) = mean_error_m(&single(radio, estimate).map(log, &Unwatched), &nodes);
            assert!(joint_m < 0.95 * alone_m, "{estimate:?}: {joint_m} m together, {alone_m} m alone");
        }
    }
}

/// The vertices of the search set of a node in one log, with their log-likelihoods.
fn vertices(ml_tm: &MlTm, log: &ReceptionLog, node: NodeId) -> Vec<(Position, f64)> {
    let surface = ml_tm.surface(log, node, &Unwatched).expect("a node that was heard");
    let place = |i: usize| surface.lattice.position(surface.lattice.vertex(i as u64));
    let values = surface.log_likelihood.iter().enumerate().filter(|(_, value)| value.is_finite());
    values.map(|(i, &value)| (place(i), value)).collect()
}

#[test]
fn the_joint_likelihood_is_the_product_over_both_logs() {
    // Both networks have the same stops and the same range, so that they share the lattice of one alone.
    let nodes = nodes(9, 25);
    let stops = lanes(2.0);
    let rf = Radio { range_m: ARRAY.range_m, ..RF };
    let logs = [rf.log(5, &nodes, &stops), ARRAY.log(6, &nodes, &stops)];
    let config =
        JointConfig { networks: vec![network("a", rf), network("b", ARRAY)], ..config(EstimateKind::Argmax) };
    let (map, fits) = joint(config.clone()).map(&[&logs[0], &logs[1]], &Unwatched).unwrap();
    assert_eq!(fits, [None, None]);
    let mean = joint(JointConfig { estimate: EstimateKind::PosteriorMean, ..config });
    let (mean, _) = mean.map(&[&logs[0], &logs[1]], &Unwatched).unwrap();
    let mut compared = 0;
    for node in 0..25 {
        let of = |radio, log: &ReceptionLog| vertices(&single(radio, EstimateKind::Argmax), log, NodeId(node));
        let (a, b) = (of(rf, &logs[0]), of(ARRAY, &logs[1]));
        let mut sums: Vec<(Position, f64)> = Vec::new();
        for &(place, value) in &a {
            let same = b.iter().find(|(other, _)| other.distance_m(place) < 1e-9);
            sums.extend(same.map(|&(_, other)| (place, value + other)));
        }
        let estimate = map.estimates[node as usize].as_ref().expect("a place");
        if estimate.infeasible || sums.is_empty() {
            continue;
        }
        compared += 1;
        let best = sums
            .iter()
            .fold((Position::ORIGIN, f64::NEG_INFINITY), |best, &(p, v)| if v > best.1 { (p, v) } else { best });
        assert!((estimate.log_likelihood.unwrap() - best.1).abs() < 1e-9, "node {node}");
        let total: f64 = sums.iter().map(|(_, value)| (value - best.1).exp()).sum();
        let expected = sums.iter().fold(Position::ORIGIN, |sum, &(p, v)| sum + p * ((v - best.1).exp() / total));
        let mean = mean.estimates[node as usize].as_ref().unwrap();
        assert!(mean.position.distance_m(expected) < 1e-9 && mean.covariance.is_some());
    }
    assert!(compared > 15, "{compared}");
}

#[test]
fn a_node_heard_in_one_network_only_is_placed_by_it() {
    let mut nodes = nodes(3, 10);
    let logs = [RF.log(1, &nodes, &lanes(1.5)), ARRAY.log(2, &nodes[..4], &lanes(2.2))];
    let (map, _) = joint(config(EstimateKind::Argmax)).map(&[&logs[0], &logs[1]], &Unwatched).unwrap();
    // The lattice of both networks is that of the first one, which covers the second one.
    let alone = single(RF, EstimateKind::Argmax);
    let stops: Vec<_> = logs[0].stops().iter().chain(logs[1].stops()).copied().collect();
    let range_m = alone.profile().range_m();
    let lattice = Lattice::covering(&stops, range_m, 0.25, Z_RANGE_M, 512_000_000).unwrap();
    assert_eq!(lattice, alone.lattice(&logs[0]).unwrap());
    let expected = alone.map(&logs[0], &Unwatched).unwrap();
    for node in 4..10 {
        let likelihood = |map: &sextant_mapper::TopologyMap| map.estimates[node].as_ref().unwrap().log_likelihood;
        assert_eq!(likelihood(&map), likelihood(&expected));
    }
    // A node far from both is not placed.
    nodes.push(Position::new(90.0, 0.0, 0.0));
    let silent = [RF.log(1, &nodes, &lanes(1.5)), ARRAY.log(2, &nodes, &lanes(2.2))];
    let (map, _) = joint(config(EstimateKind::Argmax)).map(&[&silent[0], &silent[1]], &Unwatched).unwrap();
    assert_eq!(map.estimates[10], None);
}

#[test]
fn networks_that_contradict_each_other_are_told() {
    // The first network hears the node at one end of the room, the second one at the other, out of each other's range.
    let heard = |radio: Radio, at: Position| Radio { range_m: 3.0, ..radio }.log(1, &[at], &lanes(1.5));
    let logs = [heard(RF, Position::new(1.0, 1.0, 0.5)), heard(ARRAY, Position::new(11.0, 8.0, 0.5))];
    let near = |name: &str, radio: Radio| network(name, Radio { range_m: 3.0, ..radio });
    let config =
        JointConfig { networks: vec![near("a", RF), near("b", ARRAY)], ..config(EstimateKind::PosteriorMean) };
    let (map, _) = joint(config).map(&[&logs[0], &logs[1]], &Unwatched).unwrap();
    let estimate = map.estimates[0].as_ref().expect("a place");
    assert!(estimate.infeasible && estimate.position.is_finite());
}

#[test]
fn wrong_logs_and_settings_are_errors() {
    let nodes = nodes(3, 4);
    let logs = [RF.log(1, &nodes[..3], &lanes(3.0)), ARRAY.log(2, &nodes, &lanes(3.0))];
    let both = joint(config(EstimateKind::Argmax));
    assert_eq!(both.networks().collect::<Vec<_>>(), ["rf", "mmwave"]);
    let error = both.map(&[&logs[0]], &Unwatched).unwrap_err();
    assert_eq!(error, MapError::Networks { networks: 2, logs: 1 });
    let error = both.map(&[&logs[0], &logs[1]], &Unwatched).unwrap_err();
    assert_eq!(error, MapError::OtherNodes { network: "mmwave".into(), name: "n3".into() });
    let key = |config: JointConfig| JointMlTm::try_from(config).unwrap_err().key;
    let good = config(EstimateKind::Argmax);
    assert_eq!(key(JointConfig { networks: vec![network("rf", RF)], ..good.clone() }), "networks");
    let twice = vec![network("rf", RF), network("rf", ARRAY)];
    assert_eq!(key(JointConfig { networks: twice, ..good.clone() }), "networks[1].network");
    assert_eq!(key(JointConfig { grid_step_m: -1.0, ..good.clone() }), "grid_step_m");
    let bad = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.95, 4.0, 3.0));
    let bad = JointNetworkConfig { profile: bad, ..network("b", ARRAY) };
    assert_eq!(
        key(JointConfig { networks: vec![network("a", RF), bad], ..good }),
        "networks[1].profile.trapezoid.plateau_m"
    );
}
