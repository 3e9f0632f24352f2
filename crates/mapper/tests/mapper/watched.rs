//! Every algorithm reports its work before it begins, and ends soon after it is interrupted.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use sextant_channel::{Channel, ChannelConfig, Dbm, ObstacleField, Position, Reception, ReceptionLog, Stop};
use sextant_kernel::{Interrupted, NodeId, Purpose, Seed, Unwatched, Watch, Work};
use sextant_mapper::{
    AlgorithmConfig, ChannelProfileConfig, DrMdsConfig, Knowledge, MapError, Mapper, MlTmConfig, ObstacleUse,
    ProfileConfig, RangingConfig, RssGridConfig, RssMlConfig, SmacofConfig, TrapezoidConfig, TriangleCentroidConfig,
    TrueModel, WeightedCentroidConfig, connectivity_error, posterior_bound_m, topology_preservation_error,
};

use crate::comparators::network::{Network, RANGING, lattice};

/// Ends the work the `last`-th time that it is asked.
#[derive(Debug)]
struct Script {
    last: u64,
    asked: AtomicU64,
    steps: AtomicU64,
    begun: Mutex<Vec<Work>>,
}

impl Script {
    fn until(last: u64) -> Self {
        Self { last, asked: AtomicU64::new(0), steps: AtomicU64::new(0), begun: Mutex::default() }
    }

    fn asked(&self) -> u64 {
        self.asked.load(Ordering::Relaxed)
    }
}

impl Watch for Script {
    fn begin(&self, work: Work) {
        self.begun.lock().expect("nobody panics").push(work);
    }

    fn advance(&self, steps: u64) {
        self.steps.fetch_add(steps, Ordering::Relaxed);
    }

    fn is_stopped(&self) -> bool {
        self.asked.fetch_add(1, Ordering::Relaxed) >= self.last
    }
}

/// What a robot hears of the nodes of `network` at 64 stops, with strengths.
fn survey(network: &Network) -> ReceptionLog {
    let stop = |i: u32| Stop::at(Position::new(1.25 * f64::from(i % 8) + 0.1, 1.25 * f64::from(i / 8) + 0.2, 0.0));
    let stops: Vec<Stop> = (0..64).map(stop).collect();
    let mut receptions = Vec::new();
    for (node, place) in (0_u32..).zip(&network.places) {
        for (stop, at) in (0_u32..).zip(&stops) {
            let distance_m = place.distance_m(at.position);
            let rssi_dbm = -50.0 - 27.0 * distance_m.max(0.1).log10()
                + 3.0 * Seed(4).normal(Purpose::new(8), [u64::from(node), u64::from(stop), 0]);
            if rssi_dbm > -65.0 {
                let (node, rssi_dbm) = (NodeId(node), Some(rssi_dbm));
                receptions.push(Reception { rssi_dbm, ..Reception::heard(node, stop, 1, 1) });
            }
        }
    }
    let names = (0..network.places.len()).map(|node| format!("n{node}")).collect();
    ReceptionLog::new(names, stops, receptions, Vec::new()).expect("a log")
}

fn algorithms() -> Vec<AlgorithmConfig> {
    let ranging = RangingConfig { sigma_db: Some(3.0), ..RANGING };
    let channel = ChannelProfileConfig {
        exponent: Some(2.7),
        sigma_db: Some(3.0),
        tx_power_dbm: Some(-50.0),
        sensitivity_dbm: Some(-65.0),
        obstacles: ObstacleUse::Known,
        ..ChannelProfileConfig::default()
    };
    let ml_tm = |profile| AlgorithmConfig::MlTm(MlTmConfig::new(0.5, profile));
    vec![
        ml_tm(ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 1.0, 6.0))),
        ml_tm(ProfileConfig::Fitted(Default::default())),
        ml_tm(ProfileConfig::Channel(channel)),
        AlgorithmConfig::SelfCalibrated(Default::default()),
        AlgorithmConfig::Tpm(Default::default()),
        AlgorithmConfig::RssiTriangleCentroid(TriangleCentroidConfig { ranging, ..Default::default() }),
        AlgorithmConfig::Centroid(Default::default()),
        AlgorithmConfig::WeightedCentroid(WeightedCentroidConfig { ranging, ..Default::default() }),
        AlgorithmConfig::DvHop(Default::default()),
        AlgorithmConfig::NtldvHop(Default::default()),
        AlgorithmConfig::DrMds(DrMdsConfig { ranging, ..Default::default() }),
        AlgorithmConfig::MdsMap(Default::default()),
        AlgorithmConfig::Smacof(SmacofConfig { ranging, ..Default::default() }),
        AlgorithmConfig::Apit(Default::default()),
        AlgorithmConfig::RssMl(RssMlConfig { ranging, ..Default::default() }),
        AlgorithmConfig::RssGrid(RssGridConfig {
            grid_step_m: Some(0.5),
            ranging,
            sensitivity_dbm: Some(-65.0),
            max_range_m: None,
            estimate: sextant_mapper::EstimateKind::PosteriorMean,
            z_range_m: None,
        }),
    ]
}

#[test]
fn every_algorithm_reports_its_work_and_can_be_interrupted() {
    let network = Network::new(lattice([10, 10, 1], 0.2), 5, 2.5, 5.0, 0.0);
    let log = survey(&network);
    let obstacles = ObstacleField::default();
    let knowledge = Knowledge { log: &log, obstacles: Some(&obstacles), ..network.knowledge() };
    for config in algorithms() {
        let mapper = Mapper::try_from(config).expect("good settings");
        let name = mapper.name();
        let watched = Script::until(u64::MAX);
        let (map, learned) = mapper.map_and_learn(knowledge, &watched).expect("a map");
        assert!(map.mapped() > 50, "{name}: {} nodes", map.mapped());
        assert_eq!((map, learned), mapper.map_and_learn(knowledge, &Unwatched).expect("a map"), "{name}");
        let begun = watched.begun.into_inner().expect("nobody panics");
        let most: u64 = begun.iter().map(|work| work.steps).sum();
        assert!(!begun.is_empty() && begun.iter().all(|work| work.operations > 0.0), "{name}: {begun:?}");
        let steps = watched.steps.into_inner();
        assert!(steps > 0 && steps <= 2 * most, "{name}: {steps} steps of {most}");
        let all = watched.asked.into_inner();
        for last in [0, 10, all / 2] {
            let script = Script::until(last);
            let ended = mapper.map_and_learn(knowledge, &script);
            assert_eq!(ended.unwrap_err(), MapError::Interrupted(Interrupted), "{name} after {last} of {all}");
            // Each thread may be in the middle of a node.
            assert!(script.asked() <= last + 40_000, "{name} went on for {} of {all}", script.asked() - last);
        }
    }
}

#[test]
fn bounds_and_metrics_can_be_interrupted() {
    let network = Network::new(lattice([10, 10, 1], 0.2), 5, 2.5, 5.0, 0.0);
    let log = survey(&network);
    let truth = &network.places;
    let channel = Channel::new(ChannelConfig::default().try_into().unwrap(), ObstacleField::default(), Seed(1));
    let (tx, sensitivity) = (Dbm(-50.0), Dbm(-84.0));
    let z_range_m = [0.0, 0.0];
    let model = TrueModel {
        channel: &channel,
        tx,
        sensitivity,
        delivery: 0.9,
        packets_per_stop: 1.0,
        near: truth,
        z_range_m,
    };
    let map: Vec<Option<Position>> = truth.iter().copied().map(Some).collect();
    let rule = sextant_mapper::NeighbourhoodRule::Affine;
    for last in [0, 1, 50] {
        assert_eq!(posterior_bound_m(&log, &model, &Script::until(last)), Err(Interrupted));
        assert_eq!(topology_preservation_error(truth, &map, &Script::until(last)), Err(Interrupted));
    }
    let error = connectivity_error(truth, &map, 2.0, rule, &Script::until(0)).unwrap_err();
    assert_eq!(error.to_string(), "interrupted");
    assert!(posterior_bound_m(&log, &model, &Unwatched).is_ok_and(|bound| bound.is_some()));
}

#[test]
fn tables_that_need_too_much_memory_are_rejected_with_their_size() {
    // Beacons of 30 000 anchors, which nobody hears: the hops alone would need 3.6 GB.
    let places: Vec<Position> = (0..30_000_u32).map(|i| Position::new(f64::from(i), f64::from(i % 7), 0.0)).collect();
    let anchors: Vec<_> = places
        .iter()
        .enumerate()
        .map(|(i, &position)| sextant_channel::Anchor { node: NodeId::from_index(i), position })
        .collect();
    let nobody = sextant_channel::NeighbourLog::new(places.len(), Vec::new()).expect("a log");
    let names = (0..places.len()).map(|i| format!("n{i}")).collect();
    let stops = vec![Stop::at(Position::ORIGIN)];
    let log = ReceptionLog::new(names, stops, Vec::new(), Vec::new()).expect("a log");
    let knowledge = Knowledge { neighbours: Some(&nobody), anchors: &anchors, ..Knowledge::from(&log) };
    let mapper = Mapper::try_from(AlgorithmConfig::DvHop(Default::default())).expect("good settings");
    let error = mapper.map(knowledge).unwrap_err().to_string();
    assert_eq!(error, "`dv-hop` needs 3600 MB for the hops of 30000 nodes to 30000 anchors; allowed: 3200 MB");
}

#[test]
fn a_log_that_has_grown_is_mapped_again_without_a_second_choice() {
    let network = Network::new(lattice([3, 2, 1], 0.2), 3, 2.5, 5.0, 0.0);
    let whole = survey(&network);
    let receptions = whole.receptions().iter().filter(|reception| reception.stop < 48).collect();
    let early = ReceptionLog::new(whole.names().to_vec(), whole.stops()[..48].to_vec(), receptions, Vec::new());
    let early = early.unwrap();
    let mapper = Mapper::try_from(AlgorithmConfig::Auto(Default::default())).unwrap();
    let (_, learned) = mapper.map_and_learn(&early, &Unwatched).unwrap();
    let again = mapper.after(&learned.unwrap()).unwrap();
    let (from_start, watched) = (Script::until(u64::MAX), Script::until(u64::MAX));
    let (map, _) = mapper.map_and_learn(&whole, &from_start).unwrap();
    let (quick, learned) = again.map_and_learn(&whole, &watched).unwrap();
    let [fewer, all] = [&watched, &from_start].map(|script| script.begun.lock().expect("nobody panics").len());
    // The choice maps parts of the log with each estimator.
    assert!(3 * fewer < all, "{fewer} of {all}");
    assert_eq!((quick.algorithm, quick.mapped()), (map.algorithm, map.mapped()));
    let apart = quick.positions().into_iter().zip(map.positions());
    let apart = apart.filter_map(|(one, other)| Some(one?.distance_m(other?))).fold(0.0, f64::max);
    // A few nodes tell a choice little, and the shorter log told it less.
    assert!(apart < 0.5, "{apart} m");
    // What it learned is what the next one begins with.
    assert!(again.after(&learned.unwrap()).is_some());
}
