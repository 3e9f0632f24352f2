//! TAP: the header with data of the receiver before a frame of IEEE 802.15.4 (link type 283; "IEEE 802.15.4 TAP Link Type
//! Specification", sections 3 and 4).

use super::frame::CapturedFrame;

/// Types of the fields.
mod field {
    pub(super) const FCS_TYPE: u16 = 0;
    pub(super) const RSS: u16 = 1;
    pub(super) const CHANNEL_ASSIGNMENT: u16 = 3;
    pub(super) const START_OF_FRAME: u16 = 5;
    pub(super) const END_OF_FRAME: u16 = 6;
    pub(super) const LINK_QUALITY: u16 = 10;
}

/// What a TAP header tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TapHeader {
    /// The check sequence of the frame.
    pub fcs: TapFcs,
    /// Received signal strength (dBm).
    pub rssi_dbm: Option<f64>,
}

/// The check sequence at the end of the frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum TapFcs {
    /// There is none.
    None = 0,
    /// Of 16 bits.
    Crc16 = 1,
    /// Of 32 bits.
    Crc32 = 2,
}

/// Appends header and frame.
pub(super) fn write(frame: &CapturedFrame<'_>, record: &mut Vec<u8>) {
    let start = record.len();
    let end = frame.start + frame.airtime;
    // Version, reserved octet, length of the TAP header.
    record.extend([0; 4]);
    write_field(field::FCS_TYPE, &[TapFcs::Crc16 as u8], record);
    if let Some(signal) = frame.signal {
        #[expect(clippy::cast_possible_truncation, reason = "the format has single precision")]
        let power_dbm = signal.power.0 as f32;
        write_field(field::RSS, &power_dbm.to_le_bytes(), record);
    }
    write_field(field::CHANNEL_ASSIGNMENT, &[frame.channel, 0, frame.page], record);
    write_field(field::START_OF_FRAME, &frame.start.as_nanos().to_le_bytes(), record);
    write_field(field::END_OF_FRAME, &end.as_nanos().to_le_bytes(), record);
    if let Some(signal) = frame.signal {
        write_field(field::LINK_QUALITY, &[signal.link_quality()], record);
    }
    let octets = u16::try_from(record.len() - start).expect("six fields of at most 12 octets");
    record[start + 2..start + 4].copy_from_slice(&octets.to_le_bytes());
    record.extend(frame.mpdu);
}

/// A field: type, length, value, zeros up to a multiple of four octets.
fn write_field(kind: u16, value: &[u8], record: &mut Vec<u8>) {
    let octets = u16::try_from(value.len()).expect("at most eight octets");
    record.extend(kind.to_le_bytes());
    record.extend(octets.to_le_bytes());
    record.extend(value);
    record.extend(std::iter::repeat_n(0, value.len().next_multiple_of(4) - value.len()));
}

/// Header and frame; `None` if the header is not valid.
#[must_use]
pub fn parse(octets: &[u8]) -> Option<(TapHeader, &[u8])> {
    let [0, _, low, high, ..] = *octets else { return None };
    let length = usize::from(u16::from_le_bytes([low, high]));
    let (header, frame) = octets.split_at_checked(length)?;
    let mut fields = header.get(4..)?;
    let mut found = TapHeader { fcs: TapFcs::None, rssi_dbm: None };
    while let [kind_low, kind_high, length_low, length_high, rest @ ..] = fields {
        let length = usize::from(u16::from_le_bytes([*length_low, *length_high]));
        let value = rest.get(..length)?;
        match u16::from_le_bytes([*kind_low, *kind_high]) {
            field::FCS_TYPE => {
                found.fcs = match value {
                    [0] => TapFcs::None,
                    [1] => TapFcs::Crc16,
                    [2] => TapFcs::Crc32,
                    _ => return None,
                }
            }
            field::RSS => found.rssi_dbm = Some(f64::from(f32::from_le_bytes(value.try_into().ok()?))),
            _ => {}
        }
        // Fields are filled up to a multiple of four octets.
        fields = rest.get(length.next_multiple_of(4)..).unwrap_or_default();
    }
    found.rssi_dbm = found.rssi_dbm.filter(|level| level.is_finite());
    Some((found, frame))
}
