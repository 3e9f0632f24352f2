//! The settings of the robots' antenna as a text.

use sextant_channel::SectorGains;

/// The settings of the antenna with these gains as a text of TOML, from which the same gains are read: those of
/// `antenna.toml` in the folder of a log. `None` of an antenna without sectors.
#[must_use]
pub fn write(gains: &SectorGains) -> Option<String> {
    gains.config().map(|config| toml::to_string(&config).expect("settings have a text"))
}
