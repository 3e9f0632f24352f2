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
//! let refused = scenario.with("channel.path_loss.log_distance.exponent", -1.0).err().expect("path loss grows with distance");
//! assert!(refused.to_string().contains("exponent"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The folders follow the way of a key: `document` merges texts, `config` is a scenario as written, `check` makes of each table
//! what a run uses.
//!
//! - [`ScenarioFile`] is the text with what it extends; [`Scenario`] is what it means; [`ScenarioConfig`] is it as written.
//! - [`SweepConfig`] is the table `[sweep]` as written, and [`SweepAxes`] its checked axes; `sextant-study` runs them.
//! - [`MapSettings`] are those of one map of a log, whether a scenario is there or not.
//! - [`explain`] and [`key_reference`] say what keys mean, and [`schema`] is the JSON schema of the format.
//! - [`Template`](template::Template)s are scenarios to begin with; [`shell`] quotes the names of files in their commands.

mod check;
mod config;
mod deserialize;
mod diagnosis;
mod document;
mod effective_value;
mod error;
mod file;
mod loaded;
mod map_settings;
mod reference;
mod refusal;
mod replaced;
mod schema;
pub mod shell;
mod source;
mod survey_identity;
mod sweep;
pub mod template;
pub mod unit;

pub use check::maps::MapJob;
pub use check::missions::distributed::NodeMapJob;
pub use check::missions::planned::{MissionMap, PlannedMission};
pub use check::networks::network::{ForeignChip, IncompleteChip};
pub use check::networks::surveyed::PacketsPerStop;
pub use config::detail::DetailConfig;
pub use config::network::NetworkConfig;
pub use config::snapshots::SnapshotsConfig;
pub use config::team::{FramesConfig, TeamConfig};
pub use config::{MetricsConfig, PcapConfig, RecordingConfig, ScenarioConfig};
pub use error::{Excerpt, RefusedSetting, ScenarioError, ScenarioErrors};
pub use file::ScenarioFile;
pub use loaded::{NamedFile, Scenario};
pub use map_settings::{AlgorithmName, MapSettings, RecordedScenario, UnknownAlgorithm};
pub use reference::{Choice, ExplainError, Explanation, KeyReference, explain, key_reference};
pub use replaced::{ReplacedSetting, check_given};
pub use schema::{schema, schema_of_files};
pub use sextant_apps::MissionGoal;
pub use survey_identity::SurveyIdentity;
pub use sweep::{Setting, SweepAxes, SweepConfig};

#[cfg(test)]
mod tests;
