//! IEEE 802.11ad (directional multi-gigabit): all that knows this technology. Its links sweep their sectors, and send
//! data to all from each of them.

mod broadcast;
mod links;
mod radio;
mod settings;
mod stack;
mod tracks;
mod transceiver;

pub(super) use links::Links;
pub use radio::DmgRadio;
pub use settings::Ieee80211ad;
pub(super) use settings::Ieee80211ad as Settings;
