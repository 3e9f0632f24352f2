//! Networks whose stations sleep on the command line: what is refused and why, the best interval, captures that Wireshark decodes, and
//! that nothing but the seed decides.

use std::fs;

use serde_json::Value;

use crate::pcap::tshark::{dissect, tshark};
use crate::program::{Said, scenario, sets, sextant};

/// What `check` says of a scenario with these settings: whether it is good, and what was printed.
fn check(name: &str, settings: &[&str]) -> (bool, String) {
    let output = sextant().args(["check", "-v"]).arg(scenario(name)).args(sets(settings)).output();
    let (code, printed, message) = output.expect("it starts").all();
    (code == 0, printed + &message)
}

fn refused(name: &str, settings: &[&str], parts: &[&str]) {
    let (is_good, message) = check(name, settings);
    assert!(!is_good, "{message}");
    for part in parts {
        assert!(message.contains(part), "{settings:?}: no `{part}` in {message}");
    }
}

#[test]
fn settings_of_sleep_that_do_not_fit_are_refused_with_their_keys() {
    let contenders = "sleep/contenders.toml";
    for (setting, parts) in [
        ("mac.sleep.interval_s=0.01", ["mac.sleep.interval_s", "0.012768"]),
        ("mac.sleep.max_retries=16", ["mac.sleep.max_retries", "0 to 15"]),
        ("mac.sleep.max_backoffs=16", ["mac.sleep.max_backoffs", "0 to 15"]),
        ("mac.sleep.queue_frames=0", ["mac.sleep.queue_frames", "1 to 10000"]),
        ("mac.sleep.allowed_ppm=-1", ["mac.sleep.allowed_ppm", "1000"]),
        ("mac.sleep.wake_up.repeated_data.gap_us=399", ["mac.sleep.wake_up.repeated_data.gap_us", "400"]),
        ("mac.sleep.wake_up={ x_mac = { gap_us = 400 } }", ["mac.sleep.wake_up.x_mac", "gap_us"]),
        ("traffic.poisson.mpdu_octets=18", ["traffic.poisson.mpdu_octets", "at least 19"]),
    ] {
        refused(contenders, &[setting], &parts);
    }
    refused("smoke.toml", &["mac={ sleep = { wake_up = { x_mac = {} } } }"], &["mac.sleep", "robots"]);
    refused(
        "sleep/csl-corridor.toml",
        &["routing.tree={ collection = {} }"],
        &["mac.sleep", "routing.tree.collection", "an interval each"],
    );
}

#[test]
fn the_best_interval_is_named_where_receivers_have_to_be_woken() {
    let (is_good, text) = check("sleep/x-mac.toml", &[]);
    // 56.4 mW for 1504 us; 54.4 mW on average in a period of strobes; a packet a minute.
    assert!(
        is_good && text.contains("best 0.432 s, where checks and waking take 392.8 uW; 397.0 uW with 0.500 s"),
        "{text}"
    );
    for settings in [["mac.sleep.sinks=\"always_on\""], ["mac.sleep.wake_up={ csl = { phases = \"learned\" } }"]] {
        let (is_good, text) = check("sleep/x-mac.toml", &settings);
        assert!(is_good && !text.contains("wake-up interval"), "{text}");
    }
}

#[test]
fn checks_that_miss_what_could_be_received_are_warned_of() {
    let (_, good) = check("sleep/contenders.toml", &[]);
    assert!(!good.contains("cca_threshold_dbm"), "{good}");
    let (is_good, text) = check("sleep/contenders.toml", &["radio.cca_threshold_dbm=-80"]);
    assert!(is_good && text.contains("`radio.cca_threshold_dbm`") && text.contains("wake nobody"), "{text}");
    // A window receives whatever is above the sensitivity.
    let (_, window) = check("sleep/x-mac.toml", &[]);
    assert!(!window.contains("cca_threshold_dbm"), "{window}");
}

fn run(folder: &std::path::Path, name: &str, from: &str, settings: &[&str]) -> Value {
    let mut command = sextant();
    command.current_dir(folder).arg("run").arg(scenario(from)).args(["--format", "json", "--quiet"]);
    command.args(sets(settings)).args(["--pcap", &format!("{name}.pcap"), "--out", &format!("{name}.mcap")]);
    command.output().expect("it starts").json()
}

#[test]
fn each_packet_ends_once_also_with_fast_clocks_and_nodes_that_die() {
    let folder = tempfile::tempdir().expect("a folder");
    for wake_up in ["x_mac = {}", "repeated_data = { phases = \"learned\" }", "csl = {}"] {
        for acknowledged in ["true", "false"] {
            let wake_up = format!("mac.sleep.wake_up={{ {wake_up} }}");
            let acknowledged = format!("traffic.poisson.acknowledged={acknowledged}");
            let settings = [
                wake_up.as_str(),
                &acknowledged,
                "traffic.poisson.rate_per_s=1",
                "duration_s=400",
                "warm_up_s=50",
                "radio.clock_ppm=1000",
                "faults.deaths={ share = 0.5, from_s = 60.0, to_s = 300.0 }",
            ];
            let summary = run(folder.path(), "a", "sleep/contenders.toml", &settings);
            let mac = &summary["mac"];
            let ended = [
                "delivered",
                "lost_collision",
                "lost_channel_access",
                "lost_queue",
                "lost_signal",
                "out_of_range",
                "not_listened",
                "died",
                "pending",
            ];
            let sum: u64 = ended.iter().filter_map(|key| mac[key].as_u64()).sum();
            assert_eq!(mac["offered"].as_u64(), Some(sum), "{wake_up}: {mac}");
            let share = mac["sleep"]["duty_cycle"].as_f64().expect("a share");
            assert!((0.0..=1.0).contains(&share), "{share}");
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_octets_and_wireshark_decodes_the_frames_of_csl() {
    let folder = tempfile::tempdir().expect("a folder");
    let settings = ["duration_s=600"];
    let summaries = ["a", "b"].map(|name| run(folder.path(), name, "sleep/csl-corridor.toml", &settings));
    for ending in ["pcap", "mcap"] {
        let octets = ["a", "b"].map(|name| fs::read(folder.path().join(format!("{name}.{ending}"))).expect("a file"));
        assert!(octets[0] == octets[1], "{ending}");
    }
    assert_eq!(summaries[0]["mac"]["sleep"], summaries[1]["mac"]["sleep"]);
    let Some(program) = tshark() else { return };
    let fields = [
        "wpan.frame_type",
        "wpan.fcs_ok",
        "_ws.malformed",
        "wpan.header_ie.csl.phase",
        "wpan.header_ie.csl.period",
        "wpan.header_ie.csl.rendezvous_time",
    ];
    let rows = dissect(&program, &folder.path().join("a.pcap"), &fields);
    let (mut wake_ups, mut phases) = (0, 0);
    for row in &rows {
        let [kind, fcs_ok, malformed, phase, period, rendezvous] = &row[..] else { panic!("{row:?}") };
        assert!(matches!(fcs_ok.as_str(), "1" | "True") && malformed.is_empty(), "{row:?}");
        if matches!(kind.as_str(), "0x0005" | "0x5" | "5") {
            assert!(!rendezvous.is_empty(), "{row:?}");
            wake_ups += 1;
        }
        if !phase.is_empty() {
            // 0.5 s in units of 160 us.
            assert_eq!(period, "3125", "{row:?}");
            phases += 1;
        }
    }
    assert!(wake_ups > 100 && phases > 20, "{wake_ups}, {phases}");
}
