//! Radiotap headers (link type 127; radiotap.org).

/// What a header tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct RadiotapHeader {
    pub(super) has_bad_fcs: bool,
    /// Signal at the antenna, over all antennas if there are several.
    pub(super) signal_dbm: Option<i8>,
}

/// Size and alignment of the fields up to the signal: TSFT, flags, rate, channel, FHSS, signal.
const FIELDS: [(usize, usize); 6] = [(8, 8), (1, 1), (1, 1), (4, 2), (2, 1), (1, 1)];
const FLAGS: usize = 1;
const SIGNAL: usize = 5;
/// A word of present fields is followed by another one.
const MORE: u32 = 1 << 31;
const BAD_FCS: u8 = 0x40;

/// Header and frame; `None` if the header is not valid.
pub(super) fn parse(octets: &[u8]) -> Option<(RadiotapHeader, &[u8])> {
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
    for (field, (size, alignment)) in FIELDS.into_iter().enumerate() {
        if present & 1 << field == 0 {
            continue;
        }
        at = at.next_multiple_of(alignment);
        let value = *header.get(at..at + size)?.first()?;
        match field {
            FLAGS => found.has_bad_fcs = value & BAD_FCS != 0,
            SIGNAL => found.signal_dbm = Some(value.cast_signed()),
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
