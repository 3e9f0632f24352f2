//! Radiotap: the header with data of the receiver before a frame of IEEE 802.11 (link type 127; radiotap.org).

use super::frame::CapturedDmgFrame;

/// Numbers of the fields: bits of the word that tells which are present, and places in [`FIELDS`].
mod field {
    pub(super) const TSFT: usize = 0;
    pub(super) const FLAGS: usize = 1;
    pub(super) const CHANNEL: usize = 3;
    pub(super) const ANTENNA_SIGNAL: usize = 5;
}
/// Size and alignment of the fields up to the signal: TSFT, flags, rate, channel, FHSS, signal.
const FIELDS: [(usize, usize); 6] = [(8, 8), (1, 1), (1, 1), (4, 2), (2, 1), (1, 1)];
/// A word of present fields is followed by another one.
const MORE: u32 = 1 << 31;
/// Values of the field of flags.
mod flag {
    /// The frame ends with its FCS.
    pub(super) const FCS_AT_END: u8 = 0x10;
    /// The FCS is wrong.
    pub(super) const BAD_FCS: u8 = 0x40;
}
/// Centre of channel 2 of IEEE 802.11ad (MHz).
const CHANNEL_2_MHZ: u16 = 60_480;

/// What a radiotap header tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RadiotapHeader {
    /// Whether the check sequence of the frame was wrong.
    pub has_bad_fcs: bool,
    /// Signal at the antenna (dBm), over all antennas if there are several.
    pub signal_dbm: Option<i8>,
}

/// Appends header and frame.
pub(super) fn write(frame: &CapturedDmgFrame<'_>, record: &mut Vec<u8>) {
    let mut fields: u32 = 1 << field::TSFT | 1 << field::FLAGS | 1 << field::CHANNEL;
    let mut octets = 22_u16;
    if frame.power.is_some() {
        fields |= 1 << field::ANTENNA_SIGNAL;
        octets += 1;
    }
    // Version, padding, length of the header.
    record.extend([0; 2]);
    record.extend(octets.to_le_bytes());
    record.extend(fields.to_le_bytes());
    record.extend((frame.start.as_nanos() / 1000).to_le_bytes());
    // Flags, and padding so that the channel is aligned.
    record.extend([flag::FCS_AT_END, 0]);
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

/// Header and frame; `None` if the header is not valid.
#[must_use]
pub fn parse(octets: &[u8]) -> Option<(RadiotapHeader, &[u8])> {
    let [0, _, low, high, ..] = *octets else { return None };
    let (header, frame) = octets.split_at_checked(usize::from(u16::from_le_bytes([low, high])))?;
    let word = |at: usize| Some(u32::from_le_bytes(*header.get(at..)?.first_chunk()?));
    let present = word(4)?;
    let mut at = 8;
    let mut last = present;
    while last & MORE != 0 {
        last = word(at)?;
        at += 4;
    }
    let mut found = RadiotapHeader { has_bad_fcs: false, signal_dbm: None };
    for (number, (size, alignment)) in FIELDS.into_iter().enumerate() {
        if present & 1 << number == 0 {
            continue;
        }
        at = at.next_multiple_of(alignment);
        let value = *header.get(at..at + size)?.first()?;
        match number {
            field::FLAGS => found.has_bad_fcs = value & flag::BAD_FCS != 0,
            field::ANTENNA_SIGNAL => found.signal_dbm = Some(value.cast_signed()),
            _ => {}
        }
        at += size;
    }
    Some((found, frame))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_aligned_and_further_words_are_skipped() {
        // Two words of present fields: TSFT, flags, channel, signal; then nothing.
        let mut header = vec![0, 0, 30, 0, 0b0010_1011, 0, 0, 0x80, 0, 0, 0, 0];
        header.resize(16, 0);
        header.extend([1; 8]);
        header.extend([0x50, 0, 0x6C, 0x09, 0xA0, 0x00]);
        header[2] = u8::try_from(header.len() + 1).unwrap();
        header.push(0xC8);
        let octets = [&header[..], b"frame"].concat();
        let expected = RadiotapHeader { has_bad_fcs: true, signal_dbm: Some(-56) };
        assert_eq!(parse(&octets), Some((expected, &b"frame"[..])));
        for cut in 0..header.len() {
            assert_eq!(parse(&octets[..cut]), None, "{cut}");
        }
    }
}
