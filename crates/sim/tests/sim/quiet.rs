//! Channel access of nodes that nobody watches runs ahead of the event queue. Nodes whose packets are traced are watched, so
//! that the same simulation runs in both ways.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::Seed;
use sextant_mac::csma::CsmaConfig;
use sextant_sim::{
    DeathsConfig, FaultsConfig, Observer, PeriodicConfig, PoissonConfig, RadioConfig, SaturatedConfig, Setup,
    Simulation, Sink, TrafficConfig, Unobserved,
};

use crate::network;

/// Looks at every packet, but does nothing.
struct Watcher;

impl Observer for Watcher {
    fn wants_packets(&self) -> bool {
        true
    }
}

fn star(nodes: usize, traffic: TrafficConfig, csma: CsmaConfig, clock_ppm: f64) -> Setup {
    let mut setup = network::setup(&network::cluster(nodes), 0.0, network::free_space(), traffic, 3);
    setup.sinks = vec![Sink { name: "sink".into(), position: Position::ORIGIN, networks: None }];
    setup.duration = Some(Duration::from_secs(4));
    let link = network::ieee802154(&mut setup.networks[0]);
    link.radio = network::radios(RadioConfig { clock_ppm, ..network::radio(0.0) });
    link.mac = sextant_sim::Mac::CsmaUnslotted(csma.try_into().expect("good settings"));
    setup
}

/// Everything that a simulation tells of its packets and radios.
fn told(setup: &Setup, warm_up: Duration, observer: &mut impl Observer) -> String {
    let simulation = Simulation::new(setup.clone()).expect("good settings").with_warm_up(warm_up);
    let survey = simulation.run(observer);
    format!("{} {:?} {:?} {:?}", survey.events, survey.end, survey.packets, survey.networks)
}

#[test]
fn nodes_that_nobody_watches_do_what_watched_nodes_do() {
    let saturated = |acknowledged, start_spread_s| {
        TrafficConfig::Saturated(SaturatedConfig { mpdu_octets: 127, acknowledged, to: None, start_spread_s })
    };
    let periodic = |acknowledged| {
        let (mpdu_octets, interval_s, jitter) = (50, 0.1, 0.5);
        TrafficConfig::Beacon(PeriodicConfig {
            acknowledged,
            ..PeriodicConfig::each(mpdu_octets, interval_s, jitter)
        })
    };
    let poisson =
        TrafficConfig::Poisson(PoissonConfig { mpdu_octets: 20, rate_per_s: 20.0, acknowledged: false, to: None });
    let traffics = [
        saturated(false, 0.01),
        saturated(false, 0.0),
        saturated(true, 0.01),
        periodic(false),
        periodic(true),
        poisson,
    ];
    let queue = CsmaConfig { queue_frames: 3, ..CsmaConfig::default() };
    let accesses = [
        CsmaConfig::default(),
        CsmaConfig { idle_turnarounds: true, ..queue },
        CsmaConfig { rx_on_when_idle: true, ..queue },
        CsmaConfig { min_be: 0, max_be: 8, max_backoffs: 5, ..queue },
    ];
    for traffic in &traffics {
        for csma in accesses {
            for (clock_ppm, warm_up_ms) in [(0.0, 0), (40.0, 1003)] {
                let mut setup = star(12, traffic.clone(), csma, clock_ppm);
                if clock_ppm > 0.0 {
                    let deaths = DeathsConfig { share: Some(0.3), names: None, from_s: 1.5, to_s: 3.0 };
                    let faults = FaultsConfig { deaths: Some(deaths), ..FaultsConfig::default() };
                    setup.faults = faults.build(&setup.world.nodes, Seed(5)).expect("good faults");
                }
                let warm_up = Duration::from_millis(warm_up_ms);
                let (quiet, watched) = (told(&setup, warm_up, &mut Unobserved), told(&setup, warm_up, &mut Watcher));
                assert_eq!(quiet, watched, "{traffic:?} {csma:?} {clock_ppm} {warm_up_ms}");
            }
        }
    }
}

#[test]
fn a_simulation_without_an_end_ends_with_the_last_spacing_of_quiet_nodes() {
    let query = sextant_sim::OnceConfig { mpdu_octets: 20, at_s: 0.5, acknowledged: false, to: None };
    let setup = Setup { duration: None, ..star(5, TrafficConfig::Query(query), CsmaConfig::default(), 0.0) };
    let quiet = told(&setup, Duration::ZERO, &mut Unobserved);
    assert_eq!(quiet, told(&setup, Duration::ZERO, &mut Watcher));
}
