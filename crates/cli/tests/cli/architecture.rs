//! The crates depend on each other in one direction only.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

/// What each crate may depend on, tests and benchmarks included: one line an arrow of the crate graph in README.md.
const ALLOWED: [(&str, &[&str]); 7] = [
    ("sextant-kernel", &[]),
    ("sextant-channel", &["sextant-kernel"]),
    ("sextant-mac", &["sextant-kernel", "sextant-channel"]),
    ("sextant-sim", &["sextant-kernel", "sextant-channel", "sextant-mac"]),
    ("sextant-mapper", &["sextant-kernel", "sextant-channel"]),
    ("sextant-apps", &["sextant-kernel", "sextant-channel", "sextant-mac", "sextant-sim", "sextant-mapper"]),
    (
        "sextant",
        &["sextant-kernel", "sextant-channel", "sextant-mac", "sextant-sim", "sextant-mapper", "sextant-apps"],
    ),
];

#[test]
fn crates_depend_in_one_direction() {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--no-deps", "--offline"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs, as it runs this test");
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).expect("cargo prints JSON");
    let mut found = BTreeMap::new();
    for package in metadata["packages"].as_array().expect("a list of packages") {
        let name = package["name"].as_str().expect("a package has a name");
        let dependencies = package["dependencies"].as_array().expect("a list of dependencies").iter();
        let own: BTreeSet<_> = (dependencies.filter_map(|dependency| dependency["name"].as_str()))
            .filter(|dependency| dependency.starts_with("sextant"))
            .collect();
        found.insert(name, own);
    }
    for (name, allowed) in ALLOWED {
        let own = found.get(name).unwrap_or_else(|| panic!("no crate {name}"));
        let beyond: Vec<_> = own.iter().filter(|dependency| !allowed.contains(dependency)).collect();
        assert!(beyond.is_empty(), "{name} must not depend on {beyond:?}");
    }
    assert_eq!(found.len(), ALLOWED.len() + 1, "a new crate (beside the benchmarks) needs a line here");
}
