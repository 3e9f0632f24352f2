//! Frames that Wireshark decodes without error, written and read. Their octets were made by another program.

use sextant_kernel::StationId;

use super::*;
use crate::Phy;
use crate::frame::{Address, Endpoint};
use crate::tsch::{Asn, CellOptions};

const PAN: u16 = 0xABCD;
const ROOT: u64 = 0x0017_1200_0000_0001;

fn octets(hex: &str) -> Vec<u8> {
    (0..hex.len() / 2).map(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).expect("hex digits")).collect()
}

#[test]
fn the_beacon_of_the_minimal_schedule_has_its_octets() {
    let cell = AdvertisedCell { timeslot: 0, channel_offset: 0, options: CellOptions::of_bits(0x0F) };
    let beacon = EnhancedBeacon {
        from: Endpoint { pan: PAN, address: Address::Extended(ROOT) },
        sequence: 7,
        asn: Asn(513),
        join_metric: 0,
        slotframes: vec![AdvertisedSlotframe { handle: 0, length: 101, cells: vec![cell] }],
    };
    let expected =
        octets("40ea07cdabffff0100000000121700003f1a88061a010200000000011c0001c8000a1b0100650001000000000ffe08");
    let mut mpdu = Vec::new();
    beacon.write(&mut mpdu);
    assert_eq!((mpdu.as_slice(), beacon.octets()), (expected.as_slice(), 47));
    assert_eq!(EnhancedBeacon::parse(&expected), Ok(beacon));
    assert_eq!(Phy::Oqpsk2450.airtime(47).as_micros(), 1696);
}

#[test]
fn enhanced_acknowledgements_have_their_octets() {
    let plain = EnhancedAck { sequence: 7, to: None, correction_us: 100, is_refusal: false };
    let root = Some(Endpoint { pan: PAN, address: Address::Extended(ROOT) });
    for (acknowledgement, hex) in [
        (plain, "022207020f6400d5fb"),
        (EnhancedAck { correction_us: -100, ..plain }, "022207020f9c0feab1"),
        (EnhancedAck { correction_us: -100, is_refusal: true, ..plain }, "022207020f9c8fe235"),
        (EnhancedAck { correction_us: 0, to: root, ..plain }, "022e07cdab0100000000121700020f0000a42a"),
    ] {
        let mut mpdu = Vec::new();
        acknowledgement.write(&mut mpdu);
        assert_eq!(mpdu, octets(hex));
        assert_eq!(usize::from(acknowledgement.octets()), mpdu.len());
        assert_eq!(EnhancedAck::parse(&mpdu), Ok(acknowledgement));
    }
    assert_eq!([-5000, -2048, 0, 2047, 5000].map(EnhancedAck::fitting), [-2048, -2048, 0, 2047, 2047]);
}

#[test]
fn data_and_empty_frames_have_their_octets() {
    let hello = SlotData { pan: PAN, from: StationId(1), to: Some(StationId(2)), sequence: 7, payload: b"hello" };
    let empty = SlotData { pan: PAN, from: StationId(2), to: Some(StationId(1)), sequence: 8, payload: &[] };
    for (frame, hex) in [(hello, "61a807cdab0200010068656c6c6f5e40"), (empty, "61a808cdab010002006a62")] {
        let mut mpdu = Vec::new();
        frame.write(&mut mpdu);
        assert_eq!(mpdu, octets(hex));
        assert_eq!(SlotData::parse(&mpdu), Ok(frame));
    }
}

#[test]
fn frames_of_stations_with_extended_addresses_and_to_all_are_read_as_they_were_written() {
    for (from, to) in [(70_000, Some(80_000)), (70_000, Some(3)), (3, Some(70_000)), (3, None), (70_000, None)] {
        let frame =
            SlotData { pan: PAN, from: StationId(from), to: to.map(StationId), sequence: 1, payload: &[0x3F, 9] };
        let mut mpdu = Vec::new();
        frame.write(&mut mpdu);
        assert_eq!(SlotData::parse(&mpdu), Ok(frame), "{from} to {to:?}");
        let addresses =
            [Some(from), to].map(|station| if station.is_some_and(|number| number > 65_533) { 8 } else { 2 });
        assert_eq!(mpdu.len(), 7 + addresses.iter().sum::<usize>() + 2);
    }
}

#[test]
fn other_frames_are_refused() {
    // An acknowledgement of 2006, and the data frame as an acknowledgement.
    let old = octets("02000515e2");
    assert!(matches!(EnhancedAck::parse(&old), Err(SlotFrameError::OtherFrame(2, _))));
    let data = octets("61a808cdab010002006a62");
    assert!(matches!(EnhancedAck::parse(&data), Err(SlotFrameError::OtherFrame(..))));
    assert!(matches!(EnhancedBeacon::parse(&data), Err(SlotFrameError::OtherFrame(..))));
    let beacon =
        octets("40ea07cdabffff0100000000121700003f1a88061a010200000000011c0001c8000a1b0100650001000000000ffe08");
    // Cut off anywhere, with a check sequence of its own.
    for end in 0..beacon.len() - 2 {
        let mut cut = beacon[..end].to_vec();
        finish(&mut cut);
        assert!(EnhancedBeacon::parse(&cut).is_err(), "{end} octets");
    }
    let mut changed = beacon;
    changed[20] ^= 1;
    assert!(matches!(EnhancedBeacon::parse(&changed), Err(SlotFrameError::Header(ParseError::BadFcs { .. }))));
}
