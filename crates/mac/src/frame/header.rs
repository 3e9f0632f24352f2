//! The start of a frame of any revision of the standard, up to its addresses.

use super::ParseError;
use super::address::{Address, Width};
use super::cursor::Cursor;

/// The start of a frame of any revision from 2003 to 2020, secured or not: addresses are never encrypted. A sniffer hears
/// such frames; [`super::Frame`] is one that the stations of a simulation send.
///
/// ```
/// use sextant_mac::frame::{Address, Header};
///
/// // Data of 2015: both addresses are short, in the PAN 0xABCD; the sequence number is left out.
/// let octets = [0x41, 0xA9, 0xCD, 0xAB, 0x00, 0x00, 0x01, 0x00, 0xFF];
/// let header = Header::parse(&octets)?;
/// let source = header.source.expect("it has a source");
/// assert_eq!((source.pan, source.address, header.sequence), (Some(0xABCD), Address::Short(1), None));
/// # Ok::<(), sextant_mac::frame::ParseError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// Sequence number, if given.
    pub sequence: Option<u8>,
    /// Destination, if given.
    pub destination: Option<HeaderAddress>,
    /// Source, if given.
    pub source: Option<HeaderAddress>,
}

/// An address and its PAN, as far as the frame tells it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HeaderAddress {
    /// PAN identifier, if given.
    pub pan: Option<u16>,
    /// Address.
    pub address: Address,
}

/// What the frame control field says of the addresses.
struct Layout {
    has_sequence: bool,
    destination: Option<Width>,
    source: Option<Width>,
    has_destination_pan: bool,
    has_source_pan: bool,
}

impl Header {
    /// Reads the start of an MPDU; it may be cut off anywhere after its addresses.
    ///
    /// # Errors
    /// If the octets end too early, or have a reserved frame type, version or addressing mode.
    pub fn parse(mpdu: &[u8]) -> Result<Self, ParseError> {
        Self::split(mpdu).map(|(header, _)| header)
    }

    /// The same, and the octets after the addresses.
    pub(crate) fn split(mpdu: &[u8]) -> Result<(Self, &[u8]), ParseError> {
        let mut cursor = Cursor::new(mpdu);
        let [low] = cursor.take("frame control")?;
        let layout = match low & 7 {
            kind @ 0..=3 => {
                let [high] = cursor.take("frame control")?;
                general(kind, u16::from_le_bytes([low, high]))?
            }
            5 => multipurpose(low, &mut cursor)?,
            // A fragment has no addresses.
            6 => return Ok((Self { sequence: None, destination: None, source: None }, cursor.rest())),
            kind => return Err(ParseError::ReservedType(kind)),
        };
        let sequence = if layout.has_sequence { Some(cursor.u8("sequence number")?) } else { None };
        let destination_pan = if layout.has_destination_pan { Some(cursor.u16("destination PAN")?) } else { None };
        let mut address = |width: Option<Width>| width.map(|width| Address::parse(width, &mut cursor)).transpose();
        let destination = address(layout.destination)?;
        let source_pan = if layout.has_source_pan { Some(cursor.u16("source PAN")?) } else { None };
        let source = layout.source.map(|width| Address::parse(width, &mut cursor)).transpose()?;
        let header = Self {
            sequence,
            destination: destination.map(|address| HeaderAddress { pan: destination_pan, address }),
            // A source PAN that is left out is the destination PAN.
            source: source.map(|address| HeaderAddress { pan: source_pan.or(destination_pan), address }),
        };
        Ok((header, cursor.rest()))
    }
}

fn width(mode: u16, whose: &'static str) -> Result<Option<Width>, ParseError> {
    match mode & 3 {
        0 => Ok(None),
        1 => Err(ParseError::ReservedAddressingMode(whose)),
        2 => Ok(Some(Width::Short)),
        _ => Ok(Some(Width::Extended)),
    }
}

/// Frame control of beacons, data, acknowledgements and commands (IEEE 802.15.4-2020, 7.2.2).
fn general(kind: u8, bits: u16) -> Result<Layout, ParseError> {
    let is_compressed = bits & 1 << 6 != 0;
    let destination = width(bits >> 10, "destination")?;
    let source = width(bits >> 14, "source")?;
    let version = bits >> 12 & 3;
    let (has_destination_pan, has_source_pan) = match version {
        0 | 1 => (destination.is_some(), source.is_some() && !(is_compressed && destination.is_some())),
        2 => pans(destination, source, is_compressed),
        _ => return Err(ParseError::UnsupportedVersion(3)),
    };
    // Bit 8 is reserved in the earlier revisions.
    let has_sequence = version != 2 || bits & 1 << 8 == 0;
    // An acknowledgement of the earlier revisions has no addresses, whatever its modes say.
    let is_bare = kind == 2 && version != 2;
    Ok(Layout {
        has_sequence,
        destination: destination.filter(|_| !is_bare),
        source: source.filter(|_| !is_bare),
        has_destination_pan: has_destination_pan && !is_bare,
        has_source_pan: has_source_pan && !is_bare,
    })
}

/// Whether the destination PAN and the source PAN are given (IEEE 802.15.4-2020, table 7-2).
fn pans(destination: Option<Width>, source: Option<Width>, is_compressed: bool) -> (bool, bool) {
    match (destination, source) {
        (None, None) => (is_compressed, false),
        (Some(_), None) => (!is_compressed, false),
        (None, Some(_)) => (false, !is_compressed),
        (Some(Width::Extended), Some(Width::Extended)) => (!is_compressed, false),
        (Some(_), Some(_)) => (true, !is_compressed),
    }
}

/// Frame control of multipurpose frames (IEEE 802.15.4-2020, 7.3.5). `low` is its first octet.
fn multipurpose(low: u8, cursor: &mut Cursor<'_>) -> Result<Layout, ParseError> {
    let is_long = low & 1 << 3 != 0;
    let high = if is_long { cursor.u8("frame control")? } else { 0 };
    if high >> 4 & 3 != 0 {
        return Err(ParseError::UnsupportedVersion(high >> 4 & 3));
    }
    Ok(Layout {
        has_sequence: high & 1 << 2 == 0,
        destination: width(u16::from(low >> 4), "destination")?,
        source: width(u16::from(low >> 6), "source")?,
        has_destination_pan: high & 1 != 0,
        has_source_pan: false,
    })
}

#[cfg(test)]
mod tests {
    use super::super::{Endpoint, Frame};
    use super::*;

    const SHORT: [u8; 2] = [0x01, 0x00];
    const EXTENDED: [u8; 8] = [8, 7, 6, 5, 4, 3, 2, 1];
    const DESTINATION_PAN: [u8; 2] = [0xCD, 0xAB];
    const SOURCE_PAN: [u8; 2] = [0x34, 0x12];

    fn octets_of(mode: u16) -> (&'static [u8], Option<Address>) {
        match mode {
            0 => (&[], None),
            2 => (&SHORT, Some(Address::Short(1))),
            _ => (&EXTENDED, Some(Address::Extended(0x0102_0304_0506_0708))),
        }
    }

    #[test]
    fn the_addresses_of_each_row_of_the_table_of_pan_id_compression_are_found() {
        // IEEE 802.15.4-2020, table 7-2: modes of destination and source, compression, PAN of destination and source.
        let table = [
            (0, 0, 0, false, false),
            (0, 0, 1, true, false),
            (2, 0, 0, true, false),
            (3, 0, 0, true, false),
            (2, 0, 1, false, false),
            (3, 0, 1, false, false),
            (0, 2, 0, false, true),
            (0, 3, 0, false, true),
            (0, 2, 1, false, false),
            (0, 3, 1, false, false),
            (3, 3, 0, true, false),
            (3, 3, 1, false, false),
            (2, 2, 0, true, true),
            (2, 3, 0, true, true),
            (3, 2, 0, true, true),
            (2, 3, 1, true, false),
            (3, 2, 1, true, false),
            (2, 2, 1, true, false),
        ];
        for (to, from, compression, has_to_pan, has_from_pan) in table {
            for suppression in [0, 1] {
                let control: u16 = 1 | compression << 6 | suppression << 8 | to << 10 | 2 << 12 | from << 14;
                let ((to_octets, to_address), (from_octets, from_address)) = (octets_of(to), octets_of(from));
                let part = |is_given: bool, octets: &'static [u8]| if is_given { octets } else { &[] };
                let octets = [
                    &control.to_le_bytes(),
                    part(suppression == 0, &[0x77]),
                    part(has_to_pan, &DESTINATION_PAN),
                    to_octets,
                    part(has_from_pan, &SOURCE_PAN),
                    from_octets,
                ]
                .concat();
                let to_pan = has_to_pan.then_some(0xABCD);
                let from_pan = if has_from_pan { Some(0x1234) } else { to_pan };
                let expected = Header {
                    sequence: (suppression == 0).then_some(0x77),
                    destination: to_address.map(|address| HeaderAddress { pan: to_pan, address }),
                    source: from_address.map(|address| HeaderAddress { pan: from_pan, address }),
                };
                assert_eq!(Header::parse(&octets), Ok(expected), "{to} {from} {compression} {suppression}");
                for cut in 0..octets.len() {
                    let error = Header::parse(&octets[..cut]);
                    assert!(matches!(error, Err(ParseError::Truncated { .. })), "{error:?}");
                }
            }
        }
    }

    #[test]
    fn only_acknowledgements_of_the_latest_revision_have_addresses() {
        for (version, has_address) in [(0_u16, false), (1, false), (2, true)] {
            let control: u16 = 2 | 2 << 10 | version << 12;
            let octets = [&control.to_le_bytes()[..], &[0x77], &DESTINATION_PAN, &SHORT].concat();
            let header = Header::parse(&octets).expect("a good acknowledgement");
            assert_eq!(header.sequence, Some(0x77));
            assert_eq!(header.destination.is_some(), has_address, "revision {version}");
        }
    }

    #[test]
    fn the_header_of_a_frame_that_we_write_is_that_of_the_frame() {
        let places = [
            Endpoint { pan: 1, address: Address::Short(7) },
            Endpoint { pan: 1, address: Address::Extended(7 << 40) },
            Endpoint { pan: 2, address: Address::Short(7) },
        ];
        let header = |endpoint: Endpoint| HeaderAddress { pan: Some(endpoint.pan), address: endpoint.address };
        for source in places {
            for destination in places {
                let mut mpdu = Vec::new();
                Frame::data(9, source, destination, &[1, 2, 3]).write(&mut mpdu).expect("it is short");
                let expected = Header {
                    sequence: Some(9),
                    destination: Some(header(destination)),
                    source: Some(header(source)),
                };
                assert_eq!(Header::parse(&mpdu), Ok(expected));
            }
        }
        let mut mpdu = Vec::new();
        Frame::acknowledgement(5).write(&mut mpdu).expect("it is short");
        assert_eq!(Header::parse(&mpdu), Ok(Header { sequence: Some(5), destination: None, source: None }));
    }

    #[test]
    fn security_does_not_hide_the_addresses() {
        // Version 2006 with security: both addresses short, one PAN, then the security header and encrypted octets.
        let octets = [0x49, 0x98, 0x21, 0xCD, 0xAB, 0x00, 0x00, 0x02, 0x00, 0x0D, 1, 0, 0, 0, 0xEE, 0xEE];
        let source = Header::parse(&octets).expect("it is valid").source;
        assert_eq!(source, Some(HeaderAddress { pan: Some(0xABCD), address: Address::Short(2) }));
    }

    #[test]
    fn multipurpose_frames_are_read() {
        // Short frame control: destination and source are short, no PAN.
        let short = Header::parse(&[0xA5, 0x11, 0x05, 0x00, 0x06, 0x00]).expect("it is valid");
        assert_eq!(short.sequence, Some(0x11));
        assert_eq!(short.source, Some(HeaderAddress { pan: None, address: Address::Short(6) }));
        // Long frame control: PAN given, sequence number left out.
        let long = Header::parse(&[0xAD, 0x05, 0xCD, 0xAB, 0x05, 0x00, 0x06, 0x00]).expect("it is valid");
        assert_eq!(long.sequence, None);
        assert_eq!(long.source, Some(HeaderAddress { pan: Some(0xABCD), address: Address::Short(6) }));
    }

    #[test]
    fn reserved_values_are_errors() {
        assert_eq!(Header::parse(&[0x04, 0x00, 0x01]), Err(ParseError::ReservedType(4)));
        assert_eq!(Header::parse(&[0x07, 0x00, 0x01]), Err(ParseError::ReservedType(7)));
        assert_eq!(Header::parse(&[0x01, 0xB0, 0x01]), Err(ParseError::UnsupportedVersion(3)));
        assert_eq!(Header::parse(&[0x01, 0x44, 0x01]), Err(ParseError::ReservedAddressingMode("destination")));
    }
}
