//! Information elements (IEEE 802.15.4-2015, 7.4).

use super::SlotFrameError;

/// The element of a header that says that payload elements follow.
pub(super) const PAYLOAD_FOLLOWS: u16 = 0x7E;

/// The element of a header with a correction of the clock.
pub(super) const TIME_CORRECTION: u16 = 0x1E;

/// The group of payload elements with those of the MAC.
pub(super) const MLME: u16 = 1;

/// That of the IETF (RFC 8137).
pub(super) const IETF: u16 = 5;

/// Within the group of the MAC: the number of the slot and the join metric, ...
pub(super) const SYNCHRONISATION: u16 = 0x1A;

/// ... slotframes and their cells, ...
pub(super) const SLOTFRAMES: u16 = 0x1B;

/// ... the template of the slot, ...
pub(super) const TIMESLOT: u16 = 0x1C;

/// ... and the sequence of channels, which is a long element.
pub(super) const HOPPING: u16 = 9;

/// Writes an element of the header.
pub(crate) fn write_header(id: u16, content: &[u8], mpdu: &mut Vec<u8>) {
    write(length(content) | id << 7, content, mpdu);
}

/// Writes a payload element.
pub(super) fn write_payload(group: u16, content: &[u8], mpdu: &mut Vec<u8>) {
    write(length(content) | group << 11 | 1 << 15, content, mpdu);
}

/// Writes a short element of the group of the MAC.
pub(super) fn write_short(id: u16, content: &[u8], group: &mut Vec<u8>) {
    write(length(content) | id << 8, content, group);
}

/// Writes a long one.
pub(super) fn write_long(id: u16, content: &[u8], group: &mut Vec<u8>) {
    write(length(content) | id << 11 | 1 << 15, content, group);
}

fn write(descriptor: u16, content: &[u8], octets: &mut Vec<u8>) {
    octets.extend(descriptor.to_le_bytes());
    octets.extend(content);
}

fn length(content: &[u8]) -> u16 {
    u16::try_from(content.len()).expect("elements fit into a frame")
}

/// The next element of a header: its number, its content, and the octets after it.
pub(crate) fn header_element(octets: &[u8]) -> Result<(u16, &[u8], &[u8]), SlotFrameError> {
    let (descriptor, rest) = descriptor(octets)?;
    let (content, rest) = content(rest, descriptor & 0x7F)?;
    Ok((descriptor >> 7 & 0xFF, content, rest))
}

/// The next payload element: its group, its content, and the octets after it.
pub(super) fn payload_element(octets: &[u8]) -> Result<(u16, &[u8], &[u8]), SlotFrameError> {
    let (descriptor, rest) = descriptor(octets)?;
    let (content, rest) = content(rest, descriptor & 0x7FF)?;
    Ok((descriptor >> 11 & 0xF, content, rest))
}

/// The next element of the group of the MAC: its number, its content, and the octets after it. Numbers of long ones and of short
/// ones do not overlap as far as they are used here.
pub(super) fn nested_element(octets: &[u8]) -> Result<(u16, &[u8], &[u8]), SlotFrameError> {
    let (descriptor, rest) = descriptor(octets)?;
    let (id, octets) = match descriptor >> 15 {
        0 => (descriptor >> 8 & 0x7F, descriptor & 0xFF),
        _ => (descriptor >> 11 & 0xF, descriptor & 0x7FF),
    };
    let (content, rest) = content(rest, octets)?;
    Ok((id, content, rest))
}

fn descriptor(octets: &[u8]) -> Result<(u16, &[u8]), SlotFrameError> {
    let (head, rest) = octets.split_first_chunk().ok_or(SlotFrameError::TruncatedElement)?;
    Ok((u16::from_le_bytes(*head), rest))
}

fn content(octets: &[u8], length: u16) -> Result<(&[u8], &[u8]), SlotFrameError> {
    octets.split_at_checked(length.into()).ok_or(SlotFrameError::TruncatedElement)
}
