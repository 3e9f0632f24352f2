//! Tests of frames: octets that an analyser decodes, in both directions; errors; round trips.

use proptest::prelude::*;
use sextant_channel::Db;
use sextant_kernel::StationId;

use super::*;

const ROBOT: MacAddress = MacAddress::of(StationId(1));
const SENSOR: MacAddress = MacAddress::of(StationId(7));

fn octets(hex: &str) -> Vec<u8> {
    let digits: Vec<u8> = hex.chars().filter_map(|c| c.to_digit(16)?.try_into().ok()).collect();
    digits.chunks_exact(2).map(|pair| pair[0] << 4 | pair[1]).collect()
}

fn written(frame: &SweepFrame) -> Vec<u8> {
    let mut octets = vec![0xEE; 3];
    frame.write(&mut octets);
    octets
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
        (0, 0xD4, "the frame control field starts with 0xd4; allowed: 0x64 (control frame extension)"),
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
    fn no_octets_make_the_parser_panic(covered in proptest::collection::vec(any::<u8>(), 0..40), extension in 7..12_u8) {
        let _ = SweepFrame::parse(&covered);
        // With a good header and FCS, the parser gets further.
        let mut covered = covered;
        if let [control, kind, ..] = &mut covered[..] {
            (*control, *kind) = (FRAME_CONTROL, extension);
        }
        let _ = SweepFrame::parse(&with_fcs(covered));
    }
}
