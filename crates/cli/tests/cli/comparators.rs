//! The algorithms for comparison, from a scenario to the table, the summary and the recording.

use std::path::PathBuf;

use serde_json::json;
use tempfile::TempDir;

use crate::program;

const CLASSICS: [&str; 11] = [
    "ml-tm",
    "tpm",
    "rssi-triangle-centroid",
    "centroid",
    "weighted-centroid",
    "apit",
    "dv-hop",
    "mds-map",
    "smacof",
    "rss-ml",
    "rss-grid",
];

fn classics() -> PathBuf {
    program::scenario("ml-tm/classics.toml")
}

fn sextant() -> assert_cmd::Command {
    assert_cmd::Command::from_std(program::sextant())
}

#[test]
fn every_classic_runs_reports_its_knowledge_and_gives_the_same_map_from_the_recording() {
    let folder = TempDir::new().unwrap();
    let [recording, summary, again] = ["run.mcap", "run.json", "map.json"].map(|name| folder.path().join(name));
    let run = sextant()
        .args(["run".as_ref(), classics().as_os_str(), "--out".as_ref(), recording.as_os_str()])
        .args(["--summary".as_ref(), summary.as_os_str()])
        .assert()
        .success();
    let table = String::from_utf8_lossy(&run.get_output().stdout).into_owned();
    assert!(table.contains("neighbours (aligned to the truth)") && table.contains("anchor RSSI, anchors, path loss"));
    let summary = program::summary(&summary);
    let maps = summary["maps"].as_array().expect("maps");
    let names: Vec<_> = maps.iter().map(|map| map["algorithm"].as_str().expect("a name")).collect();
    assert_eq!(names, CLASSICS);
    let map = |name: &str| &maps[CLASSICS.iter().position(|other| *other == name).expect("a classic")];
    for map in maps {
        assert_eq!((&map["mapped"], &map["unmapped"]), (&json!(150), &json!(0)), "{map}");
        let cdf = map["connectivity_errors"][0]["node_error_cdf"].as_array().expect("a distribution");
        let shares: Vec<f64> = cdf.iter().map(|pair| pair[1].as_f64().expect("a share")).collect();
        assert!(shares.windows(2).all(|pair| pair[0] <= pair[1]), "{shares:?}");
        assert!((shares[10] - 1.0).abs() < 1e-12);
        let error = |key: &str| map[key]["mean"].as_f64().expect("an error");
        assert!(error("aligned_error_m") <= error("aligned_error_without_reflection_m") * (1.0 + 1e-9));
    }
    assert_eq!(map("ml-tm")["knowledge"], json!(["robot-receptions"]));
    assert_eq!((&map("ml-tm")["alignment"], &map("tpm")["alignment"]), (&json!("none"), &json!("truth")));
    assert_eq!(map("mds-map")["alignment"], json!("anchors"));
    assert_eq!(map("rss-ml")["knowledge"], json!(["neighbour-rssi", "anchor-rssi", "anchors", "path-loss"]));
    assert_eq!(map("rss-grid")["knowledge"], json!(["robot-rssi", "path-loss"]));
    // More knowledge gives smaller errors: strengths are better than receptions, cooperation than anchors alone.
    let mean_m = |name: &str| map(name)["position_error_m"]["mean"].as_f64().expect("an error");
    assert!(mean_m("rss-ml") < mean_m("rssi-triangle-centroid") && mean_m("rss-grid") < mean_m("ml-tm"));
    // Energy by messages: N n E_tx with CC2420 at its lowest level, 8.5 mA, and frames of 832 us.
    let stops = summary["gathering"]["stops"].as_f64().expect("stops");
    let expected_j = 150.0 * stops * 3.0 * 8.5e-3 * 832e-6;
    let found_j = map("ml-tm")["message_energy_j"].as_f64().expect("energy");
    assert!((found_j / expected_j - 1.0).abs() < 1e-9, "{found_j} not {expected_j}");
    let energy_j = |name: &str| map(name)["message_energy_j"].as_f64().expect("energy");
    assert!(energy_j("rssi-triangle-centroid") < energy_j("ml-tm"), "the thesis: RSSI is the most efficient");
    assert_eq!(map("dv-hop").get("message_energy_j"), None, "the thesis has no formula for it");
    let discovery = &summary["discovery"];
    assert_eq!((&discovery["neighbours"]["senders"], &discovery["anchors"]["senders"]), (&json!(150), &json!(30)));
    assert!(discovery["neighbours"]["energy_j"]["rx"].as_f64().expect("energy") > 50.0);

    // The recording contains everything that the maps need.
    let log = [recording.as_os_str(), "--summary".as_ref(), again.as_os_str(), "--quiet".as_ref()];
    sextant().arg("map").args(log).assert().success();
    let again = program::summary(&again);
    for (map, again) in maps.iter().zip(again["maps"].as_array().expect("maps")) {
        for key in ["mapped", "position_error_m", "connectivity_error", "alignment", "knowledge"] {
            assert_eq!(map[key], again[key], "{} {key}", map["algorithm"]);
        }
    }
}

#[test]
fn invalid_settings_of_anchors_and_discovery_are_rejected_before_anything_runs() {
    let check = |set: &str| {
        let output = sextant().arg("check").arg(classics()).assert().success();
        drop(output);
        let folder = TempDir::new().expect("a folder");
        let out = folder.path().join("run.mcap");
        let refused = sextant()
            .args(["run".as_ref(), classics().as_os_str(), "--set".as_ref(), set.as_ref()])
            .args(["--out".as_ref(), out.as_os_str()])
            .assert()
            .code(2);
        assert!(!out.exists());
        String::from_utf8_lossy(&refused.get_output().stderr).into_owned()
    };
    let error = check("anchors.count=3");
    assert!(error.contains("anchors") && error.contains("at least 4, for the maps `mds-map`, `smacof`"), "{error}");
    let error = check("anchors.share=1.5");
    assert!(error.contains("anchors.share") && error.contains("0 to 1"), "{error}");
    let error = check("discovery.range_m=-1");
    assert!(error.contains("discovery.range_m"), "{error}");
    let error = check("maps.1.algorithm.tpm.link_share=2");
    assert!(error.contains("link_share") && error.contains("above 0, at most 1"), "{error}");
}

#[test]
fn a_map_that_needs_neighbours_is_rejected_for_a_log_without_them() {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("stops.csv"), "stop,t_s,x_m,y_m,z_m\n0,0,0,0,0\n1,1,1,0,0\n").unwrap();
    std::fs::write(folder.path().join("receptions.csv"), "node,stop,received\na,0,1\n").unwrap();
    let set = "maps.0.algorithm.tpm={}";
    let refused = sextant().arg("map").arg(folder.path()).args(["--set", set]).assert().code(2);
    let error = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    assert!(error.contains("`tpm` needs what the nodes heard of each other"), "{error}");
}
