//! Who sent a captured frame, and how strongly it was received.

use std::fmt;

use sextant_mac::fcs;
use sextant_mac::frame::{Address, Header};
use sextant_recording::capture::tap::TapFcs;
use sextant_recording::capture::{link_type, radiotap, tap};

use super::ieee80211::{MacAddress, transmitter};
use super::skipped::Skipped;
use crate::options::sniffer_options::FcsField;

/// The sender of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sender {
    /// Its PAN, if the frame tells it.
    pub(super) pan: Option<u16>,
    pub(super) address: SenderAddress,
}

/// The address of a sender.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SenderAddress {
    /// IEEE 802.15.4; unique within its PAN only.
    Short(u16),
    /// IEEE 802.15.4.
    Extended(u64),
    /// IEEE 802.11.
    Mac(MacAddress),
}

/// Whether short addresses are named with their PAN, because the capture has several.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PanNames {
    One,
    Several,
}

impl Sender {
    /// Writes its name, as protocol analysers do.
    pub(super) fn write(self, pans: PanNames, name: &mut impl fmt::Write) -> fmt::Result {
        match (self.address, self.pan) {
            (SenderAddress::Short(address), Some(pan)) if pans == PanNames::Several => {
                write!(name, "{pan:#06x}/{address:#06x}")
            }
            (SenderAddress::Short(address), _) => write!(name, "{address:#06x}"),
            (SenderAddress::Extended(address), _) => octets(&address.to_be_bytes(), name),
            (SenderAddress::Mac(MacAddress(address)), _) => octets(&address, name),
        }
    }
}

fn octets(octets: &[u8], name: &mut impl fmt::Write) -> fmt::Result {
    octets.iter().enumerate().try_for_each(|(index, octet)| {
        let colon = if index == 0 { "" } else { ":" };
        write!(name, "{colon}{octet:02x}")
    })
}

/// A frame whose sender is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HeardFrame {
    pub(super) sender: Sender,
    pub(super) rssi_dbm: Option<f64>,
}

/// The sender of a frame with a header of type `link`; `None` if the type is not known. At the end of frames of link type 195
/// is `fcs`; if the frame is cut, it is missing.
pub(super) fn heard(link: u16, octets: &[u8], is_cut: bool, fcs: FcsField) -> Option<Result<HeardFrame, Skipped>> {
    let without_level = |sender| HeardFrame { sender, rssi_dbm: None };
    Some(match link {
        link_type::WITH_FCS if is_cut => ieee802154(octets).map(without_level),
        link_type::WITH_FCS => match fcs {
            FcsField::Checked => checked_16(octets).and_then(ieee802154).map(without_level),
            FcsField::None => ieee802154(octets).map(without_level),
            FcsField::Ti { offset_db } => with_rssi(octets, offset_db),
        },
        link_type::WITHOUT_FCS => ieee802154(octets).map(without_level),
        link_type::TAP => from_tap(octets, is_cut),
        link_type::RADIOTAP => from_radiotap(octets),
        _ => return None,
    })
}

/// A frame in whose last two octets a chip of Texas Instruments wrote its RSSI, and whether the check sequence was right:
/// table 23 of the data sheet of the CC2420 (SWRS041), figure 23-15 of the manual of the CC2530 (SWRU191).
fn with_rssi(frame: &[u8], offset_db: f64) -> Result<HeardFrame, Skipped> {
    const CRC_OK: u8 = 0x80;
    let (frame, &[rssi, correlation]) = frame.split_last_chunk().ok_or(Skipped::TooShort)?;
    if correlation & CRC_OK == 0 {
        return Err(Skipped::BadFcs);
    }
    Ok(HeardFrame { sender: ieee802154(frame)?, rssi_dbm: Some(f64::from(rssi.cast_signed()) + offset_db) })
}

fn from_tap(octets: &[u8], is_cut: bool) -> Result<HeardFrame, Skipped> {
    let (header, frame) = tap::parse(octets).ok_or(Skipped::Invalid)?;
    let frame = match header.fcs {
        _ if is_cut => frame,
        TapFcs::None => frame,
        TapFcs::Crc16 => checked_16(frame)?,
        TapFcs::Crc32 => checked_32(frame)?,
    };
    Ok(HeardFrame { sender: ieee802154(frame)?, rssi_dbm: header.rssi_dbm })
}

fn from_radiotap(octets: &[u8]) -> Result<HeardFrame, Skipped> {
    let (header, frame) = radiotap::parse(octets).ok_or(Skipped::Invalid)?;
    if header.has_bad_fcs {
        return Err(Skipped::BadFcs);
    }
    let sender = Sender { pan: None, address: SenderAddress::Mac(transmitter(frame)?) };
    Ok(HeardFrame { sender, rssi_dbm: header.signal_dbm.map(f64::from) })
}

/// The frame before its 16-bit check sequence, if that is right.
fn checked_16(frame: &[u8]) -> Result<&[u8], Skipped> {
    let (covered, &check) = frame.split_last_chunk().ok_or(Skipped::TooShort)?;
    if fcs(covered) == u16::from_le_bytes(check) { Ok(covered) } else { Err(Skipped::BadFcs) }
}

/// The frame before its 32-bit check sequence, if that is right (IEEE 802.15.4-2020, 7.2.11). A frame that is shorter than
/// its check sequence is filled up with zeros before it is computed.
fn checked_32(frame: &[u8]) -> Result<&[u8], Skipped> {
    let (covered, &check) = frame.split_last_chunk().ok_or(Skipped::TooShort)?;
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(covered);
    hasher.update(&[0; 4][covered.len().min(4)..]);
    if hasher.finalize() == u32::from_le_bytes(check) { Ok(covered) } else { Err(Skipped::BadFcs) }
}

fn ieee802154(frame: &[u8]) -> Result<Sender, Skipped> {
    use sextant_mac::frame::ParseError;
    let header = Header::parse(frame).map_err(|error| match error {
        ParseError::Truncated { .. } => Skipped::TooShort,
        _ => Skipped::Invalid,
    })?;
    let source = header.source.ok_or(Skipped::NoSource)?;
    let address = match source.address {
        Address::Short(address) => SenderAddress::Short(address),
        Address::Extended(address) => SenderAddress::Extended(address),
    };
    Ok(Sender { pan: source.pan, address })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Data from 0x0001 in PAN 0xabcd.
    const DATA: [u8; 10] = [0x41, 0x88, 0x07, 0xCD, 0xAB, 0x00, 0x00, 0x01, 0x00, 0x55];

    const SENDER: Sender = Sender { pan: Some(0xABCD), address: SenderAddress::Short(1) };

    fn name(address: SenderAddress, pans: PanNames) -> String {
        let mut name = String::new();
        Sender { address, ..SENDER }.write(pans, &mut name).unwrap();
        name
    }

    #[test]
    fn senders_are_named_as_protocol_analysers_do() {
        assert_eq!(name(SenderAddress::Short(1), PanNames::One), "0x0001");
        assert_eq!(name(SenderAddress::Short(1), PanNames::Several), "0xabcd/0x0001");
        assert_eq!(name(SenderAddress::Extended(0x0012_4B00_0102_030A), PanNames::One), "00:12:4b:00:01:02:03:0a");
        assert_eq!(
            name(SenderAddress::Mac(MacAddress([0xAA, 0, 1, 2, 3, 0xFF])), PanNames::One),
            "aa:00:01:02:03:ff"
        );
    }

    #[test]
    fn a_check_sequence_is_checked_where_there_is_one() {
        let expected = Some(Ok(HeardFrame { sender: SENDER, rssi_dbm: None }));
        let good = [&DATA[..], &fcs(&DATA).to_le_bytes()].concat();
        let mut bad = good.clone();
        bad[9] ^= 1;
        assert_eq!(heard(link_type::WITH_FCS, &good, false, FcsField::Checked), expected);
        assert_eq!(heard(link_type::WITH_FCS, &bad, false, FcsField::Checked), Some(Err(Skipped::BadFcs)));
        assert_eq!(heard(link_type::WITHOUT_FCS, &DATA, false, FcsField::Checked), expected);
        // A cut frame has lost it.
        assert_eq!(heard(link_type::WITH_FCS, &good[..9], true, FcsField::Checked), expected);
        assert_eq!(heard(1, &good, false, FcsField::Checked), None);
    }

    #[test]
    fn a_chip_of_texas_instruments_writes_its_rssi_in_the_place_of_the_check_sequence() {
        let ti = FcsField::Ti { offset_db: -73.0 };
        // An RSSI of -12 (two's complement), a right check sequence and a correlation of 107.
        let good = [&DATA[..], &[0xF4, 0x80 | 107]].concat();
        let bad = [&DATA[..], &[0xF4, 107]].concat();
        assert_eq!(
            heard(link_type::WITH_FCS, &good, false, ti),
            Some(Ok(HeardFrame { sender: SENDER, rssi_dbm: Some(-85.0) }))
        );
        assert_eq!(heard(link_type::WITH_FCS, &bad, false, ti), Some(Err(Skipped::BadFcs)));
        assert_eq!(heard(link_type::WITH_FCS, &[0x80], false, ti), Some(Err(Skipped::TooShort)));
        // Frames of other link types have no such octets.
        let without = Some(Ok(HeardFrame { sender: SENDER, rssi_dbm: None }));
        assert_eq!(heard(link_type::WITHOUT_FCS, &DATA, false, ti), without);
        assert_eq!(heard(link_type::WITH_FCS, &DATA, false, FcsField::None), without);
        assert_eq!(heard(link_type::WITH_FCS, &bad, false, FcsField::None), without);
    }

    #[test]
    fn the_header_of_tap_tells_level_and_check_sequence() {
        // FCS type, RSS of -70.5 dBm.
        let tap = |fcs_type: u8| {
            [&[0, 0, 20, 0, 0, 0, 1, 0, fcs_type, 0, 0, 0, 1, 0, 4, 0][..], &(-70.5_f32).to_le_bytes()].concat()
        };
        let expected = Some(Ok(HeardFrame { sender: SENDER, rssi_dbm: Some(-70.5) }));
        assert_eq!(heard(link_type::TAP, &[&tap(0), &DATA[..]].concat(), false, FcsField::Checked), expected);
        let short = [&tap(1), &DATA[..], &fcs(&DATA).to_le_bytes()].concat();
        assert_eq!(heard(link_type::TAP, &short, false, FcsField::Checked), expected);
        assert_eq!(
            heard(link_type::TAP, &short[..short.len() - 1], false, FcsField::Checked),
            Some(Err(Skipped::BadFcs))
        );
        let long = [&tap(2), &DATA[..], &crc32fast::hash(&DATA).to_le_bytes()].concat();
        assert_eq!(heard(link_type::TAP, &long, false, FcsField::Checked), expected);
        assert_eq!(heard(link_type::TAP, &[0, 0, 9], false, FcsField::Checked), Some(Err(Skipped::Invalid)));
    }

    #[test]
    fn acknowledgements_and_invalid_frames_are_skipped_with_a_reason() {
        let ack = [0x02, 0x00, 0x6A, 0xE4, 0x79];
        assert_eq!(heard(link_type::WITH_FCS, &ack, false, FcsField::Checked), Some(Err(Skipped::NoSource)));
        assert_eq!(heard(link_type::WITHOUT_FCS, &DATA[..7], false, FcsField::Checked), Some(Err(Skipped::TooShort)));
        assert_eq!(
            heard(link_type::WITHOUT_FCS, &[0x04, 0x00, 0x01], false, FcsField::Checked),
            Some(Err(Skipped::Invalid))
        );
    }
}
