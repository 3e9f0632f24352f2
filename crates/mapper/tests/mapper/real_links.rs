//! Maps of logs whose links are like real ones: packets of a link share their shadowing, and so do neighbouring stops.

use std::sync::LazyLock;

use sextant_channel::{Position, Reception, ReceptionLog, Stop};
use sextant_kernel::{NodeId, Purpose, Seed, Unwatched};
use sextant_mapper::{
    Area, Auto, AutoConfig, Choice, Comparator, Concern, EstimatorFit, Knowledge, LinkEvidence, LinkFit, LinkModel,
    LinkModelConfig, Mapper, PacketCentroid, PacketCentroidConfig, PlacePrior, Region, SelfCalibrated,
    SelfCalibratedConfig, StrongestStop, TopologyMap,
};

const WORLD: Purpose = Purpose::new(9001);

/// A world of links: a log-distance law with static shadowing, part of which is a field of waves over the stops, that differs
/// from node to node.
struct World {
    seed: Seed,
    nodes: usize,
    /// Stops along each side.
    side: usize,
    /// Standard deviations of the static shadowing and of the offsets of nodes, in units of the fading.
    shadowing: f64,
    offset: f64,
    packets: u32,
    rssi: bool,
    /// Mean margin at 5 m.
    margin: f64,
    /// How far all nodes are beyond the stops (m); `None` if they are amid them.
    beyond_m: Option<f64>,
}

impl World {
    fn usual() -> Self {
        Self {
            seed: Seed(3),
            nodes: 60,
            side: 7,
            shadowing: 1.0,
            offset: 0.3,
            packets: 12,
            rssi: false,
            margin: 1.2,
            beyond_m: None,
        }
    }

    fn nodes(&self) -> Vec<Position> {
        let along = |node, axis| 18.0 * self.seed.uniform(WORLD, [0, node, axis]);
        let place = |node| {
            let (x_m, y_m) = (along(node, 0), along(node, 1));
            match (self.beyond_m, node % 4) {
                (None, _) => Position::new(x_m, y_m, 0.0),
                (Some(beyond_m), 0) => Position::new(x_m, -beyond_m, 0.0),
                (Some(beyond_m), 1) => Position::new(18.0 + beyond_m, y_m, 0.0),
                (Some(beyond_m), 2) => Position::new(x_m, 18.0 + beyond_m, 0.0),
                (Some(beyond_m), _) => Position::new(-beyond_m, y_m, 0.0),
            }
        };
        (0..self.nodes as u64).map(place).collect()
    }

    fn stops(&self) -> Vec<Position> {
        let step_m = 18.0 / (self.side - 1) as f64;
        let at = |i: usize, j: usize| Position::new(step_m * i as f64, step_m * j as f64, 0.0);
        (0..self.side).flat_map(|j| (0..self.side).map(move |i| at(i, j))).collect()
    }

    fn log(&self) -> ReceptionLog {
        let stops = self.stops();
        let mut receptions = Vec::new();
        for (node, place) in (0..).zip(self.nodes()) {
            for (number, &stop) in (0..).zip(&stops) {
                let normal = |what, at| self.seed.normal(WORLD, [what, u64::from(node), at]);
                // A sum of waves about 6 m long is a smooth field of variance 1.
                let field: f64 = (0..24)
                    .map(|wave| {
                        let angle = std::f64::consts::TAU * self.seed.uniform(WORLD, [1, u64::from(node), wave]);
                        let phase = std::f64::consts::TAU * self.seed.uniform(WORLD, [2, u64::from(node), wave]);
                        let per_m = 0.7 * (0.5 + self.seed.uniform(WORLD, [3, u64::from(node), wave]));
                        (2.0f64 / 24.0).sqrt()
                            * (per_m * (stop.x_m * angle.cos() + stop.y_m * angle.sin()) + phase).cos()
                    })
                    .sum();
                let shadowing = self.shadowing * (0.8 * field + 0.6 * normal(4, u64::from(number)));
                let margin = self.margin - 1.7 * (place.distance_m(stop).max(0.3) / 5.0).ln()
                    + self.offset * normal(5, 0)
                    + shadowing;
                let strengths: Vec<f64> = (0..u64::from(self.packets))
                    .map(|packet| margin + self.seed.normal(WORLD, [6 + packet, u64::from(node), u64::from(number)]))
                    .filter(|&strength| strength > 0.0)
                    .collect();
                let mean = strengths.iter().sum::<f64>() / strengths.len().max(1) as f64;
                receptions.push(Reception {
                    rssi_dbm: (self.rssi && !strengths.is_empty()).then_some(-92.0 + 4.0 * mean),
                    ..Reception::heard(
                        NodeId(node),
                        number,
                        u32::try_from(strengths.len()).expect("few packets"),
                        self.packets,
                    )
                });
            }
        }
        let stop = |position| Stop::at(position);
        let names = (0..self.nodes).map(|node| format!("n{node}")).collect();
        ReceptionLog::new(names, stops.into_iter().map(stop).collect(), receptions, Vec::new()).expect("a valid log")
    }
}

fn mean_error_m(map: &TopologyMap, truth: &[Position]) -> f64 {
    let errors = map
        .estimates
        .iter()
        .zip(truth)
        .filter_map(|(estimate, place)| Some(estimate.as_ref()?.position.distance_m(*place)));
    let errors: Vec<f64> = errors.collect();
    errors.iter().sum::<f64>() / errors.len() as f64
}

fn coverage(map: &TopologyMap, truth: &[Position]) -> f64 {
    let regions = map.estimates.iter().zip(truth).filter_map(|(estimate, &place)| {
        let region = Region::of_95(estimate.as_ref()?)?;
        Some(f64::from(u8::from(region.contains(place))))
    });
    let within: Vec<f64> = regions.collect();
    within.iter().sum::<f64>() / within.len() as f64
}

fn link_model() -> LinkModel {
    LinkModel::try_from(LinkModelConfig::default()).expect("valid settings")
}

/// The map of the usual world by packets, and that by packets and strengths, each with what was learned.
static BY_PACKETS: LazyLock<(TopologyMap, LinkFit)> = LazyLock::new(|| usual_map(false));
static BY_BOTH: LazyLock<(TopologyMap, LinkFit)> = LazyLock::new(|| usual_map(true));

fn usual_map(rssi: bool) -> (TopologyMap, LinkFit) {
    let (map, fit) =
        link_model().map(&World { rssi, ..World::usual() }.log(), None, &Unwatched).expect("nobody interrupts");
    (map, fit.expect("nodes were heard"))
}

#[test]
fn the_law_of_links_is_found_without_any_place_known() {
    let (_, fit) = &*BY_BOTH;
    assert!(fit.settled, "{fit:?}");
    assert_eq!(fit.evidence, LinkEvidence::PacketsAndRssi);
    let receiver = fit.receiver.unwrap();
    assert!((receiver.threshold_dbm + 92.0).abs() < 1.5, "{receiver:?}");
    assert!((receiver.fading_db - 4.0).abs() < 0.8, "{receiver:?}");
    assert!((fit.law.slope - 1.7).abs() < 0.4, "{:?}", fit.law);
    assert!((fit.law.shadowing - 1.0).abs() < 0.25, "{:?}", fit.law);
    assert!((fit.path_loss_exponent().unwrap() - 1.7 * 4.0 / 4.343).abs() < 0.4);
    // At 5 m, the mean margin of 1.2 scatters by 1 from link to link and by 0.3 from node to node.
    assert!((fit.probability(5.0) - 0.80).abs() < 0.06, "{}", fit.probability(5.0));
}

#[test]
fn places_are_nearer_than_those_of_any_centroid_and_strengths_help() {
    let world = World::usual();
    let (truth, log) = (world.nodes(), world.log());
    let by_packets_m = mean_error_m(&BY_PACKETS.0, &truth);
    for power in [1.0, 3.0, 6.0] {
        let centroid = PacketCentroid::try_from(PacketCentroidConfig { power }).unwrap().map(&log);
        assert!(by_packets_m < mean_error_m(&centroid, &truth), "{by_packets_m} m, power {power}");
    }
    let (by_both, _) = &*BY_BOTH;
    assert!(mean_error_m(by_both, &truth) < by_packets_m);
    assert!(by_both.concerns().next().is_none());
}

#[test]
fn regions_hold_the_true_places_as_often_as_they_say() {
    let (mut held, mut ratio) = (Vec::new(), 0.0);
    let usual = World::usual();
    for seed in (1..=4).map(Seed) {
        let world = World { seed, ..World::usual() };
        let map = if seed == usual.seed {
            BY_PACKETS.0.clone()
        } else {
            link_model().map(&world.log(), None, &Unwatched).unwrap().0
        };
        let truth = world.nodes();
        held.push(coverage(&map, &truth));
        let each = map.estimates.iter().flatten().zip(&truth).map(|(estimate, place)| {
            let covariance = estimate.covariance.unwrap();
            estimate.position.distance_m(*place).powi(2) / (covariance[0][0] + covariance[1][1])
        });
        ratio += each.sum::<f64>() / truth.len() as f64 / 4.0;
    }
    // Regions are a little too large, never much: errors are as large as they say.
    assert!(held.iter().sum::<f64>() / 4.0 > 0.93, "{held:?}");
    assert!((0.25..1.2).contains(&ratio), "{ratio}");
}

#[test]
fn the_log_chooses_the_model_that_its_links_follow() {
    let chosen = |world: World| {
        let (_, choice) = Auto::try_from(AutoConfig::default()).unwrap().map(&world.log(), None, &Unwatched).unwrap();
        let choice = choice.unwrap();
        assert_eq!(choice.scores.len(), 3);
        assert!(choice.scores.iter().any(|score| score.error == 0.0));
        assert_eq!(choice.chosen, "link-model");
        choice.opinions.unwrap()
    };
    let by_packets = chosen(World { rssi: false, ..World::usual() });
    assert!(by_packets.gain.is_none() && by_packets.link_model_power > 0.99);
    assert_eq!(by_packets.others.iter().map(|other| other.estimator).collect::<Vec<_>>(), ["packet-centroid"]);
    let by_strengths = chosen(World { rssi: true, ..World::usual() });
    assert!(by_strengths.gain.unwrap() > 0.0 && by_strengths.link_model_power > 0.99, "its law is that of the links");
    let names: Vec<_> = by_strengths.others.iter().map(|other| other.estimator).collect();
    assert_eq!(names, ["rssi-centroid", "strongest-stop"]);
}

#[test]
fn nodes_that_all_stand_beyond_the_stops_are_found_there() {
    // Strong nodes on all sides, 9 m from the nearest stop: simple methods put them at the border.
    let world = World { rssi: true, nodes: 12, margin: 6.0, beyond_m: Some(9.0), shadowing: 0.8, ..World::usual() };
    let (truth, log) = (world.nodes(), world.log());
    let (map, choice) = Auto::try_from(AutoConfig::default()).unwrap().map(&log, None, &Unwatched).unwrap();
    let choice = choice.unwrap();
    let Some(EstimatorFit::Links(fit)) = choice.fit else { panic!("{} was chosen", choice.chosen) };
    assert!(fit.has_far_nodes, "the log is more probable if nodes are outside");
    let strongest = StrongestStop.map(&Knowledge::from(&log), &Unwatched).unwrap();
    let (auto_m, strongest_m) = (mean_error_m(&map, &truth), mean_error_m(&strongest, &truth));
    assert!(auto_m < 0.6 * strongest_m, "{auto_m} m, strongest stop {strongest_m} m");
    assert!(coverage(&map, &truth) > 0.8, "regions hold {}", coverage(&map, &truth));
    assert!(!BY_BOTH.1.has_far_nodes && !BY_PACKETS.1.has_far_nodes, "nodes amid the stops are not far");
}

#[test]
fn a_law_that_explains_strengths_badly_does_not_mislead_the_map() {
    // Smooth shadowing of 16 dB, which no law of distances explains.
    let world = World { rssi: true, shadowing: 4.0, nodes: 30, ..World::usual() };
    let (truth, log) = (world.nodes(), world.log());
    let (map, choice) = Auto::try_from(AutoConfig::default()).unwrap().map(&log, None, &Unwatched).unwrap();
    let (by_links, _) = link_model().map(&log, None, &Unwatched).unwrap();
    let strongest = StrongestStop.map(&Knowledge::from(&log), &Unwatched).unwrap();
    let opinions = choice.unwrap().opinions.unwrap();
    let best_m = mean_error_m(&by_links, &truth).min(mean_error_m(&strongest, &truth));
    assert!(mean_error_m(&map, &truth) < 1.1 * best_m, "{} {best_m} {opinions:?}", mean_error_m(&map, &truth));
    assert!(coverage(&map, &truth) > 0.85, "{}", coverage(&map, &truth));
}

#[test]
fn where_packets_are_independent_the_choice_is_about_as_good_as_the_best() {
    let world = World { shadowing: 0.0, offset: 0.0, ..World::usual() };
    let (truth, log) = (world.nodes(), world.log());
    let (chosen, _) = Auto::try_from(AutoConfig::default()).unwrap().map(&log, None, &Unwatched).unwrap();
    let (by_links, _) = link_model().map(&log, None, &Unwatched).unwrap();
    let calibrated = SelfCalibrated::try_from(SelfCalibratedConfig::default()).unwrap();
    let (calibrated, _) = calibrated.map(&log, &Unwatched).unwrap();
    let best_m = mean_error_m(&by_links, &truth).min(mean_error_m(&calibrated, &truth));
    assert!(mean_error_m(&chosen, &truth) < 1.2 * best_m, "{} {best_m}", mean_error_m(&chosen, &truth));
}

#[test]
fn the_map_is_the_same_at_any_number_of_threads() {
    let log = World { nodes: 20, ..World::usual() }.log();
    let of_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| link_model().map(&log, None, &Unwatched).unwrap())
    };
    assert_eq!(of_threads(1), of_threads(3));
}

#[test]
fn no_place_is_beyond_reach_whatever_the_log_says() {
    let stop = |x_m: f64, y_m: f64, z_m: f64| Stop::at(Position::new(x_m, y_m, z_m));
    let reception = |node, stop, received, sent| Reception::heard(NodeId(node), stop, received, sent);
    let names = |count: usize| (0..count).map(|node| format!("n{node}")).collect::<Vec<_>>();
    let line: Vec<Stop> = (0..20).map(|i| stop(f64::from(i), 0.0, 0.0)).collect();
    let on_line = (0..20).map(|at| reception(0, at, u32::from((6..=12).contains(&at)), 1)).collect();
    let everywhere: Vec<Reception> =
        (0..3).flat_map(|node| (0..20).map(move |at| reception(node, at, 5, 5))).collect();
    let uneven: Vec<Stop> =
        (0..20).map(|i| stop(f64::from(i % 5), f64::from(i / 5), 0.01 * f64::from(i % 3))).collect();
    let far: Vec<Stop> =
        (0..10).map(|i| stop(f64::from(i % 5) + if i < 5 { 0.0 } else { 5000.0 }, 0.0, 0.0)).collect();
    let in_far = (0..10).map(|at| reception(u32::from(at >= 5), at, 3, 4)).collect();
    let logs = [
        ReceptionLog::new(names(1), line.clone(), on_line, vec![]),
        ReceptionLog::new(names(3), line, everywhere.clone(), vec![]),
        ReceptionLog::new(names(3), uneven, everywhere, vec![]),
        ReceptionLog::new(names(1), vec![stop(0.0, 0.0, 0.0); 4], vec![reception(0, 2, 1, 1)], vec![]),
        ReceptionLog::new(names(1), vec![stop(7.0, 1.0, 2.0)], vec![reception(0, 0, 3, 8)], vec![]),
        ReceptionLog::new(names(2), far, in_far, vec![]),
    ];
    for (number, log) in logs.into_iter().enumerate() {
        let log = log.unwrap();
        let (map, choice) = Auto::try_from(AutoConfig::default()).unwrap().map(&log, None, &Unwatched).unwrap();
        assert!(choice.is_some());
        for (node, estimate) in map.estimates.iter().enumerate() {
            let place = estimate.as_ref().unwrap().position;
            let heard = log.of(NodeId::from_index(node)).iter().filter(|reception| reception.received > 0);
            let nearest_m = heard
                .map(|reception| log.stops()[reception.stop as usize].position.distance_m(place))
                .fold(f64::INFINITY, f64::min);
            assert!(place.x_m.is_finite() && nearest_m < 15.0, "log {number}, node {node}: {place:?}, {nearest_m} m");
        }
    }
}

#[test]
fn a_log_in_which_all_is_heard_everywhere_says_so() {
    let stops = (0..16).map(|i| Stop::at(Position::new(f64::from(i % 4), f64::from(i / 4), 0.0)));
    let heard = (0..3).flat_map(|node| (0..16).map(move |stop| Reception::heard(NodeId(node), stop, 4, 4)));
    let log = ReceptionLog::new(vec!["a".into(), "b".into(), "c".into()], stops.collect(), heard.collect(), vec![]);
    let (map, _) = link_model().map(&log.unwrap(), None, &Unwatched).unwrap();
    let concerns: Vec<Concern> = map.concerns().map(|(_, concern)| concern).collect();
    assert_eq!(concerns, [Concern::NoEvidence; 3]);
}

#[test]
fn places_keep_to_the_area_that_is_known() {
    let world = World { nodes: 20, ..World::usual() };
    let log = world.log();
    let area = Area::rectangle([0.0, 0.0], [9.0, 18.0]).unwrap();
    let prior = PlacePrior::new(Some(area.clone()), None).unwrap();
    let (map, fit) = link_model().map(&log, Some(&prior), &Unwatched).unwrap();
    assert!(fit.is_some());
    assert!(map.positions().into_iter().flatten().all(|place| area.contains(place)));
    let near = PlacePrior::new(None, Some(0.5)).unwrap();
    let (near, _) = link_model().map(&log, Some(&near), &Unwatched).unwrap();
    let (free, _) = link_model().map(&log, None, &Unwatched).unwrap();
    let variance_m2 = |map: &TopologyMap| -> f64 {
        let covariances = map.estimates.iter().flatten().filter_map(|estimate| estimate.covariance);
        covariances.map(|covariance| covariance[0][0] + covariance[1][1]).sum()
    };
    assert!(variance_m2(&near) < variance_m2(&free));
}

#[test]
fn the_mappers_tell_what_they_learned() {
    let log = World { nodes: 12, ..World::usual() }.log();
    let mapper = Mapper::new(link_model());
    let (map, learned) = mapper.map_and_learn(&log, &Unwatched).unwrap();
    assert_eq!((map.algorithm, map.mapped()), ("link-model", 12));
    assert!(learned.unwrap().get::<LinkFit>().is_some());
    let mapper = Mapper::new(Auto::try_from(AutoConfig::default()).unwrap());
    let (map, learned) = mapper.map_and_learn(&log, &Unwatched).unwrap();
    assert_eq!(map.algorithm, "auto");
    assert!(learned.unwrap().get::<Choice>().unwrap().fit.is_some());
}
