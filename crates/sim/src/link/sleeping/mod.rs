//! Links of IEEE 802.15.4 whose stations sleep, and look at the channel at each interval.
//!
//! A check takes events only if somebody sends in it who could be heard: those who could hear a frame are looked for when it begins.
//! All other checks are counted.

mod checks;
mod links;
mod reach;
mod settings;
mod stack;
mod usage;

pub(crate) use links::Links;
pub use settings::Sleeping;
pub(super) use settings::Sleeping as Settings;
