//! Noise, groups of radios and a warm-up in complete networks.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::Seed;
use sextant_sim::{
    InterfererConfig, NodesOfGroup, Packets, PoissonConfig, Radio, RadioConfig, RadioGroupConfig, ReceptionModel,
    Setup, Simulation, Sink, Survey, TrafficConfig, Unobserved,
};

use crate::network;

/// Three nodes about a metre from a sink on channel 11, whose few packets arrive unless something disturbs them.
fn setup() -> Setup {
    let config = PoissonConfig { mpdu_octets: 50, rate_per_s: 5.0, acknowledged: false, to: None };
    let traffic = TrafficConfig::Poisson(config);
    // 0 dBm at one metre.
    let mut setup = network::setup(&network::cluster(3), 0.0, network::free_space(), traffic, 1);
    setup.sinks = vec![Sink { name: "sink".into(), position: Position::new(0.0, 0.0, 0.0), networks: None }];
    setup.duration = Some(Duration::from_secs(20));
    setup
}

fn run(setup: Setup) -> Survey {
    Simulation::new(setup).expect("good settings").run(&mut Unobserved)
}

fn packets(setup: Setup) -> Packets {
    run(setup).packets
}

/// A noise that is one metre from the nodes, and 1.4 m from the sink.
fn noise(channel: u8, power_dbm: f64, duty_cycle: f64) -> InterfererConfig {
    InterfererConfig {
        name: "oven".into(),
        position_m: Position::new(1.0, 1.0, 0.0),
        power_dbm,
        channel: Some(channel),
        center_mhz: None,
        bandwidth_mhz: 2.0,
        leakage: Vec::new(),
        period_s: 0.1,
        duty_cycle,
    }
}

fn with_noise(config: &InterfererConfig) -> Packets {
    let mut setup = setup();
    setup.world.interferers = vec![config.build(0, Seed(1)).expect("good settings")];
    packets(setup)
}

#[test]
fn a_noise_that_never_ends_keeps_the_channel_busy() {
    let quiet = packets(setup());
    assert!(quiet.received > 250 && quiet.lost_channel_access < 3, "{quiet:?}");
    let noisy = with_noise(&noise(11, 0.0, 1.0));
    assert_eq!((noisy.offered, noisy.sent), (quiet.offered, 0));
    assert_eq!(noisy.lost_channel_access + noisy.lost_queue + noisy.pending, quiet.offered);
}

#[test]
fn a_noise_that_nodes_do_not_sense_destroys_the_frames_at_the_sink() {
    // Nodes sense from -80 dBm on, the sink receives from -90 dBm on: the noise lies between.
    let config = noise(11, -85.0, 1.0);
    let noisy = with_noise(&config);
    assert_eq!(noisy.received, 0);
    assert!(noisy.lost_channel_access < 3, "{noisy:?}");
    assert!(noisy.lost_collision > 250, "{noisy:?}");
}

#[test]
fn a_noise_on_another_channel_disturbs_by_its_leakage_alone() {
    let quiet = packets(setup());
    assert_eq!(with_noise(&noise(12, 20.0, 1.0)), quiet);
    let leaky = InterfererConfig { leakage: vec![[0.0, -20.0], [10.0, -40.0]], ..noise(12, 20.0, 1.0) };
    let noisy = with_noise(&leaky);
    assert_eq!((noisy.offered, noisy.sent), (quiet.offered, 0));
    // Two channels away it ends.
    assert_eq!(with_noise(&InterfererConfig { channel: Some(14), ..leaky }), quiet);
}

#[test]
fn a_noise_that_is_on_for_a_third_of_the_time_disturbs_about_a_third_of_the_frames() {
    // Long periods, and frames of 1792 us: a frame overlaps a burst with a probability of (1 + 0.0018) / 3. Nodes do not
    // sense the noise. Of n frames n p are lost, with a deviation of sqrt(n p (1 - p)): four deviations.
    let config = InterfererConfig { period_s: 3.0, ..noise(11, -85.0, 1.0 / 3.0) };
    let mut setup = setup();
    setup.duration = Some(Duration::from_secs(120));
    setup.world.interferers = vec![config.build(0, Seed(1)).expect("good settings")];
    let found = packets(setup);
    let sent = found.sent as f64;
    let deviation = (sent * 2.0 / 9.0).sqrt();
    assert!((found.lost_collision as f64 - sent / 3.0).abs() < 4.0 * deviation, "{found:?}");
}

#[test]
fn a_group_of_nodes_with_less_power_is_not_heard_and_costs_less() {
    let all = run(setup());
    let mut setup = setup();
    let group = RadioGroupConfig {
        nodes: NodesOfGroup::Names(vec!["n1".into()]),
        tx_power_dbm: Some(-95.0),
        sensitivity_dbm: None,
        cca_threshold_dbm: None,
        noise_floor_dbm: None,
        clock_ppm: None,
        clock_offset_ppm: None,
    };
    let config = RadioConfig { groups: vec![group], ..network::radio(0.0) };
    let radio = Radio::new(&config, &setup.world.nodes).expect("good settings");
    network::ieee802154(&mut setup.networks[0]).radio = radio.with_reception(ReceptionModel::Overlap);
    let grouped = run(setup);
    let received =
        |survey: &Survey| survey.networks[0].packets[..3].iter().map(|packets| packets.received).collect::<Vec<_>>();
    let (before, after) = (received(&all), received(&grouped));
    assert!(before.iter().all(|&received| received > 50), "{before:?}");
    assert_eq!(after[1], 0);
    assert!(after[0] >= before[0] && after[2] >= before[2], "{before:?} {after:?}");
    let tx_j = |survey: &Survey| survey.networks[0].energy[1].tx_j;
    // 8.5 mA instead of 17.4 mA.
    assert!((tx_j(&grouped) / tx_j(&all) - 8.5 / 17.4).abs() < 1e-3);
}

#[test]
fn a_warm_up_is_left_out_of_packets_delays_and_energy() {
    let seconds = Duration::from_secs;
    let whole = run(setup());
    let late = Simulation::new(setup()).expect("good settings").with_warm_up(seconds(15)).run(&mut Unobserved);
    let mut early = setup();
    early.duration = Some(seconds(15));
    let early = run(early);
    // Nothing is under way at 15 s, so that the parts are those of the whole.
    assert_eq!(early.packets.pending, 0);
    let mut sum = early.packets;
    sum += late.packets;
    assert_eq!(sum, whole.packets);
    assert!(late.packets.offered > 30 && late.packets.received > 30, "{:?}", late.packets);
    let count = |survey: &Survey| survey.networks[0].delays.iter().map(|delays| delays.count()).sum::<u64>();
    assert_eq!(count(&early) + count(&late), count(&whole));
    assert_eq!(count(&late), late.packets.received);
    let sink = |survey: &Survey| survey.networks[0].deliveries[3];
    assert_eq!(sink(&early) + sink(&late), sink(&whole));
    let joules = |survey: &Survey| survey.energy.total_j();
    assert!((joules(&early) + joules(&late) - joules(&whole)).abs() < 1e-9 * joules(&whole));
}
