//! Which scenarios have the same surveys.

use std::collections::BTreeMap;

use serde::Serialize;
use sextant_apps::ControllerConfig;
use sextant_apps::distributed::DistributedMappingConfig;
use sextant_apps::routing::RoutingConfig;
use sextant_channel::{ChannelConfig, RangingDeviceConfig};
use sextant_mac::EnergyConfig;
use sextant_sim::{
    AnchorsConfig, AntennasConfig, BatteryConfig, FaultsConfig, InterfererConfig, LinkTraceConfig, MacConfig,
    RadioConfig, ReceptionConfig, RobotConfig, SensorsConfig, SinkConfig, TrafficConfig, WorldConfig,
};
use sha2::{Digest, Sha256};

use super::config::ScenarioConfig;
use super::config::network::NetworkConfig;
use super::config::simulation::SimulationConfig;
use super::config::team::TeamConfig;
use super::loaded::Scenario;

/// A hash of all settings that a survey depends on, except the seed. Scenarios with the same hash have the same survey for
/// each seed. Files are hashed by name, not by content.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SurveyIdentity([u8; 32]);

/// The settings that a survey depends on.
#[derive(Serialize)]
struct SurveySettings<'a> {
    world: &'a WorldConfig,
    sensors: &'a SensorsConfig,
    radio: &'a Option<RadioConfig>,
    channel: &'a ChannelConfig,
    #[serde(skip_serializing_if = "Option::is_none")]
    link_trace: &'a Option<LinkTraceConfig>,
    mac: &'a MacConfig,
    traffic: &'a Option<TrafficConfig>,
    #[serde(skip_serializing_if = "Option::is_none")]
    routing: &'a Option<RoutingConfig>,
    reception: &'a Option<ReceptionConfig>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ranging: &'a Option<RangingDeviceConfig>,
    antenna: &'a Option<AntennasConfig>,
    energy: &'a Option<EnergyConfig>,
    #[serde(skip_serializing_if = "Option::is_none")]
    battery: &'a Option<BatteryConfig>,
    networks: &'a BTreeMap<String, NetworkConfig>,
    duration_s: &'a Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    warm_up_s: &'a Option<f64>,
    #[serde(skip_serializing_if = "SimulationConfig::is_default")]
    simulation: &'a SimulationConfig,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    interferers: &'a [InterfererConfig],
    sinks: &'a [SinkConfig],
    robots: &'a [RobotConfig<ControllerConfig>],
    #[serde(skip_serializing_if = "Option::is_none")]
    team: &'a Option<TeamConfig>,
    faults: &'a FaultsConfig,
    /// The map that nodes compute while they are surveyed, and the anchors that begin it.
    distributed: Option<(&'a DistributedMappingConfig, &'a AnchorsConfig)>,
}

impl SurveyIdentity {
    /// The identity of the surveys of `config`.
    ///
    /// # Panics
    /// Never for a scenario that was read from text.
    #[must_use]
    pub fn of(config: &ScenarioConfig) -> Self {
        let config = &with_paths_as_text(config);
        // Without `..`, so that a new table of settings must be listed here.
        let ScenarioConfig {
            world,
            sensors,
            radio,
            channel,
            link_trace,
            mac,
            traffic,
            routing,
            reception,
            ranging,
            antenna,
            energy,
            battery,
            networks,
            duration_s,
            warm_up_s,
            simulation,
            interferers,
            sinks,
            robots,
            team,
            faults,
            name: _,
            seed: _,
            anchors,
            distributed_mapping,
            discovery: _,
            maps: _,
            applications: _,
            metrics: _,
            recording: _,
            sweep: _,
        } = config;
        let settings = SurveySettings {
            world,
            sensors,
            radio,
            channel,
            link_trace,
            mac,
            traffic,
            routing,
            reception,
            ranging,
            antenna,
            energy,
            battery,
            networks,
            duration_s,
            warm_up_s,
            simulation,
            interferers,
            sinks,
            robots,
            team,
            faults,
            distributed: distributed_mapping.as_ref().map(|mapping| (mapping, anchors)),
        };
        Self(hash(&settings))
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
