//! How the frames of a network are written into a capture.

use sextant_channel::Dbm;

/// How the frames of a network are written into a capture: the header that goes before each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FrameFormat {
    /// IEEE 802.15.4 TAP: page and number of the radio channel.
    Tap {
        /// Channel page.
        page: u8,
        /// Number of the radio channel.
        channel: u8,
        /// Minimum power of a frame that can be received.
        sensitivity: Dbm,
    },
    /// Radiotap: the carrier.
    Radiotap {
        /// Carrier frequency of the radio channel (Hz).
        carrier_hz: f64,
    },
}
