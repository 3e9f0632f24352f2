//! What is counted of nodes that nobody hears: as if all were simulated.

use std::time::Duration;

use proptest::prelude::*;
use sextant_channel::Position;
use sextant_kernel::Files;
use sextant_sim::{
    AllSimulated, GroupConfig, MANY_NODES, NodesOfGroup, OnceConfig, Packets, PeriodicConfig, PoissonConfig,
    SaturatedConfig, Setup, SimulatedPart, SimulatedRegion, Sink, Survey, TrafficConfig, TrafficPlan,
};

use super::{LISTENERS, RANGE_M, field, heard, periodic, poisson, setup, simulate, two_fields};
use crate::network;

#[test]
fn packets_of_each_node_are_offered_whether_they_are_simulated_or_not() {
    for traffic in [periodic(), poisson()] {
        let all = simulate(two_fields(traffic.clone(), 7), SimulatedRegion::All);
        let near = simulate(two_fields(traffic.clone(), 7), LISTENERS);
        for node in 0..98 {
            let (all, near) = (all.networks[0].packets[node], near.networks[0].packets[node]);
            assert_eq!(near.offered, all.offered, "{traffic:?}: node {node}");
            assert_eq!((all.not_simulated, near.received), (0, all.received), "{traffic:?}: node {node}");
        }
        assert!(near.packets.not_simulated > 5000, "{}", near.packets.not_simulated);
    }
}

/// The sum of what becomes of packets.
fn ended(packets: &Packets) -> u64 {
    let Packets { received, lost_collision, lost_channel_access, lost_queue, lost_signal, .. } = packets;
    let Packets { out_of_range, not_listened, pending, .. } = packets;
    received + lost_collision + lost_channel_access + lost_queue + lost_signal + out_of_range + not_listened + pending
}

/// Whether two numbers differ by less than a share.
fn is_near(found: f64, expected: f64, share: f64) -> bool {
    (found - expected).abs() < share * expected
}

#[test]
fn what_becomes_of_packets_that_are_not_simulated_is_estimated_from_the_others() {
    for traffic in [periodic(), poisson()] {
        let all = simulate(two_fields(traffic.clone(), 7), SimulatedRegion::All);
        let near = simulate(two_fields(traffic, 7), LISTENERS);
        let (all_packets, packets) = (all.packets, near.packets);
        assert_eq!((packets.offered, ended(&packets)), (all_packets.offered, all_packets.offered));
        assert_eq!((packets.received, packets.lost_collision), (all_packets.received, all_packets.lost_collision));
        for (found, expected, share) in [
            (packets.sent, all_packets.sent, 1e-3),
            (packets.transmissions, all_packets.transmissions, 1e-3),
            (packets.not_listened, all_packets.not_listened, 0.05),
            (packets.out_of_range, all_packets.out_of_range, 0.25),
            (packets.assessments, all_packets.assessments, 0.02),
        ] {
            assert!(is_near(found as f64, expected as f64, share), "{found} {expected}: {packets:?} {all_packets:?}");
        }
        assert!(is_near(near.energy.total_j(), all.energy.total_j(), 0.01), "{:?} {:?}", near.energy, all.energy);
        assert!(is_near(near.energy.tx_j, all.energy.tx_j, 1e-3), "{:?} {:?}", near.energy, all.energy);
    }
}

#[test]
fn the_energy_of_packets_that_are_not_simulated_is_that_of_their_own_length() {
    // Nodes of the far field send frames of 120 octets, and those near the robot of 20.
    let group = |name: &str, nodes: NodesOfGroup, mpdu_octets| GroupConfig {
        name: name.into(),
        nodes,
        traffic: Box::new(TrafficConfig::Periodic(PeriodicConfig::each(mpdu_octets, 0.5, 0.1))),
    };
    let setup = || {
        let near = NodesOfGroup::Names((0..49).map(|node| format!("n{node}")).collect());
        let groups = vec![group("near", near, 20), group("far", NodesOfGroup::Others {}, 120)];
        let setup = two_fields(periodic(), 3);
        let plan = TrafficPlan::new(&TrafficConfig::Groups(groups), &setup.world.nodes, &Files::default());
        let mut setup = network::with(setup, |network| network.traffic = plan.expect("good groups"));
        setup.robots = vec![network::tour(vec![Position::new(2.0, 2.5, 0.0)], 0.25, Duration::from_secs(60))];
        setup
    };
    let (all, near) = (simulate(setup(), SimulatedRegion::All), simulate(setup(), LISTENERS));
    let not_simulated = |nodes: std::ops::Range<usize>| -> u64 {
        near.networks[0].packets[nodes].iter().map(|packets| packets.not_simulated).sum()
    };
    assert_eq!(not_simulated(0..49), 0);
    assert!(not_simulated(49..98) > 4000, "{}", not_simulated(49..98));
    // Of long frames a few more find the channel busy. By the length of the short ones it would be a third.
    assert!(is_near(near.energy.tx_j, all.energy.tx_j, 0.03), "{:?} {:?}", near.energy, all.energy);
}

#[test]
fn the_energy_of_packets_is_counted_even_if_none_of_them_was_simulated() {
    let setup = || {
        let mut setup = setup(&field(2, [500.0, 0.0]), Vec::new(), periodic(), 3);
        setup.robots = vec![network::tour(vec![Position::ORIGIN], 0.25, Duration::from_secs(100))];
        setup
    };
    let (all, near) = (simulate(setup(), SimulatedRegion::All), simulate(setup(), LISTENERS));
    assert_eq!(near.packets.not_simulated, near.packets.offered);
    assert_eq!((near.packets.offered, near.packets.sent), (all.packets.offered, all.packets.offered));
    assert!(is_near(near.energy.tx_j, all.energy.tx_j, 1e-3), "{:?} {:?}", near.energy, all.energy);
    assert!(is_near(near.energy.total_j(), all.energy.total_j(), 0.02), "{:?} {:?}", near.energy, all.energy);
}

#[test]
fn nodes_rest_of_themselves_only_where_they_are_many() {
    let simulated = |nodes: usize| {
        let places: Vec<Position> = (0..nodes).map(|i| Position::new(i as f64, 0.0, 0.0)).collect();
        let setup = setup(&places, vec![Position::ORIGIN], periodic(), 1);
        let setup = Setup { duration: Some(Duration::from_millis(50)), ..setup };
        simulate(setup, SimulatedRegion::NearListenersIfMany).simulated
    };
    assert_eq!(simulated(MANY_NODES - 1), SimulatedPart::AllBecause(AllSimulated::FewNodes));
    assert_eq!(simulated(MANY_NODES), SimulatedPart::NearListeners { halo_m: 2.0 * RANGE_M });
}

/// Everything that a simulation of random stations leaves behind, but what was simulated: as text.
fn outcome(survey: &Survey) -> String {
    let Survey { logs, robots, packets, energy, networks, sensed, deaths, end, .. } = survey;
    format!("{logs:?} {robots:?} {packets:?} {energy:?} {networks:?} {sensed:?} {deaths:?} {end:?}")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn of_a_small_network_each_figure_is_that_of_all_nodes_wherever_they_are(
        places in proptest::collection::vec([-300.0..300.0_f64, -40.0..40.0], 1..12),
        sinks in proptest::collection::vec([-60.0..60.0_f64, -30.0..30.0], 0..3),
        kind in 0..5_usize, acknowledged in proptest::bool::ANY, range_m in 3.0..10.0_f64, seed in 0..100_u64,
    ) {
        let at = |[x_m, y_m]: [f64; 2]| Position::new(x_m, y_m, 0.0);
        let places: Vec<Position> = places.into_iter().map(at).collect();
        let to = None;
        let traffic = match kind {
            0 => TrafficConfig::Periodic(PeriodicConfig { acknowledged, to, ..PeriodicConfig::each(40, 0.4, 0.2) }),
            1 => TrafficConfig::Poisson(PoissonConfig { mpdu_octets: 20, rate_per_s: 5.0, acknowledged, to }),
            2 => TrafficConfig::Once(OnceConfig { mpdu_octets: 90, at_s: 0.5, acknowledged, to }),
            3 => {
                TrafficConfig::Saturated(SaturatedConfig { mpdu_octets: 100, acknowledged, to, start_spread_s: 0.01 })
            }
            _ => TrafficConfig::Beacon(PeriodicConfig { acknowledged, to, ..PeriodicConfig::each(127, 1.0, 0.0) }),
        };
        let setup = |seed| {
            let stops = vec![Position::new(3.0, 0.0, 0.0), Position::new(9.0, 2.0, 0.0)];
            let setup = setup(&places, stops, traffic.clone(), seed);
            let setup = network::with(setup, |network| {
                network.channel = network.channel.within_m(range_m);
            });
            let sink = |(i, place)| Sink { name: format!("sink {i}"), position: at(place), networks: None };
            let sinks: Vec<Sink> = sinks.iter().copied().enumerate().map(sink).collect();
            let duration = (!sinks.is_empty()).then_some(Duration::from_secs(3));
            Setup { sinks, duration, ..setup }
        };
        let all = simulate(setup(seed), SimulatedRegion::All);
        let spared = simulate(setup(seed), SimulatedRegion::NearListenersIfMany);
        prop_assert_eq!(outcome(&spared), outcome(&all));
        // What is asked for with sinks, or with acknowledgements, is the same.
        if !sinks.is_empty() || acknowledged {
            prop_assert_eq!(outcome(&simulate(setup(seed), LISTENERS)), outcome(&all));
        }
    }

    #[test]
    fn of_nodes_that_rest_each_packet_is_offered_and_none_is_received_more_or_less(
        places in proptest::collection::vec([-300.0..300.0_f64, -300.0..300.0], 1..30),
        rate_per_s in 0.5..20.0_f64, is_poisson in proptest::bool::ANY, seed in 0..100_u64,
    ) {
        // Nodes so far apart that no chain of carrier sense crosses a halo.
        let mut apart: Vec<Position> = Vec::new();
        for [x_m, y_m] in places {
            let place = Position::new(x_m, y_m, 0.0);
            if apart.iter().all(|other| other.distance_m(place) > 2.0 * RANGE_M) {
                apart.push(place);
            }
        }
        let (mpdu_octets, acknowledged, to) = (30, false, None);
        let traffic = match is_poisson {
            true => TrafficConfig::Poisson(PoissonConfig { mpdu_octets, rate_per_s, acknowledged, to }),
            false => {
                let (interval_s, jitter) = (1.0 / rate_per_s, 0.3);
                TrafficConfig::Periodic(PeriodicConfig { acknowledged, to, ..PeriodicConfig::each(mpdu_octets, interval_s, jitter) })
            }
        };
        let stops = vec![Position::new(0.0, 0.0, 0.0), Position::new(40.0, 10.0, 0.0)];
        let setup = || setup(&apart, stops.clone(), traffic.clone(), seed);
        let (all, near) = (simulate(setup(), SimulatedRegion::All), simulate(setup(), LISTENERS));
        prop_assert_eq!(heard(&near), heard(&all));
        prop_assert_eq!(near.packets.offered, all.packets.offered);
        prop_assert_eq!((near.packets.received, near.packets.lost_signal), (all.packets.received, all.packets.lost_signal));
        prop_assert_eq!(ended(&near.packets), all.packets.offered);
        for (near, all) in near.networks[0].packets.iter().zip(&all.networks[0].packets) {
            prop_assert_eq!(near.offered, all.offered);
        }
        // Poisson packets that find a node busy are lost, and how many were is an estimate.
        let share = if is_poisson { 0.1 } else { 0.01 };
        prop_assert!((near.energy.tx_j - all.energy.tx_j).abs() <= share * all.energy.tx_j + 1e-4);
    }
}
