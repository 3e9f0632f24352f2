//! IEEE 802.15.4: all that knows this technology.

mod addressing;
mod data_packet;
mod frame_queue;
mod links;
mod mac;
mod plan;
mod radio;
mod settings;
mod spectrum;
mod stack;
mod transceiver;

pub(super) use addressing::{check_frame, first_sequence, header, offered_octets, pan};
pub(super) use data_packet::{DataPacket, EndedPacket, Origin};
pub(super) use links::Links;
pub use mac::Mac;
pub(super) use radio::Levels;
pub use radio::Radio;
pub use settings::Ieee802154;
pub(super) use settings::Ieee802154 as Settings;
