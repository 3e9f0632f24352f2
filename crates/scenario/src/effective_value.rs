//! The values that settings have, wherever they are from.

use serde_json::Value;

use super::document::effective::inline;
use super::document::key_path::KeyPath;
use super::loaded::Scenario;
use super::reference::{Explanation, explain};
use super::survey_identity::with_paths_as_text;

impl Scenario {
    /// The value in TOML that each of the settings `keys` has: as given, or as in the file, or its default. It is empty if there is
    /// none, because the key is of another choice, for example.
    #[must_use]
    pub fn effective_values<'k>(&self, keys: impl IntoIterator<Item = &'k str>) -> Vec<String> {
        let config = serde_json::to_value(with_paths_as_text(self.config())).unwrap_or_default();
        let document = self.file().overridden(self.overrides().0, None).unwrap_or_default();
        let value = |key: &str| {
            let path = KeyPath::parse(key).ok()?;
            let used = path.0.iter().try_fold(&config, |value, step| match value {
                Value::Array(items) => items.get(step.index()?),
                value => value.get(step.key()?),
            })?;
            match document.nearest(&path) {
                (entry, true) => Some(inline(&entry.value)),
                _ => Some(used).filter(|used| !used.is_null()).map(Value::to_string),
            }
        };
        keys.into_iter().map(|key| value(key).unwrap_or_default()).collect()
    }
    /// Those of the settings `keys` that are given, by the file or by an override, with another value than their default.
    #[must_use]
    pub fn changed_keys<'k>(&self, keys: impl IntoIterator<Item = &'k str>) -> Vec<&'k str> {
        let document = self.file().overridden(self.overrides().0, None).unwrap_or_default();
        let is_changed = |key: &&str| {
            let Ok(path) = KeyPath::parse(key) else { return false };
            let (entry, true) = document.nearest(&path) else { return false };
            let default = match explain(key) {
                Ok(Explanation::Key { key, .. }) => key.default,
                _ => None,
            };
            default.is_none_or(|default| !is_same(&inline(&entry.value), &default))
        };
        keys.into_iter().filter(is_changed).collect()
    }
}

/// Whether two values in TOML are the same: `12` is `12.0`.
fn is_same(a: &str, b: &str) -> bool {
    match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => a.total_cmp(&b).is_eq(),
        _ => a == b,
    }
}
