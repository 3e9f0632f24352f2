//! Nodes that move, end to end, against closed forms.

use std::fs;

use sextant::{Scenario, Summary, Unwatched};

use crate::programs::shipped;

fn summary(scenario: &Scenario) -> Summary {
    sextant::run(scenario, &mut (), &Unwatched).expect("a run").summary().clone()
}

/// Frames delivered, of those offered.
fn delivered(scenario: &Scenario) -> [f64; 2] {
    let all = summary(scenario).mac.expect("a sink").all;
    [all.delivered as f64, all.offered as f64]
}

#[test]
fn a_node_that_passes_is_heard_for_its_time_in_range() {
    // 2 √(50² - 30²) / (v T): 80 frames at 2 m/s.
    for (speed, seconds, expected) in [(2.0, 60.0, 80.0), (1.0, 120.0, 160.0), (4.0, 30.0, 40.0)] {
        let scenario = shipped("moving/passing.toml");
        let scenario = scenario.with("world.motions.0.motion.waypoints.speed_m_per_s", speed).expect("a setting");
        let scenario = scenario.with("duration_s", seconds).expect("a setting");
        let runs = 40_u32;
        let heard = (0..runs).map(|seed| delivered(&scenario.with("seed", seed).expect("a seed"))[0]);
        let mean = heard.sum::<f64>() / f64::from(runs);
        // A random phase gives one of two neighbouring numbers.
        assert!((mean - expected).abs() < 0.6, "{speed} m/s: {mean}");
        assert_eq!(summary(&scenario).simulation.expect("a simulation").moving_nodes, Some(1));
    }
}

/// Eight nodes with sinks and spatial shadowing; the motions, if any, are those of `more`.
fn star(more: &str) -> String {
    format!(
        r#"
name = "star"
duration_s = 40.0
[world.nodes.explicit]
positions_m = [[0, 0], [20, 0], [0, 20], [20, 20], [10, 0], [0, 10], [20, 10], [10, 20]]
[radio]
tx_power_dbm = 0.0
sensitivity_dbm = -85.0
[channel]
fading = {{ doppler_hz = 1.0 }}
shadowing = {{ sigma_db = 4.0, correlation.spatial = {{ distance_m = 5.0 }} }}
path_loss.log_distance = {{ exponent = 3.5, reference_loss_db = 40.0 }}
[traffic.poisson]
mpdu_octets = 60
rate_per_s = 8.0
acknowledged = true
[[sinks]]
name = "sink"
position_m = [10.0, 10.0]
{more}"#
    )
}

/// What the MAC of a run counted, in words.
fn counted(text: &str, files: &[(&str, &str)]) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        fs::write(folder.path().join(name), text).expect("a file");
    }
    let path = folder.path().join("star.toml");
    fs::write(&path, text).expect("a file");
    let scenario = Scenario::load(&path).expect("a scenario");
    format!("{:?}", summary(&scenario).mac.expect("a sink"))
}

#[test]
fn a_way_on_which_a_node_stands_changes_nothing() {
    let standing = counted(&star(""), &[]);
    let ways = "t_s,node,x_m,y_m\n0,n1,20,0\n40,n1,20,0\n5,n4,10,0\n";
    let entry = "[[world.motions]]\nnodes.names = [\"n1\", \"n4\"]\nmotion.file = { file = \"ways.csv\" }\n";
    assert_eq!(counted(&star(entry), &[("ways.csv", ways)]), standing);
}

#[test]
fn the_same_way_in_three_formats_gives_the_same_run_and_another_one_than_standing() {
    let csv = "t_s,node,x_m,y_m\n0,n1,20,0\n10,n1,20,0\n30,n1,60,0\n0,n2,0,20\n20,n2,0,60\n";
    let bonnmotion = "0 20 0 10 20 0 30 60 0\n0 0 20 20 0 60\n";
    let setdest = "$node_(0) set X_ 20\n$node_(0) set Y_ 0\n$node_(1) set X_ 0\n$node_(1) set Y_ 20\n\
                   $ns_ at 10.0 \"$node_(0) setdest 60 0 2.0\"\n$ns_ at 0.0 \"$node_(1) setdest 0 60 2.0\"\n";
    let run = |format: &str, text: &str| {
        let entry = format!(
            "[[world.motions]]\nnodes.names = [\"n1\", \"n2\"]\nmotion.file = {{ file = \"ways\", format = \"{format}\" }}\n"
        );
        counted(&star(&entry), &[("ways", text)])
    };
    let by_table = run("csv", csv);
    assert_eq!(run("bonnmotion", bonnmotion), by_table);
    assert_eq!(run("setdest", setdest), by_table);
    assert_ne!(counted(&star(""), &[]), by_table);
}

#[test]
fn a_node_that_jumps_out_of_reach_is_heard_until_then() {
    let run = |positions: &str| {
        let entry =
            "[[world.motions]]\nnodes.names = [\"n4\"]\nmotion.file = { file = \"ways\", format = \"positions\" }\n";
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("ways"), positions).expect("a file");
        let path = folder.path().join("star.toml");
        fs::write(&path, star(entry).replace("rate_per_s = 8.0", "rate_per_s = 1.0")).expect("a file");
        let scenario = Scenario::load(&path).expect("a scenario");
        let run = sextant::run(&scenario, &mut (), &Unwatched).expect("a run");
        run.survey().expect("a simulation").networks[0].packets[4]
    };
    let stays = run("0 0 10 5\n");
    let jumps = run("0 0 10 5\n0 20 5000 5\n");
    assert_eq!(jumps.offered, stays.offered);
    assert!(stays.received * 10 > stays.offered * 9, "{stays:?}");
    // Half of the time: 40 frames, so a standard deviation of 3.
    assert!((jumps.received * 2).abs_diff(stays.received) < stays.received / 2, "{jumps:?} {stays:?}");
}

#[test]
fn two_nodes_in_convoy_sense_each_other_all_the_way() {
    // The link between the two is within its range of 10 m all the time; to the sink it is not.
    let text = |gap: f64| {
        format!(
            r#"
name = "convoy"
duration_s = 100.0
[world.nodes.explicit]
positions_m = [[0, 0], [1, 0]]
[[world.motions]]
nodes.names = ["n0"]
motion.waypoints = {{ places_m = [[0, 0], [200, 0]], speed_m_per_s = 2.0 }}
[[world.motions]]
nodes.names = ["n1"]
motion.waypoints = {{ places_m = [[{gap}, 0], [{end}, 0]], speed_m_per_s = 2.0 }}
[radio]
tx_power_dbm = 0.0
sensitivity_dbm = -90.0
[channel]
max_range_m = 10.0
path_loss.log_distance = {{ exponent = 2.0, reference_loss_db = 40.0 }}
[mac.csma_unslotted]
[reception.overlap]
[traffic.saturated]
mpdu_octets = 100
[[sinks]]
name = "sink"
position_m = [5.0, 5.0]
"#,
            end = 200.0 + gap
        )
    };
    let backoffs_a_frame = |gap: f64| {
        let all = summary(&Scenario::parse(&text(gap)).expect("a scenario")).mac.expect("a sink").all;
        all.backoffs as f64 / all.transmissions as f64
    };
    let (near, far) = (backoffs_a_frame(5.0), backoffs_a_frame(15.0));
    // Within range each finds the channel busy while the other sends, all the way; beyond it there is one backoff a frame.
    assert!((far - 1.0).abs() < 1e-3 && near > 1.3, "{near} {far}");
}
