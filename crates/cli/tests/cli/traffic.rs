//! Studies of channel access without robots: sinks, kinds of traffic, groups, several networks, and their figures.

use std::fs;
use std::path::Path;
use std::process::Output;

use serde_json::Value;
use tempfile::TempDir;

use crate::program::{Said, scenario, sets, sextant};

/// Two nodes 2 m from a sink, without losses but those of the MAC.
const STAR: &str = r#"name = "star"
seed = 1
duration_s = 20.0

[world.nodes.explicit]
positions_m = [[-2.0, 0.0], [2.0, 0.0]]
names = ["west", "east"]

[[world.obstacles]]
name = "wall"
absorption_per_m = 4.6
[world.obstacles.shape.box]
center_m = [9.0, 9.0, 0.0]
size_m = [2.0, 1.0, 3.0]

[radio]
tx_power_dbm = 0.0
sensitivity_dbm = -90.0

[channel.path_loss.log_distance]
exponent = 2.0
reference_loss_db = 40.05

[mac.csma_unslotted]

[reception.overlap]

[[sinks]]
name = "sink"
position_m = [0.0, 0.0]

"#;

/// A folder with the star and this traffic, and perhaps a trace.
struct Folder(TempDir);

impl Folder {
    fn new(traffic: &str) -> Self {
        let folder = tempfile::tempdir().expect("there is room");
        fs::write(folder.path().join("star.toml"), format!("{STAR}{traffic}")).expect("there is room");
        Self(folder)
    }

    fn with_trace(self, trace: &str) -> Self {
        fs::write(self.0.path().join("trace.csv"), trace).expect("there is room");
        self
    }

    fn path(&self, name: &str) -> std::path::PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, set: &[&str]) -> Output {
        run(&self.path("star.toml"), &self.path("star.mcap"), set)
    }

    /// The summary of a run that succeeds.
    fn summary(&self, set: &[&str]) -> Value {
        self.run(set).json()
    }
}

fn run(file: &Path, recording: &Path, set: &[&str]) -> Output {
    let mut command = sextant();
    command.arg("run").arg(file).arg("--out").arg(recording).args(["--format", "json", "--quiet"]);
    command.args(sets(set)).output().expect("the program starts")
}

fn count(traffic: &Value, key: &str) -> u64 {
    traffic[key].as_u64().unwrap_or_else(|| panic!("no count {key} in {traffic}"))
}

fn number(traffic: &Value, key: &str) -> f64 {
    traffic[key].as_f64().unwrap_or_else(|| panic!("no number {key} in {traffic}"))
}

/// Packets over all outcomes.
fn ended(traffic: &Value) -> u64 {
    let outcomes =
        ["delivered", "lost_collision", "lost_channel_access", "lost_queue", "lost_signal", "out_of_range"];
    outcomes.iter().chain(&["not_listened", "pending"]).map(|key| count(traffic, key)).sum::<u64>()
        + traffic["died"].as_u64().unwrap_or(0)
}

#[test]
fn each_packet_of_each_shipped_study_is_in_one_outcome() {
    let folder = tempfile::tempdir().expect("there is room");
    for name in ["saturated-star", "poisson-star", "hidden-nodes", "acknowledged-star", "one-shot-star"] {
        let file = scenario(&format!("mac/{name}.toml"));
        let set = if name == "one-shot-star" { "duration_s=1.0" } else { "duration_s=5.0" };
        let json = run(&file, &folder.path().join("a.mcap"), &[set]).json();
        let mac = &json["mac"];
        assert_eq!(ended(mac), count(mac, "offered"), "{name}: {mac}");
        assert!(count(mac, "delivered") > 0, "{name}");
        let nodes = mac["nodes"].as_array().expect("nodes");
        for key in ["offered", "delivered", "retries", "backoffs", "lost_collision"] {
            assert_eq!(nodes.iter().map(|node| count(node, key)).sum::<u64>(), count(mac, key), "{name}: {key}");
        }
        let bins = mac["delay_histogram"].as_array().expect("a histogram");
        assert_eq!(bins.iter().map(|bin| count(bin, "packets")).sum::<u64>(), count(mac, "delivered"), "{name}");
        assert!(json.get("gathering").is_none() && json.get("maps").is_none(), "{name}");
    }
}

#[test]
fn traffic_that_nobody_receives_is_an_error() {
    let star = Folder::new("[traffic.beacon]\ninterval_s = 1.0\n");
    assert!(star.run(&[]).status.success());
    let message = star.run(&["sinks=[]"]).refusal();
    assert!(message.contains("`sinks` is missing") && message.contains("or a robot that surveys"), "{message}");
}

#[test]
fn a_warm_up_leaves_the_start_out_of_counts_rates_and_energy() {
    let star = Folder::new("[traffic.saturated]\nmpdu_octets = 127\n");
    let (whole, late) = (star.summary(&[]), star.summary(&["warm_up_s=15.0"]));
    let (whole, late) = (&whole["mac"], &late["mac"]);
    assert_eq!(ended(late), count(late, "offered"));
    assert!((number(late, "duration_s") - 5.0).abs() < 1e-9 && (number(late, "warm_up_s") - 15.0).abs() < 1e-9);
    assert!(whole.get("warm_up_s").is_none());
    let share = count(late, "delivered") as f64 / count(whole, "delivered") as f64;
    assert!((share - 0.25).abs() < 0.02, "{share}");
    // Rates and powers are those of the whole, but for chance.
    let ratio = number(late, "throughput_bit_per_s") / number(whole, "throughput_bit_per_s");
    assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
    let watts = |mac: &Value| number(&mac["energy_j"], "rx") / number(mac, "duration_s");
    assert!((watts(late) / watts(whole) - 1.0).abs() < 0.05);
}

#[test]
fn an_interferer_in_the_channel_takes_the_share_of_the_frames_that_its_duty_cycle_says() {
    let star = Folder::new("[traffic.poisson]\nmpdu_octets = 30\nrate_per_s = 10.0\n");
    let oven = "interferers=[{ name = \"oven\", position_m = [0.5, 0.5], power_dbm = 0.0, channel = 11, period_s = 1.0, \
                duty_cycle = 0.5 }]";
    let quiet = star.summary(&[]);
    let noisy = star.summary(&[oven]);
    assert!(number(&quiet["mac"], "prr") > 0.94, "{quiet}");
    let prr = number(&noisy["mac"], "prr");
    assert!((0.35..0.65).contains(&prr), "{prr}");
}

#[test]
fn one_saturated_node_has_the_throughput_of_the_closed_form() {
    // Mean backoff 3.5 * 320 us, CCA 128, turnaround 192, frame 4256, then spacing 640, or with acknowledgement
    // 192 + 352 + 640 us: 6336 and 6880 us for 116 octets of payload. The backoff of each of about 3000 frames is uniform
    // on eight values with a deviation of 733 us: five standard errors of the mean are 67 us.
    let star = Folder::new("");
    for (acknowledged, period_us) in [(false, 6336.0), (true, 6880.0)] {
        let traffic = format!(
            "[[traffic.groups]]\nname = \"one\"\nnodes = {{ count = 1 }}\n[traffic.groups.traffic.saturated]\n\
             mpdu_octets = 127\nacknowledged = {acknowledged}\n"
        );
        fs::write(star.path("star.toml"), format!("{STAR}{traffic}")).expect("there is room");
        let json = star.summary(&[]);
        let mac = &json["mac"];
        assert!(number(mac, "prr") >= 1.0, "{mac}");
        let period_found_us = 1e6 * 8.0 * 116.0 / number(mac, "throughput_bit_per_s");
        assert!((period_found_us - period_us).abs() < 67.0, "{period_found_us} us, not {period_us} us");
        let group = &mac["groups"][0];
        assert_eq!((group["name"].as_str(), count(group, "delivered")), (Some("one"), count(mac, "delivered")));
        let idle = mac["nodes"].as_array().expect("nodes").iter().find(|node| node["name"] == "east");
        assert_eq!(count(idle.expect("a node"), "offered"), 0);
    }
}

#[test]
fn a_trace_is_sent_as_it_stands() {
    let folder = Folder::new("[traffic.trace]\nfile = \"trace.csv\"\nacknowledged = true\n")
        .with_trace("t_s,node,mpdu_octets\n1.0,west,20\n1.5,east,100\n2.0,west,30\n");
    let json = folder.summary(&[]);
    let nodes = json["mac"]["nodes"].as_array().expect("nodes");
    let of = |name: &str| nodes.iter().find(|node| node["name"] == name).expect("a node");
    assert_eq!((count(of("west"), "offered"), count(of("west"), "delivered")), (2, 2));
    // 9 and 19 octets of payload of west, 89 of east, in 20 s.
    let rate = |name| number(of(name), "throughput_bit_per_s") * 20.0 / 8.0;
    assert!((rate("west") - 28.0).abs() < 1e-9 && (rate("east") - 89.0).abs() < 1e-9);
    assert_eq!(json["mac"]["sinks"][0]["received"], 3);
}

#[test]
fn a_full_queue_loses_packets_and_a_long_one_delays_them() {
    let traffic = "[traffic.poisson]\nmpdu_octets = 127\nrate_per_s = 60.0\n";
    let of = |frames: u32| {
        let json = Folder::new(traffic).summary(&[&format!("mac.csma_unslotted.queue_frames={frames}")]);
        (count(&json["mac"], "lost_queue"), number(&json["mac"]["delay_s"], "mean"))
    };
    let (none, few, many) = (of(0), of(2), of(1000));
    assert!(none.0 > few.0 && few.0 > many.0 && many.0 == 0, "{none:?} {few:?} {many:?}");
    assert!(none.1 < few.1 && few.1 < many.1, "{none:?} {few:?} {many:?}");
}

#[test]
fn networks_on_different_channels_do_not_disturb_each_other_and_on_one_channel_they_do() {
    let networks = |channel: u8| {
        format!(
            "[networks.a]\nnodes.names = [\"west\"]\n[networks.a.traffic.saturated]\nmpdu_octets = 100\n\
             [networks.b]\nnodes.names = [\"east\"]\n[networks.b.traffic.saturated]\nmpdu_octets = 100\n\
             [networks.b.radio]\ntx_power_dbm = 0.0\nsensitivity_dbm = -90.0\nchannel = {channel}\n"
        )
    };
    let of = |channel: u8| {
        let json = Folder::new(&networks(channel)).summary(&[]);
        let (first, second) = (json["mac"].clone(), json["other_networks"][0].clone());
        assert_eq!((first["network"].as_str(), second["network"].as_str()), (Some("a"), Some("b")));
        (first, second)
    };
    let (first, second) = of(26);
    assert!(number(&first, "prr") >= 1.0 && number(&second, "prr") >= 1.0, "{first} {second}");
    assert_eq!(count(&first, "lost_collision") + count(&second, "lost_collision"), 0);
    let (first, second) = of(11);
    assert!(count(&first, "lost_collision") > 50 && count(&second, "lost_collision") > 50, "{first} {second}");
}

#[test]
fn acknowledged_packets_go_to_a_robot_or_sink_of_their_own_network() {
    let networks = "[networks.a]\n[networks.a.traffic.periodic]\nacknowledged = true\n\
                    [networks.b]\n[networks.b.traffic.silent]\n\
                    [[robots]]\nname = \"other\"\nnetwork = \"b\"\nstart_m = [0.0, 1.0]\nlisten_s = 15.0\n\
                    [robots.controller.waypoints]\nplaces_m = [[0.0, 1.0]]\n";
    let json =
        Folder::new(networks).summary(&["networks.b.radio={tx_power_dbm=0.0,sensitivity_dbm=-90.0,channel=20}"]);
    let mac = &json["mac"];
    assert!(count(mac, "delivered") >= 28 && number(mac, "prr") >= 1.0, "{mac}");
    let sinks = mac["sinks"].as_array().expect("sinks");
    let received: Vec<_> = sinks.iter().map(|sink| (sink["name"].as_str(), count(sink, "received"))).collect();
    assert_eq!(received, [(Some("other"), 0), (Some("sink"), count(mac, "delivered"))]);
    let said = Folder::new(networks).run(&["robots.0.network=\"c\""]).refusal();
    assert!(said.contains("robots[0].network") && said.contains("`a`, `b`"), "{said}");
}

#[test]
fn every_physical_layer_carries_packets_at_its_rate() {
    let traffic = "[[traffic.groups]]\nname = \"one\"\nnodes.count = 1\n[traffic.groups.traffic.saturated]\nmpdu_octets = 127\n";
    let layers = ["oqpsk2450", "bpsk868", "bpsk915", "ask868", "ask915", "oqpsk868", "oqpsk915"];
    let throughput = |layer: &str| {
        let json = Folder::new(traffic).summary(&[&format!("radio.phy=\"{layer}\"")]);
        assert!(number(&json["mac"], "prr") >= 1.0, "{layer}");
        number(&json["mac"], "throughput_bit_per_s")
    };
    let rates: Vec<f64> = layers.iter().map(|layer| throughput(layer)).collect();
    // kbit/s on air: 250, 20, 40, 250, 250, 100, 250.
    assert!(rates[1] < 20e3 && rates[1] > 10e3 && (rates[2] / rates[1] - 2.0).abs() < 0.1, "{rates:?}");
    assert!((rates[6] / rates[0] - 1.0).abs() < 0.1 && rates[5] < 0.5 * rates[0], "{rates:?}");
}

#[test]
fn mistakes_are_rejected_at_their_key() {
    let saturated = || Folder::new("[traffic.saturated]\nmpdu_octets = 100\n");
    let trace = |rows: &str| {
        Folder::new("[traffic.trace]\nfile = \"trace.csv\"\n").with_trace(&format!("t_s,node,mpdu_octets\n{rows}"))
    };
    for (folder, set, key, words) in [
        (saturated(), "sinks.0.position_m=[9.0, 9.0]", "sinks[0].position_m", "inside obstacle `wall`"),
        (saturated(), "duration_s=0.0", "duration_s", "0"),
        (saturated(), "duration_s=-1.0", "duration_s", "-1"),
        (saturated(), "traffic.saturated.mpdu_octets=128", "traffic.saturated.mpdu_octets", "11 to 127"),
        (saturated(), "sinks.0.name=\"a b\"", "sinks[0].name", "letters"),
        (saturated(), "radio.channel=5", "radio.channel", "11 to 26"),
        (saturated(), "traffic.saturated.start_spread_s=-1.0", "traffic.saturated.start_spread_s", "0 to 1000000"),
        (saturated(), "traffic.saturated.start_spread_s=nan", "traffic.saturated.start_spread_s", "NaN"),
        (saturated(), "radio.clock_ppm=-1.0", "radio.clock_ppm", "0 to 1000"),
        (saturated(), "radio.clock_ppm=nan", "radio.clock_ppm", "NaN"),
        (saturated(), "warm_up_s=20.0", "warm_up_s", "less than `duration_s`"),
        (saturated(), "warm_up_s=-1.0", "warm_up_s", "less than `duration_s`"),
        (saturated(), "warm_up_s=nan", "warm_up_s", "NaN"),
        (
            saturated(),
            "radio.groups=[{ nodes = { names = [\"north\"] } }]",
            "radio.groups[0].nodes.names[0]",
            "the name of a node",
        ),
        (
            saturated(),
            "radio.groups=[{ nodes = { others = {} }, tx_power_dbm = nan }]",
            "radio.groups[0].tx_power_dbm",
            "NaN",
        ),
        (
            saturated(),
            "interferers=[{ name = \"oven\", position_m = [1.0, 0.0], power_dbm = 0.0, channel = 9 }]",
            "interferers[0].channel",
            "11 to 26",
        ),
        (
            saturated(),
            "interferers=[{ name = \"oven\", position_m = [1.0, 0.0], power_dbm = 0.0, channel = 15, duty = 0.5 }]",
            "interferers[0]",
            "unknown key `duty`",
        ),
        (saturated(), "mac.csma_unslotted.queue_frames=20000", "mac.csma_unslotted.queue_frames", "0 to 10000"),
        (
            Folder::new("[traffic.saturated]\nacknowledged = true\nto = \"nobody\"\n"),
            "seed=1",
            "traffic.saturated.to",
            "`sink`",
        ),
        (trace("1,west,20\n0.5,west,20\n"), "seed=1", "traffic.trace.file", "rising"),
        (trace("1,north,20\n"), "seed=1", "traffic.trace.file", "`north`"),
        (trace("1,west,200\n"), "seed=1", "traffic.trace.file", "127"),
        (trace("1,west,twenty\n"), "seed=1", "traffic.trace.file", "line 2"),
    ] {
        let said = folder.run(&[set]).refusal();
        assert!(said.contains(key) && said.contains(words), "{set}: {key} and {words} are not in\n{said}");
    }
    let without_end = Folder::new("[traffic.saturated]\n").run(&["duration_s=inf"]).refusal();
    assert!(without_end.contains("duration_s"), "{without_end}");
}

#[test]
fn a_scenario_without_robots_needs_an_end() {
    let folder = Folder::new("[traffic.saturated]\n");
    let text = fs::read_to_string(folder.path("star.toml")).expect("the scenario");
    fs::write(folder.path("star.toml"), text.replace("duration_s = 20.0\n", "")).expect("there is room");
    let said = folder.run(&[]).refusal();
    assert!(said.contains("robots") && said.contains("duration_s"), "{said}");
}

#[test]
fn a_sweep_of_the_load_is_drawn_with_its_intervals() {
    let folder = Folder::new(
        "[traffic.poisson]\nrate_per_s = 5.0\n\n[sweep]\nruns = 2\n\n[sweep.product]\ntraffic.poisson.rate_per_s = [5.0, 50.0, 100.0]\n",
    );
    let table = folder.path("star.csv");
    let swept = sextant().arg("sweep").arg(folder.path("star.toml")).arg("--out").arg(&table).arg("--quiet").output();
    assert!(swept.expect("the program starts").status.success());
    let listed = sextant().arg("figure").arg(&table).output().expect("the program starts").printed();
    for measure in ["mac-prr", "mac-delay_s-mean", "mac-throughput_bit_per_s"] {
        let file = folder.path(&format!("star.figures/star-{measure}.svg"));
        assert!(listed.contains(&*file.to_string_lossy()), "{listed}");
        let svg = fs::read_to_string(&file).expect("a figure");
        assert!(svg.contains("rate (1/s)") && svg.contains("95 % intervals"), "{measure}");
    }
    let unknown = sextant().arg("figure").arg(&table).args(["--column", "mac.nothing"]).output().expect("it starts");
    assert_eq!(unknown.status.code(), Some(2));
}

#[test]
fn a_network_with_sinks_is_drawn_from_its_recording() {
    let folder = Folder::new("[traffic.saturated]\n");
    folder.summary(&["duration_s=1.0"]);
    sextant().arg("figure").arg(folder.path("star.mcap")).output().expect("the program starts").printed();
    let svg = fs::read_to_string(folder.path("star.figures/network.svg")).expect("a figure");
    assert!(svg.contains("1 sink") && !svg.contains("stop"), "{svg}");
}
