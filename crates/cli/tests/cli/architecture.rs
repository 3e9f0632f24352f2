//! Crates, and the modules within each crate, depend on each other in one direction only; guides name files that exist.

mod crates;
mod guides;
mod modules;
mod profiles;
mod reasons;
mod source;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

pub(super) use guides::guides;
use modules::Modules;

/// The root of the tree.
pub(super) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The modules of the library from top to bottom: each may use only those below it.
const ROOMS: [&str; 12] = [
    "run",
    "export",
    "forecast",
    "link",
    "antenna",
    "next",
    "mapping",
    "floorplan",
    "measure",
    "summary",
    "columns",
    "threads",
];

/// The modules of studies from top to bottom.
const STUDIES: [&str; 2] = ["campaign", "sweep"];

/// The modules of the command line from top to bottom.
const COMMAND_LINE: [&str; 8] =
    ["commands", "live", "paragraph", "progress", "terminal", "interrupt", "invocation", "diagnostic"];

/// The folders of the crates whose modules are checked.
const FOLDERS: [&str; 15] = [
    "kernel",
    "channel",
    "mac",
    "sim",
    "mapper",
    "apps",
    "recording",
    "logs",
    "figure",
    "scenario",
    "sextant",
    "study",
    "report",
    "thesis",
    "cli",
];

/// The folders of the crates in which no module imports an item through the root of its crate. The root hands items on
/// to other crates; inside, each item is imported from its module.
const BY_MODULE_PATH: [&str; 9] =
    ["channel", "sim", "mapper", "recording", "figure", "study", "report", "thesis", "cli"];

/// The modules of the crate in a folder, which all tests read once.
fn modules_of(folder: &str) -> &'static Modules {
    static MODULES: LazyLock<BTreeMap<&str, Modules>> = LazyLock::new(|| {
        let read = |folder: &'static str| (folder, Modules::read(&root().join("crates").join(folder).join("src")));
        FOLDERS.into_iter().map(read).collect()
    });
    &MODULES[folder]
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
    for (folder, rooms) in [("sextant", &ROOMS[..]), ("study", &STUDIES), ("cli", &COMMAND_LINE)] {
        let upwards = modules_of(folder).upwards(rooms);
        assert!(upwards.is_empty(), "{folder}: these use modules above them: {upwards:#?}");
    }
}

#[test]
fn no_module_imports_through_the_root_of_its_crate() {
    for folder in BY_MODULE_PATH {
        let through_root = modules_of(folder).through_root();
        assert!(through_root.is_empty(), "{folder}: these are to be imported from their modules: {through_root:#?}");
    }
}

/// The one module that changes files, in the crate `recording`: tests put disks that fail under it.
const DISK: &str = "disk";

#[test]
fn files_are_changed_in_one_place() {
    for folder in FOLDERS {
        let modules = modules_of(folder);
        let changes = modules.paths_ending(&source::CHANGES_OF_FILES);
        let elsewhere: Vec<_> =
            changes.iter().filter(|(module, _)| !(folder == "recording" && module.contains(DISK))).collect();
        assert!(elsewhere.is_empty(), "{folder}: `sextant_recording::disk` does this: {elsewhere:#?}");
    }
    let files = [
        ("lib.rs", "mod a; fn f() { std::fs::remove_file(\"a\"); }"),
        ("a.rs", "use std::fs; fn g() { fs::read(\"a\"); }"),
    ];
    let found = Modules::of(files).paths_ending(&source::CHANGES_OF_FILES);
    assert_eq!(found, [("crate".to_owned(), "std::fs::remove_file".to_owned())]);
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
fn an_import_through_the_root_is_found() {
    let through_root = |text| {
        let root = ("lib.rs", "mod a; mod b; pub use a::A; pub use kernel::K; struct Own;");
        Modules::of([root, ("a.rs", "pub struct A;"), ("b/mod.rs", ""), ("b/c.rs", text)]).through_root()
    };
    for through in ["use crate::A;", "use crate::{a, A as C};", "use super::super::A;", "fn f() -> crate::A {}"] {
        assert_eq!(through_root(through), ["crate::b::c uses crate::A"], "{through}");
    }
    assert_eq!(through_root("use crate::K;"), ["crate::b::c uses crate::K"]);
    for direct in ["use crate::a::A;", "use crate::Own;", "use super::A;", "#[cfg(test)] mod tests { use crate::A; }"]
    {
        assert_eq!(through_root(direct), Vec::<String>::new(), "{direct}");
    }
}

#[test]
fn an_upward_dependency_is_found() {
    let files = [("lib.rs", ""), ("top/mod.rs", "use crate::low::X;"), ("top/part.rs", ""), ("low.rs", "fn f() {}")];
    let upwards = |low| Modules::of([files[0], files[1], files[2], ("low.rs", low)]).upwards(&["top", "low"]);
    assert_eq!(upwards("fn f() {}"), Vec::<String>::new());
    assert_eq!(upwards("fn f() { crate::top::part::g() }"), ["crate::low -> crate::top::part"]);
}
