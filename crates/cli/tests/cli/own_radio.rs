//! Networks whose programs command the radios: what a scenario may say of them, and what a run without programs does.

use std::fs;

use crate::program::{Said, scenario, sets, sextant, unwrapped};

/// Exit code and what is said, on one line, of `sextant check` with settings of the scenario of such a network.
fn checked(settings: &[&str]) -> (Option<i32>, String) {
    let path = fs::canonicalize(scenario("mac/own-radio.toml")).expect("the scenario is there");
    let (code, _, message) = sextant().arg("check").arg(path).args(sets(settings)).output().expect("it starts").all();
    (Some(code), unwrapped(&message))
}

#[test]
fn a_scenario_of_programs_is_good_and_says_that_it_has_none() {
    let (code, said) = checked(&[]);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("`mac.program`: no program comes with a scenario, so the nodes are silent"), "{said}");
    // No sink is needed: nodes receive themselves.
    assert_eq!(checked(&["sinks=[]"]).0, Some(0));
    assert_eq!(checked(&["traffic={silent={}}"]).0, Some(0));
}

#[test]
fn settings_that_make_no_sense_are_refused_with_words() {
    let cases: [(&[&str], &str); 8] = [
        (&["mac.program.channels=[27]"], "`mac.program.channels[0]` is 27; allowed: 11 to 26 with this `phy`"),
        (&["mac.program.channels=[15,26]"], "`mac.program.channels[1]` is 26, which is named before"),
        (&["mac.program.wake_up_us=100"], "`mac.program.wake_up_us` is 100; allowed: 192 to 1000000"),
        (&["mac.program.chanels=[12]"], "chanels"),
        (
            &["radio.clock_ppm=40"],
            "`radio.clock_ppm` is not 0, for all nodes or a group; allowed: 0 with `mac.program`",
        ),
        (
            &["traffic={poisson={mpdu_octets=20,rate_per_s=1}}"],
            "`traffic` conflicts with `mac.program`; remove the table, because nodes send what their programs say",
        ),
        (&["antenna={}"], "`antenna`"),
        (&["maps=[{algorithm={mds_map={}}}]"], "`mac.program` conflicts with the map"),
    ];
    for (settings, words) in cases {
        let (code, said) = checked(settings);
        assert_eq!(code, Some(2), "{settings:?}: {said}");
        assert!(said.contains(words), "{settings:?}: {said}");
    }
}

#[test]
fn a_run_without_programs_is_silent() {
    let folder = tempfile::tempdir().expect("there is room");
    let path = fs::canonicalize(scenario("mac/own-radio.toml")).expect("the scenario is there");
    let output = sextant()
        .current_dir(folder.path())
        .args(["run", "--quiet", "--format", "json", "--set", "duration_s=1"])
        .arg(path)
        .output()
        .expect("it starts");
    let text = String::from_utf8(output.stdout).expect("text");
    let summary: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(summary["mac"]["offered"], 0);
    // Ten nodes are off for a second: 20 uA at 3 V.
    let idle_j = summary["mac"]["energy_j"]["idle"].as_f64().expect("a number");
    assert!((idle_j - 600e-6).abs() < 1e-9, "{idle_j}");
}
