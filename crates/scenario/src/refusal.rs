//! Errors of settings, with their place in the source text.

use std::fmt;

use sextant_kernel::text::shortened;
use sextant_kernel::{SettingError, SettingProblem};

use super::document::key_path::{KeyPath, PathStep};
use super::document::{Document, Entry, Value};
use super::error::ScenarioError;
use super::reference::{Explanation, explain};
use super::source::Origin;

/// Why a setting is rejected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Refusal {
    UnknownField {
        field: String,
        expected: &'static [&'static str],
    },
    UnknownVariant {
        variant: String,
        expected: &'static [&'static str],
    },
    MissingField(&'static str),
    Unfit {
        found: String,
        expected: String,
    },
    /// A table with several choices, of which one is allowed.
    SeveralChoices(Vec<String>),
    Other(String),
}

impl Refusal {
    /// The unknown key or choice; empty for other errors.
    fn name(&self) -> &str {
        match self {
            Self::UnknownField { field: name, .. } | Self::UnknownVariant { variant: name, .. } => name,
            _ => "",
        }
    }
}

impl Document {
    /// The error that the value at `error.key` is not allowed.
    pub(super) fn outside(&self, error: &SettingError) -> ScenarioError {
        let found = Some(error.found())
            .filter(|_| !matches!(error.problem, SettingProblem::Missing { .. } | SettingProblem::MissingTable));
        let this = ScenarioError::new(error.to_string()).about(&error.key, found, Some(error.allowed()));
        match KeyPath::parse(&error.key) {
            Ok(path) => {
                let (entry, exact) = self.nearest(&path);
                let label = if exact { value_label(error.allowed()) } else { "in this table".to_owned() };
                self.pointing(this, entry, exact, label)
            }
            Err(_) => this,
        }
    }

    /// The error that the setting at `path` is rejected.
    pub(super) fn refused(&self, path: &KeyPath, refusal: &Refusal) -> ScenarioError {
        let (entry, exact) = self.nearest(path);
        let (table, entry_of) = self.named_in(path, refusal.name());
        let [path_text, table_text] = [path, &table].map(KeyPath::to_string);
        let [shown, table_shown] = [&path_text, &table_text].map(|text| shortened(text));
        let place = if table.0.is_empty() { "the scenario".to_owned() } else { format!("`{table_shown}`") };
        match refusal {
            Refusal::UnknownField { field, expected } => {
                let this = ScenarioError::new(format!("unknown key `{}` in {place}", shortened(field)));
                let label = suggestion(field, expected, "no such key");
                let key = table.child(PathStep::Key((*field).clone()));
                let this = this.about(key, Some(field), Some(names(expected)));
                self.pointing_at_key(this, &entry_of.origin, label).help(allowed("keys allowed here", expected))
            }
            Refusal::UnknownVariant { variant, expected } => {
                let is_key = matches!(entry.value, Value::Table(_)) || !exact;
                let label = suggestion(variant, expected, "no such choice");
                let this = ScenarioError::new(format!("unknown choice `{}` for {place}", shortened(variant)));
                let this = this.about(&table, Some(variant), Some(names(expected)));
                let this = if is_key {
                    self.pointing_at_key(this, &entry_of.origin, label)
                } else {
                    self.pointing(this, entry, true, label)
                };
                this.help(allowed("choices", expected))
            }
            Refusal::MissingField(field) => {
                let this = ScenarioError::new(format!("`{field}` is missing in {place}"));
                let key = path.child(PathStep::Key((*field).to_owned()));
                let help = format!("write `{} = ..`", shortened(&key.to_string()));
                let this = this.about(key, None, None::<&str>);
                self.pointing_at_key(this, &entry.origin, "this table needs it").help(help)
            }
            Refusal::Unfit { found, expected } => {
                let whole = whole_number(path, expected);
                let expected = whole.as_ref().unwrap_or(expected);
                let this = ScenarioError::new(format!("`{shown}` is {}; allowed: {expected}", shortened(found)));
                let this = this.about(path, Some(&shortened(found)), Some(expected));
                self.pointing(this, entry, exact, value_label(expected))
            }
            Refusal::SeveralChoices(choices) => {
                let this = ScenarioError::new(format!("`{shown}`: only one of {} is allowed", names(choices)));
                let found = choices.join(", ");
                let this = this.about(path, Some(&found), Some(format!("one of {}", names(choices))));
                self.pointing(this, entry, exact, "here")
            }
            Refusal::Other(message) => {
                let message = if path.0.is_empty() { message.clone() } else { format!("`{shown}`: {message}") };
                let this = ScenarioError::new(message).about(path, None, None::<&str>);
                self.pointing(this, entry, exact, "here")
            }
        }
    }

    /// The table that has the unknown key or choice `name`, and the entry of that. The path to an unknown key may end at the
    /// key or at its table.
    pub(super) fn named_in(&self, path: &KeyPath, name: &str) -> (KeyPath, &Entry) {
        let (entry, _) = self.nearest(path);
        let step = PathStep::Key(name.to_owned());
        match (path.0.split_last(), entry.child(&step)) {
            (_, Some(child)) => (path.clone(), child),
            (Some((last, above)), None) if *last == step => (KeyPath(above.to_vec()), entry),
            _ => (path.clone(), entry),
        }
    }

    /// Makes `error` point at the value of `entry`, or at its key if the value is a table or `exact` is false.
    fn pointing(&self, error: ScenarioError, entry: &Entry, exact: bool, label: impl Into<String>) -> ScenarioError {
        let origin = &entry.origin;
        let whole = matches!(entry.value, Value::Table(_)) || !exact;
        let span = if whole { origin.head() } else { origin.value.clone() };
        error.at(&self.sources[origin.source], span, label)
    }

    fn pointing_at_key(&self, error: ScenarioError, origin: &Origin, label: impl Into<String>) -> ScenarioError {
        error.at(&self.sources[origin.source], origin.head(), label)
    }
}

/// The whole numbers that are allowed at `path`, which are fewer than those of its type, `expected` in words.
fn whole_number(path: &KeyPath, expected: &str) -> Option<String> {
    let of_type = expected.strip_prefix("a whole number, ")?;
    let Ok(Explanation::Key { key, .. }) = explain(&path.to_string()) else { return None };
    let range = key.range?;
    // Without a bound of its own, the greatest number is that of the type.
    let range = match (range.strip_suffix(" or above"), of_type.split_once(" to ")) {
        (Some(least), Some((_, most))) => format!("{least} to {most}"),
        _ => range,
    };
    Some(format!("a whole number, {range}"))
}

/// The label below a rejected value. It repeats what is allowed only if that is short.
fn value_label(allowed: &str) -> String {
    if allowed.chars().count() <= 50 { format!("allowed: {allowed}") } else { "this value".to_owned() }
}

/// "did you mean ..?" if one of `expected` is similar to `found`, otherwise `otherwise`.
fn suggestion(found: &str, expected: &[&str], otherwise: &str) -> String {
    match closest(found, expected) {
        Some(name) => format!("did you mean `{name}`?"),
        None => otherwise.to_owned(),
    }
}

/// The one of `expected` that is similar to `found`, if there is one.
pub(super) fn closest<'a>(found: &str, expected: &[&'a str]) -> Option<&'a str> {
    expected
        .iter()
        .map(|name| (strsim::jaro_winkler(found, name), *name))
        .max_by(|(a, _), (b, _)| a.total_cmp(b))
        .filter(|(likeness, _)| *likeness > 0.8)
        .map(|(_, name)| name)
}

fn allowed(what: &str, expected: &[&str]) -> String {
    if expected.is_empty() { format!("{what}: none") } else { format!("{what}: {}", names(expected)) }
}

fn names(names: &[impl fmt::Display]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}
