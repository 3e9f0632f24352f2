//! Finds all errors of a scenario at once.
//!
//! What is wrong is set aside, and the rest is read and checked again, until nothing new is found: an unknown key or choice
//! is replaced by the similar one that was likely meant, or removed; a placeholder stands for a value that is wrong or
//! missing. What is found only because a certain placeholder stands there is no error of the scenario, so each check is
//! made with several placeholders, and an error counts if it is found with all of them.

use serde::de::DeserializeOwned;
use sextant_kernel::{SettingError, SettingProblem};

use super::deserialize::read;
use super::document::key_path::{KeyPath, PathStep};
use super::document::{Document, Entry, Placeholder, Value};
use super::error::{ScenarioError, ScenarioErrors};
use super::refusal::{Refusal, closest};

/// More errors than these are not looked for.
const MOST_ERRORS: usize = 200;

/// Maximum number of times that all settings are checked again. Each time finds all errors but those that hide behind one
/// found before, in the same table.
const MOST_CHECKS: usize = 20;

/// The placeholders in the order in which they are tried. If one is refused, the next takes its place.
const PREFERENCES: [[Placeholder; 3]; 3] = [
    [Placeholder::Absent, Placeholder::One, Placeholder::Large],
    [Placeholder::One, Placeholder::Large, Placeholder::Absent],
    [Placeholder::Large, Placeholder::One, Placeholder::Absent],
];

/// All errors of `document`, in the order of the file: those of reading a `T`, and those that `check` finds in it. `None` if
/// there are none.
pub(super) fn errors_of<T: DeserializeOwned>(
    document: Document,
    check: &dyn Fn(&Document, T) -> Vec<SettingError>,
) -> Option<ScenarioErrors> {
    let mut diagnosis =
        Diagnosis { document, check, placeholders: Vec::new(), guesses: Vec::new(), errors: Vec::new() };
    diagnosis.run();
    ScenarioErrors::in_order(diagnosis.errors, &diagnosis.document.sources)
}

struct Diagnosis<'a, T> {
    /// The scenario, without what was found to be wrong.
    document: Document,
    check: &'a dyn Fn(&Document, T) -> Vec<SettingError>,
    /// Where placeholders stand. A table comes before what is in it.
    placeholders: Vec<KeyPath>,
    /// Settings under the name that was likely meant.
    guesses: Vec<KeyPath>,
    errors: Vec<ScenarioError>,
}

impl<T: DeserializeOwned> Diagnosis<'_, T> {
    fn run(&mut self) {
        let mut known: Vec<SettingError> = Vec::new();
        for _ in 0..MOST_CHECKS {
            let Some(found) = self.certain() else { return };
            let fresh: Vec<_> = found.into_iter().filter(|error| !known.contains(error)).collect();
            if fresh.is_empty() || self.errors.len() >= MOST_ERRORS {
                return;
            }
            self.errors.extend(fresh.iter().map(|error| self.document.outside(error)));
            for error in &fresh {
                self.set_value_aside(error);
            }
            known.extend(fresh);
        }
    }

    /// Sets the value of an error aside: a name that is allowed takes its place, or a placeholder.
    fn set_value_aside(&mut self, error: &SettingError) {
        let Ok(path) = KeyPath::parse(&error.key) else { return };
        let Some(entry) = self.document.entry_mut(&path) else { return };
        match (&mut entry.value, error.allowed().split('"').nth(1)) {
            (Value::String(text), Some(name)) if text != name => *text = name.to_owned(),
            _ => {
                self.set_placeholder(&path, Placeholder::Absent);
            }
        }
    }

    /// The errors of settings that do not depend on what stands for the wrong ones; `None` if the scenario cannot be read.
    fn certain(&mut self) -> Option<Vec<SettingError>> {
        let config = self.read()?;
        if self.placeholders.is_empty() {
            return Some((self.check)(&self.document, config));
        }
        let mut certain: Option<Vec<SettingError>> = None;
        for preference in PREFERENCES {
            let Some(found) = self.found_with(preference) else { continue };
            certain = Some(match certain {
                None => found,
                Some(certain) => certain.into_iter().filter(|error| found.contains(error)).collect(),
            });
        }
        certain
    }

    /// The errors of settings with these placeholders, without those about the placeholders themselves. Where every placeholder
    /// but [`Absent`](Placeholder::Absent) is refused, another setting of the same table may be needed only because of that: it
    /// is not called missing.
    fn found_with(&mut self, preference: [Placeholder; 3]) -> Option<Vec<SettingError>> {
        let mut changed = self.placeholders.clone();
        let mut found = Vec::new();
        for placeholder in preference {
            for path in &changed {
                if let Some(entry) = self.document.entry_mut(path) {
                    entry.value = Value::Placeholder(placeholder);
                }
            }
            let config = self.read()?;
            found = (self.check)(&self.document, config);
            let refused = |path: &&KeyPath| {
                found.iter().any(|error| KeyPath::parse(&error.key).is_ok_and(|key| key.is_within(path)))
            };
            changed = self.placeholders.iter().filter(refused).cloned().collect();
            if changed.is_empty() {
                break;
            }
        }
        let is_one_of_two = |error: &SettingError, key: &KeyPath| {
            preference[0] != Placeholder::Absent
                && matches!(error.problem, SettingProblem::Missing { .. })
                && self.placeholders.iter().any(|path| path.is_beside(key) && self.is_absent(path))
        };
        found.retain(|error| {
            KeyPath::parse(&error.key).map_or(true, |key| !self.is_set_aside(&key) && !is_one_of_two(error, &key))
        });
        Some(found)
    }

    /// Whether nothing stands at `path`.
    fn is_absent(&self, path: &KeyPath) -> bool {
        matches!(self.document.nearest(path), (Entry { value: Value::Placeholder(Placeholder::Absent), .. }, true))
    }

    /// Reads the scenario; what cannot be read is set aside. `None` if that did not help.
    fn read(&mut self) -> Option<T> {
        for _ in 0..10 * MOST_ERRORS {
            let (refusal, path) = match read(&self.document) {
                Ok(config) => return Some(config),
                Err(refused) => refused,
            };
            if !self.set_aside(&refusal, &path) || self.errors.len() >= MOST_ERRORS {
                return None;
            }
        }
        None
    }

    /// Notes why the setting at `path` cannot be read, and sets it aside. False if that is not possible.
    fn set_aside(&mut self, refusal: &Refusal, path: &KeyPath) -> bool {
        match refusal {
            Refusal::UnknownField { field, expected } => {
                self.note(refusal, path);
                let (table, _) = self.document.named_in(path, field);
                self.rename(&table, field, expected)
            }
            Refusal::UnknownVariant { variant, expected } => {
                self.note(refusal, path);
                self.choose(path, variant, expected)
            }
            Refusal::SeveralChoices(choices) => {
                self.note(refusal, path);
                let first = choices.first().cloned();
                match self.document.entry_mut(path).map(|entry| &mut entry.value) {
                    Some(Value::Table(table)) => {
                        table.retain(|key, _| Some(key) == first.as_ref());
                        true
                    }
                    _ => false,
                }
            }
            Refusal::MissingField(field) => {
                let key = path.child(PathStep::Key((*field).to_owned()));
                if !self.is_set_aside(&key) {
                    self.note(refusal, path);
                }
                self.set_placeholder(&key, Placeholder::One)
            }
            Refusal::Unfit { .. } | Refusal::Other(_) => {
                if self.is_set_aside(path) {
                    return false;
                }
                // What was guessed may be wrong.
                if !self.guesses.contains(path) {
                    self.note(refusal, path);
                }
                self.document.nearest(path).1 && self.set_placeholder(path, Placeholder::Absent)
            }
        }
    }

    fn note(&mut self, refusal: &Refusal, path: &KeyPath) {
        self.errors.push(self.document.refused(path, refusal));
    }

    /// Whether a placeholder stands at `path` or above it.
    fn is_set_aside(&self, path: &KeyPath) -> bool {
        self.placeholders.iter().any(|placeholder| path.is_within(placeholder))
    }

    fn set_placeholder(&mut self, path: &KeyPath, placeholder: Placeholder) -> bool {
        let Some(entry) = self.document.entry_or_insert(path) else { return false };
        entry.value = Value::Placeholder(placeholder);
        if !self.placeholders.contains(path) {
            self.placeholders.push(path.clone());
        }
        true
    }

    /// Replaces `name` in `table` by the one of `expected` that was likely meant, or removes it.
    fn rename(&mut self, table: &KeyPath, name: &str, expected: &[&str]) -> bool {
        let Some(Entry { value: Value::Table(settings), .. }) = self.document.entry_mut(table) else { return false };
        let Some(entry) = settings.remove(name) else { return false };
        if let Some(meant) = closest(name, expected).filter(|meant| !settings.contains_key(*meant)) {
            settings.insert(meant.to_owned(), entry);
            self.guesses.push(table.child(PathStep::Key(meant.to_owned())));
        }
        true
    }

    /// Replaces the choice `name` at `path` by the one of `expected` that was likely meant, or by a placeholder.
    fn choose(&mut self, path: &KeyPath, name: &str, expected: &[&str]) -> bool {
        let meant = closest(name, expected);
        match self.document.entry_mut(path).map(|entry| &mut entry.value) {
            Some(Value::Table(table)) if table.len() > 1 => table.remove(name).is_some(),
            Some(Value::Table(_)) if meant.is_some() => self.rename(path, name, expected),
            Some(Value::String(text)) if meant.is_some() => {
                *text = meant.unwrap_or_default().to_owned();
                true
            }
            Some(_) => self.set_placeholder(path, Placeholder::Absent),
            None => false,
        }
    }
}

#[cfg(test)]
mod tests;
