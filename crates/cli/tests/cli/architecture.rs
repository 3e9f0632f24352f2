//! Crates, and the modules within each crate, depend on each other in one direction only.

mod modules;
mod source;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

use modules::Modules;

/// The crates that each crate may depend on, also in tests and benchmarks, as in the crate graph in README.md.
const ALLOWED: [(&str, &[&str]); 12] = [
    ("sextant-kernel", &[]),
    ("sextant-channel", &["sextant-kernel"]),
    ("sextant-mac", &["sextant-kernel", "sextant-channel"]),
    ("sextant-sim", &["sextant-kernel", "sextant-channel", "sextant-mac"]),
    ("sextant-mapper", &["sextant-kernel", "sextant-channel"]),
    ("sextant-apps", &["sextant-kernel", "sextant-channel", "sextant-mac", "sextant-sim", "sextant-mapper"]),
    ("sextant-recording", &["sextant-kernel", "sextant-channel"]),
    ("sextant-logs", &["sextant-kernel", "sextant-channel", "sextant-mac", "sextant-mapper", "sextant-recording"]),
    ("sextant-figure", &["sextant-kernel", "sextant-channel", "sextant-mapper", "sextant-recording"]),
    ("sextant", LIBRARY),
    ("sextant-thesis", ALL),
    ("sextant-cli", ALL),
];

/// What the library uses.
const LIBRARY: &[&str] = &[
    "sextant-kernel",
    "sextant-channel",
    "sextant-mac",
    "sextant-sim",
    "sextant-mapper",
    "sextant-apps",
    "sextant-recording",
    "sextant-logs",
    "sextant-figure",
];

/// The library and what it uses, and the reproduction.
const ALL: &[&str] = &[
    "sextant-kernel",
    "sextant-channel",
    "sextant-mac",
    "sextant-sim",
    "sextant-mapper",
    "sextant-apps",
    "sextant-recording",
    "sextant-logs",
    "sextant-figure",
    "sextant",
    "sextant-thesis",
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
    assert_eq!(found.len(), ALLOWED.len() + 1, "a new crate (except the benchmarks) needs a line here");
}

/// The modules of the library from top to bottom: each may use only those below it.
const ROOMS: [&str; 7] = ["sweep", "run", "mapping", "measure", "summary", "scenario", "columns"];

/// The modules of the command line from top to bottom.
const COMMAND_LINE: [&str; 5] = ["commands", "progress", "terminal", "interrupt", "diagnostic"];

/// The folders of the crates whose modules are checked.
const FOLDERS: [&str; 12] =
    ["kernel", "channel", "mac", "sim", "mapper", "apps", "recording", "logs", "figure", "sextant", "thesis", "cli"];

fn modules_of(folder: &str) -> Modules {
    Modules::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder).join("src"))
}

#[test]
fn modules_have_no_circular_dependencies() {
    for folder in FOLDERS {
        let modules = modules_of(folder);
        let circles: Vec<_> = modules.circles().into_iter().map(|circle| (modules.ties(&circle), circle)).collect();
        assert!(circles.is_empty(), "{folder}: dependencies, and the modules that form a circle: {circles:#?}");
    }
}

#[test]
fn modules_use_only_those_below_them() {
    for (folder, rooms) in [("sextant", &ROOMS[..]), ("cli", &COMMAND_LINE)] {
        let upwards = modules_of(folder).upwards(rooms);
        assert!(upwards.is_empty(), "{folder}: these use modules above them: {upwards:#?}");
    }
}

#[test]
fn a_circle_is_found_however_it_is_written() {
    let circles = |files: &[(&str, &str)]| Modules::of(files.iter().copied()).circles();
    let one_way = [("lib.rs", "mod a; mod b; pub use a::A;"), ("a.rs", "use crate::b::B;"), ("b.rs", "struct B;")];
    assert_eq!(circles(&one_way), Vec::<Vec<String>>::new());
    for back in [
        "use crate::a::A;",
        "use super::a::A;",
        "use crate::A;",
        "use super::{a::{self, A as C}};",
        "fn f() -> crate::a::A {}",
        "mod inner { use super::super::a::A; }",
    ] {
        let files = [one_way[0], one_way[1], ("b.rs", back)];
        assert_eq!(circles(&files), [["crate::a", "crate::b"]], "{back}");
    }
    for harmless in
        ["// use crate::a::A;", "const T: &str = \"crate::a::A\";", "#[cfg(test)] mod tests { use crate::a::A; }"]
    {
        let files = [one_way[0], one_way[1], ("b.rs", harmless)];
        assert_eq!(circles(&files), Vec::<Vec<String>>::new(), "{harmless}");
    }
    let three = [
        ("lib.rs", ""),
        ("a.rs", "use crate::b::B;"),
        ("b/mod.rs", "mod c; pub use c::C;"),
        ("b/c.rs", "use crate::a::A;"),
    ];
    assert_eq!(circles(&three), [["crate::a", "crate::b"]], "a uses b, and a part of b uses a");
    let through = [three[0], ("a.rs", "use crate::b::C;"), three[2], three[3]];
    assert_eq!(circles(&through), [["crate::a", "crate::b"]], "a uses an item of c that b re-exports");
    let whole_and_part = [("lib.rs", ""), ("b/mod.rs", "mod c; struct B(c::C);"), ("b/c.rs", "use super::B;")];
    assert_eq!(circles(&whole_and_part), Vec::<Vec<String>>::new(), "a part may use its parent");
    let around = [("lib.rs", ""), ("a.rs", "use crate::b::c::C;"), ("b/mod.rs", "use crate::a::A;"), ("b/c.rs", "")];
    assert_eq!(circles(&around), [["crate::a", "crate::b"]], "a uses a part of b, and b uses a");
}

#[test]
fn an_upward_dependency_is_found() {
    let files = [("lib.rs", ""), ("top/mod.rs", "use crate::low::X;"), ("top/part.rs", ""), ("low.rs", "fn f() {}")];
    let upwards = |low| Modules::of([files[0], files[1], files[2], ("low.rs", low)]).upwards(&["top", "low"]);
    assert_eq!(upwards("fn f() {}"), Vec::<String>::new());
    assert_eq!(upwards("fn f() { crate::top::part::g() }"), ["crate::low -> crate::top::part"]);
}
