//! IEEE 802.11ad (directional multi-gigabit): all that knows this technology. Its links sweep their sectors, and send
//! data to all from each of them.

mod antennas;
mod broadcast;
pub(crate) mod network;
mod radio;
mod stack;
mod transceiver;

use sextant_mac::dmg::SweepSettings;

use crate::air::ReceptionModel;

pub use antennas::{Antennas, AntennasConfig, HeadingsConfig};
pub use radio::DmgRadio;

/// Links of IEEE 802.11ad.
#[derive(Clone, Debug)]
pub struct Ieee80211ad {
    /// The radios.
    pub radio: DmgRadio,
    /// The rule that decides whether a frame is received.
    pub reception: ReceptionModel,
    /// Sector sweeps, and how nodes share the channel for their answers.
    pub sweep: SweepSettings,
    /// The antennas.
    pub antennas: Antennas,
}
