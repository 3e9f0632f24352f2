//! Tests of frames: published octets in both directions, errors, round trips.

use proptest::prelude::*;
use sextant_kernel::StationId;

use super::*;

fn octets(hex: &str) -> Vec<u8> {
    let digits: Vec<u8> = hex.chars().filter_map(|c| c.to_digit(16)?.try_into().ok()).collect();
    digits.chunks_exact(2).map(|pair| pair[0] << 4 | pair[1]).collect()
}

fn short(pan: u16, address: u16) -> Endpoint {
    Endpoint { pan, address: Address::Short(address) }
}

fn extended(pan: u16, address: u64) -> Endpoint {
    Endpoint { pan, address: Address::Extended(address) }
}

fn written(frame: &Frame<'_>) -> Vec<u8> {
    let mut mpdu = vec![0xEE; 3];
    frame.write(&mut mpdu).expect("a frame that fits");
    mpdu
}

/// The octets with their correct FCS.
fn with_fcs(mut covered: Vec<u8>) -> Vec<u8> {
    covered.extend(fcs(&covered).to_le_bytes());
    covered
}

fn assert_octets(frame: &Frame<'_>, hex: &str) {
    assert_eq!(written(frame), octets(hex));
    assert_eq!(Frame::parse(&octets(hex)).as_ref(), Ok(frame));
}

#[test]
fn data_with_short_addresses_has_the_octets_that_an_analyser_decodes() {
    let frame = Frame { ack_request: true, ..Frame::data(5, short(0x1234, 7), short(0x1234, 0), b"hello") };
    assert_octets(&frame, "61880534120000070068656c6c6f8788");
}

#[test]
fn a_broadcast_has_the_octets_that_an_analyser_decodes() {
    let frame = Frame::data(9, short(0x1234, 7), short(0x1234, 0xFFFF), b"q");
    assert_octets(&frame, "4188093412ffff0700711b47");
}

#[test]
fn data_with_extended_addresses_has_the_octets_that_an_analyser_decodes() {
    let destination = extended(0x1234, 0x0706_0504_0302_0100);
    let source = extended(0x1234, 0x0F0E_0D0C_0B0A_0908);
    let frame = Frame { ack_request: true, ..Frame::data(7, source, destination, b"x") };
    assert_octets(&frame, "61cc073412000102030405060708090a0b0c0d0e0f786ef3");
}

#[test]
fn an_acknowledgement_has_the_octets_that_an_analyser_decodes() {
    assert_octets(&Frame::acknowledgement(5), "02000515e2");
    assert_octets(&Frame::acknowledgement(0x6A), "02006ae479");
    assert_octets(&Frame::acknowledgement(0x56), "0200560b82");
}

#[test]
fn a_beacon_has_the_octets_that_an_analyser_decodes() {
    assert_octets(&beacon(1, Vec::new(), b"BCN"), "0080013412000046cf000042434efad5");
}

#[test]
fn a_data_request_has_the_octets_that_an_analyser_decodes() {
    let body = FrameBody::Command { command: MacCommand::DataRequest, payload: &[] };
    let frame = Frame { ack_request: true, body, ..Frame::data(6, short(0x1234, 7), short(0x1234, 0), &[]) };
    assert_octets(&frame, "63880634120000070004f016");
}

fn beacon(sequence: u8, guaranteed: Vec<GuaranteedSlot>, payload: &[u8]) -> Frame<'_> {
    let superframe = Superframe {
        beacon_order: 6,
        superframe_order: 4,
        final_cap_slot: 15,
        battery_life_extension: false,
        pan_coordinator: true,
        association_permit: true,
    };
    let body = FrameBody::Beacon(Beacon {
        superframe,
        gts_permit: false,
        guaranteed,
        pending_short: Vec::new(),
        pending_extended: Vec::new(),
        payload,
    });
    Frame { destination: None, body, ..Frame::data(sequence, short(0x1234, 0), short(0, 0), &[]) }
}

#[test]
fn guaranteed_slots_take_a_mask_of_directions_and_three_octets_each() {
    let slot = |device, first_slot, slots, receive_only| GuaranteedSlot { device, first_slot, slots, receive_only };
    let frame = beacon(1, vec![slot(0x0102, 14, 2, false), slot(0x0304, 11, 3, true)], &[]);
    let mpdu = written(&frame);
    assert_eq!(mpdu[9..17], [0x02, 0b10, 0x02, 0x01, 0x2E, 0x04, 0x03, 0x3B]);
    assert_eq!(Frame::parse(&mpdu), Ok(frame));
}

#[test]
fn a_beacon_request_names_a_destination_and_no_source() {
    let body = FrameBody::Command { command: MacCommand::BeaconRequest, payload: &[] };
    let everybody = short(BROADCAST_PAN, 0xFFFF);
    let frame = Frame { source: None, body, ..Frame::data(1, everybody, everybody, &[]) };
    assert_eq!(written(&frame)[..8], [0x03, 0x08, 1, 0xFF, 0xFF, 0xFF, 0xFF, 7]);
}

#[test]
fn a_frame_between_two_pans_names_both() {
    let frame = Frame::data(1, short(0x1111, 1), short(0x2222, 2), &[]);
    assert_eq!(written(&frame)[..11], [0x01, 0x88, 1, 0x22, 0x22, 2, 0, 0x11, 0x11, 1, 0]);
}

#[test]
fn an_invalid_frame_is_rejected_with_the_reason() {
    let reason = |hex: &str| Frame::parse(&with_fcs(octets(hex))).expect_err("no frame");
    assert_eq!(Frame::parse(&[1]), Err(ParseError::Truncated { octets: 1, part: "FCS" }));
    assert_eq!(Frame::parse(&[0; 128]), Err(ParseError::Oversized(128)));
    let bad_fcs = ParseError::BadFcs { found: 0xE216, computed: 0xE215 };
    assert_eq!(Frame::parse(&octets("02000516e2")), Err(bad_fcs));
    assert_eq!(reason("0200"), ParseError::Truncated { octets: 4, part: "sequence number" });
    assert_eq!(reason("41880934"), ParseError::Truncated { octets: 6, part: "destination PAN" });
    assert_eq!(reason("4188093412ffff07"), ParseError::Truncated { octets: 10, part: "addresses" });
    assert_eq!(reason("040005"), ParseError::ReservedType(4));
    assert_eq!(reason("022005"), ParseError::UnsupportedVersion(2));
    assert_eq!(reason("0a0005"), ParseError::Secured);
    assert_eq!(reason("010405"), ParseError::ReservedAddressingMode("destination"));
    assert_eq!(reason("014005"), ParseError::ReservedAddressingMode("source"));
    assert_eq!(reason("4108051234"), ParseError::CompressionWithoutBothAddresses);
    assert_eq!(reason("0308013412ffff0a"), ParseError::ReservedCommand(10));
    assert_eq!(reason("0200053f"), ParseError::AcknowledgementWithPayload(1));
}

#[test]
fn a_frame_that_does_not_fit_is_not_written() {
    let ends = (short(1, 1), short(1, 2));
    let mut mpdu = Vec::new();
    assert_eq!(Frame::data(1, ends.0, ends.1, &[0; 116]).write(&mut mpdu), Ok(()));
    assert_eq!(mpdu.len(), 127);
    assert_eq!(Frame::data(1, ends.0, ends.1, &[0; 117]).write(&mut mpdu), Err(WriteError::Oversized(128)));
    let slot = GuaranteedSlot { device: 1, first_slot: 16, slots: 1, receive_only: false };
    let error = beacon(1, vec![slot], &[]).write(&mut mpdu).expect_err("16 needs five bits");
    assert_eq!(error.to_string(), "the first slot of a guaranteed slot of the beacon is 16; allowed: 0 to 15");
}

#[test]
fn a_frame_of_a_station_has_the_size_asked_for() {
    let mut mpdu = Vec::new();
    for (station, least) in [(7, 11), (65_533, 11), (65_534, 17), (u32::MAX, 17)] {
        let station = StationId(station);
        let broadcast = DataFrame::broadcast(1, station);
        assert!(broadcast.filler(least - 1).is_err());
        assert!(broadcast.filler(128).is_err());
        assert_eq!(broadcast.max_payload_octets(), 127 - least);
        for size in least..=127 {
            broadcast.write(3, broadcast.filler(size).expect("a good size"), &mut mpdu);
            assert_eq!(mpdu.len(), usize::from(size));
            let frame = Frame::parse(&mpdu).expect("a frame");
            assert_eq!(frame.source.and_then(|from| from.address.station()), Some(station));
            assert!(!frame.ack_request && frame.sequence == 3);
            let FrameBody::Data(payload) = frame.body else { panic!("{frame:?}") };
            assert_eq!(payload.first().copied(), (size > least).then_some(0x3F));
        }
    }
    let (station, near, far) = (StationId(7), StationId(9), StationId(70_000));
    DataFrame::unicast(1, station, near).write(3, &[], &mut mpdu);
    assert_eq!(mpdu[..9], [0x61, 0x88, 3, 1, 0, 9, 0, 7, 0]);
    assert!(DataFrame::unicast(1, far, near).filler(16).is_err());
    assert!(DataFrame::unicast(1, station, far).filler(16).is_err());
    let both_far = DataFrame::unicast(1, far, far);
    assert!(both_far.filler(22).is_err());
    both_far.write(3, both_far.filler(23).expect("a good size"), &mut mpdu);
    assert_eq!(mpdu.len(), 23);
}

#[test]
fn writing_into_a_used_buffer_allocates_nothing() {
    let mut mpdu = Vec::with_capacity(127);
    let place = mpdu.as_ptr();
    for size in [127, 11, 64, 127] {
        let frame = DataFrame::broadcast(1, StationId(1));
        frame.write(0, frame.filler(size).expect("a good size"), &mut mpdu);
    }
    assert_eq!((mpdu.as_ptr(), mpdu.capacity()), (place, 127));
}

prop_compose! {
    fn any_endpoint()(pan in 0..4_u16, address in prop_oneof![
        any::<u16>().prop_map(Address::Short),
        any::<u64>().prop_map(Address::Extended),
    ]) -> Endpoint {
        Endpoint { pan, address }
    }
}

prop_compose! {
    fn any_slot()(device: u16, first_slot in 0..16_u8, slots in 0..16_u8, receive_only: bool) -> GuaranteedSlot {
        GuaranteedSlot { device, first_slot, slots, receive_only }
    }
}

prop_compose! {
    fn any_superframe()(
        beacon_order in 0..16_u8,
        superframe_order in 0..16_u8,
        final_cap_slot in 0..16_u8,
        battery_life_extension: bool,
        pan_coordinator: bool,
        association_permit: bool,
    ) -> Superframe {
        Superframe {
            beacon_order,
            superframe_order,
            final_cap_slot,
            battery_life_extension,
            pan_coordinator,
            association_permit,
        }
    }
}

fn any_body(payload: &'static [u8]) -> impl Strategy<Value = FrameBody<'static>> {
    let lists = (
        proptest::collection::vec(any_slot(), 0..=7),
        proptest::collection::vec(any::<u16>(), 0..=7),
        proptest::collection::vec(any::<u64>(), 0..=2),
    );
    let beacon = (any_superframe(), any::<bool>(), lists).prop_map(
        move |(superframe, gts_permit, (guaranteed, pending_short, pending_extended))| {
            FrameBody::Beacon(Beacon { superframe, gts_permit, guaranteed, pending_short, pending_extended, payload })
        },
    );
    let command = proptest::sample::select(&MacCommand::ALL[..]);
    prop_oneof![
        beacon,
        Just(FrameBody::Data(payload)),
        Just(FrameBody::Acknowledgement),
        command.prop_map(move |command| FrameBody::Command { command, payload }),
    ]
}

proptest! {
    #[test]
    fn every_written_frame_is_parsed_to_the_same_frame(
        body in (0..=30_usize).prop_flat_map(|size| {
            any_body(&b"a payload of up to 30 octets.."[..size])
        }),
        version in prop_oneof![Just(Version::V2003), Just(Version::V2006)],
        (frame_pending, ack_request, sequence) in any::<(bool, bool, u8)>(),
        destination in proptest::option::of(any_endpoint()),
        source in proptest::option::of(any_endpoint()),
    ) {
        let frame = Frame { version, frame_pending, ack_request, sequence, destination, source, body };
        let mpdu = written(&frame);
        prop_assert_eq!(Frame::parse(&mpdu), Ok(frame));
    }

    #[test]
    fn no_octets_make_the_parser_panic(covered in proptest::collection::vec(any::<u8>(), 0..140)) {
        let _ = Frame::parse(&covered);
        // With a correct FCS, the parser gets further.
        let mpdu = with_fcs(covered);
        if let Ok(frame) = Frame::parse(&mpdu) {
            let again = written(&frame);
            prop_assert_eq!(Frame::parse(&again), Ok(frame));
        }
    }

    #[test]
    fn a_truncated_frame_is_rejected_or_has_less_payload(cut in 0..24_usize) {
        let whole = octets("61cc073412000102030405060708090a0b0c0d0e0f786ef3");
        let mpdu = with_fcs(whole[..cut.saturating_sub(2)].to_vec());
        let parsed = Frame::parse(&mpdu);
        prop_assert_eq!(parsed.is_ok(), cut >= 23, "{:?}", parsed);
    }
}
