//! DMG Beacon frames (IEEE 802.11ad-2012, 8.3.4.1) that carry a payload in vendor specific elements (IEEE 802.11-2012,
//! 8.4.2.28).
//!
//! An element has room for 251 octets after its organizationally unique identifier (OUI) and its type. All elements of a
//! beacon together hold a sequence number of one octet and the payload; only the last one may have room left.

use super::super::address::MacAddress;
use super::super::sector::TxSector;
use super::elements::{Element, Elements};
use super::{SweepBody, SweepFrame, SweepParseError, bits, nine_bits, ssw_field, tx_sector};

/// Frame control of a beacon: protocol version 0, type extension, subtype DMG Beacon; no flags.
pub(super) const FRAME_CONTROL: u8 = 0x0C;

/// Largest frame that the control PHY carries (octets; IEEE 802.11ad-2012, table 21-11).
pub(crate) const MAX_CONTROL_OCTETS: u16 = 1023;
/// Largest payload of a beacon (octets).
pub const MAX_BEACON_PAYLOAD_OCTETS: u16 = 964;
/// The OUI of the elements with the payload. It belongs to no organisation: the bit 0x02 of its first octet says that
/// it is given locally (IEEE 802, 8.2.2).
pub(crate) const PAYLOAD_OUI: [u8; 3] = [0x02, 0x53, 0x58];
/// The type of these elements among those of the OUI.
pub(crate) const PAYLOAD_TYPE: u8 = 1;

/// Frame control, Duration, BSSID.
const HEADER_OCTETS: usize = 10;
/// Timestamp, Sector Sweep, Beacon Interval, Beacon Interval Control, DMG Parameters.
const FIXED_OCTETS: usize = 20;
/// Header, fixed fields and FCS.
const OCTETS_WITHOUT_ELEMENTS: u16 = 34;
/// ID, length, OUI, type.
const ELEMENT_HEADER_OCTETS: u16 = 6;
/// Room in an element: 255 octets without OUI and type.
const ELEMENT_ROOM: u16 = 251;
const VENDOR_SPECIFIC: u8 = 221;

/// Beacon Interval Control: no access period for answers (A-BFT) follows in this beacon interval or the next 14, and the
/// sweep is complete in one interval.
const INTERVAL_CONTROL: u64 = 15 << 15 | 1 << 20;
/// Clustering Control present, in Beacon Interval Control.
const HAS_CLUSTERING: u8 = 1;
/// DMG Parameters: the station belongs to an independent BSS, and access is by contention alone.
const DMG_PARAMETERS: u8 = 1 | 1 << 2;

const _: () = assert!(beacon_octets(MAX_BEACON_PAYLOAD_OCTETS) == MAX_CONTROL_OCTETS);

/// Size of a beacon with a payload of so many octets, FCS included (octets).
#[must_use]
pub const fn beacon_octets(payload_octets: u16) -> u16 {
    let content = payload_octets.saturating_add(1);
    let elements = content.div_ceil(ELEMENT_ROOM);
    OCTETS_WITHOUT_ELEMENTS.saturating_add(content).saturating_add(ELEMENT_HEADER_OCTETS * elements)
}

/// The size of the payload with which a beacon has `octets` octets, FCS included; `None` if there is none.
#[must_use]
pub const fn beacon_payload_octets(octets: u16) -> Option<u16> {
    if octets > MAX_CONTROL_OCTETS {
        return None;
    }
    let Some(with_headers) = octets.checked_sub(OCTETS_WITHOUT_ELEMENTS) else { return None };
    let elements = with_headers.div_ceil(ELEMENT_ROOM + ELEMENT_HEADER_OCTETS);
    let Some(content) = with_headers.checked_sub(ELEMENT_HEADER_OCTETS * elements) else { return None };
    match content.checked_sub(1) {
        Some(payload) if beacon_octets(payload) == octets => Some(payload),
        _ => None,
    }
}

/// The payload of a frame of a sector level sweep, FCS included: that of a beacon, and none of other frames.
///
/// # Errors
/// If the octets are not a valid frame of the sector level sweep.
pub fn beacon_payload(octets: &[u8]) -> Result<Vec<u8>, SweepParseError> {
    let SweepBody::Beacon { .. } = SweepFrame::parse(octets)?.body else { return Ok(Vec::new()) };
    let end = octets.len() - super::FCS_OCTETS;
    let mut content = Vec::new();
    for element in elements(&octets[..end]) {
        content.extend_from_slice(payload_part(element?).unwrap_or(&[]));
    }
    // Behind the sequence number.
    Ok(content.split_off(1))
}

/// What the fixed fields of a beacon say.
pub(super) struct Fixed {
    pub(super) timestamp_us: u64,
    pub(super) cdown: u16,
    pub(super) sector: TxSector,
}

/// Writes everything but the FCS.
pub(super) fn write(frame: &SweepFrame, fixed: &Fixed, sequence: u8, payload: &[u8], octets: &mut Vec<u8>) {
    octets.extend([FRAME_CONTROL, 0]);
    octets.extend(frame.duration_us.to_le_bytes());
    octets.extend(frame.from.0);
    octets.extend(fixed.timestamp_us.to_le_bytes());
    octets.extend(&ssw_field(0, fixed.cdown, fixed.sector).to_le_bytes()[..3]);
    // Broadcasts are not periodic: no beacon interval.
    octets.extend([0, 0]);
    octets.extend(&INTERVAL_CONTROL.to_le_bytes()[..6]);
    octets.push(DMG_PARAMETERS);
    let room = usize::from(ELEMENT_ROOM);
    let (first, others) = payload.split_at(payload.len().min(room - 1));
    write_element(&[sequence], first, octets);
    for part in others.chunks(room) {
        write_element(&[], part, octets);
    }
}

fn write_element(sequence: &[u8], part: &[u8], octets: &mut Vec<u8>) {
    let length = PAYLOAD_OUI.len() + 1 + sequence.len() + part.len();
    octets.extend([VENDOR_SPECIFIC, u8::try_from(length).expect("at most 255 octets")]);
    octets.extend(PAYLOAD_OUI);
    octets.push(PAYLOAD_TYPE);
    octets.extend_from_slice(sequence);
    octets.extend_from_slice(part);
}

/// Reads everything but the FCS, which is good.
pub(super) fn parse(covered: &[u8]) -> Result<SweepFrame, SweepParseError> {
    let size = || SweepParseError::BeaconSize(covered.len() + super::FCS_OCTETS);
    if covered.len() + super::FCS_OCTETS > usize::from(MAX_CONTROL_OCTETS) {
        return Err(size());
    }
    let (&[_, flags, d0, d1, b0, b1, b2, b3, b4, b5], fixed) =
        covered.split_first_chunk::<HEADER_OCTETS>().ok_or_else(size)?;
    let (&timestamp, fixed) = fixed.split_first_chunk::<8>().ok_or_else(size)?;
    let (&[s0, s1, s2, _, _, control, ..], _) = fixed.split_first_chunk::<{ FIXED_OCTETS - 8 }>().ok_or_else(size)?;
    if flags != 0 {
        return Err(SweepParseError::Flags(flags));
    }
    if control & HAS_CLUSTERING != 0 {
        return Err(SweepParseError::Clustering);
    }
    let (mut sequence, mut content) = (None, 0);
    for element in elements(covered) {
        if let Some(part) = payload_part(element?) {
            sequence = sequence.or(part.first().copied());
            content += part.len();
        }
    }
    let (Some(sequence), Ok(content)) = (sequence, u16::try_from(content)) else {
        return Err(SweepParseError::NoPayload);
    };
    let ssw = bits([s0, s1, s2]);
    Ok(SweepFrame {
        duration_us: u16::from_le_bytes([d0, d1]),
        to: MacAddress::BROADCAST,
        from: MacAddress([b0, b1, b2, b3, b4, b5]),
        body: SweepBody::Beacon {
            timestamp_us: u64::from_le_bytes(timestamp),
            cdown: nine_bits(ssw >> 1),
            sector: tx_sector(ssw),
            sequence,
            payload_octets: content - 1,
        },
    })
}

/// The elements of a beacon without its FCS.
fn elements(beacon: &[u8]) -> Elements<'_> {
    Elements::new("DMG Beacon", beacon, HEADER_OCTETS + FIXED_OCTETS)
}

/// The part of the payload that an element carries, if it is of this kind.
fn payload_part((id, content): Element<'_>) -> Option<&[u8]> {
    match content.split_first_chunk::<4>() {
        Some((&[a, b, c, PAYLOAD_TYPE], part)) if id == VENDOR_SPECIFIC && [a, b, c] == PAYLOAD_OUI => Some(part),
        _ => None,
    }
}
