//! Each direct dependency has its reason in `docs/dependencies.md`.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

/// The tables of the page by their headings: the libraries, and whether each has both of its reasons.
fn tables() -> BTreeMap<String, BTreeMap<String, bool>> {
    let page = std::fs::read_to_string(super::root().join("docs/dependencies.md")).expect("the page");
    let mut tables = BTreeMap::<_, BTreeMap<_, _>>::new();
    let mut heading = String::new();
    for line in page.lines() {
        if let Some(title) = line.strip_prefix("## ") {
            title.clone_into(&mut heading);
        }
        let Some((name, rest)) = line.strip_prefix("| `").and_then(|row| row.split_once('`')) else { continue };
        let reasons: Vec<_> = rest.split('|').map(str::trim).filter(|cell| !cell.is_empty()).collect();
        let twice = tables.entry(heading.clone()).or_default().insert(name.to_owned(), reasons.len() == 2);
        assert!(twice.is_none(), "docs/dependencies.md has `{name}` twice");
    }
    tables
}

/// The names of the table with a heading. Each has both reasons.
fn reasoned(heading: &str) -> BTreeSet<String> {
    let table = tables().remove(heading).unwrap_or_else(|| panic!("docs/dependencies.md has no table `{heading}`"));
    let without: Vec<_> = table.iter().filter(|(_, has_both)| !**has_both).map(|(name, _)| name).collect();
    assert!(without.is_empty(), "these need to say what they do, and why it is not our own: {without:?}");
    table.into_keys().collect()
}

/// Crates that are not published: benchmarks and fuzz targets.
const OF_DEVELOPERS: [&str; 2] = ["sextant-benches", "sextant-fuzz"];

/// The dependencies of our crates that are not ours: those that a program needs, and those that only tests need.
fn dependencies() -> [BTreeSet<String>; 2] {
    let workspace = super::crates::workspace();
    let named = |is_normal| -> BTreeSet<String> {
        let all =
            workspace.iter().filter(|(name, _)| !OF_DEVELOPERS.contains(&name.as_str())).flat_map(|(_, uses)| uses);
        let chosen = all.filter(|dependency| dependency.is_normal == is_normal);
        let others = chosen.filter(|dependency| !dependency.name.starts_with("sextant"));
        others.map(|dependency| dependency.name.clone()).collect()
    };
    let of_developers = OF_DEVELOPERS.iter().flat_map(|name| &workspace[*name]);
    let names = of_developers.map(|dependency| dependency.name.clone());
    let tests: BTreeSet<_> = names.filter(|name| !name.starts_with("sextant")).chain(named(false)).collect();
    let program = named(true);
    let tests = tests.difference(&program).cloned().collect();
    [program, tests]
}

#[test]
fn each_direct_dependency_has_its_reason_and_each_reason_its_dependency() {
    let [program, tests] = dependencies();
    assert_eq!(reasoned("In the program"), program, "docs/dependencies.md and the manifests, of the program");
    assert_eq!(
        reasoned("In tests, benchmarks and fuzz targets only"),
        tests,
        "docs/dependencies.md and the manifests, of tests"
    );
}

#[test]
fn each_dependency_of_the_workspace_is_used_by_a_crate() {
    let manifest = std::fs::read_to_string(super::root().join("Cargo.toml")).expect("the manifest");
    let manifest: toml::Table = manifest.parse().expect("TOML");
    let named = manifest["workspace"]["dependencies"].as_table().expect("a table").keys();
    let [program, tests] = dependencies();
    let unused: Vec<_> = named
        .filter(|name| !name.starts_with("sextant") && !program.contains(*name) && !tests.contains(*name))
        .collect();
    assert!(unused.is_empty(), "no crate uses these of [workspace.dependencies]: {unused:?}");
}

#[test]
fn each_library_of_reports_has_its_reason() {
    let path = super::root().join("crates/report/web/package.json");
    let package: Value = serde_json::from_str(&std::fs::read_to_string(path).expect("the package")).expect("JSON");
    let of = |key: &str| package[key].as_object().expect("a table").keys().cloned().collect::<BTreeSet<_>>();
    let all: BTreeSet<_> = of("dependencies").union(&of("devDependencies")).cloned().collect();
    assert_eq!(reasoned("In reports"), all, "docs/dependencies.md and crates/report/web/package.json");
}
