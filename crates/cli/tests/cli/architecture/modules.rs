//! The modules of a crate and their dependencies.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::source::Source;

/// A module with its own file: the names from the root of the crate.
type Module = Vec<String>;

/// The modules of one crate that have their own files.
#[derive(Debug)]
pub(super) struct Modules {
    sources: BTreeMap<Module, Source>,
}

/// Maximum number of re-exports to follow; more would be a circle.
const LONGEST_CHAIN: u32 = 16;

impl Modules {
    /// Reads all files below the folder `src` of a crate.
    pub(super) fn read(src: &Path) -> Self {
        let mut texts = Vec::new();
        let mut folders = vec![src.to_owned()];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(&folder).expect("a folder of sources") {
                let path: PathBuf = entry.expect("an entry of a folder").path();
                if path.is_dir() {
                    folders.push(path);
                } else if path.extension().is_some_and(|extension| extension == "rs") {
                    let name = path.strip_prefix(src).expect("a path below the folder").display().to_string();
                    texts.push((name, std::fs::read_to_string(&path).expect("a source file")));
                }
            }
        }
        Self::of(texts.iter().map(|(name, text)| (name.as_str(), text.as_str())))
    }

    /// The modules of the files (name, text). Programs are ignored, because no module can use them.
    pub(super) fn of<'a>(files: impl IntoIterator<Item = (&'a str, &'a str)>) -> Self {
        let files = files.into_iter().filter(|(name, _)| *name != "main.rs" && !name.starts_with("bin/"));
        let mut sources: BTreeMap<Module, Source> =
            files.map(|(name, text)| (module(name), Source::read(name, text))).collect();
        let in_tests = |(module, source): (&Module, &Source)| {
            let below = |name: &String| [module.as_slice(), std::slice::from_ref(name)].concat();
            source.test_modules.iter().map(below).collect::<Vec<_>>()
        };
        let test_modules: Vec<Module> = sources.iter().flat_map(in_tests).collect();
        sources.retain(|module, _| !test_modules.iter().any(|test| module.starts_with(test)));
        Self { sources }
    }

    /// The modules that each module uses. A re-exported item counts as an item of the module that defines it.
    fn arrows(&self) -> BTreeMap<&Module, BTreeSet<&Module>> {
        let arrows = |(module, source): (&'_ Module, &Source)| -> BTreeSet<&Module> {
            let targets = source.paths.iter().filter_map(|(inner, path)| self.target(module, *inner, path));
            targets.filter(|target| *target != module).collect()
        };
        self.sources.iter().map(|(module, source)| (module, arrows((module, source)))).collect()
    }

    /// The circles of sibling modules: each module of a circle, with its children, depends on all others of the circle. A
    /// module and its own children may use each other.
    pub(super) fn circles(&self) -> Vec<Vec<String>> {
        let mut beside: BTreeMap<&[String], BTreeSet<(Module, Module)>> = BTreeMap::new();
        for (module, others) in self.arrows() {
            for other in others {
                let shared = module.iter().zip(other).take_while(|(a, b)| a == b).count();
                if shared < module.len().min(other.len()) {
                    let arrow = (module[..=shared].to_vec(), other[..=shared].to_vec());
                    beside.entry(&module[..shared]).or_default().insert(arrow);
                }
            }
        }
        beside.values().flat_map(circles).map(|circle| circle.iter().map(name).collect()).collect()
    }

    /// The modules that have a path with one of these ends, outside of tests, and that path.
    pub(super) fn paths_ending(&self, ends: &[&str]) -> Vec<(String, String)> {
        let has_end = |path: &str| {
            ends.iter().any(|end| path.strip_suffix(end).is_some_and(|rest| rest.is_empty() || rest.ends_with("::")))
        };
        let of_module = |(module, source): (&Module, &Source)| {
            let paths = source.paths.iter().map(|(_, path)| path.join("::"));
            paths.filter(|path| has_end(path)).map(|path| (name(module), path)).collect::<Vec<_>>()
        };
        self.sources.iter().flat_map(of_module).collect()
    }

    /// The dependencies between the modules of a circle and their children.
    pub(super) fn ties(&self, circle: &[String]) -> Vec<String> {
        let member = |module: &Module| {
            let name = name(module);
            circle.iter().position(|member| name == *member || name.starts_with(&format!("{member}::")))
        };
        self.arrows_where(|from, to| {
            let (from, to) = (member(from), member(to));
            from.is_some() && to.is_some() && from != to
        })
    }

    /// The dependencies of top-level modules on earlier ones in `rooms`, which lists all of them from top to bottom.
    pub(super) fn upwards(&self, rooms: &[&str]) -> Vec<String> {
        let floor = |module: &Module| {
            let room = module.first()?;
            let floor = rooms.iter().position(|other| other == room);
            Some(floor.unwrap_or_else(|| panic!("`{room}` has no line in the list of rooms")))
        };
        self.arrows_where(|from, to| matches!((floor(from), floor(to)), (Some(from), Some(to)) if to < from))
    }

    /// The modules that import an item through the root of the crate instead of the module that it is in, and that item.
    pub(super) fn through_root(&self) -> Vec<String> {
        let Some(root) = self.sources.get(&Module::new()) else { return Vec::new() };
        let is_handed_on = |name: &String| root.imports.iter().any(|import| import.name == *name);
        let of_module = |(module, source): (&Module, &Source)| {
            let items = source.paths.iter().filter_map(|(inner, path)| item_of_root(module, *inner, path));
            let items = items.filter(|item| is_handed_on(item) && self.child(&[], item).is_none());
            items.map(|item| format!("{} uses crate::{item}", name(module))).collect::<Vec<_>>()
        };
        self.sources.iter().filter(|(module, _)| !module.is_empty()).flat_map(of_module).collect()
    }

    fn arrows_where(&self, is_wanted: impl Fn(&Module, &Module) -> bool) -> Vec<String> {
        let arrows = self.arrows();
        let arrows = arrows.iter().flat_map(|(from, others)| others.iter().map(move |to| (*from, *to)));
        let wanted = arrows.filter(|(from, to)| is_wanted(from, to));
        wanted.map(|(from, to)| format!("{} -> {}", name(from), name(to))).collect()
    }

    /// The module that defines the item at `path`, if it is in this crate. The path is used in `module`, or in an inline
    /// module `inner` levels deeper in the same file.
    fn target(&self, module: &Module, inner: usize, path: &[String]) -> Option<&Module> {
        let mut base = module.clone();
        // Paths to inline modules of the same file are no dependencies.
        let mut inner = inner;
        let mut path = path;
        match path.first()?.as_str() {
            "crate" => (base, path) = (Module::new(), &path[1..]),
            "self" => path = &path[1..],
            "super" => {
                while path.first().is_some_and(|step| step == "super") {
                    if inner > 0 {
                        inner -= 1;
                    } else {
                        base.pop();
                    }
                    path = &path[1..];
                }
                if inner > 0 {
                    return None;
                }
            }
            first => {
                let is_below = inner == 0 && self.child(&base, first).is_some();
                if !is_below {
                    return None;
                }
            }
        }
        self.resolve(base, path, LONGEST_CHAIN)
    }

    fn child(&self, module: &[String], name: &str) -> Option<Module> {
        let child = [module, &[name.to_owned()]].concat();
        self.sources.contains_key(&child).then_some(child)
    }

    fn resolve(&self, mut base: Module, mut path: &[String], chain: u32) -> Option<&Module> {
        while let [first, rest @ ..] = path {
            let Some(child) = self.child(&base, first) else { break };
            (base, path) = (child, rest);
        }
        let (at, source) = self.sources.get_key_value(&base)?;
        let handed_on = path.first().and_then(|first| source.imports.iter().find(|import| import.name == *first));
        match handed_on {
            Some(import) if chain > 0 => {
                let onward = [import.path.as_slice(), &path[1..]].concat();
                let target = self.target_of_import(at, &onward, chain - 1);
                // An item of another crate belongs to the module that re-exports it.
                target.or(Some(at))
            }
            _ => Some(at),
        }
    }

    fn target_of_import(&self, module: &Module, path: &[String], chain: u32) -> Option<&Module> {
        let (base, path) = match path.first()?.as_str() {
            "crate" => (Module::new(), &path[1..]),
            "self" => (module.clone(), &path[1..]),
            "super" => {
                let up = path.iter().take_while(|step| *step == "super").count();
                (module[..module.len().checked_sub(up)?].to_vec(), &path[up..])
            }
            first => {
                self.child(module, first)?;
                (module.clone(), path)
            }
        };
        self.resolve(base, path, chain)
    }
}

/// The circles in `arrows`.
fn circles(arrows: &BTreeSet<(Module, Module)>) -> BTreeSet<Vec<Module>> {
    let reached: BTreeMap<&Module, BTreeSet<&Module>> =
        arrows.iter().map(|(from, _)| (from, reached(from, arrows))).collect();
    let leads_back = |from: &Module, to: &Module| reached.get(to).is_some_and(|others| others.contains(from));
    let mut circles = BTreeSet::new();
    for (&from, others) in &reached {
        let circle: Vec<Module> = others.iter().filter(|to| leads_back(from, to)).map(|&to| to.clone()).collect();
        if !circle.is_empty() {
            circles.insert(circle);
        }
    }
    circles
}

/// The modules that can be reached from `from`.
fn reached<'a>(from: &'a Module, arrows: &'a BTreeSet<(Module, Module)>) -> BTreeSet<&'a Module> {
    let mut reached = BTreeSet::new();
    let mut next = vec![from];
    while let Some(module) = next.pop() {
        let onward = arrows.iter().filter(|(from, _)| from == module).map(|(_, to)| to);
        next.extend(onward.filter(|&to| reached.insert(to)));
    }
    reached
}

/// The step after the root of the crate, if `path` leads through it. The path is used in `module`, or in an inline module
/// `inner` levels deeper in the same file.
fn item_of_root<'a>(module: &Module, inner: usize, path: &'a [String]) -> Option<&'a String> {
    let up = path.iter().take_while(|step| *step == "super").count();
    if up > 0 && up == module.len() + inner {
        return path.get(up);
    }
    path.get(1).filter(|_| path[0] == "crate")
}

/// The module of a file: `a/b.rs` and `a/b/mod.rs` are `a::b`.
fn module(file: &str) -> Module {
    let path = file.trim_end_matches(".rs").replace('\\', "/");
    let path = path.strip_suffix("/mod").unwrap_or(&path);
    if path == "lib" { Module::new() } else { path.split('/').map(str::to_owned).collect() }
}

/// A module as it is written: `crate::a::b`.
fn name(module: &Module) -> String {
    std::iter::once("crate").chain(module.iter().map(String::as_str)).collect::<Vec<_>>().join("::")
}
