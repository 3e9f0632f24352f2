//! Every key of a summary is defined in `docs/metrics.md`.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use assert_cmd::prelude::*;
use serde_json::Value;
use tempfile::TempDir;

use crate::program::{scenario, sextant, summary};

/// A path from the top of the tree.
fn from_top(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

/// The words in code marks of the page.
fn defined(page: &str) -> BTreeSet<&str> {
    let marked = page.split('`').skip(1).step_by(2);
    marked.flat_map(|text| text.split(|c: char| !c.is_alphanumeric() && c != '_')).collect()
}

/// Adds the paths of the keys in a value that are not among `defined`.
fn undefined(value: &Value, defined: &BTreeSet<&str>, path: &str, found: &mut BTreeSet<String>) {
    match value {
        Value::Object(keys) => {
            for (key, value) in keys {
                let path = format!("{path}.{key}");
                if !defined.contains(key.as_str()) {
                    found.insert(path.clone());
                }
                undefined(value, defined, &path, found);
            }
        }
        Value::Array(items) => items.iter().for_each(|item| undefined(item, defined, path, found)),
        _ => {}
    }
}

/// The summary of a run with further arguments.
fn summary_of(folder: &Path, scenario: &Path, arguments: &[&str]) -> Value {
    let file = folder.join("summary.json");
    let mut run = sextant();
    run.arg("run").arg(scenario).arg("--out").arg(folder.join("run.mcap")).arg("--summary").arg(&file);
    run.args(["--quiet", "--set", "recording.frames=false"]).args(arguments).assert().success();
    summary(&file)
}

#[test]
fn every_key_of_a_summary_is_defined_on_the_page_of_metrics() {
    let page = std::fs::read_to_string(from_top("docs/metrics.md")).expect("the page of metrics");
    let defined = defined(&page);
    let folder = TempDir::new().expect("a folder");
    let few_seconds = ["--set", "duration_s=2.0"];
    let short = ["applications.0.duration_s=5.0", "applications.1.duration_s=5.0", "applications.2.duration_s=5.0"];
    let short = short.map(|setting| ["--set", setting]).concat();
    for (file, arguments) in [
        (scenario("smoke.toml"), &[][..]),
        (scenario("mac/acknowledged-star.toml"), &few_seconds),
        (from_top("docs/pictures/nodes-mobile.toml"), &[]),
        (scenario("seek/pioneer.toml"), &short),
    ] {
        let mut missing = BTreeSet::new();
        undefined(&summary_of(folder.path(), &file, arguments), &defined, "", &mut missing);
        assert!(missing.is_empty(), "{}: keys that docs/metrics.md does not define: {missing:#?}", file.display());
    }
}

#[test]
fn what_estimators_learn_is_defined_on_the_page_of_metrics() {
    let page = std::fs::read_to_string(from_top("docs/metrics.md")).expect("the page of metrics");
    let defined = defined(&page);
    let folder = TempDir::new().expect("a folder");
    let (recording, file) = (folder.path().join("run.mcap"), folder.path().join("map.json"));
    summary_of(folder.path(), &scenario("smoke.toml"), &[]);
    for algorithm in ["ml-tm", "self-calibrated", "rss-grid"] {
        let mut map = sextant();
        map.arg("map").arg(&recording).args(["--algorithm", algorithm, "--quiet", "--summary"]).arg(&file);
        map.assert().success();
        let mut missing = BTreeSet::new();
        undefined(&summary(&file), &defined, "", &mut missing);
        assert!(missing.is_empty(), "{algorithm}: keys that docs/metrics.md does not define: {missing:#?}");
    }
}

#[test]
fn a_key_that_the_page_lacks_is_found() {
    let value = serde_json::json!({ "maps": [{ "known": 1, "new": { "deep": 2 } }] });
    let mut found = BTreeSet::new();
    undefined(&value, &defined("`maps[]`: `known`, `deep_s` and deep"), "", &mut found);
    assert_eq!(found.into_iter().collect::<Vec<_>>(), [".maps.new", ".maps.new.deep"]);
}
