//! Faults of a scenario: lost frames, nodes that die, anchors that lie.

use serde_json::Value;
use tempfile::TempDir;

use crate::program::{self, Said, sets};

/// Antennas of nodes, one of which would look beyond the vertical.
const TILTED: &str =
    "antenna={nodes={sectors={azimuth_sectors=8}}, robots={omnidirectional={}}, node_tilts_deg=[0.0, 95.0]}";

/// The summary of a run of a scenario with these settings, without its timing.
fn run(scenario: &str, settings: &[&str]) -> Value {
    let folder = TempDir::new().expect("there is room");
    let [recording, summary] = ["run.mcap", "run.json"].map(|name| folder.path().join(name));
    let mut program = program::sextant();
    program.arg("run").arg(program::scenario(scenario)).args(["--quiet", "--out"]).arg(recording);
    program.arg("--summary").arg(&summary);
    program.args(sets(settings)).output().expect("the program starts").printed();
    let mut summary = program::summary(&summary);
    let keys = summary.as_object_mut().expect("an object");
    keys.remove("timing");
    keys.remove("scenario");
    summary
}

/// The errors of a scenario with these settings.
fn refused(scenario: &str, settings: &[&str]) -> String {
    let mut program = program::sextant();
    let output = program.arg("run").arg(program::scenario(scenario)).args(sets(settings)).output();
    output.expect("the program starts").refusal()
}

#[test]
fn lost_frames_and_deaths_leave_fewer_receptions_and_the_dead_are_named() {
    let received = |summary: &Value| summary["gathering"]["packets_received"].as_u64().expect("a count");
    let without = run("smoke.toml", &[]);
    assert_eq!(run("smoke.toml", &["faults.message_loss=0.0"]), without);
    assert_eq!(without.get("faults"), None);
    let lossy = run("smoke.toml", &["faults.message_loss=0.9"]);
    assert!(received(&lossy) < received(&without) / 2, "{} of {}", received(&lossy), received(&without));
    let deaths = ["faults.deaths.share=0.5", "faults.deaths.from_s=0.0", "faults.deaths.to_s=5.0"];
    let dying = run("smoke.toml", &deaths);
    let nodes = without["simulation"]["nodes"].as_u64().expect("a count");
    let names = dying["faults"]["deaths"].as_array().expect("names");
    assert_eq!(names.len() as u64, nodes.div_ceil(2));
    assert!(received(&dying) < received(&without));
    assert_eq!(run("smoke.toml", &deaths), dying);
}

#[test]
fn maps_use_the_places_that_lying_anchors_believe_in() {
    let one = ["maps=[{algorithm={dv_hop={}}},{algorithm={ml_tm={grid_step_m=0.5,profile={channel={}}}}}]"];
    let truth = run("ml-tm/classics.toml", &one);
    let lies = ["faults.lying_anchors.share=1.0", "faults.lying_anchors.distance_m=40.0"];
    let lied = run("ml-tm/classics.toml", &[&one[..], &lies[..]].concat());
    let error_m = |summary: &Value, map: usize| summary["maps"][map]["position_error_m"]["mean"].as_f64().expect("m");
    assert!(error_m(&lied, 0) > error_m(&truth, 0) + 5.0, "{} and {}", error_m(&lied, 0), error_m(&truth, 0));
    assert_eq!(lied["maps"][1], truth["maps"][1]);
    let names = lied["faults"]["lying_anchors"].as_array().expect("names");
    // A fifth of the 150 nodes are anchors.
    assert_eq!(names.len(), 30);
}

#[test]
fn invalid_faults_are_refused_at_their_keys() {
    let lying = "faults.lying_anchors.distance_m=5.0";
    for (settings, key, found) in [
        (&["faults.message_loss=1.5"][..], "faults.message_loss", "1.5"),
        (&["faults.message_loss=nan"][..], "faults.message_loss", "NaN"),
        (&["faults.deaths={share=1.5, from_s=0, to_s=1}"][..], "faults.deaths.share", "1.5"),
        (&["faults.deaths={share=0.5, from_s=2, to_s=1}"][..], "faults.deaths.to_s", "1"),
        (&["faults.deaths={names=[\"nobody\"], from_s=0, to_s=1}"][..], "faults.deaths.names[0]", "`nobody`"),
        (&["faults.lying_anchors.names=[\"nobody\"]", lying][..], "faults.lying_anchors.names[0]", "`nobody`"),
        (&[lying][..], "faults.lying_anchors", "is missing"),
    ] {
        let text = refused("smoke.toml", settings);
        assert!(text.contains(key) && text.contains(found), "{settings:?}: {text}");
    }
}

#[test]
fn a_mobile_anchor_needs_messages_to_send() {
    let text = refused("smoke.toml", &["robots.0.role=\"anchor\""]);
    assert!(text.contains("robots[0].role") && text.contains("\"survey\""), "{text}");
}

#[test]
fn a_tilt_that_raises_a_beam_beyond_the_vertical_is_refused() {
    let text = refused("smoke.toml", &[TILTED, "mac={sector_sweep={}}"]);
    assert!(text.contains("antenna.node_tilts_deg[1]") && text.contains("95"), "{text}");
}
