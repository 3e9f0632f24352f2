//! `sextant reproduce` from end to end.

use std::process::{Command, Output};

use tempfile::TempDir;

fn reproduce(arguments: &[&str], folder: &TempDir) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sextant"));
    command.env("NO_COLOR", "1").current_dir(folder.path()).arg("reproduce").args(arguments);
    command.output().expect("it starts")
}

#[test]
fn the_list_names_each_experiment_and_what_it_runs() {
    let folder = TempDir::new().unwrap();
    let output = reproduce(&["--list"], &folder);
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    for experiment in sextant::reproduce::CHAPTER_3 {
        let line = text.lines().find(|line| line.split_whitespace().next() == Some(experiment.id));
        let line = line.unwrap_or_else(|| panic!("{} is missing in:\n{text}", experiment.id));
        assert!(line.contains(experiment.title), "{line}");
    }
}

#[test]
fn an_experiment_leaves_its_table_and_the_scenarios_that_it_ran() {
    let folder = TempDir::new().unwrap();
    let output = reproduce(&["3.2", "--out", "here", "--quiet", "--format", "json"], &folder);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let lines = &json["reproduction"]["experiments"][0]["lines"];
    assert_eq!(lines.as_array().unwrap().len(), 4);
    let out = folder.path().join("here");
    let table = std::fs::read_to_string(out.join("3.2.csv")).unwrap();
    assert!(table.starts_with("what,published,unit,mean,half_width_95,runs,result\n"), "{table}");
    for (name, text) in sextant::reproduce::SHIPPED {
        assert_eq!(std::fs::read_to_string(out.join("scenarios").join(name)).unwrap(), *text);
    }
}

#[test]
fn what_there_is_not_is_refused_with_what_there_is() {
    let folder = TempDir::new().unwrap();
    let output = reproduce(&["9.9"], &folder);
    assert_eq!(output.status.code(), Some(2));
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(text.contains("`9.9`") && text.contains("3.6"), "{text}");
    assert_eq!(reproduce(&[], &folder).status.code(), Some(2), "without an id there is nothing to do");
    assert_eq!(reproduce(&["3.2", "--runs", "0"], &folder).status.code(), Some(2));
}
