//! Settings that would have no effect are refused, and mistakes are told once.

use std::fs;
use std::path::Path;
use std::process::Output;

use crate::program::{Said, folder, scenario, sextant, unwrapped};

/// The smoke scenario with this sweep, in a folder of its own.
fn swept(sweep: &str) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().expect("there is room");
    let base = fs::canonicalize(scenario("smoke.toml")).expect("the smoke scenario is there");
    let path = folder.path().join("swept.toml");
    fs::write(&path, format!("extends = '{}'\n{sweep}", base.display())).expect("there is room");
    (folder, path)
}

fn sextant_with(arguments: &[&str], path: &Path) -> Output {
    let folder = path.parent().expect("a file lies in a folder");
    sextant().current_dir(folder).args(arguments).arg(path).output().expect("it starts")
}

/// What a command that refuses its input says, on one line.
fn refused(arguments: &[&str], path: &Path) -> String {
    sextant_with(arguments, path).refusal()
}

#[test]
fn a_setting_that_each_cell_of_a_sweep_replaces_is_refused() {
    let (_folder, path) = swept(
        "[sweep]\nruns = 1\n[sweep.product]\n\"robots.0.speed_m_per_s\" = [1, 2]\n\
         maps.0.algorithm.ml_tm.profile = [{ trapezoid = { p0 = 0.8, plateau_m = 2.0, range_m = 6.0 } }]\n\
         [sweep.zip]\nradio.tx_power_dbm = [-50, -45]\n",
    );
    for (setting, place) in [
        ("robots.0.speed_m_per_s=3", "sweep.product.\"robots.0.speed_m_per_s\""),
        ("robots[0].speed_m_per_s=3", "sweep.product.\"robots.0.speed_m_per_s\""),
        ("radio.tx_power_dbm=-60", "sweep.zip.radio.tx_power_dbm"),
        // A table, a part of which is replaced.
        ("radio={tx_power_dbm=-60, sensitivity_dbm=-90}", "sweep.zip.radio.tx_power_dbm"),
        // A part of a value that is replaced as a whole.
        ("maps.0.algorithm.ml_tm.profile.trapezoid.p0=0.5", "sweep.product.maps.0.algorithm.ml_tm.profile"),
    ] {
        let said = refused(&["sweep", "--dry-run", "--set", setting], &path);
        assert!(said.contains(&format!("the setting `{setting}` has no effect")), "{said}");
        assert!(said.contains(place), "{said}");
        let plan = path.with_file_name("plan");
        let plan = plan.to_str().expect("text");
        let said = refused(&["sweep", "--plan", plan, "--set", setting], &path);
        assert!(said.contains("has no effect") && !Path::new(plan).exists(), "{said}");
    }
    let said = refused(&["sweep", "--dry-run", "--set", "robots.0.speed_m_per_s=3"], &path);
    assert!(said.contains("set `sweep.product.\"robots.0.speed_m_per_s\"=[3]` instead"), "{said}");
}

#[test]
fn settings_beside_those_that_a_sweep_varies_have_their_effect() {
    let (_folder, path) = swept(
        "[sweep]\nruns = 1\n[sweep.product]\n\"robots.0.speed_m_per_s\" = [1, 2]\n[[sweep.list]]\nseed_of_nothing = 1\n",
    );
    let text =
        fs::read_to_string(&path).expect("it was written").replace("seed_of_nothing = 1", "radio.tx_power_dbm = -45");
    fs::write(&path, text + "[[sweep.list]]\nradio.sensitivity_dbm = -80\n").expect("there is room");
    for setting in [
        "robots.0.radius_m=0.1",
        "radio={tx_power_dbm=-60, sensitivity_dbm=-90}",
        // The second cell of the list does not set it.
        "radio.tx_power_dbm=-60",
        // What the hint of the error says.
        "sweep.product.\"robots.0.speed_m_per_s\"=[3]",
    ] {
        sextant_with(&["sweep", "--dry-run", "--set", setting], &path).printed();
    }
    // `run` does not sweep, and `check` is for both.
    for arguments in [
        &["check", "--set", "robots.0.speed_m_per_s=3"][..],
        &["run", "--quiet", "--set", "robots.0.speed_m_per_s=3"],
    ] {
        sextant_with(arguments, &path).printed();
    }
}

#[test]
fn seeds_beyond_the_greatest_one_are_refused() {
    let (_folder, path) = swept("[sweep]\nruns = 2\n");
    let greatest = u64::MAX.to_string();
    let said = refused(&["sweep", "--dry-run", "--seed", &greatest], &path);
    assert!(said.contains(&format!("allowed: a seed of at most {}", u64::MAX - 1)), "{said}");
    let said = refused(&["sweep", "--dry-run", "--shard", "1/2", "--runs", "10", "--seed", &greatest], &path);
    assert!(said.contains(&format!("allowed: a seed of at most {}", u64::MAX - 9)), "{said}");
    let said = sextant_with(&["sweep", "--dry-run", "--runs", "1", "--seed", &greatest], &path).printed();
    assert!(said.contains(&format!("with the seeds {greatest} to {greatest}")), "{said}");
}

#[test]
fn a_seed_or_a_number_of_runs_that_is_given_twice_is_refused() {
    let (_folder, path) = swept("[sweep]\nruns = 2\n");
    for arguments in [
        &["run", "--quiet", "--seed", "4", "--set", "seed=5"][..],
        &["sweep", "--dry-run", "--seed", "4", "--set", "seed=5"],
        &["sweep", "--dry-run", "--runs", "4", "--set", "sweep.runs=5"],
    ] {
        let said = refused(arguments, &path);
        assert!(said.contains("has no effect: 4 is given for") && said.contains("give only one"), "{said}");
    }
}

#[test]
fn a_setting_that_a_later_one_replaces_is_refused_and_keys_that_one_leaves_out_are_named() {
    let (_folder, path) = swept("[sweep]\nruns = 1\nproduct.radio.tx_power_dbm = [-50, -45]\n");
    for command in [&["run", "--quiet"][..], &["check"], &["sweep", "--dry-run"]] {
        let said = refused(
            &[command, &["--set", "channel.max_range_m=5", "--set", "channel.max_range_m=4"]].concat(),
            &path,
        );
        assert!(said.contains("`channel.max_range_m=5` has no effect"), "{command:?}: {said}");
        let table = "channel.path_loss={log_distance={exponent=3}}";
        let (code, _, said) = sextant_with(&[command, &["--set", table]].concat(), &path).all();
        assert!(code == 0 && said.contains("log_distance.reference_loss_db` of the file"), "{said}");
    }
}

#[test]
fn a_mistake_that_concerns_several_parts_is_told_once() {
    let maps = ["a", "b", "c"].map(|name| format!("[[maps]]\nname = \"{name}\"\nalgorithm = \"dv_hop\"\n")).concat();
    let obstacle = "[[world.obstacles]]\nmaterial = \"concrete\"\n\
                    shape.box = { center_m = [0, 0, 0], size_m = [90, 90, 9] }\n";
    let nodes = "[world.nodes.explicit]\npositions_m = [[0, 0], [1, 0], [2, 1], [5, 5]]\n";
    let rest = "[radio]\ntx_power_dbm = 0\nsensitivity_dbm = -90\n[traffic.periodic]\n[[robots]]\nname = \"r\"\n\
                start_m = [60, 0]\n[robots.controller.s_path]\nlane_spacing_m = 1\nstop_spacing_m = 1\n\
                region.rectangle = { min_m = [60, 0], max_m = [63, 3] }\n";
    for (text, mistake) in [
        (format!("name = \"m\"\n{nodes}{rest}[anchors]\ncount = 1\n{maps}"), "for the maps `a`, `b`, `c`"),
        (format!("name = \"m\"\n{nodes}{obstacle}{rest}"), "and 3 others as wrong"),
    ] {
        let folder = folder(&[("mistake.toml", &text)]);
        let path = folder.path().join("mistake.toml");
        for command in [&["check"][..], &["run", "--quiet"], &["sweep", "--quiet"]] {
            let (_, _, said) = sextant_with(command, &path).all();
            assert_eq!(said.matches('×').count(), 1, "{command:?}: {said}");
            let line = unwrapped(&said);
            assert!(line.contains(mistake), "{command:?}: {line}");
        }
    }
}
