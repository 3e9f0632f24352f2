//! What crates depend on, as `cargo metadata` says.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

use serde_json::Value;

/// Crates that test the others, and may use them all.
const TESTING: [&str; 2] = ["sextant-benches", "sextant-fuzz"];

/// A crate that one of ours depends on.
pub(super) struct Dependency {
    pub(super) name: String,
    /// Whether users of the crate need it; otherwise its tests or its build script.
    pub(super) is_normal: bool,
}

/// The crates of the workspace, and what each depends on.
pub(super) fn workspace() -> BTreeMap<String, Vec<Dependency>> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--no-deps", "--offline"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs, as it runs this test");
    let metadata: Value = serde_json::from_slice(&output.stdout).expect("cargo prints JSON");
    let text = |value: &Value| value.as_str().expect("a name").to_owned();
    let dependency = |value: &Value| Dependency { name: text(&value["name"]), is_normal: value["kind"].is_null() };
    let packages = metadata["packages"].as_array().expect("a list of packages").iter();
    packages
        .map(|package| {
            let dependencies = package["dependencies"].as_array().expect("a list of dependencies");
            (text(&package["name"]), dependencies.iter().map(dependency).collect())
        })
        .collect()
}

/// The table of crates in `docs/architecture.md`: package, and the packages that it may use.
fn documented() -> BTreeMap<String, Vec<String>> {
    let page = std::fs::read_to_string(super::root().join("docs/architecture.md")).expect("the page");
    let package = |name: &str| match name {
        "sextant" => name.to_owned(),
        _ => format!("sextant-{name}"),
    };
    let rows = page.lines().filter_map(|line| line.strip_prefix("| [`"));
    rows.map(|row| {
        let (name, rest) = row.split_once('`').expect("the name of a crate");
        let cell = rest.trim_end_matches('|').rsplit('|').next().expect("a last column");
        let used = cell.split(',').map(str::trim).filter(|name| !name.is_empty());
        (package(name), used.map(package).collect())
    })
    .collect()
}

/// The crates that `name` may use: those of the table, and what they use.
fn allowed(name: &str, table: &BTreeMap<String, Vec<String>>) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut next = table[name].clone();
    while let Some(used) = next.pop() {
        next.extend(table[&used].iter().cloned());
        found.insert(used);
    }
    found
}

#[test]
fn crates_depend_on_each_other_as_the_page_on_architecture_says() {
    let table = documented();
    let workspace = workspace();
    for (name, dependencies) in workspace.iter().filter(|(name, _)| !TESTING.contains(&name.as_str())) {
        assert!(table.contains_key(name), "{name} needs a line in docs/architecture.md");
        let allowed = allowed(name, &table);
        let ours = dependencies.iter().map(|dependency| &dependency.name).filter(|name| name.starts_with("sextant"));
        let beyond: Vec<_> = ours.filter(|&other| !allowed.contains(other)).collect();
        assert!(beyond.is_empty(), "{name} must not depend on {beyond:?}");
    }
    let gone: Vec<_> = table.keys().filter(|&name| !workspace.contains_key(name)).collect();
    assert!(gone.is_empty(), "docs/architecture.md names crates that do not exist: {gone:?}");
}

#[test]
fn the_module_of_python_uses_the_libraries_of_users_and_the_program_alone() {
    let workspace = workspace();
    let ours = workspace["sextant-python"].iter().map(|dependency| dependency.name.as_str());
    let ours: BTreeSet<_> = ours.filter(|name| name.starts_with("sextant")).collect();
    assert_eq!(ours, BTreeSet::from(["sextant", "sextant-cli", "sextant-study"]));
}

#[test]
fn no_crate_of_the_table_uses_itself_by_a_detour() {
    let table = documented();
    let circles: Vec<_> = table.keys().filter(|&name| allowed(name, &table).contains(name)).collect();
    assert!(circles.is_empty(), "{circles:?}");
}

#[test]
fn only_the_program_depends_on_crates_for_the_command_line() {
    const OF_THE_PROGRAM: [&str; 6] = ["clap", "clap_complete", "clap_mangen", "ctrlc", "indicatif", "miette"];
    let workspace = workspace();
    let used = |name: &str| -> Vec<&str> {
        let normal = workspace[name].iter().filter(|dependency| dependency.is_normal);
        normal.map(|dependency| dependency.name.as_str()).filter(|name| OF_THE_PROGRAM.contains(name)).collect()
    };
    assert_eq!(used("sextant-cli").len(), OF_THE_PROGRAM.len(), "the program uses them all");
    for name in workspace.keys().filter(|name| *name != "sextant-cli" && !TESTING.contains(&name.as_str())) {
        assert_eq!(used(name), Vec::<&str>::new(), "{name} is a library");
    }
}
