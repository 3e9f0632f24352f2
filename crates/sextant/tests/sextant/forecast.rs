//! What `check -v` says before a run is what the run does, or it says what it leaves out.

use sextant::{Forecast, Scenario, Unwatched};

use crate::programs::shipped;

/// The scenario without a warm-up and a sweep, for so long.
fn for_so_long(name: &str, duration_s: f64, set: &[&str]) -> Scenario {
    let mut all = vec!["warm_up_s=0".to_owned(), format!("duration_s={duration_s}"), "sweep={}".to_owned()];
    all.extend(set.iter().map(|&set| set.to_owned()));
    shipped(name).with_all(&all, None).expect("a scenario")
}

/// Frames of the forecast, and transmissions of the packets in the run.
fn frames(scenario: &Scenario) -> (f64, f64) {
    let cost = Forecast::of(scenario).cost.expect("a duration");
    let run = sextant::run(scenario, &mut (), &Unwatched).expect("a run");
    let summary = run.summary();
    let sent = match &summary.routing {
        Some(routing) => routing.transmissions,
        None => summary.mac.as_ref().expect("sinks").all.transmissions,
    };
    (cost.frames, sent as f64)
}

#[test]
fn the_frames_of_a_forecast_are_those_of_the_run_over_one_hop_and_over_several() {
    let answers = ["routing.tree={ shortest = { metric = \"hops\" } }", "routing.to=\"sink_and_back\""];
    for (name, duration_s, set) in [
        ("mac/acknowledged-star.toml", 100.0, &[][..]),
        ("mac/poisson-star.toml", 100.0, &[]),
        ("routing/given-tree.toml", 3600.0, &[]),
        ("routing/requests-and-answers.toml", 1200.0, &[]),
        ("routing/collection-tree.toml", 600.0, &answers),
        ("routing/rpl-udp.toml", 1200.0, &[]),
        ("routing/rpl-node-to-node.toml", 1800.0, &[]),
        ("routing/fragments.toml", 3600.0, &[]),
        ("tsch/orchestra-tree.toml", 3600.0, &["mac.tsch.schedule.orchestra.unicast=\"sender_based\""]),
        ("sleep/csl-corridor.toml", 7200.0, &[]),
    ] {
        let (expected, sent) = frames(&for_so_long(name, duration_s, set));
        assert!((sent / expected - 1.0).abs() < 0.2, "{name}: {sent}, not {expected}");
    }
}

#[test]
fn a_forecast_says_what_it_leaves_out() {
    for (name, left_out) in [
        ("mac/poisson-star.toml", &[][..]),
        ("mac/acknowledged-star.toml", &["acknowledgements", "tries after collisions"]),
        ("routing/collection-tree.toml", &["acknowledgements", "tries after collisions", "messages of the tree"]),
        ("tsch/orchestra-tree.toml", &["acknowledgements", "tries after collisions", "what keeps slots"]),
        ("sleep/csl-corridor.toml", &["acknowledgements", "tries after collisions", "what wakes receivers"]),
    ] {
        let forecast = Forecast::of(&shipped(name));
        let cost = forecast.cost.expect("a duration");
        assert_eq!(cost.without, left_out, "{name}");
        let network = &forecast.networks[0];
        let has_one_hop = name.starts_with("mac/");
        assert_eq!((network.load.is_some(), network.load_unknown.is_some()), (has_one_hop, !has_one_hop), "{name}");
        assert_eq!((cost.events.is_some(), cost.cpu_s.is_some()), (has_one_hop, has_one_hop), "{name}");
    }
}

#[test]
fn the_events_of_a_star_with_acknowledgements_are_forecast() {
    let scenario = for_so_long("mac/acknowledged-star.toml", 100.0, &[]);
    let events = Forecast::of(&scenario).cost.expect("a duration").events.expect("one hop");
    let run = sextant::run(&scenario, &mut (), &Unwatched).expect("a run");
    let found = run.summary().simulation.as_ref().expect("a simulation").events as f64;
    assert!((found / events - 1.0).abs() < 0.2, "{found}, not {events}");
}

/// A frame that is acknowledged occupies the channel for 1792 us, and its acknowledgement for 352 us.
#[test]
fn the_load_has_acknowledgements_and_the_tries_of_weak_links() {
    let load = |name: &str, set: &[&str]| {
        let forecast = Forecast::of(&for_so_long(name, 100.0, set));
        forecast.networks[0].load.expect("one hop").mean_erlang
    };
    let all_hear = 20.0 * 4.0;
    assert!((load("mac/acknowledged-star.toml", &[]) - all_hear * 2144e-6).abs() < 1e-3);
    let broadcasts = load("mac/acknowledged-star.toml", &["traffic.periodic.acknowledged=false"]);
    assert!((broadcasts - all_hear * 1792e-6).abs() < 1e-3, "{broadcasts}");
}
