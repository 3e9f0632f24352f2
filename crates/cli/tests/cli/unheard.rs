//! Nodes that nobody hears: they are in each figure of a study.

use std::path::Path;

use serde_json::{Map, Value};

use crate::program::{Said, folder, scenario, sets, sextant};

/// A sink, and nodes at these distances from it (m), each with a packet of 20 octets a second for two minutes.
fn star(distances_m: &[f64]) -> String {
    let places: Vec<String> = distances_m.iter().map(|x_m| format!("[{x_m}, 0]")).collect();
    format!(
        r#"name = "star"
duration_s = 120.0

[world.nodes.explicit]
positions_m = [{}]

[radio]
tx_power_dbm = 0.0
sensitivity_dbm = -90.0

[channel.path_loss.log_distance]
exponent = 3.0

[mac.csma_unslotted]

[traffic.periodic]
mpdu_octets = 20
interval_s = 1.0

[[sinks]]
name = "sink"
position_m = [0, 0]
"#,
        places.join(", ")
    )
}

/// The summary of a scenario with these settings.
fn run(path: &Path, settings: &[&str]) -> Value {
    let folder = tempfile::tempdir().expect("there is room");
    let mut command = sextant();
    command.current_dir(folder.path()).arg("run").arg(path).args(["--quiet", "--format", "json"]);
    command.args(sets(settings)).output().expect("it starts").json()
}

/// The summary of a text.
fn run_text(text: &str, settings: &[&str]) -> Value {
    run(&folder(&[("scenario.toml", text)]).path().join("scenario.toml"), settings)
}

/// The same without what tells of the work and not of the network: times, events, and which part was simulated.
fn figures(mut summary: Value) -> Value {
    let table = |value: &mut Value, key: &str| value.get_mut(key).and_then(Value::as_object_mut).cloned();
    let mut simulation: Map<String, Value> = table(&mut summary, "simulation").expect("a simulation");
    ["events", "region"].iter().for_each(|key| drop(simulation.remove(*key)));
    let mut identity: Map<String, Value> = table(&mut summary, "scenario").expect("a scenario");
    identity.remove("sha256");
    summary["simulation"] = simulation.into();
    summary["scenario"] = identity.into();
    summary.as_object_mut().expect("an object").remove("timing");
    summary
}

fn number(summary: &Value, pointer: &str) -> f64 {
    summary.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer}: {summary:#}"))
}

#[test]
fn a_node_that_no_sink_hears_has_its_packets_and_its_energy() {
    let near = run_text(&star(&[10.0]), &[]);
    assert_eq!(near["mac"]["prr"], 1.0);
    for far_m in [700.0, 1000.0, 1e5] {
        let both = run_text(&star(&[10.0, far_m]), &[]);
        // One packet a second of each, with a phase of up to a second.
        let offered = number(&both, "/mac/offered");
        assert!((238.0..=240.0).contains(&offered), "{far_m}: {offered}");
        assert!((number(&both, "/mac/prr") - 0.5).abs() < 0.005, "{far_m}");
        assert_eq!(both["mac"]["delivered"], near["mac"]["delivered"], "{far_m}");
        assert_eq!(both["mac"]["nodes"][1]["delivered"], 0, "{far_m}");
        assert_eq!(both["mac"]["nodes"][1]["prr"], 0.0, "{far_m}");
        // 26 octets of 32 us on air, with 17.4 mA at 3 V.
        let tx_j = number(&both, "/mac/sent") * 26.0 * 32e-6 * 17.4e-3 * 3.0;
        assert!((number(&both, "/mac/energy_j/tx") / tx_j - 1.0).abs() < 1e-6, "{far_m}");
    }
}

#[test]
fn the_share_of_received_packets_falls_with_the_distance_and_stays_at_zero() {
    let prr = |distance_m: f64| number(&run_text(&star(&[distance_m]), &[]), "/mac/prr");
    let shares = [1.0, 10.0, 30.0, 50.0, 100.0, 200.0, 400.0, 700.0, 1000.0, 5000.0, 1e6].map(prr);
    assert!(shares.is_sorted_by(|near, far| near >= far), "{shares:?}");
    assert_eq!((shares[0], shares[7..].to_vec()), (1.0, vec![0.0; 4]), "{shares:?}");
}

#[test]
fn each_kind_of_traffic_has_the_same_summary_wherever_its_nodes_are_simulated() {
    let periodic = "[traffic.periodic]\nmpdu_octets = 20\ninterval_s = 1.0\n";
    for traffic in [
        periodic.to_owned(),
        format!("{periodic}acknowledged = true\n"),
        "[traffic.poisson]\nrate_per_s = 4.0\n".to_owned(),
        "[traffic.poisson]\nrate_per_s = 4.0\nacknowledged = true\nto = \"sink\"\n".to_owned(),
        "[traffic.saturated]\nmpdu_octets = 100\n".to_owned(),
        "[traffic.once]\nat_s = 3.0\nacknowledged = true\n".to_owned(),
    ] {
        let text = star(&[10.0, 14.0, 800.0, 1200.0, 1201.0]).replace(periodic, &traffic).replace("120.0", "10.0");
        let all = figures(run_text(&text, &["simulation.region=all"]));
        for region in ["auto", "listeners"] {
            let spared = figures(run_text(&text, &[&format!("simulation.region={region}")]));
            assert_eq!(spared, all, "{traffic}{region}");
        }
        let deaf = &all["mac"]["nodes"][2];
        assert!(number(deaf, "/transmissions") >= number(deaf, "/sent") && number(deaf, "/sent") > 0.0, "{deaf:#}");
    }
}

#[test]
fn a_survey_counts_the_nodes_out_of_reach_of_its_stops() {
    let robot = "[[robots]]\nname = \"surveyor\"\nstart_m = [0, 0]\nlisten_s = 20.0\n\
                 [robots.controller.s_path]\nlane_spacing_m = 4.0\nstop_spacing_m = 4.0\n\
                 region.rectangle = { min_m = [0, 0], max_m = [8, 4] }\n";
    let text = star(&[3.0, 6.0, 900.0, 903.0]);
    let text = format!("{}{robot}", text.split("[[sinks]]").next().unwrap_or_default().replace("duration_s", "#"));
    let all = figures(run_text(&text, &["simulation.region=all"]));
    let spared = figures(run_text(&text, &[]));
    assert_eq!(spared, all);
    // Asked for the saving, the nodes at rest are still offered, and the summary says that they rest.
    let saved = figures(run_text(&text, &["simulation.region=listeners"]));
    let counts = |summary: &Value| summary["gathering"]["packets_offered"].clone();
    assert_eq!(counts(&saved), counts(&all));
    assert!(number(&saved, "/gathering/packets_not_simulated") > 100.0, "{saved:#}");
    for pointer in ["/gathering/packets_sent", "/gathering/energy_j/tx", "/gathering/energy_j/rx"] {
        let (found, expected) = (number(&saved, pointer), number(&all, pointer));
        assert!((found / expected - 1.0).abs() < 0.02, "{pointer}: {found} {expected}");
    }
}

#[test]
fn shipped_scenarios_with_traffic_have_the_same_summary_wherever_nodes_are_simulated() {
    for (name, settings) in [
        ("smoke.toml", &[][..]),
        ("mac/hidden-nodes.toml", &["duration_s=5"]),
        ("mac/acknowledged-star.toml", &["duration_s=5"]),
        ("mac/poisson-star.toml", &["duration_s=5"]),
        ("mac/one-shot-star.toml", &[]),
        ("mac/packet-trace.toml", &[]),
    ] {
        let all = figures(run(&scenario(name), &[settings, &["simulation.region=all"]].concat()));
        assert_eq!(figures(run(&scenario(name), settings)), all, "{name}");
    }
}

#[test]
fn the_energy_is_that_of_a_chip_of_the_band_of_the_radios() {
    // By the data sheets at 3 V: the AT86RF212B takes 18 mA to transmit at up to 5 dBm, the CC2420 17.4 mA at 0 dBm.
    for (phy, octet_s, header_s, ma) in [
        ("oqpsk2450", 32e-6, 192e-6, 17.4),
        ("bpsk868", 400e-6, 48.0 * 50e-6, 18.0),
        ("bpsk915", 200e-6, 48.0 * 25e-6, 18.0),
        ("ask868", 32e-6, 3.4 * 80e-6, 18.0),
        ("oqpsk915", 32e-6, 192e-6, 18.0),
    ] {
        let text = star(&[10.0]).replace("[radio]\n", &format!("[radio]\nphy = \"{phy}\"\n"));
        let summary = run_text(&text, &[]);
        let tx_j = number(&summary, "/mac/sent") * (header_s + 20.0 * octet_s) * ma * 1e-3 * 3.0;
        let found = number(&summary, "/mac/energy_j/tx");
        assert!((found / tx_j - 1.0).abs() < 1e-6, "{phy}: {found} {tx_j}");
    }
}
