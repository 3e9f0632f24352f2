//! The values that settings have, wherever they are from.

use serde_json::Value;

use super::document::effective::inline;
use super::document::key_path::KeyPath;
use super::loaded::Scenario;
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
}
