//! Clocks that drift, and how nodes join.

use std::path::Path;

use sextant::Scenario;

use super::{assert_close, mac, network};

/// Nodes without traffic whose clocks are fast by 40 ppm against the sink: the guard of 1100 us lasts for 27.5 s.
fn drifting(folder: &Path, keep_alive_s: f64, duration_s: f64) -> Scenario {
    let rest = format!(
        "duration_s = {duration_s}
traffic.silent = {{}}
radio.groups = [{{ nodes.others = {{}}, clock_offset_ppm = 40.0 }}]
[mac.tsch]
schedule.minimal.slotframe = 101
synchronisation = {{ keep_alive_s = {keep_alive_s}, lost_after_s = 120.0 }}
"
    );
    network(folder, 1, None, &rest)
}

#[test]
fn keep_alive_frames_within_the_guard_time_keep_a_node_in_the_network() {
    let folder = tempfile::tempdir().expect("a folder");
    let kept = mac(&drifting(folder.path(), 20.0, 3600.0)).slots.expect("slots");
    assert_eq!((kept.lost, kept.joined, kept.transmit_unacknowledged), (0, 1, 0));
    // One each 90 to 100 % of 20 s, and the wait for its slot.
    assert!((170..=205).contains(&kept.transmit_acknowledged), "{kept:?}");
    // The first frame goes out after 27.5 s: too late to be heard, and so are all others.
    let late = mac(&drifting(folder.path(), 31.0, 3600.0)).slots.expect("slots");
    assert_eq!((late.lost, late.joined, late.transmit_acknowledged), (1, 0, 0));
    assert!(late.transmit_unacknowledged > 0, "{late:?}");
    // No charge was published for a scan.
    assert!(kept.mean_current_a.is_some() && late.mean_current_a.is_none(), "{late:?}");
    // In a network without beacons nobody comes back: it listens for ever, and the radio is on.
    assert_close(late.duty_cycle.expect("nodes"), (3600.0 - 120.0) / 3600.0, 0.01, "duty cycle");
}

#[test]
fn clocks_that_drift_without_beacons_are_a_warning() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = drifting(folder.path(), 20.0, 3600.0);
    let is_warned = |scenario: &Scenario| {
        sextant::forecast::warnings(scenario).iter().any(|warning| warning.key == "mac.tsch.beacons")
    };
    assert!(is_warned(&scenario));
    assert!(!is_warned(&scenario.with("mac.tsch.beacons.interval_s", 16.5).expect("beacons")));
    assert!(!is_warned(&scenario.with("radio.groups", "[]").expect("exact clocks")));
}

#[test]
fn a_guard_time_lasts_as_long_as_two_clocks_need_to_drift_apart() {
    let folder = tempfile::tempdir().expect("a folder");
    // A node that is corrected by nothing sends one frame, at this time. Its clock is early by 40 ppm of it: 1100 us after
    // 27.5 s. The frame goes out in the next slot with a cell, within 1.01 s.
    for (at_s, is_heard) in [(20.0, true), (25.9, true), (27.6, false), (40.0, false)] {
        let rest = format!(
            "duration_s = 100.0
traffic.once = {{ mpdu_octets = 30, at_s = {at_s}, acknowledged = true }}
mac.tsch = {{ max_retries = 0, schedule.minimal = {{}}, synchronisation = {{ keep_alive_s = 1000.0, lost_after_s = 2000.0 }} }}
radio.groups = [{{ nodes.others = {{}}, clock_offset_ppm = 40.0 }}]
"
        );
        let found = mac(&network(folder.path(), 1, None, &rest)).all;
        assert_eq!(found.delivered, u64::from(is_heard), "{at_s} s");
        assert_eq!(found.not_listened_by.asleep, u64::from(!is_heard), "{at_s} s");
    }
}

#[test]
fn packets_correct_the_clock_as_keep_alive_frames_do() {
    let folder = tempfile::tempdir().expect("a folder");
    let rest = "duration_s = 7200.0
traffic.periodic = { mpdu_octets = 30, interval_s = 10.0, jitter = 0.5, acknowledged = true }
mac.tsch = { max_retries = 7, schedule.minimal.slotframe = 7 }
";
    let scenario = network(folder.path(), 6, None, rest);
    let drifting = scenario.with("radio.clock_ppm", 40.0).expect("a clock");
    let (exact, drifting) = (mac(&scenario), mac(&drifting));
    for mac in [&exact, &drifting] {
        assert!(mac.all.prr > Some(0.9995), "{:?}", mac.all.prr);
    }
    assert_eq!(drifting.slots.map(|slots| slots.lost), Some(0));
    let delays = [&exact, &drifting].map(|mac| mac.all.delay_s.expect("delays").mean);
    assert_close(delays[1], delays[0], 0.1 * delays[0], "delay");
}

/// A node that scans hears beacons of one sink on the channel on which it listens: with C channels and a rate of beacons r, it waits
/// C / r on average.
#[test]
fn a_node_joins_after_as_many_beacons_as_there_are_channels_on_average() {
    let folder = tempfile::tempdir().expect("a folder");
    let rest = "duration_s = 4000.0
traffic.silent = {}
[mac.tsch]
schedule.minimal.slotframe = 13
beacons.interval_s = 4.0
synchronisation.joining = \"by_scan\"
";
    let scenario = network(folder.path(), 1, None, rest);
    let rounds = 300;
    let mut sum_s = 0.0;
    for seed in 0..rounds {
        let slots = mac(&scenario.with("seed", seed).expect("a seed")).slots.expect("slots");
        assert_eq!((slots.joined, slots.joined_by_scan), (1, Some(1)), "{slots:?}");
        sum_s += slots.join_s.expect("it joined");
    }
    // A beacon each 3.5 s, drawn from 3 to 4 s, of 16 channels. The wait is nearly exponential.
    let expected_s = 16.0 * 3.5;
    let mean_s = sum_s / rounds as f64;
    assert_close(mean_s, expected_s, 4.0 * expected_s / (rounds as f64).sqrt(), "time to join");
}

#[test]
fn nodes_join_over_several_hops_and_come_back_after_they_were_lost() {
    let folder = tempfile::tempdir().expect("a folder");
    let links = [("n0", "sink", 1.0), ("sink", "n0", 1.0), ("n0", "n1", 1.0), ("n1", "n0", 1.0)];
    let rest = "duration_s = 4000.0
traffic.silent = {}
[mac.tsch]
schedule.orchestra = {}
beacons.interval_s = 2.0
synchronisation.joining = \"by_scan\"
";
    let scenario = network(folder.path(), 2, Some(&links), rest);
    let slots = mac(&scenario).slots.expect("slots");
    assert_eq!((slots.joined, slots.joined_by_scan, slots.lost), (2, Some(2), 0), "{slots:?}");
    // With a clock so fast that it is lost between two corrections, a node scans and joins again.
    let fast = scenario.with("radio.clock_ppm", 1000.0).expect("a clock");
    let fast = fast.with("mac.tsch.synchronisation.keep_alive_s", 30.0).expect("a period");
    let slots = mac(&fast).slots.expect("slots");
    assert!(slots.lost > 2, "{slots:?}");
    assert!(slots.duty_cycle.is_some_and(|share| share > 0.05), "{slots:?}");
    // One that was in from the start comes back, and has not joined.
    let at_start = fast.with("mac.tsch.synchronisation.joining", "at_start").expect("a setting");
    let slots = mac(&at_start).slots.expect("slots");
    assert!(slots.lost > 0 && slots.join_s.is_none() && slots.joined_by_scan.is_none(), "{slots:?}");
}

/// The mean time is of the nodes that joined; one that nobody hears never does, and the count says so.
#[test]
fn the_time_to_join_is_of_as_many_nodes_as_joined_by_a_scan() {
    let folder = tempfile::tempdir().expect("a folder");
    let links = [("n0", "sink", 1.0), ("sink", "n0", 1.0), ("n2", "sink", 1.0), ("sink", "n2", 1.0)];
    let rest = "duration_s = 2000.0
traffic.silent = {}
[mac.tsch]
schedule.minimal.slotframe = 13
beacons.interval_s = 2.0
synchronisation.joining = \"by_scan\"
";
    let scenario = network(folder.path(), 3, Some(&links), rest);
    let run = sextant::run(&scenario, &mut (), &sextant::Unwatched).expect("a run");
    let slots = run.summary().mac.clone().expect("a sink").slots.expect("slots");
    assert_eq!((slots.joined, slots.joined_by_scan), (2, Some(2)), "{slots:?}");
    let mut printed = Vec::new();
    sextant::summary::write(run.summary(), &mut printed).expect("memory");
    let printed = String::from_utf8(printed).expect("text");
    assert!(printed.contains("of 2 of 3 that scanned"), "{printed}");
    // At the start all are in the network: nobody scanned.
    let at_start = scenario.with("mac.tsch.synchronisation.joining", "at_start").expect("a setting");
    let slots = mac(&at_start).slots.expect("slots");
    assert_eq!((slots.joined, slots.joined_by_scan), (3, None), "{slots:?}");
}
