//! Radios of IEEE 802.15.4 that the programs of the stations command: no channel access, no queue, no retries.

mod commands;
mod links;
mod packet;
mod settings;
mod stack;

pub(crate) use links::Links;
pub use packet::RadioFrame;
pub use settings::Programmed;
pub(super) use settings::Programmed as Settings;
pub use stack::{Acknowledging, Hearing};
