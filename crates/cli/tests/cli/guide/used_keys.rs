//! The keys that somebody shows: those of the files in `scenarios/`, and those that a page of the guide names.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use sextant::scenario::{KeyReference, key_reference};

use super::super::architecture::root;
use super::{pages, read};

/// The keys of a scenario, and which of them have the same keys below them.
struct Keys {
    paths: BTreeSet<String>,
    same: BTreeMap<String, String>,
}

impl Keys {
    fn new(keys: &[KeyReference]) -> Self {
        let same = keys.iter().filter_map(|key| Some((key.path.clone(), key.same_as.clone()?)));
        Self { paths: keys.iter().map(|key| key.path.clone()).collect(), same: same.collect() }
    }

    /// The path at which the reference lists a key.
    fn listed(&self, path: &str) -> String {
        let mut path = path.to_owned();
        while let Some((above, first)) = self.above(&path) {
            path = format!("{first}{}", &path[above..]);
        }
        path
    }

    /// The length of the longest path above `path` whose keys are listed elsewhere, and where.
    fn above(&self, path: &str) -> Option<(usize, &str)> {
        let ends = path.match_indices(['.', '[']).map(|(at, _)| at);
        ends.rev().find_map(|at| Some((at, self.same.get(&path[..at])?.as_str())))
    }

    /// Adds the keys in a part of a scenario, which stands at `path`.
    fn add(&self, part: &toml::Value, path: &str, used: &mut BTreeSet<String>) {
        used.insert(self.listed(path));
        match part {
            toml::Value::Table(table) => {
                for (name, part) in table {
                    let own = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                    let is_key = self.paths.contains(&self.listed(&own));
                    let own = if is_key { own } else { format!("{path}.NAME") };
                    self.add(part, &own, used);
                }
            }
            toml::Value::Array(entries) => {
                for entry in entries.iter().filter(|entry| entry.is_table()) {
                    self.add(entry, &format!("{path}[]"), used);
                }
            }
            _ => {}
        }
    }
}

/// The files of scenarios in a folder and its folders.
fn scenarios(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let (folders, files): (Vec<_>, Vec<_>) = entries.partition(|path| path.is_dir());
    let files = files.into_iter().filter(|path| path.extension().is_some_and(|extension| extension == "toml"));
    files.chain(folders.iter().flat_map(|folder| scenarios(folder))).collect()
}

/// The words of the pages that people wrote.
fn words() -> BTreeSet<String> {
    let written =
        pages().into_iter().filter(|page| !page.parent().is_some_and(|folder| folder.ends_with("reference")));
    let is_end = |c: char| !c.is_alphanumeric() && c != '_';
    written.flat_map(|page| read(&page).split(is_end).map(str::to_owned).collect::<Vec<_>>()).collect()
}

#[test]
fn every_key_stands_in_a_scenario_or_on_a_page() {
    let reference = key_reference();
    let keys = Keys::new(&reference);
    let mut used = BTreeSet::new();
    for file in scenarios(&root().join("scenarios")) {
        keys.add(&toml::from_str(&read(&file)).expect("a scenario"), "", &mut used);
    }
    let words = words();
    let unused = reference.iter().filter(|key| !used.contains(&key.path) && !words.contains(key.name()));
    let unused: Vec<_> = unused.map(|key| key.path.as_str()).collect();
    assert!(unused.is_empty(), "show these keys in a scenario, or say on a page when to change them: {unused:#?}");
}

#[test]
fn keys_are_found_where_the_reference_lists_them() {
    let reference = key_reference();
    let keys = Keys::new(&reference);
    let text = "networks.low.radio.tx_power_dbm = 0\n[[radio.groups]]\nclock_offset_ppm = 1\n";
    let mut used = BTreeSet::new();
    keys.add(&toml::from_str(text).expect("TOML"), "", &mut used);
    for path in ["networks.NAME.radio", "radio.tx_power_dbm", "radio.groups[].clock_offset_ppm"] {
        assert!(used.contains(path), "{path}: {used:?}");
    }
    assert!(!used.contains("radio.sensitivity_dbm"));
}
