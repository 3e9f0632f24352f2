//! Which scenarios have the same surveys.

use serde::Serialize;
use sextant_sim::{AnchorsConfig, DiscoveryConfig};
use sha2::{Digest, Sha256};

use super::config::{MetricsConfig, RecordingConfig, ScenarioConfig};
use super::loaded::Scenario;

/// A hash of all settings that a survey depends on, except the seed. Scenarios with the same hash have the same survey for
/// each seed. Files are hashed by name, not by content.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SurveyIdentity([u8; 32]);

impl SurveyIdentity {
    /// The identity of the surveys of `config`.
    ///
    /// # Panics
    /// Never for a scenario that was read from text.
    #[must_use]
    pub fn of(config: &ScenarioConfig) -> Self {
        // A survey depends on each table that is not listed here.
        let mut config = ScenarioConfig {
            name: String::new(),
            seed: 0,
            discovery: DiscoveryConfig::default(),
            maps: Vec::new(),
            applications: Vec::new(),
            metrics: MetricsConfig::default(),
            recording: RecordingConfig::default(),
            sweep: None,
            ..with_paths_as_text(config)
        };
        // Anchors begin the map that nodes compute while they are surveyed.
        if config.distributed_mapping.is_none() {
            config.anchors = AnchorsConfig::default();
        }
        Self(hash(&config))
    }
}

impl Scenario {
    /// Identifies the scenarios with the same surveys.
    #[must_use]
    pub fn survey_identity(&self) -> SurveyIdentity {
        SurveyIdentity::of(self.config())
    }

    /// Identifies the scenarios with the same settings, however they are written. The seed is one of them.
    #[must_use]
    pub fn settings_identity(&self) -> [u8; 32] {
        hash(&with_paths_as_text(self.config()))
    }
}

fn hash(settings: &impl Serialize) -> [u8; 32] {
    let json = serde_json::to_vec(settings)
        .expect("all paths are texts now, and so were all other settings when they were read");
    Sha256::digest(json).into()
}

/// The same settings. In paths that are no Unicode, because folders may have any name, other octets are escaped.
pub(super) fn with_paths_as_text(config: &ScenarioConfig) -> ScenarioConfig {
    let mut config = config.clone();
    for (_, path) in config.files_mut() {
        if path.to_str().is_none() {
            *path = path.as_os_str().as_encoded_bytes().escape_ascii().to_string().into();
        }
    }
    config
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use serde_json::{Value, json};

    use super::*;

    /// Tables that a survey does not depend on; on the anchors it does if the nodes compute a map.
    const OTHERS: [&str; 9] =
        ["name", "seed", "anchors", "discovery", "maps", "applications", "metrics", "recording", "sweep"];

    fn shipped(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                shipped(&path, found);
            } else if path.extension().is_some_and(|extension| extension == "toml") {
                found.push(path);
            }
        }
    }

    /// Pointers to all values in `value`, except tables and arrays.
    fn leaves(value: &Value, pointer: &str, found: &mut Vec<String>) {
        match value {
            Value::Object(table) => {
                table.iter().for_each(|(key, value)| leaves(value, &format!("{pointer}/{key}"), found))
            }
            Value::Array(items) => {
                items.iter().enumerate().for_each(|(i, value)| leaves(value, &format!("{pointer}/{i}"), found));
            }
            _ => found.push(pointer.to_owned()),
        }
    }

    fn another(value: &Value) -> Value {
        match value {
            Value::Bool(value) => json!(!value),
            Value::Number(number) if number.is_f64() => json!(number.as_f64().unwrap() + 0.125),
            Value::Number(number) => json!(number.as_u64().map_or(0, |number| number + 1)),
            Value::Null => json!(1.5),
            other => json!(format!("{}-other", other.as_str().unwrap())),
        }
    }

    #[test]
    fn every_survey_key_changes_the_identity_and_no_other_key_does() {
        let mut paths = Vec::new();
        shipped(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios"), &mut paths);
        let (mut survey_keys, mut other_keys) = (0, 0);
        for path in paths {
            let config = Scenario::load(&path).unwrap().config().clone();
            let identity = SurveyIdentity::of(&config);
            let tree = serde_json::to_value(&config).unwrap();
            let mut pointers = Vec::new();
            leaves(&tree, "", &mut pointers);
            for pointer in pointers {
                let mut tree = tree.clone();
                let leaf = tree.pointer_mut(&pointer).unwrap();
                *leaf = another(leaf);
                // The name of a variant cannot be changed to another valid value.
                let Ok(changed) = serde_json::from_value::<ScenarioConfig>(tree) else { continue };
                let table = pointer.split('/').nth(1).unwrap();
                let is_other =
                    OTHERS.contains(&table) && (table != "anchors" || config.distributed_mapping.is_none());
                *(if is_other { &mut other_keys } else { &mut survey_keys }) += 1;
                let is_same = SurveyIdentity::of(&changed) == identity;
                assert_eq!(is_same, is_other, "{} in {}", pointer, path.display());
            }
        }
        assert!(survey_keys > 300 && other_keys > 100, "{survey_keys} and {other_keys} keys were tried");
    }
}
