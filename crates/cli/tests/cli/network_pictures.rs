//! What recordings have of networks over time: hops in slots and among sleeping stations, schedules, trees that change; and
//! the pictures of them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::program::{Said, Table, scenario, sets, sextant, summary, table};

/// A run with its recording.
struct Recorded {
    folder: tempfile::TempDir,
    summary: Value,
}

fn succeeds(command: &mut Command) -> String {
    command.output().expect("the program starts").printed()
}

impl Recorded {
    fn of(name: &str, set: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("there is room");
        let mut command = sextant();
        command.args(["run", "--quiet"]).arg(scenario(name)).arg("--out").arg(folder.path().join("run.mcap"));
        command.arg("--summary").arg(folder.path().join("run.json"));
        succeeds(command.args(sets(set)));
        let summary = summary(&folder.path().join("run.json"));
        succeeds(
            sextant()
                .arg("export")
                .arg(folder.path().join("run.mcap"))
                .arg("--out")
                .arg(folder.path().join("tables")),
        );
        Self { folder, summary }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// A table without quoted cells; empty if there is none.
    fn table(&self, name: &str) -> Table {
        table(&self.path("tables").join(format!("{name}.csv")))
    }

    fn figure(&self, arguments: &[&str]) -> String {
        succeeds(sextant().args(["figure", "--force"]).arg(self.path("run.mcap")).args(arguments))
    }

    fn picture(&self, name: &str) -> String {
        fs::read_to_string(self.path("run.figures").join(name)).expect("a picture")
    }
}

fn number(row: &BTreeMap<String, String>, column: &str) -> u64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column} of {row:?}"))
}

fn nanos(row: &BTreeMap<String, String>, column: &str) -> u64 {
    let (whole, rest) = row[column].split_once('.').unwrap_or((&row[column], ""));
    whole.parse::<u64>().expect("seconds") * 1_000_000_000 + format!("{rest:0<9}").parse::<u64>().expect("decimals")
}

#[test]
fn packets_in_slots_and_among_sleeping_stations_have_hops() {
    for name in ["tsch/orchestra-tree.toml", "sleep/csl-corridor.toml"] {
        let run = Recorded::of(name, &["recording.packets=true", "duration_s=1200", "warm_up_s=0"]);
        let (packets, hops) = (run.table("mac_packets"), run.table("routing_hops"));
        let by_id: BTreeMap<u64, _> = packets.iter().map(|packet| (number(packet, "packet"), packet)).collect();
        assert!(packets.len() > 50, "{name}");
        assert_eq!(hops.len(), packets.len(), "{name}: all packets go over several hops");
        let nodes = run.summary["simulation"]["nodes"].as_u64().expect("a number");
        let arrived: BTreeSet<(u64, u64)> = hops
            .iter()
            .filter(|hop| {
                let packet = by_id[&number(hop, "packet")];
                number(packet, "destination") >= nodes && packet["fate"] == "received"
            })
            .map(|hop| (number(hop, "origin"), number(hop, "number")))
            .collect();
        assert_eq!(Some(arrived.len() as u64), run.summary["routing"]["delivered"].as_u64(), "{name}");
    }
}

/// Nodes agree on cells, and give them up: a frame arrives in a cell that its receiver had at that time.
#[test]
fn negotiated_cells_have_the_times_in_which_frames_go_in_them() {
    let some = ["recording.packets=true", "duration_s=1500", "warm_up_s=0", "radio.clock_ppm=0"];
    let busy = [
        "mac.tsch.schedule.msf.max_num_cells=20",
        "mac.tsch.schedule.msf.lim_num_cells_used_high=15",
        "mac.tsch.schedule.msf.lim_num_cells_used_low=5",
    ];
    let run = Recorded::of("tsch/msf-star.toml", &[&some[..], &busy].concat());
    let (cells, packets) = (run.table("mac_cells"), run.table("mac_packets"));
    assert!(cells.iter().filter(|cell| !cell["peer"].is_empty()).all(|cell| cell["from_s"] != "0"));
    assert!(cells.iter().any(|cell| !cell["to_s"].is_empty()), "some are given up");
    let to: BTreeMap<&str, &str> =
        packets.iter().map(|packet| (&*packet["packet"], &*packet["destination"])).collect();
    let seconds = |cell: &BTreeMap<String, String>, key: &str| cell[key].parse::<f64>().ok();
    let sent = run.table("mac_transmissions");
    let received: Vec<_> = sent.iter().filter(|sent| sent["outcome"] == "received").collect();
    assert!(received.len() > 1000, "{}", received.len());
    for sent in received {
        let start_s = seconds(sent, "start_s").expect("a time");
        let slot = std::time::Duration::from_secs_f64(start_s).as_millis() / 10;
        let hears = |cell: &&BTreeMap<String, String>| {
            cell["station"] == to[&*sent["packet"]]
                && cell["options"].contains("receive")
                && slot % u128::from(number(cell, "slotframe")) == u128::from(number(cell, "timeslot"))
                && seconds(cell, "from_s").is_some_and(|from_s| from_s <= start_s)
                && seconds(cell, "to_s").is_none_or(|to_s| start_s < to_s)
        };
        assert!(cells.iter().any(|cell| hears(&cell)), "{sent:?}");
    }
}

/// Nobody sends, so that each slot of a schedule is one in which nodes listen in vain: counted slot by slot.
#[test]
fn the_cells_of_a_recording_are_those_in_which_nodes_listen() {
    let quiet = ["traffic.poisson.rate_per_s=1e-6", "radio.clock_ppm=0", "mac.tsch.beacons.interval_s=3600"];
    let recorded = ["recording.packets=true", "duration_s=60", "warm_up_s=0"];
    let run = Recorded::of("tsch/orchestra-tree.toml", &[recorded, quiet].concat());
    let nodes = run.summary["simulation"]["nodes"].as_u64().expect("a number");
    let cells = run.table("mac_cells");
    let mut listening = 0;
    for node in 0..nodes {
        let own = || cells.iter().filter(|cell| number(cell, "station") == node);
        let receiving: Vec<(u64, u64)> = own()
            .filter(|cell| cell["options"].contains("receive"))
            .map(|cell| (number(cell, "timeslot"), number(cell, "slotframe")))
            .collect();
        listening +=
            (0..6000_u64).filter(|slot| receiving.iter().any(|(at, length)| slot % length == *at)).count() as u64;
        // Orchestra: a station listens in the slot of its number, and sends beacons in that of the beacon slotframe.
        assert!(receiving.contains(&(node % 17, 17)), "{node}: {receiving:?}");
        let beacons: Vec<_> =
            own().filter(|cell| cell["beacons"] == "1" && cell["options"].contains("transmit")).collect();
        let [cell] = &beacons[..] else { panic!("one slot for its beacons, not {beacons:?}") };
        assert_eq!((number(cell, "timeslot"), number(cell, "slotframe")), (node, 397));
    }
    assert_eq!(run.summary["mac"]["offered"], 0);
    let slots = &run.summary["mac"]["slots"];
    assert_eq!(
        slots["idle_listen"].as_u64().zip(slots["receive"].as_u64()).map(|(idle, heard)| idle + heard),
        Some(listening)
    );
}

#[test]
fn the_checks_of_a_recording_are_those_that_are_counted() {
    let run = Recorded::of(
        "sleep/csl-corridor.toml",
        &["recording.packets=true", "duration_s=600", "traffic.poisson.rate_per_s=1e-6"],
    );
    let checks = run.table("mac_checks");
    assert_eq!(checks.len(), 4, "the sink is always on");
    let counted: u64 = checks
        .iter()
        .map(|check| {
            let (first, interval) = (nanos(check, "first_s"), nanos(check, "interval_s"));
            assert!(first < interval && interval.abs_diff(500_000_000) <= 20_000, "{check:?}");
            (600_000_000_000 - first).div_ceil(interval)
        })
        .sum();
    assert_eq!(run.summary["mac"]["offered"], 0);
    // The true interval is rounded to a nanosecond: in 1200 of them less than a check.
    assert_eq!(run.summary["mac"]["sleep"]["checks"].as_u64(), Some(counted));
}

#[test]
fn the_last_parent_of_each_node_is_that_of_the_tree_at_the_end() {
    let run = Recorded::of(
        "routing/collection-tree.toml",
        &["duration_s=1200", "routing.tree.collection.hysteresis_etx=0.5"],
    );
    let (changes, tree) = (run.table("routing_changes"), run.table("routing_tree"));
    assert!(changes.is_sorted_by_key(|change| nanos(change, "t_s")));
    let mut parents: BTreeMap<&str, Vec<&BTreeMap<String, String>>> = BTreeMap::new();
    changes.iter().for_each(|change| parents.entry(&change["node"]).or_default().push(change));
    let mut total = 0;
    for edge in &tree {
        let own = &parents[&*edge["node"]];
        assert_eq!(own[0]["old_parent"], "", "a first parent comes after none");
        assert!(own.windows(2).all(|pair| pair[0]["new_parent"] == pair[1]["old_parent"]), "{own:?}");
        let last = own[own.len() - 1];
        assert_eq!((&last["new_parent"], &last["parent_station"]), (&edge["parent"], &edge["parent_station"]));
        assert_eq!(number(edge, "changes"), own.len() as u64 - 1);
        total += own.len() as u64 - 1;
    }
    assert!(total > 20);
    assert_eq!(run.summary["routing"]["parent_changes"].as_u64(), Some(total));
    // A tree that does not change says nothing of changes.
    let fixed = Recorded::of("routing/given-tree.toml", &["duration_s=60"]);
    assert!(fixed.table("routing_changes").is_empty());
}

#[test]
fn the_tree_is_drawn_at_an_instant_and_its_changes_beside_each_other() {
    let run = Recorded::of("routing/collection-tree.toml", &["duration_s=600", "warm_up_s=0"]);
    let drawn = run.figure(&["--time", "0"]);
    assert!(drawn.contains("tree.svg") && drawn.contains("tree-changes.svg"), "{drawn}");
    assert!(run.picture("tree.svg").contains("100 nodes, 100 without a way"));
    run.figure(&["--time", "450.5"]);
    assert!(run.picture("tree.svg").contains("tree after 450.5 s"));
    let changes = run.picture("tree-changes.svg");
    for words in ["after 60 s", "after 300 s", "after 600 s", "another parent than in the plot before"] {
        assert!(changes.contains(words), "{words}");
    }
    let refused = |file: &Path, time: &str| {
        let output = sextant().args(["figure", "--time", time]).arg(file).output().expect("the program starts");
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8(output.stderr).expect("text")
    };
    assert!(refused(&run.path("run.mcap"), "601").contains("`--time 601` is not in the run; allowed: 0 to 600"));
    let without = Recorded::of("mac/acknowledged-star.toml", &["duration_s=2.0"]);
    assert!(refused(&without.path("run.mcap"), "1").contains("has no tree"));
}

#[test]
fn a_time_line_follows_the_packet_over_most_hops_through_its_slots() {
    let set = ["recording.packets=true", "recording.frames=true", "duration_s=900"];
    let run = Recorded::of("batteries/slots-tree.toml", &set);
    run.figure(&[]);
    let line = run.picture("time-line.svg");
    for words in
        ["the quickest packet over 4 hops", "slot in which it listens", "acknowledgement on air", "way of packet"]
    {
        assert!(line.contains(words), "{words}");
    }
    run.figure(&["--from", "700", "--to", "760"]);
    let cut = run.picture("time-line.svg");
    assert!(cut.contains("cut after 3000 bars") && cut.contains("too long for its slots and checks"));
    let asleep = Recorded::of("sleep/csl-corridor.toml", &["recording.packets=true", "recording.frames=true"]);
    asleep.figure(&[]);
    let line = asleep.picture("time-line.svg");
    for words in
        ["the quickest packet over 4 hops", "check of the channel", "strobe or wake-up frame", "\nfour\n", "\nsink\n"]
    {
        assert!(line.contains(words), "{words}");
    }
}

/// Living nodes of a depth with a way.
fn with_way(nodes: &Value) -> u64 {
    nodes.get("with_way").unwrap_or(&nodes["nodes"]).as_u64().expect("a count")
}

#[test]
fn figures_say_what_is_of_each_hop_and_draw_the_delay_end_to_end() {
    let run = Recorded::of("routing/given-tree.toml", &["recording.packets=true"]);
    let drawn = run.figure(&[]);
    assert!(drawn.contains("delay-end-to-end.svg"), "{drawn}");
    let routing = &run.summary["routing"];
    let (delivered, delay_s) = (&routing["delivered"], routing["delay_s"]["p50"].as_f64().expect("a delay"));
    let end_to_end = run.picture("delay-end-to-end.svg");
    let said = format!("{delivered} packets delivered, median {:.1} ms", 1e3 * delay_s);
    assert!(end_to_end.contains(&said), "{said}: {end_to_end}");
    for name in ["delay-cdf.svg", "outcomes-by-node.svg", "outcomes-over-time.svg"] {
        assert!(run.picture(name).contains("packets on each hop"), "{name}");
    }
    let star = Recorded::of("mac/packet-trace.toml", &[]);
    assert!(!star.figure(&[]).contains("delay-end-to-end") && !star.picture("delay-cdf.svg").contains("hop"));
}

/// The packets of those behind it have no way any more.
#[test]
fn a_node_that_dies_by_a_fault_is_dead_in_the_tree_and_in_the_shares() {
    let run = Recorded::of(
        "routing/given-tree.toml",
        &[
            "duration_s=70",
            "traffic.periodic.interval_s=0.02",
            "recording.packets=true",
            "faults={ deaths = { names = [\"two\"], from_s = 60, to_s = 60 } }",
        ],
    );
    let died: Vec<_> = run.table("routing_tree").into_iter().map(|edge| edge["died_s"].clone()).collect();
    assert_eq!(died, ["", "60", "", "", "", "", ""]);
    run.figure(&[]);
    assert!(
        run.picture("tree.svg")
            .contains("7 nodes, 1 with a way: 1.0 hops in the mean, 1 at most, 5 without a way, 1 dead")
    );
    // The summary has the same: the dead node stands where it was, and has no way.
    let routing = &run.summary["routing"];
    assert_eq!((&routing["depth"], &routing["without_way"]), (&1.into(), &5.into()));
    let with_way: Vec<u64> = routing["by_depth"].as_array().expect("rows").iter().map(with_way).collect();
    assert_eq!(with_way, [1, 0, 0, 0, 0, 0, 0]);
    let died = run.summary["mac"]["died"].as_u64().expect("a count");
    assert!(died > 0 && run.picture("outcomes-by-node.svg").contains(&format!("node died: {died}")));
}
