//! Radiotap: the header with data of the receiver before a frame of IEEE 802.11 (radiotap.org).

use std::time::Duration;

use sextant_channel::Dbm;
use sextant_kernel::SimTime;

/// Bits of the fields that are present.
mod present {
    pub(super) const TSFT: u32 = 1 << 0;
    pub(super) const FLAGS: u32 = 1 << 1;
    pub(super) const CHANNEL: u32 = 1 << 3;
    pub(super) const ANTENNA_SIGNAL: u32 = 1 << 5;
}
/// Flag: the frame ends with its FCS.
const FCS_AT_END: u8 = 0x10;
/// Centre of channel 2 of IEEE 802.11ad (MHz).
const CHANNEL_2_MHZ: u16 = 60_480;

/// A frame of IEEE 802.11ad in a capture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapturedDmgFrame<'a> {
    /// First symbol on air.
    pub start: SimTime,
    /// Time on air.
    pub airtime: Duration,
    /// The MAC frame with its check sequence.
    pub octets: &'a [u8],
    /// Carrier frequency (Hz).
    pub carrier_hz: f64,
    /// Received power, if the capture is by one receiver (dBm).
    pub power: Option<Dbm>,
}

/// Appends header and frame.
pub(super) fn write(frame: &CapturedDmgFrame<'_>, record: &mut Vec<u8>) {
    let mut fields = present::TSFT | present::FLAGS | present::CHANNEL;
    let mut octets = 22_u16;
    if frame.power.is_some() {
        fields |= present::ANTENNA_SIGNAL;
        octets += 1;
    }
    // Version, padding, length of the header.
    record.extend([0; 2]);
    record.extend(octets.to_le_bytes());
    record.extend(fields.to_le_bytes());
    record.extend((frame.start.as_nanos() / 1000).to_le_bytes());
    // Flags, and padding so that the channel is aligned.
    record.extend([FCS_AT_END, 0]);
    record.extend(channel_mhz(frame.carrier_hz).to_le_bytes());
    // No flag of a channel is about this band.
    record.extend([0; 2]);
    if let Some(power) = frame.power {
        #[expect(clippy::cast_possible_truncation, reason = "between -128 and 127")]
        let power_dbm = power.0.round().clamp(-128.0, 127.0) as i8;
        record.extend(power_dbm.to_le_bytes());
    }
    record.extend(frame.octets);
}

/// The frequency to name: the field holds at most 65535 MHz, so a carrier above that (73 GHz) is named as channel 2,
/// which makes analysers read the frame as one of IEEE 802.11ad.
fn channel_mhz(carrier_hz: f64) -> u16 {
    let mhz = (1e-6 * carrier_hz).round();
    if mhz > f64::from(u16::MAX) {
        return CHANNEL_2_MHZ;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 65535")]
    let mhz = mhz.max(0.0) as u16;
    mhz
}
