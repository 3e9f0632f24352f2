//! Scenario files: reading, layering, checking; every refusal points at the key in the text.

mod build;
mod config;
mod deserialize;
mod document;
mod effective;
mod error;
mod key_path;
mod known_channel;
mod layers;
mod map_settings;
mod survey_identity;
mod sweep;

pub use build::{NamedMap, Scenario};
pub use config::{MetricsConfig, PcapConfig, RecordingConfig, ScenarioConfig};
pub use error::{ScenarioError, ScenarioErrors};
pub use known_channel::KnownChannel;
pub use map_settings::{AlgorithmName, MapSettings};
pub use survey_identity::SurveyIdentity;
pub use sweep::{Setting, Sweep, SweepConfig};

use deserialize::Refusal;

/// The form of a `--set` flag, checked before anything is read.
pub(crate) fn flag(text: &str) -> Result<String, &'static str> {
    match text.split_once('=') {
        Some((key, _)) if !key.trim().is_empty() => Ok(text.to_owned()),
        _ => Err("expected path.to.key=value, for example robots.0.speed_m_per_s=2"),
    }
}

#[cfg(test)]
mod tests;
