//! The JSON schema of scenarios, judged by an independent validator: Python's `jsonschema`. `SEXTANT_PYTHON` names a Python
//! with it. An editor's checker, taplo, judges it too, if `SEXTANT_TAPLO` names it.

use std::path::Path;
use std::process::Command;

use crate::program::{scenario, sextant};

/// Files that the program refuses: what is wrong with each, and its text.
const BAD: &[(&str, &str)] = &[
    ("unknown_key", "extends = 'a.toml'\nsede = 3\n"),
    ("unknown_nested_key", "extends = 'a.toml'\n[radio]\ntx_power = 0\n"),
    ("wrong_type", "extends = 'a.toml'\nseed = 'three'\n"),
    ("wrong_nested_type", "extends = 'a.toml'\n[channel.path_loss.log_distance]\nexponent = true\n"),
    ("wrong_choice", "extends = 'a.toml'\n[channel]\nenvironment = 'moon'\n"),
    ("wrong_table", "extends = 'a.toml'\n[mac.aloha]\n"),
    ("two_choices", "extends = 'a.toml'\n[[robots]]\n[robots.controller]\nspiral = {}\nhilbert = {}\n"),
    ("negative", "extends = 'a.toml'\nseed = -1\n"),
    ("missing_key", "name = 'a'\n"),
    ("missing_nested_key", "name = 'a'\n[world.nodes.explicit]\npositions_m = [[0, 0]]\n[radio]\ntx_power_dbm = 0\n"),
    ("choice_that_needs_settings", "extends = 'a.toml'\n[[maps]]\nalgorithm.ml_tm.profile = 'trapezoid'\n"),
    ("null_place", "extends = 'a.toml'\n[[robots]]\nstart_m = [1]\n"),
];

/// Writes the schema and the bad files into `folder`.
fn write_files(folder: &Path) {
    let output = sextant().arg("schema").output().expect("the program starts");
    assert!(output.status.success());
    std::fs::write(folder.join("scenario.schema.json"), output.stdout).expect("there is room");
    for (name, text) in BAD {
        std::fs::write(folder.join(format!("{name}.toml")), text).expect("there is room");
    }
}

fn bad_files(folder: &Path) -> Vec<std::path::PathBuf> {
    BAD.iter().map(|(name, _)| folder.join(format!("{name}.toml"))).collect()
}

#[test]
fn an_independent_validator_accepts_all_scenarios_and_rejects_bad_files() {
    let Some(python) = std::env::var_os("SEXTANT_PYTHON") else {
        eprintln!("left out: SEXTANT_PYTHON is not set");
        return;
    };
    let folder = tempfile::tempdir().expect("there is room");
    write_files(folder.path());
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cli/python/check_schema.py");
    let output = Command::new(python)
        .arg(script)
        .arg(folder.path().join("scenario.schema.json"))
        .arg(scenario(""))
        .args(bad_files(folder.path()))
        .output()
        .expect("Python starts");
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    assert!(text.contains(&format!("{} rejected", BAD.len())), "{text}");
}

#[test]
fn the_program_refuses_the_bad_files_too() {
    let folder = tempfile::tempdir().expect("there is room");
    write_files(folder.path());
    std::fs::copy(scenario("smoke.toml"), folder.path().join("a.toml")).expect("there is room");
    for file in bad_files(folder.path()) {
        let output = sextant().arg("check").arg(&file).output().expect("the program starts");
        assert_eq!(output.status.code(), Some(2), "{}", file.display());
    }
}

#[test]
fn an_editor_accepts_scenarios_with_the_schema_in_their_header_and_rejects_bad_files() {
    let Some(taplo) = std::env::var_os("SEXTANT_TAPLO") else {
        eprintln!("left out: SEXTANT_TAPLO is not set");
        return;
    };
    let folder = tempfile::tempdir().expect("there is room");
    write_files(folder.path());
    let lint = |name: &str, text: &str| {
        let file = folder.path().join(name);
        std::fs::write(&file, format!("#:schema ./scenario.schema.json\n{text}")).expect("there is room");
        let output = Command::new(&taplo).args(["lint", name]).current_dir(folder.path()).output();
        let output = output.expect("taplo starts");
        (output.status.success(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    for name in ["smoke.toml", "mac/beacon-enabled.toml", "seek/two-sources.toml", "dmtm/hs-greenhouse.toml"] {
        let text = std::fs::read_to_string(scenario(name)).expect("a shipped scenario");
        let (accepted, messages) = lint("good.toml", &text);
        assert!(accepted, "{name}: {messages}");
    }
    for (name, text) in BAD {
        let (accepted, messages) = lint("bad.toml", text);
        assert!(!accepted, "{name}: {messages}");
    }
}
