//! Scenarios of Sextant: a simulation as a file or text says it, read, merged and checked.
//!
//! In goes TOML: a file, those that it extends, and overrides key by key. Out comes a [`Scenario`], whose parts are the checked
//! types of the crates below; or [`ScenarioErrors`], each of which points at the key in the file. Nothing is simulated here.
//!
//! ```
//! use sextant_scenario::Scenario;
//! use sextant_scenario::template::Template;
//!
//! let template = Template::named("survey").and_then(|template| template.scenario()).expect("a template");
//! let scenario = Scenario::parse(template.text)?.with("seed", 3)?;
//! assert_eq!(scenario.seed(), sextant_kernel::Seed(3));
//! let refused = scenario.with("channel.path_loss.log_distance.exponent", -1.0).expect_err("path loss grows with distance");
//! assert!(refused.to_string().contains("exponent"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! - [`ScenarioFile`] is the text with what it extends; [`Scenario`] is what it means; [`ScenarioConfig`] is it as written.
//! - [`SweepConfig`] is the table `[sweep]` as written, and [`SweepAxes`] its checked axes; `sextant-study` runs them.
//! - [`MapSettings`] are those of one map of a log, whether a scenario is there or not.
//! - [`explain`] and [`key_reference`] say what keys mean, and [`schema`] is the JSON schema of the format.
//! - [`Template`](template::Template)s are scenarios to begin with; [`shell`] quotes the names of files in their commands.

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
mod file;
mod files;
mod grids;
mod key_path;
mod keys;
mod known_networks;
mod layers;
mod loaded;
mod map_settings;
mod maps;
mod network_config;
mod networks;
mod plausible;
mod reference;
mod refusal;
mod replaced;
mod robots;
mod schema;
mod setting_line;
pub mod shell;
mod simulation;
mod sinks;
mod snapshots;
mod source;
mod survey_identity;
mod sweep;
mod team;
mod team_config;
pub mod template;
mod unit;

pub use algorithm::{Algorithm, Task};
pub use applications::{Application, ApplicationMap};
pub use config::{MetricsConfig, PcapConfig, RecordingConfig, ScenarioConfig};
pub use detail::DetailConfig;
pub use distributed::NodeMapJob;
pub use error::{Excerpt, RefusedSetting, ScenarioError, ScenarioErrors};
pub use file::ScenarioFile;
pub use known_networks::PacketsPerStop;
pub use loaded::{NamedFile, Scenario};
pub use map_settings::{AlgorithmName, MapSettings, RecordedScenario, UnknownAlgorithm};
pub use maps::MapJob;
pub use network_config::NetworkConfig;
pub use networks::ForeignChip;
pub use reference::{Choice, ExplainError, Explanation, KeyReference, explain, key_reference};
pub use replaced::check_given;
pub use schema::{schema, schema_of_files};
pub use snapshots::SnapshotsConfig;
pub use survey_identity::SurveyIdentity;
pub use sweep::{Setting, SweepAxes, SweepConfig};
pub use team_config::{FramesConfig, TeamConfig};

#[cfg(test)]
mod tests;
