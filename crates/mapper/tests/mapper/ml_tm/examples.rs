//! Examples of ML-TM with known results.

use sextant_channel::Position;
use sextant_kernel::{NodeId, Purpose, Seed, Unwatched};
use sextant_mapper::{CountRule, EstimateKind, MapError, MlTmConfig, ProfileConfig, TieRule, TrapezoidConfig};

use super::{entry, log, ml_tm};

#[test]
fn the_worked_example_of_the_thesis_is_reproduced() {
    // Its numbers follow from r = 0.1, not from the r = 0.2 that its text states.
    let profile = TrapezoidConfig::new(1.0, 0.1, 2.0).literal();
    let config = MlTmConfig::new(1.0, ProfileConfig::Trapezoid(profile));
    let ml_tm = ml_tm(MlTmConfig { ties: TieRule::First, ..config });
    let row = [false, false, true, false, false, false];
    let z = |d: f64, heard: bool| {
        let s = ml_tm.profile().probability(d);
        if heard { s } else { 1.0 - s }
    };
    let printed = [
        ([0.0, 1.44, 2.64, 3.78, 4.68, 6.02], 0.0),
        ([1.41, 0.36, 1.36, 2.42, 3.2, 4.6], 0.0325),
        ([3.16, 1.81, 0.76, 1.3, 2.50, 3.64], 0.3708),
        ([4.4, 3.2, 2.72, 1.97, 1.21, 2.06], 0.0),
    ];
    for (distances, expected) in printed {
        let product: f64 = distances.iter().zip(row).map(|(&d, heard)| z(d, heard)).product();
        assert!((product - expected).abs() < 2e-3, "{product} for the printed {expected}");
    }

    // The robot's stops are not printed; these reproduce the printed distances within 0.07 m. They are shifted as the
    // vertices are, which then stand for the integer places of the example.
    let shift = Position::new(0.381_966_011_250_105, 0.236_067_977_499_79, 0.0);
    let places = [(0.0, 0.0), (0.82, 1.23), (1.30, 2.31), (2.31, 3.02), (3.48, 3.08), (4.50, 4.00)];
    let stops = places.map(|(x, y)| Position::new(x, y, 0.0) + shift);
    let heard = [(0, 2), (1, 1), (1, 2), (1, 3), (2, 4)];
    let log = log(3, &stops, heard.map(|(node, stop)| entry(node, stop, 1, 1)).to_vec());
    let map = ml_tm.map(&log, &Unwatched).unwrap();
    let place = |node: usize| map.estimates[node].as_ref().unwrap().position - shift;
    assert!(place(0).distance_m(Position::new(1.0, 3.0, 0.0)) < 1e-9);
    assert!(place(2).distance_m(Position::new(4.0, 2.0, 0.0)) < 1e-9);
    // For q the printed (2, 2) is a near tie inside the rounding of the stops.
    let surface = ml_tm.surface(&log, NodeId(1), &Unwatched).unwrap();
    let printed = (0..surface.lattice.len())
        .find(|&i| {
            let vertex = surface.lattice.position(surface.lattice.vertex(i));
            (vertex - shift).distance_m(Position::new(2.0, 2.0, 0.0)) < 1e-9
        })
        .and_then(|i| usize::try_from(i).ok())
        .expect("(2, 2) is in the window");
    assert!(surface.log_likelihood[printed] > surface.maximum().1 + 0.9_f64.ln());
}

#[test]
fn without_noise_the_likelihood_is_highest_at_the_truth() {
    // Shares of received packets equal to the profile make every factor highest at the true distance.
    const SENT: u32 = 1_000_000;
    for seed in 0..20 {
        let draw = |i: u64, axis| Seed(seed).uniform(Purpose::new(8), [i, axis, 1]);
        let height_m = if seed % 2 == 0 { 0.0 } else { 4.0 };
        let stops: Vec<Position> =
            (0..40).map(|i| Position::new(12.0 * draw(i, 0), 12.0 * draw(i, 1), height_m * draw(i, 2))).collect();
        let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 1.0, 6.0));
        let ml_tm = ml_tm(MlTmConfig::new(0.3, profile));
        let empty = log(1, &stops, Vec::new());
        let lattice = ml_tm.lattice(&empty).unwrap();
        let truth = lattice.position(lattice.counts().map(|count| count / 2));
        let packets = |stop: &Position| {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most SENT")]
            let received = (ml_tm.profile().probability(truth.distance_m(*stop)) * f64::from(SENT)).round() as u32;
            // A floor of one in a million is no reception.
            if received > 1 { received } else { 0 }
        };
        let receptions = (0..).zip(&stops).map(|(i, stop)| entry(0, i, packets(stop), SENT)).collect();
        let map = ml_tm.map(&log(1, &stops, receptions), &Unwatched).unwrap();
        let estimate = map.estimates[0].as_ref().unwrap();
        assert!(estimate.position.distance_m(truth) < 1e-9, "seed {seed}: {estimate:?}, truth {truth:?}");
        assert!(!estimate.infeasible && estimate.ties == 1);
    }
}

#[test]
fn slots_with_at_least_one_packet_count_as_one_packet_received() {
    let places: Vec<Position> = (0..25_i32).map(|i| Position::new((i % 5).into(), (i / 5).into(), 0.0)).collect();
    let counted =
        vec![entry(0, 6, 2, 3), entry(0, 7, 1, 4), entry(0, 11, 5, 5), entry(0, 12, 0, 9), entry(0, 18, 0, 0)];
    let slots =
        vec![entry(0, 6, 1, 1), entry(0, 7, 1, 1), entry(0, 11, 1, 1), entry(0, 12, 0, 1), entry(0, 18, 0, 0)];
    let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 0.5, 4.0));
    let map = |counts, receptions| {
        let config =
            MlTmConfig { counts, estimate: EstimateKind::PosteriorMean, ..MlTmConfig::new(0.25, profile.clone()) };
        ml_tm(config).map(&log(1, &places, receptions), &Unwatched).unwrap().estimates
    };
    let as_slots = map(Some(CountRule::Packets), slots);
    assert_eq!(map(Some(CountRule::AtLeastOne), counted.clone()), as_slots);
    assert_ne!(map(None, counted), as_slots);
}

#[test]
fn nodes_never_heard_are_not_placed() {
    let stops = [Position::ORIGIN, Position::new(1.0, 0.0, 0.0)];
    let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 1.0, 3.0));
    let ml_tm = ml_tm(MlTmConfig::new(0.5, profile));
    let partly = log(3, &stops, vec![entry(0, 0, 1, 1), entry(1, 0, 0, 0), entry(1, 1, 0, 5)]);
    let map = ml_tm.map(&partly, &Unwatched).unwrap();
    assert_eq!((map.mapped(), map.unmapped()), (1, 2));
    assert!(map.estimates[0].is_some());
    assert!(
        matches!(ml_tm.surface(&partly, NodeId(1), &Unwatched), Err(MapError::NotHeard { name }) if name == "n1")
    );
    assert!(matches!(
        ml_tm.surface(&partly, NodeId(7), &Unwatched),
        Err(MapError::UnknownNode { node: 7, nodes: 3 })
    ));
    let silent = ml_tm.map(&log(2, &[], Vec::new()), &Unwatched).unwrap();
    assert_eq!((silent.mapped(), silent.unmapped(), silent.vertices_evaluated), (0, 2, 0));
}

#[test]
fn zero_of_zero_packets_is_no_evidence() {
    let places = [(0.0, 0.0), (2.0, 0.5), (1.0, 2.0), (1.0, 0.5)];
    let stops = places.map(|(x, y)| Position::new(x, y, 0.0));
    let heard = vec![entry(0, 0, 1, 1), entry(0, 1, 1, 1)];
    let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 0.5, 3.0));
    let ml_tm = ml_tm(MlTmConfig { z_range_m: Some([0.0, 0.0]), ..MlTmConfig::new(0.25, profile) });
    let mut with_nothing = heard.clone();
    with_nothing.push(entry(0, 3, 0, 0));
    let deaf = ml_tm.map(&log(1, &stops, with_nothing), &Unwatched).unwrap();
    let absent = ml_tm.map(&log(1, &stops[..3], heard.clone()), &Unwatched).unwrap();
    let missed = ml_tm.map(&log(1, &stops, heard), &Unwatched).unwrap();
    let likelihood = |map: &sextant_mapper::TopologyMap| map.estimates[0].as_ref().unwrap().log_likelihood.unwrap();
    assert!((likelihood(&deaf) - likelihood(&absent)).abs() < 1e-12);
    assert!(likelihood(&missed) < likelihood(&absent) - 0.01);
}

#[test]
fn a_plateau_is_represented_by_its_mean_and_mirror_images_by_one_of_them() {
    let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 1.0, 3.0));
    let place = |config: MlTmConfig, stops: &[Position], heard: &[u32]| {
        let receptions = heard.iter().map(|&stop| entry(0, stop, 1, 1)).collect();
        let map = ml_tm(config).map(&log(1, stops, receptions), &Unwatched).unwrap();
        let estimate = map.estimates[0].clone().unwrap();
        (estimate.position, estimate.ties)
    };
    // One stop on a vertex: every vertex of its plateau is as likely.
    let step_m = 0.5;
    let centre = Position::new(0.381_966_011_250_105, 0.236_067_977_499_79, 0.0) * step_m;
    let config = MlTmConfig::new(step_m, profile);
    let (mean, ties) = place(config.clone(), &[centre], &[0]);
    assert!(ties >= 9 && mean.distance_m(centre) < 1e-9, "{mean:?}, {ties} ties");
    let (first, _) = place(MlTmConfig { ties: TieRule::First, ..config.clone() }, &[centre], &[0]);
    assert!(first.y_m < centre.y_m - 0.4);

    // A straight lane of stops, the outer ones deaf to the node: it is on one side or on the other.
    let lane: Vec<Position> = (-10..=10).map(|i| centre + Position::new(0.25 * f64::from(i), 0.0, 0.0)).collect();
    let heard = [10];
    let (side, ties) = place(config, &lane, &heard);
    assert!(ties >= 2);
    assert!((side.y_m - centre.y_m).abs() > 1.0, "{side:?} is between the mirror images");
}

#[test]
fn a_stop_far_from_all_others_does_not_make_the_search_long() {
    // The lattice has 10¹³ vertices, of which those within reach of a stop are some hundreds.
    let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 1.0, 6.0));
    let ml_tm = ml_tm(MlTmConfig::new(0.5, profile));
    let stops = [Position::ORIGIN, Position::new(2.0, 0.0, 0.0), Position::new(2e6, 1e6, 0.0)];
    let log = log(1, &stops, (0..3).map(|stop| entry(0, stop, 1, 1)).collect());
    let map = ml_tm.map(&log, &Unwatched).unwrap();
    let estimate = map.estimates[0].as_ref().expect("it was heard");
    assert!(estimate.position.distance_m(Position::new(1.0, 0.0, 0.0)) < 1.0, "{estimate:?}");
    assert_eq!(map.infeasible(), 1);
}

#[test]
fn one_thread_and_two_give_the_same_bits() {
    let draw = |i: u64, what| Seed(11).uniform(Purpose::new(8), [i, what, 2]);
    let stops: Vec<Position> =
        (0..200).map(|i| Position::new(20.0 * draw(i, 0), 20.0 * draw(i, 1), 3.0 * draw(i, 2))).collect();
    let mut receptions = Vec::new();
    for node in 0..200 {
        let place = Position::new(20.0 * draw(node, 3), 20.0 * draw(node, 4), 3.0 * draw(node, 5));
        for (i, &stop) in (0..).zip(&stops) {
            if draw(1000 * node + u64::from(i), 6) < 1.0 - place.distance_m(stop) / 6.0 {
                receptions.push(entry(u32::try_from(node).unwrap(), i, 1, 1));
            }
        }
    }
    let log = log(200, &stops, receptions);
    let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 0.5, 5.0));
    let config = MlTmConfig { estimate: EstimateKind::PosteriorMean, ..MlTmConfig::new(0.5, profile) };
    let ml_tm = ml_tm(config);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        format!("{:?}", pool.install(|| ml_tm.map(&log, &Unwatched)).unwrap())
    };
    let one = on(1);
    assert_eq!(one, on(2));
    assert!(one.contains("infeasible: true") && one.contains("infeasible: false"));
}
