//! RPL on the command line: messages and fragments that Wireshark decodes, a tree over slots in time, and that nothing but the
//! seed decides.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::pcap::tshark::{dissect, tshark};
use crate::program::{Said, scenario, sets, sextant};

/// Runs a scenario with these settings, with a capture and a recording of this name: its summary.
fn run(folder: &Path, name: &str, shipped: &str, threads: &str, settings: &[&str]) -> Value {
    let mut command = sextant();
    command.current_dir(folder).arg("run").arg(scenario(shipped)).args(sets(settings));
    let (pcap, mcap) = (format!("{name}.pcap"), format!("{name}.mcap"));
    command.args(["--pcap", &pcap, "--out", &mcap, "--threads", threads, "--format", "json", "--quiet"]);
    command.output().expect("it starts").json()
}

#[test]
fn the_same_seed_gives_the_same_octets_and_wireshark_decodes_all_messages() {
    let folder = tempfile::tempdir().expect("a folder");
    let settings = ["duration_s=700.0", "recording.packets=true"];
    let summaries = [("a", "1"), ("b", "2")]
        .map(|(name, threads)| run(folder.path(), name, "routing/rpl-udp.toml", threads, &settings));
    assert_eq!(summaries[0]["routing"], summaries[1]["routing"]);
    for ending in ["pcap", "mcap"] {
        let octets = ["a", "b"].map(|name| fs::read(folder.path().join(format!("{name}.{ending}"))).expect("a file"));
        assert!(octets[0] == octets[1], "{ending}");
    }
    let Some(program) = tshark() else { return };
    let fields = [
        "_ws.malformed",
        "wpan.fcs_ok",
        "icmpv6.type",
        "icmpv6.code",
        "icmpv6.rpl.dio.rank",
        "ipv6.routing.segleft",
        "wpan.frame_type",
    ];
    let rows = dissect(&program, &folder.path().join("a.pcap"), &fields);
    let mut messages: BTreeMap<String, u32> = BTreeMap::new();
    let (mut routes, mut ranks) = (0, Vec::new());
    for row in &rows {
        let [malformed, fcs_ok, kind, code, rank, left, _] = &row[..] else { panic!("{row:?}") };
        assert!(malformed.is_empty() && matches!(fcs_ok.as_str(), "1" | "True"), "{row:?}");
        if kind == "155" {
            *messages.entry(code.clone()).or_default() += 1;
        }
        routes += u32::from(!left.is_empty());
        ranks.extend(rank.parse::<u32>().ok());
    }
    // DIO, DAO and DAO-ACK; the root has the least rank.
    assert!(["1", "2", "3"].iter().all(|code| messages.get(*code).is_some_and(|&count| count > 20)), "{messages:?}");
    assert!(routes > 20 && ranks.iter().min() == Some(&128), "{routes} routes");
}

/// All nodes are known to the root within 6 minutes, as Contiki-NG's tests ask of RPL over Orchestra. Their clocks follow the tree.
#[test]
fn over_slots_of_orchestra_the_root_knows_all_nodes_within_six_minutes() {
    let folder = tempfile::tempdir().expect("a folder");
    let summary = run(folder.path(), "a", "routing/rpl-orchestra.toml", "1", &["duration_s=1500.0"]);
    let routing = &summary["routing"];
    assert!(routing["rpl"]["routes_known_s"].as_f64().is_some_and(|known| known < 360.0), "{routing}");
    assert_eq!((&routing["rpl"]["most_routes"], &routing["without_way"]), (&Value::from(8), &Value::from(0)));
    assert!(routing["delivery"].as_f64().is_some_and(|share| share > 0.99), "{routing}");
    assert_eq!(summary["mac"]["slots"]["lost"], 0, "no clock drifts away from its parent's");
}

#[test]
fn wireshark_puts_fragments_together() {
    let folder = tempfile::tempdir().expect("a folder");
    let rpl = "routing.tree={ rpl = { mode = \"none\", probing_interval_s = 0.0 } }";
    let settings =
        [rpl, "duration_s=300.0", "mac.csma_unslotted.max_retries=7", "routing.fragments.packet_octets=200"];
    let summary = run(folder.path(), "a", "routing/fragments.toml", "1", &settings);
    let fragments = &summary["routing"]["fragments"];
    assert!(fragments["fragments"].as_u64().is_some_and(|count| count > 100), "{fragments}");
    let Some(program) = tshark() else { return };
    let fields = ["6lowpan.reassembled.length", "6lowpan.frag.size", "wpan.fcs_ok"];
    let rows = dissect(&program, &folder.path().join("a.pcap"), &fields);
    // The sizes in fragments are those of the packets, and those that Wireshark completes have them.
    let sizes: Vec<&str> = rows.iter().map(|row| row[1].as_str()).filter(|size| !size.is_empty()).collect();
    assert!(sizes.len() > 100 && sizes.iter().all(|&size| size == "200"), "{sizes:?}");
}
