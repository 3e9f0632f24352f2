//! Links: how stations of a network send to each other. Each technology is a folder, and a line in
//! [`technology`]; the rest of the simulator knows what all have in common.

pub(crate) mod antennas;
pub(crate) mod books;
mod capture;
pub(crate) mod clock;
mod config;
pub(crate) mod coordinator;
mod dmg_channel;
mod fate;
mod frame_buffer;
pub(crate) mod ieee80211ad;
pub(crate) mod ieee802154;
mod ledger;
pub(crate) mod links;
mod payloads;
pub(crate) mod programmed;
pub(crate) mod radio_settings;
mod radio_spans;
mod radios;
pub(crate) mod settings;
pub(crate) mod sleeping;
mod technology;
mod track;
pub(crate) mod transmitter;
pub(crate) mod tsch;

use sextant_kernel::SettingError;

use crate::air::ReceptionModel;
pub use capture::FrameFormat;
pub use config::{LinkConfig, LinkError, MacConfig, RadioConfig, RadioGroupConfig};
pub use ieee80211ad::Ieee80211ad;
pub use ieee802154::Ieee802154;
pub use sleeping::Sleeping;
pub(crate) use technology::Links;
pub use technology::Technology;
pub use tsch::{CellFault, Tsch};

/// Refuses bit errors of another physical layer, that of `radio`, than that of which they are known.
fn refuse_bit_errors(reception: ReceptionModel, radio: &str) -> Result<(), SettingError> {
    if reception != ReceptionModel::Ber {
        return Ok(());
    }
    let found = format!("set for {radio}");
    let allowed = "only `phy = \"oqpsk2450\"`, whose bit error rate is known; \
                   with others `reception.sinr_threshold`, `reception.sir_threshold` or `reception.overlap`";
    Err(SettingError::new("reception.ber", found, allowed))
}
