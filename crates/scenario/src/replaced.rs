//! Settings that have no effect, because something else replaces them.

use std::fmt::Display;

use super::document::Entry;
use super::document::effective;
use super::document::key_path::KeyPath;
use super::document::setting_line::ReadSetting;
use super::error::ScenarioError;
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
