//! Stations that sleep and look at the channel at each interval, and how they are woken: X-MAC, repeated frames (ContikiMAC,
//! BoX-MAC), CSL of IEEE 802.15.4-2015.
//!
//! Goes in: when a check begins in which somebody sends, frames to send, what was received. Comes out: commands to a
//! [`Radio`]. [`SleepSettings`] has all spans that follow from the settings.

mod best_interval;
mod config;
pub mod frame;
mod port;
mod settings;
mod station;
#[cfg(test)]
mod tests;

pub use best_interval::{BestInterval, IntervalPowers};
pub use config::{CslConfig, PhasesConfig, RepeatedDataConfig, SinksConfig, SleepConfig, WakeUpConfig, XMacConfig};
pub use port::{Ended, Event, Job, MeantFor, Radio, Recipient, Sent};
pub use settings::{Aimed, Check, CheckSpans, Form, STROBE_OCTETS, SleepSettings, WAKE_UP_OCTETS};
pub use station::{Rest, Sleeper};
