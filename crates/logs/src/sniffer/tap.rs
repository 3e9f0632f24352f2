//! Headers of IEEE 802.15.4 TAP (link type 283; "IEEE 802.15.4 TAP Link Type Specification", sections 3 and 4).

/// What a header tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TapHeader {
    pub(super) fcs: Fcs,
    /// Received signal strength.
    pub(super) rssi_dbm: Option<f64>,
}

/// The check sequence at the end of the frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fcs {
    None,
    Crc16,
    Crc32,
}

/// Types of fields.
const FCS_TYPE: u16 = 0;
const RSS: u16 = 1;

/// Header and frame; `None` if the header is not valid.
pub(super) fn parse(octets: &[u8]) -> Option<(TapHeader, &[u8])> {
    let [0, _, low, high, ..] = *octets else { return None };
    let length = usize::from(u16::from_le_bytes([low, high]));
    let (header, frame) = octets.split_at_checked(length)?;
    let mut fields = header.get(4..)?;
    let mut found = TapHeader { fcs: Fcs::None, rssi_dbm: None };
    while let [kind_low, kind_high, length_low, length_high, rest @ ..] = fields {
        let length = usize::from(u16::from_le_bytes([*length_low, *length_high]));
        let value = rest.get(..length)?;
        match u16::from_le_bytes([*kind_low, *kind_high]) {
            FCS_TYPE => {
                found.fcs = match value {
                    [0] => Fcs::None,
                    [1] => Fcs::Crc16,
                    [2] => Fcs::Crc32,
                    _ => return None,
                }
            }
            RSS => found.rssi_dbm = Some(f64::from(f32::from_le_bytes(value.try_into().ok()?))),
            _ => {}
        }
        // Fields are filled up to a multiple of four octets.
        fields = rest.get(length.next_multiple_of(4)..).unwrap_or_default();
    }
    found.rssi_dbm = found.rssi_dbm.filter(|level| level.is_finite());
    Some((found, frame))
}
