//! Networks with slots on the command line: what is refused and why, captures that Wireshark decodes, and that nothing but the seed
//! decides.

use std::fs;

use serde_json::Value;

use crate::pcap::tshark::{dissect, tshark};
use crate::program::{Said, scenario, sets, sextant};

/// What `check` says of a scenario with these settings.
fn refused(name: &str, settings: &[&str]) -> String {
    sextant().arg("check").arg(scenario(name)).args(sets(settings)).output().expect("it starts").refusal()
}

#[test]
fn settings_of_slots_that_do_not_fit_are_refused_with_their_keys() {
    let minimal = "tsch/minimal-star.toml";
    for (setting, parts) in [
        ("mac.tsch.schedule.minimal.slotframe=0", ["mac.tsch.schedule.minimal.slotframe", "1 to 65535"]),
        ("mac.tsch.hopping=[16, 27]", ["mac.tsch.hopping[1]", "11 to 26"]),
        ("mac.tsch.max_retries=16", ["mac.tsch.max_retries", "0 to 15"]),
        ("mac.tsch.min_be=6", ["mac.tsch.min_be", "which is 5"]),
        ("mac.tsch.max_be=9", ["mac.tsch.max_be", "0 to 8"]),
        ("mac.tsch.queue_frames=0", ["mac.tsch.queue_frames", "1 to 10000"]),
        ("mac.tsch.timeslot.length_us=7000", ["mac.tsch.timeslot.length_us", "the longest frame"]),
        ("mac.tsch.timeslot.tx_offset_us=100", ["mac.tsch.timeslot.tx_offset_us", "at least 160"]),
        ("mac.tsch.timeslot.rx_offset_us=2100", ["mac.tsch.timeslot.rx_offset_us", "at most 2088"]),
        ("mac.tsch.timeslot.rx_wait_us=1", ["mac.tsch.timeslot.rx_wait_us", "is heard"]),
        ("mac.tsch.timeslot.tx_ack_delay_us=1", ["mac.tsch.timeslot.tx_ack_delay_us", "a turnaround"]),
        ("mac.tsch.timeslot.rx_ack_delay_us=999", ["mac.tsch.timeslot.rx_ack_delay_us", "at most 968"]),
        ("mac.tsch.timeslot.ack_wait_us=1", ["mac.tsch.timeslot.ack_wait_us", "is heard"]),
        ("mac.tsch.beacons.interval_s=0", ["mac.tsch.beacons.interval_s", "0.01"]),
        ("mac.tsch.synchronisation.joining=\"by_scan\"", ["mac.tsch.beacons", "nodes with `joining = \"by_scan\"`"]),
        ("mac.tsch.synchronisation.keep_alive_s=0", ["mac.tsch.synchronisation.keep_alive_s", "0.1"]),
        ("mac.tsch.synchronisation.lost_after_s=5", ["mac.tsch.synchronisation.lost_after_s", "12"]),
        ("radio.channel=20", ["radio.channel", "mac.tsch.hopping"]),
    ] {
        let message = refused(minimal, &[setting]);
        for part in parts {
            assert!(message.contains(part), "{setting}: no `{part}` in {message}");
        }
    }
}

#[test]
fn settings_of_msf_that_do_not_fit_are_refused_with_their_keys() {
    for (setting, allowed) in [
        ("slotframe=2", "3 to 65535"),
        ("max_num_cells=3", "4 to 10000"),
        ("lim_num_cells_used_high=101", "which is 100"),
        ("lim_num_cells_used_low=76", "which is 75"),
        ("waits=1", "max_num_cells"),
    ] {
        let setting = format!("mac.tsch.schedule.msf.{setting}");
        let message = refused("tsch/msf-star.toml", &[&setting]);
        let key = setting.split('=').next().expect("a key");
        assert!(message.contains(key) && message.contains(allowed), "{setting}: {message}");
    }
}

#[test]
fn a_slotframe_that_hops_over_a_part_of_the_channels_is_warned_of() {
    let check = |slots: u16| {
        let setting = format!("mac.tsch.schedule.minimal.slotframe={slots}");
        let output =
            sextant().arg("check").arg(scenario("tsch/minimal-star.toml")).args(["--set", &setting]).output();
        let output = output.expect("it starts");
        assert!(output.status.success());
        String::from_utf8(output.stderr).expect("text") + &String::from_utf8(output.stdout).expect("text")
    };
    let warned = check(100);
    assert!(warned.contains("mac.tsch.schedule.minimal.slotframe") && warned.contains("4 of the 16"), "{warned}");
    assert!(!check(101).contains("channels"), "{}", check(101));
}

#[test]
fn nodes_with_fast_clocks_and_nodes_that_die_end_in_a_summary() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, settings) in [
        ("tsch/orchestra-tree.toml", ["radio.clock_ppm=1000", "warm_up_s=0.0"]),
        ("tsch/joining.toml", ["radio.clock_ppm=1000", "faults.deaths={ share = 0.5, from_s = 50.0, to_s = 500.0 }"]),
        ("tsch/joining.toml", ["radio.clock_ppm=40", "faults.deaths={ share = 0.5, from_s = 50.0, to_s = 500.0 }"]),
    ] {
        let mut command = sextant();
        command.current_dir(folder.path()).arg("run").arg(scenario(name)).args(["--set", "duration_s=600.0"]);
        command.args(["--set", settings[0], "--set", settings[1], "--quiet", "--format", "json"]);
        let summary = command.output().expect("it starts").json();
        let mac = &summary["mac"];
        let lost = ["lost_collision", "lost_queue", "lost_signal", "out_of_range", "not_listened"];
        let ended = lost.iter().chain(&["delivered", "died", "pending"]);
        let sum: u64 = ended.filter_map(|key| mac[key].as_u64()).sum();
        assert_eq!(mac["offered"].as_u64(), Some(sum), "{mac}");
    }
}

#[test]
fn cells_and_rules_that_name_nobody_are_refused() {
    let cell = |cell: &str| refused("tsch/hopping.toml", &[&format!("mac.tsch.schedule.own.cells=[{cell}]")]);
    let message = cell("{ node = \"nobody\", peer = \"sink\", timeslot = 3, options = \"transmit\" }");
    assert!(message.contains("mac.tsch.schedule.own.cells[0].node"), "{message}");
    let message = cell("{ node = \"near\", peer = \"near\", timeslot = 3, options = \"transmit\" }");
    assert!(message.contains("another station than"), "{message}");
    let message = cell("{ node = \"near\", peer = \"sink\", timeslot = 17, options = \"transmit\" }");
    assert!(message.contains("cells[0].timeslot"), "{message}");
    let collection = "routing.tree={ collection = {} }";
    let message =
        refused("tsch/orchestra-tree.toml", &["mac.tsch.schedule.orchestra.unicast=\"sender_based\"", collection]);
    assert!(message.contains("receiver_based"), "{message}");
}

#[test]
fn robots_take_no_part_in_networks_with_slots() {
    let message = refused("smoke.toml", &["mac={ tsch = { schedule = { minimal = {} } } }"]);
    assert!(message.contains("mac.tsch") && message.contains("robots"), "{message}");
}

#[test]
fn the_same_seed_gives_the_same_slots_and_wireshark_decodes_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = |name: &str| -> Value {
        let mut command = sextant();
        command.current_dir(folder.path()).arg("run").arg(scenario("tsch/joining.toml"));
        command.args(["--set", "duration_s=300.0", "--format", "json", "--quiet"]);
        let output = command.args(["--pcap", &format!("{name}.pcap"), "--out", &format!("{name}.mcap")]).output();
        output.expect("it starts").json()
    };
    let summaries = ["a", "b"].map(run);
    for ending in ["pcap", "mcap"] {
        let octets = ["a", "b"].map(|name| fs::read(folder.path().join(format!("{name}.{ending}"))).expect("a file"));
        assert!(octets[0] == octets[1], "{ending}");
    }
    let slots = summaries[0]["mac"]["slots"].clone();
    assert_eq!(slots, summaries[1]["mac"]["slots"]);
    assert!(slots["joined"].as_u64().is_some_and(|joined| joined > 0), "{slots}");
    let Some(program) = tshark() else { return };
    let fields = [
        "wpan.frame_type",
        "wpan.version",
        "wpan.fcs_ok",
        "_ws.malformed",
        "wpan.tsch.asn",
        "wpan.header_ie.time_correction.value",
        "wpan-tap.ch_num",
    ];
    let rows = dissect(&program, &folder.path().join("a.pcap"), &fields);
    let (mut beacons, mut acknowledgements, mut channels) = (0, 0, std::collections::BTreeSet::new());
    for row in &rows {
        let [kind, version, fcs_ok, malformed, asn, correction, channel] = &row[..] else { panic!("{row:?}") };
        assert!(matches!(fcs_ok.as_str(), "1" | "True") && malformed.is_empty(), "{row:?}");
        assert_eq!(version, "2", "{row:?}");
        match kind.as_str() {
            "0x0000" | "0x0" | "0" => {
                assert!(!asn.is_empty(), "{row:?}");
                beacons += 1;
            }
            "0x0002" | "0x2" | "2" => {
                assert!(!correction.is_empty(), "{row:?}");
                acknowledgements += 1;
            }
            _ => {}
        }
        channels.insert(channel.clone());
    }
    assert!(beacons > 20 && acknowledgements > 20, "{beacons}, {acknowledgements}");
    assert_eq!(channels.len(), 16);
}
