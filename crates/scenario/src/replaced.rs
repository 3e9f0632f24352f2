//! Settings that have no effect, because something else replaces them.

use std::fmt::Display;

use super::document::effective;
use super::document::key_path::{KeyPath, PathStep};
use super::document::setting_line::ReadSetting;
use super::document::{Document, Entry, Value};
use super::error::{ScenarioError, ScenarioErrors};
use super::file::ScenarioFile;
use super::loaded::Scenario;
use super::reference::{Explanation, explain};
use super::source::SETTING;
use super::sweep::{Setting, SweepAxes};

/// Refuses a setting of `key` among `set` (each `path.to.key=value`), if another value for it is `given` besides.
///
/// # Errors
/// If the setting would have no effect, or is none.
pub fn check_given(set: &[String], key: &str, given: Option<impl Display>) -> Result<(), ScenarioError> {
    let (Some(given), Ok(path)) = (given, KeyPath::parse(key)) else { return Ok(()) };
    for line in set {
        let setting = ReadSetting::of(line)?;
        if setting.path == path && effective::inline(&setting.value.value) != given.to_string() {
            let message = format!("the setting `{line}` has no effect: {given} is given for `{key}` besides");
            return Err(ScenarioError::new(message).help("give only one of them"));
        }
    }
    Ok(())
}

/// A setting that has no effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReplacedSetting {
    /// Its number among the settings.
    pub setting: usize,
    /// The number of the later one that replaces it.
    pub by: usize,
}

impl ScenarioFile {
    /// The settings among `set` (each `path.to.key=value`) that have no effect, because a later one replaces their key, a table
    /// around it, or the choice that they are of.
    ///
    /// # Errors
    /// If one is no setting, or names an entry that an array does not have.
    pub fn replaced(&self, set: &[String]) -> Result<Vec<ReplacedSetting>, ScenarioErrors> {
        let document = self.overridden(set, None)?;
        let first = document.sources.iter().position(|source| source.name == SETTING).unwrap_or_default();
        let mut replaced = Vec::new();
        for (setting, line) in set.iter().enumerate() {
            let path = ReadSetting::of(line)?.path;
            let by = replaced_by(&document, &path, first + setting).and_then(|source| source.checked_sub(first));
            replaced.extend(by.map(|by| ReplacedSetting { setting, by }));
        }
        Ok(replaced)
    }

    /// The scenario with what a user gave for it, all of which must have its effect.
    pub(super) fn given(&self, set: &[String], seed: Option<u64>) -> Result<Scenario, ScenarioErrors> {
        check_given(set, "seed", seed)?;
        if let Some(&ReplacedSetting { setting, by }) = self.replaced(set)?.first() {
            let message = format!("the setting `{}` has no effect: `{}` replaces it", set[setting], set[by]);
            return Err(ScenarioError::new(message).help("give only one of them").into());
        }
        self.scenario(set, seed)
    }

    /// What the settings `set` (each `path.to.key=value`) leave out of the file, where they replace a whole table: a sentence
    /// for each of them.
    ///
    /// # Errors
    /// If one is no setting, or names an entry that an array does not have.
    pub fn left_out(&self, set: &[String]) -> Result<Vec<String>, ScenarioErrors> {
        let mut sentences = Vec::new();
        let mut document = self.document().clone();
        for line in set {
            let ReadSetting { path, value } = ReadSetting::of(line)?;
            let mut keys = Vec::new();
            if let (before, true) = document.nearest(&path) {
                absent(before, &value, &path, &mut keys);
            }
            if !keys.is_empty() {
                let keys: Vec<_> = keys.iter().map(|key| format!("`{key}`")).collect();
                let has = if keys.len() == 1 { "has" } else { "have" };
                let keys = keys.join(", ");
                sentences.push(format!(
                    "the setting `{line}` replaces all of `{path}`: {keys} of the file {has} no effect"
                ));
            }
            document.lay_setting(SETTING, line, self.folder())?;
        }
        Ok(sentences)
    }
}

/// The later source that replaces what source number `source` sets at `path`; `None` if it has its effect.
fn replaced_by(document: &Document, path: &KeyPath, source: usize) -> Option<usize> {
    let mut entry = &document.root;
    for (depth, step) in path.0.iter().map(Some).chain([None]).enumerate() {
        if let Value::Table(table) = &entry.value {
            let own = table.iter().find(|(name, child)| match step {
                Some(step) => matches!(step, PathStep::Key(key) if key == *name),
                None => child.layer == source,
            });
            if let Some((own, child)) = own {
                let later = table.iter().filter(|(_, other)| other.layer > child.layer);
                let later = later.max_by_key(|(_, other)| other.layer);
                if let Some((other, entry)) = later
                    && are_choices(&KeyPath(path.0[..depth].to_vec()), [own, other])
                {
                    return Some(entry.layer);
                }
            }
        }
        match step.map(|step| entry.child(step)) {
            Some(Some(child)) => entry = child,
            Some(None) => return Some(entry.origin.source),
            None => {}
        }
    }
    (!has_origin(entry, source)).then_some(entry.origin.source)
}

/// Whether a source set this or something in it.
fn has_origin(entry: &Entry, source: usize) -> bool {
    entry.origin.source == source
        || match &entry.value {
            Value::Table(table) => table.values().any(|entry| has_origin(entry, source)),
            Value::Array(items) => items.iter().any(|entry| has_origin(entry, source)),
            _ => false,
        }
}

/// Whether only one of these may be chosen at `path`.
fn are_choices(path: &KeyPath, names: [&str; 2]) -> bool {
    let Ok(Explanation::Key { key, .. }) = explain(&path.to_string()) else { return false };
    names.iter().all(|name| key.choices.iter().any(|choice| choice.name == *name))
}

/// Adds the `keys` in `before`, which is at `path`, that `after` has not. Another choice has no keys in common.
fn absent(before: &Entry, after: &Entry, path: &KeyPath, keys: &mut Vec<KeyPath>) {
    let (Value::Table(before), Value::Table(after)) = (&before.value, &after.value) else { return };
    for (name, entry) in before {
        let path_of = |name: &String| path.child(PathStep::Key(name.clone()));
        match after.get(name) {
            Some(after) => absent(entry, after, &path_of(name), keys),
            None if after.keys().any(|other| are_choices(path, [name, other])) => {}
            None => keys.push(path_of(name)),
        }
    }
}

impl SweepAxes {
    /// Refuses settings `set` (each `path.to.key=value`) of which each cell replaces something. A cell replaces what it sets
    /// itself: the same key, what is in it, or a part of the value.
    pub(super) fn check_settings(&self, set: &[String]) -> Result<(), ScenarioError> {
        let Some((first, others)) = self.cells.split_first().filter(|(first, _)| !first.is_empty()) else {
            return Ok(());
        };
        for line in set {
            let setting = ReadSetting::of(line)?;
            for (key, path) in paths(first).filter(|(_, path)| setting.is_replaced_by(path)) {
                // The same part of it: another one may have its effect in this cell.
                let replaces = |other: KeyPath| path.is_within(&other) || setting.path.is_within(&other);
                if others.iter().all(|cell| paths(cell).any(|(_, other)| replaces(other))) {
                    return Err(self.no_effect(line, key, path.0.len() == setting.path.0.len()));
                }
            }
        }
        Ok(())
    }

    /// The error of a setting whose part `key`, or all of it, each cell replaces.
    fn no_effect(&self, line: &str, key: &str, is_whole: bool) -> ScenarioError {
        let place = self.places.get(key).map_or("sweep.list", String::as_str);
        let error = ScenarioError::new(format!(
            "the setting `{line}` has no effect on `{key}`: `{place}` gives it another value in each cell"
        ));
        let value = line.split_once('=').map_or("", |(_, value)| value.trim());
        error.help(match place.strip_prefix("sweep.product.") {
            Some(_) if is_whole => format!("to sweep with this value only, set `{place}=[{value}]` instead"),
            _ => format!("remove it, or change the values in `{place}`"),
        })
    }
}

/// The keys of the settings of a cell, also as paths.
fn paths(cell: &[Setting]) -> impl Iterator<Item = (&str, KeyPath)> {
    cell.iter().filter_map(|Setting { key, .. }| Some((key.as_str(), KeyPath::parse(key).ok()?)))
}

impl ReadSetting {
    /// Whether a later setting of `key` replaces this one, or a part of its value.
    fn is_replaced_by(&self, key: &KeyPath) -> bool {
        if self.path.is_within(key) {
            return true;
        }
        let steps = || key.0[self.path.0.len()..].iter();
        key.is_within(&self.path) && steps().try_fold(&self.value, Entry::child).is_some()
    }
}
