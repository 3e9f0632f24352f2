//! A code book as a file, with settings beside it.

use std::path::Path;

use serde::Deserialize;
use sextant_channel::{Antenna, AntennaConfig, CodeBookConfig};
use sextant_kernel::SettingError;

/// Why a code book cannot be shown.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BookError {
    /// A setting is none of a code book.
    #[error("`{setting}`: {cause}")]
    Setting {
        /// The setting as given.
        setting: String,
        /// Why.
        cause: String,
    },
    /// The code book has a flaw.
    #[error(transparent)]
    Flaw(#[from] SettingError),
}

/// The antenna of the code book in the file `path`. Settings are those of `code_book` in a scenario, `gaps=hold` for example;
/// quotes around a text are optional.
///
/// # Errors
/// If a setting is invalid, or the file has a flaw.
pub fn read_book(path: &Path, settings: &[String]) -> Result<Antenna, BookError> {
    let mut table = toml::Table::new();
    for setting in settings {
        let error = |cause: String| BookError::Setting { setting: setting.clone(), cause };
        let (key, value) = setting.split_once('=').ok_or_else(|| error("allowed: KEY=VALUE".into()))?;
        let (key, value) = (key.trim(), value.trim());
        let read = toml::from_str::<toml::Table>(&format!("value = {value}")).ok();
        let value = read.and_then(|mut table| table.remove("value"));
        table.insert(key.to_owned(), value.unwrap_or_else(|| toml::Value::String(setting_text(setting))));
        // Each setting alone, so that the message names the one that is wrong.
        let alone = toml::Table::from_iter(table.get(key).cloned().map(|value| (key.to_owned(), value)));
        CodeBookConfig::deserialize(alone).map_err(|cause| error(cause.message().trim().to_owned()))?;
    }
    let mut config = CodeBookConfig::deserialize(table)
        .map_err(|cause| BookError::Setting { setting: settings.join(" "), cause: cause.message().to_owned() })?;
    config.file = Some(path.to_owned());
    Ok(Antenna::try_from(AntennaConfig::CodeBook(config))?)
}

/// The value of a setting as a text.
fn setting_text(setting: &str) -> String {
    setting.split_once('=').map_or("", |(_, value)| value.trim()).to_owned()
}
