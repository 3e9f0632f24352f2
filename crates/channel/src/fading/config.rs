//! Fading as written in a scenario.

/// Fading as written in a scenario: many ways of a signal add up or cancel, from place to place, from channel to channel
/// and, if something moves around the links, from time to time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FadingConfig {
    /// How deep the fades are.
    #[cfg_attr(feature = "config", serde(default))]
    pub law: FadingLawConfig,
    /// Greatest Doppler shift by what moves around the links, people for example (Hz): walking at 1 m/s gives about 8 Hz at
    /// 2.4 GHz. With 0, a link between two stations that stand never changes. At most 1e6.
    #[cfg_attr(feature = "config", serde(default))]
    pub doppler_hz: f64,
    /// How much later the ways arrive than the first one (ns), the mean of an exponential law: 20 to 50 indoors. Radio
    /// channels whose frequencies differ by much more than its inverse fade independently. With 0, all fade alike. 50 if
    /// absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub delay_spread_ns: Option<f64>,
    /// Block fading instead: the gain of a link is drawn anew each so many seconds, wherever its ends are and on each channel.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub block_s: Option<f64>,
}

/// How deep fades are, as written in a scenario. The mean power is that without fading.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum FadingLawConfig {
    /// Scattered ways alone: the amplitude has the law of Rayleigh.
    #[default]
    Rayleigh,
    /// A direct way and scattered ones.
    Rician(RicianConfig),
    /// Ways in clusters: the power has a gamma law.
    Nakagami(NakagamiConfig),
}

/// Rician fading as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RicianConfig {
    /// Power of the direct way over that of all others (dB), -20 to 25: 10 or less between sensor nodes in an office.
    pub k_db: f64,
}

/// Nakagami fading as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NakagamiConfig {
    /// The parameter m, a multiple of 0.5 from 0.5 to 20: 1 is Rayleigh, less is worse.
    pub m: f64,
}
