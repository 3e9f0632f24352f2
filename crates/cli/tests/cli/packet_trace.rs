//! The packet trace agrees with the summary, which counts without it, and with the frames on air.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::program::{Said, Table, scenario, sets, sextant, summary, table};

/// A run with its packet trace, as tables.
struct Traced {
    summary: Value,
    packets: Table,
    transmissions: Table,
    assessments: Table,
    folder: tempfile::TempDir,
}

fn succeeds(command: &mut Command) -> String {
    command.output().expect("the program starts").printed()
}

impl Traced {
    fn of(file: &Path, set: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("there is room");
        let path = |name: &str| folder.path().join(name);
        let mut command = sextant();
        command.args(["run", "--quiet", "--set", "recording.packets=true"]).arg(file);
        command.arg("--out").arg(path("run.mcap")).arg("--summary").arg(path("run.json"));
        succeeds(command.args(sets(set)));
        succeeds(sextant().arg("export").arg(path("run.mcap")).arg("--out").arg(path("tables")));
        let tables = path("tables");
        Self {
            summary: summary(&path("run.json")),
            packets: table(&tables.join("mac_packets.csv")),
            transmissions: table(&tables.join("mac_transmissions.csv")),
            assessments: table(&tables.join("mac_assessments.csv")),
            folder,
        }
    }

    /// The packets of a network that count.
    fn counted(&self, network: &str) -> Vec<&BTreeMap<String, String>> {
        let of_network = self.packets.iter().filter(|packet| packet["network"] == network);
        of_network.filter(|packet| packet["counted"] == "1").collect()
    }

    /// Number of attempts of a packet in which it was on air: copies share theirs.
    fn attempts(&self) -> BTreeMap<&str, u64> {
        let rows: BTreeSet<_> = self.transmissions.iter().map(|row| (&*row["packet"], &*row["attempt"])).collect();
        let mut counts = BTreeMap::new();
        rows.into_iter().for_each(|(packet, _)| *counts.entry(packet).or_default() += 1);
        counts
    }

    /// Number of rows of `table` of a packet.
    fn of_packet(table: &Table) -> BTreeMap<&str, u64> {
        let mut counts = BTreeMap::new();
        table.iter().for_each(|row| *counts.entry(row["packet"].as_str()).or_default() += 1);
        counts
    }

    /// Compares all that the trace and the traffic of a network in the summary have in common.
    #[track_caller]
    fn agrees_with(&self, traffic: &Value) {
        let network = traffic["network"].as_str().unwrap_or_default();
        let packets = self.counted(network);
        let count = |key: &str| traffic[key].as_u64().unwrap_or_else(|| panic!("{key} in {traffic}"));
        let fate = |fate: &str| packets.iter().filter(|packet| packet["fate"] == fate).count() as u64;
        let ends = |end: &str| packets.iter().filter(|packet| packet["end"] == end).count() as u64;
        assert_eq!(packets.len() as u64, count("offered"));
        assert!(count("offered") > 20, "{traffic}");
        assert_eq!(fate("received"), count("delivered"));
        for lost in [
            "lost_collision",
            "lost_signal",
            "out_of_range",
            "not_listened",
            "lost_channel_access",
            "lost_queue",
            "died",
            "pending",
        ] {
            // It is absent if there are none.
            let told = if lost == "died" { traffic[lost].as_u64().unwrap_or(0) } else { count(lost) };
            assert_eq!(fate(lost), told, "{lost}");
        }
        for deafness in ["transmitting", "asleep", "off"] {
            let deaf = packets.iter().filter(|packet| packet["deafness"] == deafness).count() as u64;
            assert_eq!(deaf, traffic["not_listened_by"][deafness].as_u64().unwrap_or(0), "{deafness}");
        }
        assert_eq!(ends("no_acknowledgement"), count("no_acknowledgement"));
        assert_eq!(ends("channel_access_failure"), count("channel_access_failures"));
        let (sent, sensed) = (self.attempts(), Self::of_packet(&self.assessments));
        let rows = |of: &BTreeMap<&str, u64>, packet: &BTreeMap<String, String>| {
            of.get(packet["packet"].as_str()).copied().unwrap_or(0)
        };
        let (mut transmissions, mut assessments, mut on_air) = (0, 0, 0);
        for packet in &packets {
            assert_eq!(rows(&sent, packet).to_string(), packet["transmissions"]);
            assert_eq!(rows(&sensed, packet).to_string(), packet["assessments"]);
            transmissions += rows(&sent, packet);
            on_air += u64::from(rows(&sent, packet) > 0);
            if packet["end"] != "pending" {
                assessments += rows(&sensed, packet);
            }
        }
        assert_eq!(transmissions, count("transmissions"));
        assert_eq!(assessments, count("backoffs"));
        assert_eq!(on_air, count("sent"));
        assert_eq!(transmissions - on_air, count("retries"));
        let seconds = |packet: &BTreeMap<String, String>, key: &str| packet[key].parse::<f64>().ok();
        let delay = |packet: &&BTreeMap<String, String>| {
            Some(seconds(packet, "delivered_s")? - seconds(packet, "offered_s").expect("a time"))
        };
        let mut delays: Vec<f64> = packets.iter().filter_map(delay).collect();
        delays.sort_by(f64::total_cmp);
        assert_eq!(delays.len() as u64, count("delivered"));
        if !delays.is_empty() {
            let mean = delays.iter().sum::<f64>() / delays.len() as f64;
            let told = |key: &str| traffic["delay_s"][key].as_f64().expect("a number");
            assert!((mean - told("mean")).abs() < 1e-9, "{mean}, not {}", told("mean"));
            for (key, percent) in [("p50", 50), ("p90", 90), ("p99", 99)] {
                let exact = delays[(percent * delays.len()).div_ceil(100).max(1) - 1];
                assert!((exact - told(key)).abs() < 1e-9, "{key}: {exact}, not {}", told(key));
            }
        }
        self.causes_are_consistent();
    }

    /// The outcome of a packet is the best of its transmissions, and what is known of each fits its outcome.
    fn causes_are_consistent(&self) {
        const BEST_FIRST: [&str; 5] = ["received", "collided", "weak", "out_of_range", "not_listened"];
        const FATES: [&str; 5] = ["received", "lost_collision", "lost_signal", "out_of_range", "not_listened"];
        let mut best: BTreeMap<&str, usize> = BTreeMap::new();
        for sent in &self.transmissions {
            let outcome = BEST_FIRST.iter().position(|outcome| *outcome == sent["outcome"]).expect("a known outcome");
            let so_far = best.entry(&sent["packet"]).or_insert(outcome);
            *so_far = outcome.min(*so_far);
            assert!(sent["outcome"] == "collided" || sent["collided_with"].is_empty(), "{sent:?}");
            assert_eq!(sent["outcome"] == "not_listened", !sent["deafness"].is_empty(), "{sent:?}");
            assert!(sent["acknowledged_s"].is_empty() || sent["outcome"] == "received", "{sent:?}");
        }
        for packet in self.packets.iter().filter(|packet| packet["kind"] == "data" && packet["end"] != "pending") {
            let fate = best.get(packet["packet"].as_str()).map(|&outcome| FATES[outcome]);
            let unsent = ["lost_channel_access", "lost_queue"].contains(&packet["fate"].as_str());
            assert_eq!(fate, (!unsent).then_some(packet["fate"].as_str()), "{packet:?}");
        }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }
}

fn shipped() -> PathBuf {
    scenario("mac/packet-trace.toml")
}

#[test]
fn the_trace_of_hidden_nodes_with_acknowledgements_is_the_summary_and_the_capture() {
    let traced = Traced::of(&shipped(), &["recording.frames=true", "duration_s=4.0"]);
    traced.agrees_with(&traced.summary["mac"]);
    // The frames on air are told by another way, and are those of a capture.
    let frames = table(&traced.path("tables/mac_frames.csv"));
    let key = |row: &BTreeMap<String, String>, station: &str| (row["start_s"].clone(), station.to_owned());
    let packets: BTreeMap<&str, &str> =
        traced.packets.iter().map(|packet| (packet["packet"].as_str(), packet["source"].as_str())).collect();
    let mut sent: Vec<_> = (traced.transmissions.iter())
        .map(|sent| (key(sent, packets[sent["packet"].as_str()]), sent["outcome"].clone(), sent["power_dbm"].clone()))
        .collect();
    // Frame control of a data frame: its first octet ends with 1.
    let data = frames.iter().filter(|frame| frame["mpdu"].as_bytes()[1] == b'1');
    let mut on_air: Vec<_> = data
        .map(|frame| (key(frame, &frame["source"]), frame["outcome"].clone(), frame["power_dbm"].clone()))
        .collect();
    sent.sort();
    on_air.sort();
    assert!(sent.len() > 100, "{}", sent.len());
    assert_eq!(sent, on_air);
    // Stations of the two groups do not hear each other, and no station collides with itself.
    let with: Vec<_> = (traced.transmissions.iter().filter(|sent| !sent["collided_with"].is_empty()))
        .map(|sent| (packets[sent["packet"].as_str()].to_owned(), sent["collided_with"].clone()))
        .collect();
    assert!(with.len() > 10 && with.iter().all(|(source, other)| source != other), "{with:?}");
    let acknowledged = traced.transmissions.iter().filter(|sent| !sent["acknowledged_s"].is_empty()).count();
    let ended = traced.packets.iter().filter(|packet| packet["end"] == "acknowledged").count();
    assert_eq!(acknowledged, ended);
}

#[test]
fn the_trace_of_full_queues_and_a_warm_up_is_the_summary() {
    let set =
        ["mac.csma_unslotted.queue_frames=0", "traffic.poisson.rate_per_s=60.0", "duration_s=3.0", "warm_up_s=1.0"];
    let traced = Traced::of(&shipped(), &set);
    assert!(traced.packets.iter().any(|packet| packet["counted"] == "0"));
    assert!(traced.packets.iter().any(|packet| packet["fate"] == "lost_queue"));
    traced.agrees_with(&traced.summary["mac"]);
}

/// A packet is sent in copies until its receiver wakes: those of one attempt are one transmission.
#[test]
fn the_trace_of_copies_that_wake_a_receiver_is_the_summary() {
    let trace = Traced::of(&scenario("sleep/contenders.toml"), &["duration_s=600", "warm_up_s=60"]);
    let attempts: u64 = trace.attempts().values().sum();
    assert!(trace.transmissions.len() as u64 > 2 * attempts, "{attempts}");
    trace.agrees_with(&trace.summary["mac"]);
}

/// The answers of the sink are traced, and are none of the nodes' packets.
#[test]
fn the_trace_of_answers_is_the_summary_of_the_nodes() {
    let trace = Traced::of(&scenario("routing/requests-and-answers.toml"), &["duration_s=600"]);
    assert!(trace.packets.len() > trace.counted("").len() + 20);
    trace.agrees_with(&trace.summary["mac"]);
}

#[test]
fn the_trace_of_superframes_is_the_summary() {
    let set = [
        "mac={beacon_enabled={beacon_order=4,superframe_order=3}}",
        "duration_s=4.0",
        "channel.max_range_m=30.0",
        "traffic.poisson.rate_per_s=3.0",
    ];
    let traced = Traced::of(&shipped(), &set);
    traced.agrees_with(&traced.summary["mac"]);
    // Slotted access assesses twice, the second time without a backoff.
    let second = traced.assessments.iter().filter(|row| row["backoff_s"] == row["start_s"]).count();
    assert!(second * 3 > traced.assessments.len(), "{second} of {}", traced.assessments.len());
}

#[test]
fn the_trace_of_two_networks_is_the_summary_of_each() {
    let folder = tempfile::tempdir().expect("there is room");
    let file = folder.path().join("two.toml");
    let radio = "{ tx_power_dbm = 0.0, sensitivity_dbm = -90.0, channel = 15 }";
    let text = format!(
        "name = \"two\"\nseed = 2\nduration_s = 2.0\n\
         [world.nodes.explicit]\npositions_m = [[-2.0, 0.0], [2.0, 0.0], [0.0, 2.0], [0.0, -2.0]]\n\
         names = [\"a0\", \"a1\", \"b0\", \"b1\"]\n\
         [channel.path_loss.log_distance]\nexponent = 2.0\nreference_loss_db = 40.05\n\
         [reception.overlap]\n[mac.csma_unslotted]\n\
         [networks.a]\nnodes.names = [\"a0\", \"a1\"]\nradio = {radio}\ntraffic.poisson = {{ rate_per_s = 100.0 }}\n\
         [networks.b]\nnodes.names = [\"b0\", \"b1\"]\nradio = {radio}\ntraffic.poisson = {{ rate_per_s = 100.0 }}\n\
         [[sinks]]\nname = \"sink\"\nposition_m = [0.0, 0.0]\n"
    );
    fs::write(&file, text).expect("there is room");
    let traced = Traced::of(&file, &[]);
    traced.agrees_with(&traced.summary["mac"]);
    traced.agrees_with(&traced.summary["other_networks"][0]);
    // Both are on one channel, so frames of one collide with those of the other.
    let packets: BTreeMap<&str, &str> =
        traced.packets.iter().map(|packet| (packet["packet"].as_str(), packet["network"].as_str())).collect();
    let collided = traced.transmissions.iter().filter(|sent| !sent["collided_with"].is_empty());
    let across =
        collided.filter(|sent| (packets[sent["packet"].as_str()] == "a") == (&*sent["collided_with"] >= "2"));
    assert!(across.count() > 0);
}

#[test]
fn the_trace_of_sector_sweeps_is_the_summary_of_the_survey() {
    let folder = tempfile::tempdir().expect("there is room");
    let file = folder.path().join("sweeps.toml");
    fs::write(&file, crate::sector_sweeps::small_survey()).expect("there is room");
    let all = sweeps_agree(&Traced::of(&file, &[]));
    // Nodes die before the first sweep, or in the midst.
    let some = sweeps_agree(&Traced::of(&file, &["faults.deaths={share=0.4,from_s=0.001,to_s=0.002}"]));
    let fewer = sweeps_agree(&Traced::of(&file, &["faults.deaths={share=0.4,from_s=1.0,to_s=20.0}"]));
    assert!(some < fewer && fewer < all, "{some}, {fewer}, {all}");
}

/// Compares all that the trace and the survey in the summary have in common. Returns the number of answers.
#[track_caller]
fn sweeps_agree(traced: &Traced) -> u64 {
    let gathering = &traced.summary["gathering"];
    let count = |key: &str| gathering[key].as_u64().unwrap_or_else(|| panic!("{key} in {gathering}"));
    let answers = traced.counted("");
    assert!(answers.iter().all(|packet| packet["kind"] == "answer") && answers.len() > 50, "{}", answers.len());
    let fate = |fate: &str| answers.iter().filter(|packet| packet["fate"] == fate).count() as u64;
    assert_eq!(answers.len() as u64, count("packets_offered"));
    assert_eq!(fate("received"), count("packets_received"));
    for lost in ["lost_collision", "lost_signal", "out_of_range", "not_listened", "lost_channel_access", "pending"] {
        assert_eq!(fate(lost), count(lost), "{lost}");
    }
    assert_eq!(fate("died"), gathering["died"].as_u64().unwrap_or(0));
    let sweeps: Vec<_> = traced.packets.iter().filter(|packet| packet["kind"] == "sweep").collect();
    assert_eq!(sweeps.len() as u64, count("sweeps"));
    // Sixteen sectors at two elevations.
    assert!(sweeps.iter().all(|packet| packet["transmissions"] == "32"), "{sweeps:?}");
    count("packets_offered")
}

#[test]
fn the_trace_changes_nothing_else_in_a_recording() {
    let folder = tempfile::tempdir().expect("there is room");
    let topics = |set: &str| {
        let path = folder.path().join("run.mcap");
        let mut command = sextant();
        command.args(["run", "--quiet", "--set", "duration_s=1.0", "--set", set]).arg(shipped());
        succeeds(command.arg("--out").arg(&path));
        let run = sextant_recording::read_run(&path).expect("a recording");
        let told: Value =
            serde_json::from_slice(&run.attachment(sextant_recording::SUMMARY_ATTACHMENT).expect("a summary").data)
                .expect("JSON");
        (told["mac"].clone(), sextant_recording::read_packets(&path).expect("packets").len())
    };
    let (with, without) = (topics("recording.packets=true"), topics("recording.packets=false"));
    assert_eq!(with.0, without.0);
    assert!(with.1 > 0 && without.1 == 0);
}

#[test]
fn figures_of_packets_are_drawn_and_the_window_is_checked() {
    let traced = Traced::of(&shipped(), &["duration_s=2.0"]);
    let recording = traced.path("run.mcap");
    let drawn = succeeds(sextant().arg("figure").arg(&recording).args(["--from", "0.5", "--to", "0.54"]));
    for name in ["network", "delay-cdf", "outcomes-by-node", "outcomes-over-time", "time-line"] {
        assert!(drawn.contains(&format!("{name}.svg")), "{name} in {drawn}");
    }
    let line = fs::read_to_string(traced.path("run.figures/time-line.svg")).expect("a picture");
    assert!(line.contains("0.5000 s to 0.5400 s") && line.contains("backoff"));
    let refused =
        sextant().arg("figure").arg(&recording).args(["--from", "2", "--to", "1"]).output().expect("starts");
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("--from 2 --to 1"));
}

/// In a corridor of relays, node `i` sends to node `i - 1`, and the first one to the sink, which is station 7.
#[test]
fn the_hops_of_a_packet_are_its_way_along_the_tree() {
    let trace = Traced::of(&scenario("routing/given-tree.toml"), &["duration_s=600", "routing.resends=1"]);
    let tables = trace.folder.path().join("tables");
    let (hops, tree) = (table(&tables.join("routing_hops.csv")), table(&tables.join("routing_tree.csv")));
    let number = |row: &BTreeMap<String, String>, column: &str| row[column].parse::<i64>().expect("a number");
    let packets: BTreeMap<i64, _> = trace.packets.iter().map(|packet| (number(packet, "packet"), packet)).collect();
    assert_eq!(hops.len(), packets.len(), "all packets go over several hops");
    let mut arrived = BTreeMap::new();
    for hop in &hops {
        let (packet, origin) = (packets[&number(hop, "packet")], number(hop, "origin"));
        let at = origin - number(hop, "hops");
        assert_eq!(number(packet, "source"), at, "{hop:?}");
        assert_eq!(number(packet, "destination"), if at > 0 { at - 1 } else { 7 }, "{hop:?}");
        assert_eq!(hop["target"], "", "any sink");
        if at == 0 && packet["fate"] == "received" {
            arrived.insert((origin, number(hop, "number")), ());
        }
    }
    assert_eq!(arrived.len() as u64, trace.summary["routing"]["delivered"].as_u64().expect("a number"));
    let parents: Vec<_> = tree.iter().map(|edge| (&*edge["node"], &*edge["parent"], number(edge, "depth"))).collect();
    let names = ["sink", "one", "two", "three", "four", "five", "six", "seven"];
    let expected: Vec<_> = (1..8).map(|i| (names[i], names[i - 1], i64::try_from(i).expect("few"))).collect();
    assert_eq!(parents, expected);
    let stations: Vec<_> = tree.iter().map(|edge| number(edge, "parent_station")).collect();
    assert_eq!(stations, [7, 0, 1, 2, 3, 4, 5], "the sink is station 7");
    for edge in &tree {
        // 70 % of the frames arrive, and of the acknowledgements.
        let etx: f64 = edge["etx"].parse().expect("a number");
        assert!((etx - 1.0 / 0.49).abs() < 1e-9, "{edge:?}");
        assert_eq!(edge["changes"], "0");
    }
}

/// The number of nodes.
fn nodes_of(summary: &Value) -> usize {
    usize::try_from(summary["simulation"]["nodes"].as_u64().expect("a number")).expect("few nodes")
}

/// Number, mean and percentiles of the delays of packets over several hops, by the tables alone: from the offer at the origin to the
/// end of the first frame that was received at the target, or at any sink.
fn end_to_end(trace: &Traced, is_origin: impl Fn(usize) -> bool) -> Vec<f64> {
    let tables = trace.folder.path().join("tables");
    let hops = table(&tables.join("routing_hops.csv"));
    let nodes = nodes_of(&trace.summary);
    let warm_up_s = trace.summary["mac"]["warm_up_s"].as_f64().unwrap_or(0.0);
    let packets: BTreeMap<&str, _> = trace.packets.iter().map(|packet| (&*packet["packet"], packet)).collect();
    let mut arrivals: BTreeMap<(&str, &str, &str), f64> = BTreeMap::new();
    for hop in &hops {
        let packet = packets[&*hop["packet"]];
        let offered_s: f64 = hop["origin_offered_s"].parse().expect("a time");
        assert!(offered_s <= packet["offered_s"].parse().expect("a time"), "{hop:?}");
        let to: usize = packet["destination"].parse().expect("a station");
        let is_there = if hop["target"].is_empty() { to >= nodes } else { hop["target"] == packet["destination"] };
        let counts = offered_s >= warm_up_s && is_origin(hop["origin"].parse().expect("a station"));
        if let (true, Ok(delivered_s)) = (is_there && counts, packet["delivered_s"].parse::<f64>()) {
            let identity = (&*hop["origin"], &*hop["number"], &*hop["origin_offered_s"]);
            let first_s = arrivals.entry(identity).or_insert(f64::INFINITY);
            *first_s = first_s.min(delivered_s - offered_s);
        }
    }
    let mut delays_s: Vec<f64> = arrivals.into_values().collect();
    delays_s.sort_by(f64::total_cmp);
    delays_s
}

#[track_caller]
fn assert_delays(delays_s: &[f64], told: &Value) {
    assert_eq!(delays_s.len() as u64, told["delivered"].as_u64().expect("a number"));
    assert!(delays_s.len() > 50, "{}", delays_s.len());
    let mean_s = delays_s.iter().sum::<f64>() / delays_s.len() as f64;
    let percentile_s = |percent: usize| delays_s[(percent * delays_s.len()).div_ceil(100) - 1];
    for (key, found_s) in [("mean", mean_s), ("p50", percentile_s(50)), ("p99", percentile_s(99))] {
        let told_s = told["delay_s"][key].as_f64().expect("a number");
        assert!((found_s - told_s).abs() < 1e-8, "{key}: {found_s}, not {told_s}");
    }
}

#[test]
fn delays_over_several_hops_are_those_of_the_trace() {
    // Queues are long, so that packets wait before their first hop.
    let waits = ["duration_s=60", "warm_up_s=20", "traffic.periodic.interval_s=0.15"];
    let given = Traced::of(&scenario("routing/given-tree.toml"), &waits);
    let delays_s = end_to_end(&given, |_| true);
    assert_delays(&delays_s, &given.summary["routing"]);
    let both = Traced::of(&scenario("routing/requests-and-answers.toml"), &["duration_s=600"]);
    let nodes = nodes_of(&both.summary);
    assert_delays(&end_to_end(&both, |origin| origin < nodes), &both.summary["routing"]);
    assert_delays(&end_to_end(&both, |origin| origin >= nodes), &both.summary["routing"]["answers"]);
    // Some packets meet their target on the way up.
    let to_nodes = Traced::of(
        &scenario("routing/requests-and-answers.toml"),
        &["routing.to=\"nodes\"", "duration_s=1200", "warm_up_s=300"],
    );
    assert_delays(&end_to_end(&to_nodes, |_| true), &to_nodes.summary["routing"]);
    let slots = Traced::of(&scenario("batteries/slots-tree.toml"), &["duration_s=2400"]);
    assert_delays(&end_to_end(&slots, |_| true), &slots.summary["routing"]);
}
