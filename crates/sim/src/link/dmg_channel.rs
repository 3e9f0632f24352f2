//! Where the channels of IEEE 802.11ad lie in the spectrum.

/// Carrier frequency of a channel, 1 to 4 (Hz): channels are 2.16 GHz apart (IEEE 802.11ad-2012, annex E).
pub(super) fn carrier_hz(channel: u8) -> f64 {
    56.16e9 + 2.16e9 * f64::from(channel)
}
