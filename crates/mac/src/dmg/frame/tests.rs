//! Tests of frames: octets that an analyser decodes, in both directions; errors; round trips.

use proptest::prelude::*;
use sextant_channel::Db;
use sextant_kernel::StationId;

use super::super::snr_report::MeasuredSnr;
use super::*;

const ROBOT: MacAddress = MacAddress::of(StationId(1));
const SENSOR: MacAddress = MacAddress::of(StationId(7));

fn octets(hex: &str) -> Vec<u8> {
    let digits: Vec<u8> = hex.chars().filter_map(|c| c.to_digit(16)?.try_into().ok()).collect();
    digits.chunks_exact(2).map(|pair| pair[0] << 4 | pair[1]).collect()
}

fn written(frame: &SweepFrame) -> Vec<u8> {
    written_with(&[], frame)
}

fn written_with(payload: &[u8], frame: &SweepFrame) -> Vec<u8> {
    let mut octets = vec![0xEE; 3];
    frame.write(Enclosed::Payload(payload), &mut octets);
    octets
}

/// The report of these sectors by the sensor.
fn report(measurements: &[SectorMeasurement]) -> (SweepFrame, Vec<u8>) {
    let body = SweepBody::Brp { measurements: measurements.len().try_into().expect("few") };
    let frame = SweepFrame { duration_us: 0, to: ROBOT, from: SENSOR, body };
    let mut octets = vec![0xEE; 3];
    frame.write(Enclosed::Measurements(measurements), &mut octets);
    (frame, octets)
}

fn measurement(antenna: u8, sector: u8, snr: u8) -> SectorMeasurement {
    SectorMeasurement { sector: TxSector { antenna, sector }, snr: MeasuredSnr(snr) }
}

/// A beacon from sector 5 of the third antenna, 258 frames before the end of its sweep.
fn beacon(payload_octets: u16) -> SweepFrame {
    let sector = TxSector { antenna: 2, sector: 5 };
    let body =
        SweepBody::Beacon { timestamp_us: 0x0102_0304_0506, cdown: 258, sector, sequence: 0x5A, payload_octets };
    SweepFrame { duration_us: 414, to: MacAddress::BROADCAST, from: ROBOT, body }
}

/// The octets with their correct FCS.
fn with_fcs(mut covered: Vec<u8>) -> Vec<u8> {
    covered.extend(crc32fast::hash(&covered).to_le_bytes());
    covered
}

#[track_caller]
fn assert_octets(frame: &SweepFrame, hex: &str) {
    assert_eq!(written(frame), octets(hex));
    assert_eq!(SweepFrame::parse(&octets(hex)).as_ref(), Ok(frame));
    assert_eq!(usize::from(frame.octets()), hex.len() / 2);
}

fn iss(duration_us: u16, cdown: u16, sector: u8) -> SweepFrame {
    let body = SweepBody::Iss { cdown, sector: TxSector::first_antenna(sector), total_sectors: 64, rx_antennas: 1 };
    SweepFrame { duration_us, to: MacAddress::BROADCAST, from: ROBOT, body }
}

fn choice(select: TxSector, snr: SnrReport) -> SectorFeedback {
    SectorFeedback { select, snr, poll_required: false }
}

#[test]
fn frames_of_an_initiator_sweep_have_the_octets_that_an_analyser_decodes() {
    assert_octets(&iss(1003, 63, 0), "6408eb03ffffffffffff0200000000017e0000400200ef7530e5");
    assert_octets(&iss(414, 26, 37), "64089e01ffffffffffff020000000001349400400200e35089ff");
}

#[test]
fn a_frame_of_a_responder_sweep_has_the_octets_that_an_analyser_decodes() {
    let feedback = choice(TxSector::first_antenna(37), SnrReport::of(Db(12.0)));
    let body = SweepBody::Rss { cdown: 7, sector: TxSector::first_antenna(0), feedback };
    let frame = SweepFrame { duration_us: 112, to: ROBOT, from: SENSOR, body };
    assert_octets(&frame, "640870000200000000010200000000070f000025e4008bd37558");
}

#[test]
fn feedback_and_its_acknowledgement_have_the_octets_that_an_analyser_decodes() {
    let refinement = BeamRefinement::default();
    let feedback = choice(TxSector::first_antenna(3), SnrReport(100));
    let body = SweepBody::Feedback { feedback, refinement };
    let frame = SweepFrame { duration_us: 30, to: SENSOR, from: ROBOT, body };
    assert_octets(&frame, "64091e000200000000070200000000010364000000000000ee09eebd");
    let feedback = choice(TxSector { antenna: 1, sector: 37 }, SnrReport(112));
    let body = SweepBody::Ack { feedback, refinement };
    let frame = SweepFrame { duration_us: 0, to: ROBOT, from: SENSOR, body };
    assert_octets(&frame, "640a000002000000000102000000000765700000000000008bbabb7d");
}

#[test]
fn a_beacon_has_the_octets_of_the_standard() {
    // Frame control, Duration, BSSID; timestamp; direction 0, CDOWN 258, sector 5, antenna 2; no interval; Next A-BFT 15
    // (bits 15 to 18), TXSS Span 1 (bits 20 to 26); independent BSS and contention only; the element; FCS.
    let fields = "0c009e01020000000001 0605040302010000 041602 0000 008017000000 05 dd0b025358015a61626364 6566";
    let covered = octets(fields);
    let beacon = beacon(6);
    assert_eq!(written_with(b"abcdef", &beacon), with_fcs(covered.clone()));
    assert_eq!(SweepFrame::parse(&with_fcs(covered.clone())), Ok(beacon));
    assert_eq!(beacon_payload(&with_fcs(covered.clone())).as_deref(), Ok(&b"abcdef"[..]));
    // Elements of others are skipped, also those of the same OUI and of another type, before and after.
    let [mut others, ssid, kind] = [covered[..30].to_vec(), vec![0, 2, b'x', b'y'], octets("dd0502535802aa")];
    others.extend([&ssid[..], &covered[30..], &kind, &ssid].concat());
    let others = with_fcs(others);
    assert_eq!(SweepFrame::parse(&others), Ok(beacon));
    assert_eq!(beacon_payload(&others).as_deref(), Ok(&b"abcdef"[..]));
}

#[test]
fn beacons_have_the_sizes_of_their_elements_and_at_most_those_of_the_control_phy() {
    // 34 octets without elements; 6 more for each 251 octets of sequence number and payload.
    for (payload, octets) in [(0, 41), (250, 291), (251, 298), (501, 548), (502, 555), (964, 1023)] {
        assert_eq!(beacon_octets(payload), octets);
        assert_eq!(beacon_payload_octets(octets), Some(payload));
        assert_eq!(written_with(&vec![7; usize::from(payload)], &beacon(payload)).len(), usize::from(octets));
    }
    // Sizes without room for a header, between one element and two, and beyond the PHY.
    for octets in [0, 33, 34, 40, 292, 297, 549, 1024, u16::MAX] {
        assert_eq!(beacon_payload_octets(octets), None, "{octets} octets");
    }
    assert_eq!(beacon(20).airtime().as_nanos(), 26_109);
}

#[test]
fn octets_that_are_no_beacon_are_rejected_with_what_is_wrong() {
    let good = written_with(b"abcdef", &beacon(6));
    let covered = &good[..good.len() - 4];
    let message = |octets: &[u8]| SweepFrame::parse(octets).expect_err("it is broken").to_string();
    let changed = |index: usize, value: u8| {
        let mut covered = covered.to_vec();
        covered[index] = value;
        message(&with_fcs(covered))
    };
    let messages = [
        (1, 0x40, "the flags of the frame control field are 0x40; allowed: 0"),
        (23, 0x01, "the DMG Beacon frame has a Clustering Control field; allowed: none"),
        (31, 12, "the element at octet 30 of the DMG Beacon frame is cut: 13 octets are left of it"),
        (30, 220, "the DMG Beacon frame has no element with a payload"),
        (32, 0x03, "the DMG Beacon frame has no element with a payload"),
        (35, 0x02, "the DMG Beacon frame has no element with a payload"),
    ];
    for (index, value, expected) in messages {
        assert_eq!(changed(index, value), expected);
    }
    // A last element that ends within its header.
    assert_eq!(
        message(&with_fcs([covered, &[221]].concat())),
        "the element at octet 43 of the DMG Beacon frame is cut: 1 octets are left of it"
    );
    assert_eq!(message(&with_fcs(covered[..29].to_vec())), "the DMG Beacon frame has 33 octets; allowed: 41 to 1023");
    let long = with_fcs([covered, &[0; 981]].concat());
    assert_eq!(message(&long), "the DMG Beacon frame has 1028 octets; allowed: 41 to 1023");
    let mut broken = good.clone();
    broken[33] ^= 1;
    assert!(matches!(SweepFrame::parse(&broken), Err(SweepParseError::BadFcs { .. })));
    for size in 0..good.len() {
        assert!(SweepFrame::parse(&good[..size]).is_err(), "{size} octets");
    }
}

/// The report of sector 37 at 12 dB and of sector 5 of the second antenna at 0.25 dB, without FCS. Header: Action No Ack,
/// Duration, receiver, transmitter, BSSID, number. Unprotected DMG, BRP, token, request. In the DMG Beam Refinement
/// element: SNRs (bit 18), 2 measurements (bits 23 to 29), sector IDs (bit 30).
const REPORT: &str = "e0000000 020000000001 020000000007 020000000001 0000 14 01 00 00000000
    99 05 0000044100 9a 04 50 21 25 45";

#[test]
fn a_report_of_sectors_has_the_octets_of_the_standard() {
    let heard = [measurement(0, 37, 80), measurement(1, 5, 33)];
    assert!((heard[0].snr.snr().0 - 12.0).abs() < 1e-12 && (heard[1].snr.snr().0 - 0.25).abs() < 1e-12);
    let covered = octets(REPORT);
    let (frame, written) = report(&heard);
    assert_eq!(written, with_fcs(covered.clone()));
    assert_eq!(written.len(), usize::from(brp_octets(2)));
    assert_eq!(SweepFrame::parse(&written), Ok(frame));
    assert_eq!(brp_measurements(&written).as_deref(), Ok(&heard[..]));
    // Elements of others are skipped, before, between and after; other frames have no measurements.
    let ssid = [0, 2, b'x', b'y'];
    let others = with_fcs([&covered[..31], &ssid, &covered[31..38], &ssid, &covered[38..], &ssid].concat());
    assert_eq!(SweepFrame::parse(&others), Ok(frame));
    assert_eq!(brp_measurements(&others).as_deref(), Ok(&heard[..]));
    assert_eq!(brp_measurements(&written_with(b"abcdef", &beacon(6))), Ok(Vec::new()));
}

#[test]
fn reports_have_two_octets_for_each_sector_and_at_most_127_sectors() {
    for (count, octets, ns) in [(0, 44, 20_582), (36, 116, 43_273), (127, 298, 94_182)] {
        let (frame, written) = report(&vec![measurement(0, 1, 2); count]);
        assert_eq!((written.len(), frame.airtime().as_nanos()), (octets, ns), "{count} sectors");
    }
}

#[test]
#[should_panic(expected = "128 measurements")]
fn a_report_of_128_sectors_is_refused() {
    report(&[measurement(0, 1, 2); 128]);
}

#[test]
fn octets_that_are_no_report_are_rejected_with_what_is_wrong() {
    let (_, good) = report(&[measurement(0, 37, 80), measurement(1, 5, 33)]);
    let covered = &good[..good.len() - 4];
    let changed = |index: usize, value: u8| {
        let mut covered = covered.to_vec();
        covered[index] = value;
        SweepFrame::parse(&with_fcs(covered)).expect_err("it is broken").to_string()
    };
    let none =
        "the BRP frame has no SNRs of sectors; allowed: elements 153 with SNRs and sector IDs present, and 154";
    let messages = [
        (1, 0x40, "the flags of the frame control field are 0x40; allowed: 0"),
        (24, 21, "the Action No Ack frame has category 21 and action 1; allowed: 20 and 1 (BRP)"),
        (25, 0, "the Action No Ack frame has category 20 and action 0; allowed: 20 and 1 (BRP)"),
        (31, 152, none),
        (35, 0, none),
        (35, 0x0C, none),
        (36, 0x01, none),
        (38, 155, none),
        (35, 0x84, "the BRP frame has 4 octets of measurements; allowed: 6, 2 for each that it announces"),
        (39, 3, "the element at octet 43 of the BRP frame is cut: 1 octets are left of it"),
    ];
    for (index, value, expected) in messages {
        assert_eq!(changed(index, value), expected, "octet {index} is {value}");
    }
    for size in 0..good.len() {
        assert!(SweepFrame::parse(&good[..size]).is_err(), "{size} octets");
        assert!(SweepFrame::parse(&with_fcs(good[..size.min(covered.len() - 1)].to_vec())).is_err(), "{size} octets");
    }
}

#[test]
fn octets_that_are_no_frame_of_a_sweep_are_rejected_with_what_is_wrong() {
    let good = octets("6408eb03ffffffffffff0200000000017e0000400200ef7530e5");
    let mut broken = good.clone();
    broken[5] ^= 1;
    assert!(matches!(SweepFrame::parse(&broken), Err(SweepParseError::BadFcs { found: 0xE530_75EF, .. })));
    assert_eq!(SweepFrame::parse(&good[..19]), Err(SweepParseError::Truncated(19)));
    let changed = |index: usize, value: u8| {
        let mut covered = good[..22].to_vec();
        covered[index] = value;
        SweepFrame::parse(&with_fcs(covered)).err().map(|error| error.to_string())
    };
    let messages = [
        (
            0,
            0xD4,
            "the frame control field starts with 0xd4; allowed: 0x64 (control frame extension), 0x0c (DMG Beacon), \
             0xe0 (Action No Ack)",
        ),
        (1, 0x05, "control frame extension 5 is not of the sector level sweep; allowed: 8, 9, 10"),
        (1, 0x18, "the flags of the frame control field are 0x1; allowed: 0"),
        (1, 0x09, "the SSW-Feedback frame has 26 octets; allowed: 28"),
        (18, 0x04, "the RXSS length is 1; allowed: 0"),
    ];
    for (index, value, message) in messages {
        assert_eq!(changed(index, value).as_deref(), Some(message));
    }
    let longer = with_fcs([&good[..22], &[0]].concat());
    let size = SweepParseError::Size { kind: "SSW", found: 27, allowed: 26 };
    assert_eq!(SweepFrame::parse(&longer), Err(size));
}

fn any_sector() -> impl Strategy<Value = TxSector> {
    (0..4_u8, 0..64_u8).prop_map(|(antenna, sector)| TxSector { antenna, sector })
}

fn any_feedback() -> impl Strategy<Value = SectorFeedback> {
    (any_sector(), any::<i8>(), any::<bool>()).prop_map(|(select, snr, poll_required)| SectorFeedback {
        select,
        snr: SnrReport(snr),
        poll_required,
    })
}

fn any_body() -> impl Strategy<Value = SweepBody> {
    let refinement = || {
        (any::<u32>(), any::<u8>())
            .prop_map(|(request, link_maintenance)| BeamRefinement { request, link_maintenance })
    };
    prop_oneof![
        (0..512_u16, any_sector(), 0..512_u16, 0..4_u8).prop_map(|(cdown, sector, total_sectors, rx_antennas)| {
            SweepBody::Iss { cdown, sector, total_sectors, rx_antennas }
        }),
        (0..512_u16, any_sector(), any_feedback()).prop_map(|(cdown, sector, feedback)| SweepBody::Rss {
            cdown,
            sector,
            feedback
        }),
        (any_feedback(), refinement())
            .prop_map(|(feedback, refinement)| SweepBody::Feedback { feedback, refinement }),
        (any_feedback(), refinement()).prop_map(|(feedback, refinement)| SweepBody::Ack { feedback, refinement }),
    ]
}

proptest! {
    #[test]
    fn every_written_frame_is_parsed_to_the_same_frame(
        body in any_body(),
        duration_us in any::<u16>(),
        (to, from) in any::<([u8; 6], [u8; 6])>(),
    ) {
        let frame = SweepFrame { duration_us, to: MacAddress(to), from: MacAddress(from), body };
        let octets = written(&frame);
        prop_assert_eq!(octets.len(), usize::from(frame.octets()));
        prop_assert_eq!(SweepFrame::parse(&octets), Ok(frame));
    }

    #[test]
    fn every_written_beacon_is_parsed_to_the_same_beacon_and_payload(
        payload in proptest::collection::vec(any::<u8>(), 0..=964),
        (sector, cdown, sequence) in (any_sector(), 0..512_u16, any::<u8>()),
        (duration_us, timestamp_us, from) in any::<(u16, u64, [u8; 6])>(),
    ) {
        let payload_octets = payload.len().try_into().expect("at most 964");
        let body = SweepBody::Beacon { timestamp_us, cdown, sector, sequence, payload_octets };
        let frame = SweepFrame { duration_us, to: MacAddress::BROADCAST, from: MacAddress(from), body };
        let octets = written_with(&payload, &frame);
        prop_assert_eq!(octets.len(), usize::from(frame.octets()));
        prop_assert_eq!(beacon_payload_octets(frame.octets()), Some(payload_octets));
        prop_assert_eq!(SweepFrame::parse(&octets), Ok(frame));
        prop_assert_eq!(beacon_payload(&octets), Ok(payload));
    }

    #[test]
    fn every_written_report_is_parsed_to_the_same_report(
        heard in proptest::collection::vec((any_sector(), any::<u8>()), 0..=127),
        duration_us in any::<u16>(),
        (to, from) in any::<([u8; 6], [u8; 6])>(),
    ) {
        let of = |(sector, snr)| SectorMeasurement { sector, snr: MeasuredSnr(snr) };
        let heard: Vec<SectorMeasurement> = heard.into_iter().map(of).collect();
        let body = SweepBody::Brp { measurements: heard.len().try_into().expect("at most 127") };
        let frame = SweepFrame { duration_us, to: MacAddress(to), from: MacAddress(from), body };
        let mut octets = Vec::new();
        frame.write(Enclosed::Measurements(&heard), &mut octets);
        prop_assert_eq!(octets.len(), usize::from(frame.octets()));
        prop_assert_eq!(SweepFrame::parse(&octets), Ok(frame));
        prop_assert_eq!(brp_measurements(&octets), Ok(heard));
    }

    #[test]
    fn no_octets_make_the_parser_panic(covered in proptest::collection::vec(any::<u8>(), 0..60), extension in 7..12_u8) {
        let _ = SweepFrame::parse(&covered);
        // With a good header and FCS, the parser gets further.
        let mut covered = covered;
        if let [control, kind, ..] = &mut covered[..] {
            (*control, *kind) = (FRAME_CONTROL, extension);
        }
        let _ = SweepFrame::parse(&with_fcs(covered.clone()));
        if let [control, flags, ..] = &mut covered[..] {
            (*control, *flags) = (beacon::FRAME_CONTROL, 0);
        }
        let _ = beacon_payload(&with_fcs(covered.clone()));
        if let [control, _, ..] = &mut covered[..] {
            *control = brp::FRAME_CONTROL;
        }
        if let Some(action) = covered.get_mut(24..26) {
            action.copy_from_slice(&[20, 1]);
        }
        let _ = brp_measurements(&with_fcs(covered));
    }
}
