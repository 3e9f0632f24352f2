//! Scenario files: read, merged and checked. Each error points at the key in the file.

mod algorithm;
mod applications;
mod build;
mod config;
mod deserialize;
mod detail;
mod diagnosis;
mod distributed;
mod document;
mod effective;
mod error;
mod errors;
mod key_path;
mod keys;
mod known_networks;
mod layers;
mod loaded;
mod map_settings;
mod maps;
mod network_config;
mod networks;
mod reference;
mod refusal;
mod robots;
mod schema;
mod setting_line;
mod simulation;
mod sinks;
mod snapshots;
mod source;
mod survey_identity;
mod sweep;
mod team;
mod team_config;
mod unit;

pub use algorithm::{Algorithm, Task};
pub use applications::{Application, ApplicationMap};
pub use config::{MetricsConfig, PcapConfig, RecordingConfig, ScenarioConfig};
pub use detail::DetailConfig;
pub use distributed::NodeMapJob;
pub use error::{Excerpt, ScenarioError, ScenarioErrors};
pub use known_networks::PacketsPerStop;
pub use loaded::{NamedFile, Scenario};
pub use map_settings::{AlgorithmName, MapSettings, RecordedScenario, UnknownAlgorithm};
pub use maps::MapJob;
pub use network_config::NetworkConfig;
pub use reference::{Choice, ExplainError, Explanation, KeyReference, explain, key_reference};
pub use schema::{schema, schema_of_files};
pub use snapshots::SnapshotsConfig;
pub use survey_identity::SurveyIdentity;
pub use sweep::{Setting, SweepAxes, SweepConfig};
pub use team_config::{FramesConfig, TeamConfig};

#[cfg(test)]
mod tests;
