//! Sleeping MACs as written in a scenario.

use serde::{Deserialize, Serialize};

/// Stations that sleep and look at the channel at each interval, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SleepConfig {
    /// How a sender wakes its receiver.
    pub wake_up: WakeUpConfig,
    /// Time from one look of a sleeping station at the channel to the next (s): at most 10.
    #[serde(default = "default_interval_s")]
    pub interval_s: f64,
    /// Whether sinks sleep, too.
    #[serde(default)]
    pub sinks: SinksConfig,
    /// Further attempts to send a frame without acknowledgement: 0 to 15.
    #[serde(default = "default_max_retries")]
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 15)))]
    pub max_retries: u8,
    /// How often in succession a sender may find the channel busy and wait; after one more the frame is given up: 0 to 15.
    #[serde(default = "default_max_backoffs")]
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 15)))]
    pub max_backoffs: u8,
    /// Frames that a station holds, that under way included; one more is lost: 1 to 10000.
    #[serde(default = "default_queue_frames")]
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 10000)))]
    pub queue_frames: u16,
    /// Largest deviation of a clock that senders allow for when they wake a station whose phase they know (millionths): 0 to
    /// 1000. It says nothing of the clocks themselves, which `radio.clock_ppm` sets.
    #[serde(default = "default_allowed_ppm")]
    pub allowed_ppm: f64,
}

const fn default_interval_s() -> f64 {
    0.125
}

const fn default_max_retries() -> u8 {
    3
}

const fn default_max_backoffs() -> u8 {
    4
}

const fn default_queue_frames() -> u16 {
    16
}

const fn default_allowed_ppm() -> f64 {
    20.0
}

/// How a sender wakes its receiver, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum WakeUpConfig {
    /// Short frames with the address of the receiver, until it acknowledges one; then the frame itself (X-MAC).
    XMac(XMacConfig),
    /// The frame itself, again and again, until the receiver acknowledges it (ContikiMAC, BoX-MAC).
    RepeatedData(RepeatedDataConfig),
    /// Wake-up frames back to back that count down to the frame itself (CSL of IEEE 802.15.4-2015).
    Csl(CslConfig),
}

/// X-MAC, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct XMacConfig {}

/// Repeated frames, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RepeatedDataConfig {
    /// Time from the end of a frame to the start of the next one (us); two turnarounds and a symbol if absent, and not less:
    /// 400 at 2450 MHz. In it the sender notices an acknowledgement by its first symbol.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gap_us: Option<f64>,
    /// Whether senders remember when a receiver wakes up.
    #[serde(default = "unknown")]
    pub phases: PhasesConfig,
}

const fn unknown() -> PhasesConfig {
    PhasesConfig::Unknown
}

/// CSL, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CslConfig {
    /// Whether senders use the phase in an acknowledgement.
    #[serde(default)]
    pub phases: PhasesConfig,
}

/// Whether senders remember when a receiver wakes up, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum PhasesConfig {
    /// A sender that knows from an acknowledgement when its receiver wakes up begins shortly before.
    #[default]
    Learned,
    /// A sender begins at once, and sends for a whole interval.
    Unknown,
}

/// Whether sinks sleep, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum SinksConfig {
    /// Their receiver is always on.
    #[default]
    AlwaysOn,
    /// They sleep as nodes do.
    Sleep,
}
