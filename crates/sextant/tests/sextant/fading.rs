//! Links that change in time, end to end: what arrives is what the closed forms say, and all of the simulator has one gain.

use sextant::sim::NetworkId;
use sextant::{Scenario, Unwatched, explain_link};

use crate::programs::shipped;

/// Two networks of one node and one sink, on two radio channels.
const CHANNELS: &str = r#"
name = "channels"
duration_s = 10.0
[world.nodes.explicit]
positions_m = [[30.0, 4.0]]
[[sinks]]
name = "sink"
position_m = [0.0, 0.0]
[channel]
path_loss.log_distance.exponent = 2.0
fading.delay_spread_ns = 50.0
[traffic.periodic]
interval_s = 1.0
[networks.low.radio]
channel = 11
tx_power_dbm = 0.0
sensitivity_dbm = -90.0
[networks.high.radio]
channel = 26
tx_power_dbm = 0.0
sensitivity_dbm = -90.0
"#;

fn prr(scenario: &Scenario) -> (f64, f64) {
    let run = sextant::run(scenario, &mut (), &Unwatched).expect("a run");
    let mac = run.summary().mac.clone().expect("a sink");
    (mac.all.prr.expect("packets"), mac.all.offered as f64)
}

/// Margin of 11.996 dB: `exp(-10^(-M/10))` with Rayleigh fading, and the gamma law with Nakagami. 16 000 frames in four runs.
#[test]
fn the_share_of_frames_that_arrive_over_fading_links_is_the_closed_form() {
    let margin_db = 85.06 - 40.0 - 20.0 * 45.0_f64.log10();
    let level = 10_f64.powf(-margin_db / 10.0);
    let gamma_two = 1.0 - (-2.0 * level).exp() * (1.0 + 2.0 * level);
    for (m, lost) in [(1.0, 1.0 - (-level).exp()), (2.0, gamma_two)] {
        let scenario = shipped("fading/blocks.toml").with("channel.fading.law.nakagami.m", m).expect("a setting");
        let (mut received, mut offered) = (0.0, 0.0);
        for seed in 1..=4 {
            let (share, count) = prr(&scenario.with("seed", seed).expect("a seed"));
            (received, offered) = (received + share * count, offered + count);
        }
        // Five standard errors: a false alarm in 1.7 million runs with other seeds. Some of 4000 frames overlap with others.
        let error = 5.0 * (lost * (1.0 - lost) / offered).sqrt();
        let found = 1.0 - received / offered;
        assert!((found - lost).abs() < error + 0.001, "m {m}: {found} lost, not {lost}");
        let link = explain_link(&scenario, "n0", "sink", None).expect("a link");
        let [forth, _] = link.directions.expect("both in reach");
        assert!((forth.reception.probability_over_shadowing - (1.0 - lost)).abs() < 1e-6);
        assert!((forth.reception.probability - 1.0).abs() < 1e-12);
    }
}

#[test]
fn bursts_lose_their_share_of_single_frames_and_retries_within_a_burst() {
    let scenario = shipped("fading/bursts.toml");
    let (alone, _) = prr(&scenario.with("traffic.poisson.acknowledged", false).expect("a setting"));
    // 6000 s of links with stays of 12 s: about 1000 independent pieces, so a standard error of 0.013.
    assert!((alone - 0.841_667).abs() < 0.06, "{alone}");
    // Four tries of one burst: 1 - 0.07992 - what the acknowledgements lose; with independent losses at least 0.99 (1 - 0.29^4).
    let (retried, _) = prr(&scenario);
    assert!(retried > alone && retried < 0.95, "{retried}");
    let short = scenario.with("channel.bursts.good_s", 0.005).expect("a setting");
    let (drawn_anew, _) = prr(&short.with("channel.bursts.bad_s", 0.001).expect("a setting"));
    assert!(drawn_anew > 0.985, "{drawn_anew}");
}

#[test]
fn the_fade_of_a_link_is_what_receivers_hear_and_what_is_explained() {
    // Without shadowing, the strength of a reception is the power of the link with its fade.
    let scenario = shipped("fading/survey.toml").with("channel.shadowing.sigma_db", 0.0).expect("a setting");
    let scenario = scenario.with("maps", "[]").expect("no maps");
    let run = sextant::run(&scenario, &mut (), &Unwatched).expect("a run");
    let survey = run.survey().expect("a survey");
    let log = survey.log();
    let nodes = &scenario.world().nodes;
    let mut fades = Vec::new();
    for reception in log.receptions().iter().step_by(23) {
        let place = log.stops()[reception.stop as usize].position;
        let node = &nodes[reception.node.index()];
        let without_dbm = -10.0 - 40.0 - 30.0 * node.position.distance_m(place).log10();
        fades.push(reception.rssi_dbm.expect("a strength") - without_dbm);
    }
    // At least a few of them are deep, and some are gains.
    assert!(fades.len() > 20);
    assert!(fades.iter().any(|&fade| fade < -5.0) && fades.iter().any(|&fade| fade > 2.0), "{fades:?}");
    // The robot's first stop is at its start, where `explain_link` has it.
    let at_start = log.receptions().iter().find(|reception| reception.stop == 0 && reception.received > 1);
    let heard = at_start.expect("a node is heard at the start");
    let name = &nodes[heard.node.index()].name;
    let link = explain_link(&scenario, name, "robot", None).expect("a link");
    let [forth, back] = link.directions.expect("both in reach");
    assert_eq!(forth.received_dbm, back.received_dbm);
    let explained_dbm = forth.received_dbm.expect("a power");
    assert!((explained_dbm - heard.rssi_dbm.expect("a strength")).abs() < 1e-9, "{explained_dbm} {heard:?}");
}

#[test]
fn channels_that_are_far_apart_fade_apart_and_near_ones_alike() {
    let gain_db = |scenario: &Scenario, network: &str| {
        let link = explain_link(scenario, "n0", "sink", Some(network)).expect("a link");
        link.fading.expect("fading").draw_db.expect("for good")
    };
    let scenario = Scenario::parse(CHANNELS).expect("a scenario");
    let flat = scenario.with("channel.fading.delay_spread_ns", 0.0).expect("a setting");
    let (mut apart, mut alike, mut deep, mut both) = (0.0, 0.0, 0, 0);
    for seed in 0..400 {
        let of = |scenario: &Scenario| {
            let scenario = scenario.with("seed", seed).expect("a seed");
            [gain_db(&scenario, "low"), gain_db(&scenario, "high")]
        };
        let ([low, high], [flat_low, flat_high]) = (of(&scenario), of(&flat));
        apart += (low - high).abs();
        alike += (flat_low - flat_high).abs();
        deep += u32::from(low < -10.0);
        both += u32::from(low < -10.0 && high < -10.0);
    }
    // Two independent Rayleigh gains differ by 6 dB on average.
    assert!(apart / 400.0 > 4.5 && alike < 1e-9, "{apart} {alike}");
    // A hop to the other channel leaves nearly all deep fades: 9 % of 38.
    assert!((20..60).contains(&deep) && both * 4 < deep, "{both} of {deep}");
}

#[test]
fn measured_links_deliver_their_shares_at_their_strengths() {
    let folder = tempfile::tempdir().expect("a folder");
    let rows = "t_s,from,to,prr,rssi_dbm\n0,a,sink,0.7,-95\n2000,a,sink,0.2,-95\n0,b,sink,,-60\n0,c,sink,,-89\n";
    std::fs::write(folder.path().join("links.csv"), rows).expect("a file");
    let scenario = folder.path().join("measured.toml");
    let text = r#"
name = "measured"
duration_s = 4000.0
[world.nodes.explicit]
positions_m = [[900.0, 0.0], [0.0, 900.0], [3.0, 3.0], [1.0, 1.0]]
names = ["a", "b", "c", "d"]
[[sinks]]
name = "sink"
position_m = [0.0, 0.0]
[radio]
tx_power_dbm = 0.0
sensitivity_dbm = -85.0
[channel.path_loss.log_distance]
exponent = 3.0
[link_trace]
file = "links.csv"
[traffic.poisson]
mpdu_octets = 20
rate_per_s = 1.0
"#;
    std::fs::write(&scenario, text).expect("a file");
    let scenario = Scenario::load(&scenario).expect("a scenario");
    let run = sextant::run(&scenario, &mut (), &Unwatched).expect("a run");
    let packets = &run.survey().expect("a simulation").networks[usize::from(NetworkId(0).0)].packets;
    let share = |node: usize| packets[node].received as f64 / packets[node].offered as f64;
    // Half of the time each: five standard errors of 4000 frames, and some collisions.
    assert!((share(0) - 0.45).abs() < 0.045, "{}", share(0));
    // A strength goes through the receiver; without a row there is no link, however near the nodes are.
    assert!(share(1) > 0.99 && share(2) < 1e-9 && share(3) < 1e-9, "{} {} {}", share(1), share(2), share(3));
    let link = explain_link(&scenario, "b", "sink", None).expect("a link");
    let [forth, back] = link.directions.expect("measured");
    assert_eq!(forth.received_dbm, Some(-60.0));
    assert_eq!((back.received_dbm, back.reception.probability), (None, 0.0));
    let motions = "[{ nodes.names = [\"d\"], motion.waypoints = { places_m = [[1.0, 1.0], [2.0, 1.0]], speed_m_per_s = 1.0 } }]";
    let moving = scenario.with("world.motions", motions).expect("a motion");
    let is_warned = |scenario: &Scenario| {
        sextant::forecast::warnings(scenario).iter().any(|warning| warning.key == "world.motions")
    };
    assert!(is_warned(&moving) && !is_warned(&scenario), "links with rows do not move");
    let others = scenario.with("link_trace.others", "\"law\"").expect("a setting");
    let run = sextant::run(&others, &mut (), &Unwatched).expect("a run");
    let near = run.survey().expect("a simulation").networks[0].packets[3];
    assert!(near.received * 10 > near.offered * 9, "{near:?}");
}
