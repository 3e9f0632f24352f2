//! Captures of IEEE 802.11ad, octet by octet and as tshark reads them; captures of both technologies.

use std::path::Path;
use std::time::Duration;

use sextant_channel::{Db, Dbm};
use sextant_kernel::{SimTime, StationId};
use sextant_mac::dmg::{
    BeamRefinement, Enclosed, MacAddress, MeasuredSnr, SectorFeedback, SectorMeasurement, SnrReport, SweepBody,
    SweepFrame, TxSector,
};
use sextant_recording::{Capture, CapturedDmgFrame, CapturedFrame, Technologies};

use super::tshark::{dissect, tshark};

const ROBOT: MacAddress = MacAddress::of(StationId(1));
const SENSOR: MacAddress = MacAddress::of(StationId(7));
const ACK: &[u8] = &[0x02, 0x00, 0x05, 0x15, 0xE2];

fn hex(text: &str) -> Vec<u8> {
    let digits: Vec<_> = text.chars().filter(|c| !c.is_whitespace()).collect();
    let octet = |pair: &[char]| u8::from_str_radix(&pair.iter().collect::<String>(), 16).unwrap();
    digits.chunks(2).map(octet).collect()
}

/// One frame of each kind of a sector level sweep.
fn frames() -> [SweepFrame; 4] {
    let choice = |antenna, sector, snr| SectorFeedback {
        select: TxSector { antenna, sector },
        snr: SnrReport::of(Db(snr)),
        poll_required: false,
    };
    let sector = TxSector { antenna: 0, sector: 37 };
    let refinement = BeamRefinement::default();
    let iss = SweepBody::Iss { cdown: 26, sector, total_sectors: 64, rx_antennas: 1 };
    let sector = TxSector { antenna: 2, sector: 5 };
    let rss = SweepBody::Rss { cdown: 2, sector, feedback: choice(0, 37, 12.0) };
    let feedback = SweepBody::Feedback { feedback: choice(2, 5, 44.0), refinement };
    let ack = SweepBody::Ack { feedback: choice(1, 37, 47.0), refinement };
    [
        SweepFrame { duration_us: 414, to: MacAddress::BROADCAST, from: ROBOT, body: iss },
        SweepFrame { duration_us: 32, to: ROBOT, from: SENSOR, body: rss },
        SweepFrame { duration_us: 28, to: SENSOR, from: ROBOT, body: feedback },
        SweepFrame { duration_us: 0, to: ROBOT, from: SENSOR, body: ack },
    ]
}

fn captured<'a>(frame: &SweepFrame, octets: &'a mut Vec<u8>, power: Option<Dbm>) -> CapturedDmgFrame<'a> {
    frame.write(Enclosed::Nothing, octets);
    let start = SimTime::from_nanos(2_123_456_789);
    CapturedDmgFrame { start, airtime: frame.airtime(), octets, carrier_hz: 60.48e9, power }
}

fn capture(technologies: Technologies) -> Capture<Vec<u8>> {
    Capture::new(Vec::new(), Path::new("a.pcap"), technologies).unwrap()
}

#[test]
fn a_capture_of_one_frame_has_the_octets_of_the_formats() {
    let mut octets = Vec::new();
    let mut capture = capture(Technologies::Ieee80211ad);
    let frame = captured(&frames()[0], &mut octets, Some(Dbm(-60.4)));
    capture.dmg_frame(&frame).unwrap();
    capture.dmg_frame(&CapturedDmgFrame { power: None, carrier_hz: 73e9, ..frame }).unwrap();
    // The end is 2.123471698 s; the timer of the frame's start is 2123456 us; 60480 MHz is 0xEC40; -60 dBm is 0xC4.
    let expected = "4d3cb2a1 0200 0400 00000000 00000000 ffff0000 7f000000
        02000000 52075c07 31000000 31000000
        00 00 1700 2b000000 c066200000000000 10 00 40ec 0000 c4
        64089e01ffffffffffff020000000001349400400200e35089ff
        02000000 52075c07 30000000 30000000
        00 00 1600 0b000000 c066200000000000 10 00 40ec 0000
        64089e01ffffffffffff020000000001349400400200e35089ff";
    assert_eq!(capture.into_output().unwrap(), hex(expected));
}

/// Both technologies in one file: an acknowledgement of IEEE 802.15.4 and the frames of a sweep.
fn both() -> Vec<u8> {
    let mut capture = capture(Technologies::Both);
    let start = SimTime::from_nanos(5_000_000_007);
    let ack =
        CapturedFrame { start, airtime: Duration::from_micros(352), mpdu: ACK, channel: 15, page: 0, signal: None };
    capture.frame(&ack).unwrap();
    for frame in frames() {
        capture.dmg_frame(&captured(&frame, &mut Vec::new(), Some(Dbm(-60.0)))).unwrap();
    }
    capture.into_output().unwrap()
}

#[test]
fn a_capture_of_both_technologies_has_an_interface_for_each() {
    let file = both();
    let expected = "0a0d0d0a 1c000000 4d3c2b1a 0100 0000 ffffffffffffffff 1c000000
        01000000 20000000 1b01 0000 ffff0000 0900 0100 09000000 00000000 20000000
        01000000 20000000 7f00 0000 ffff0000 0900 0100 09000000 00000000 20000000
        06000000 54000000 00000000";
    let expected = hex(expected);
    assert_eq!(file[..expected.len()], expected);
    // Every block ends with its length, and the blocks fill the file.
    let mut rest = &file[..];
    let mut kinds = Vec::new();
    while !rest.is_empty() {
        let length = usize::try_from(u32::from_le_bytes(rest[4..8].try_into().unwrap())).unwrap();
        assert_eq!(rest[4..8], rest[length - 4..length]);
        assert_eq!(length % 4, 0);
        kinds.push((rest[0], rest[8]));
        rest = &rest[length..];
    }
    assert_eq!(kinds[3..], [(6, 0), (6, 1), (6, 1), (6, 1), (6, 1)]);
}

/// The fields of `file` that tshark decodes; `None` if it is not installed.
fn decoded(file: &[u8], fields: &[&str]) -> Option<Vec<Vec<String>>> {
    let program = tshark()?;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.pcap");
    std::fs::write(&path, file).unwrap();
    Some(dissect(&program, &path, fields))
}

#[test]
fn tshark_decodes_the_fields_of_all_frames_of_a_sweep() {
    let mut file = capture(Technologies::Ieee80211ad);
    for frame in frames() {
        file.dmg_frame(&captured(&frame, &mut Vec::new(), Some(Dbm(-60.4)))).unwrap();
    }
    let text = ["_ws.malformed", "wlan.ra", "wlan.ta", "frame.time_epoch"];
    let numbers = [
        "wlan.fcs.status",
        "radiotap.dbm_antsignal",
        "radiotap.channel.freq",
        "radiotap.mactime",
        "wlan.duration",
        "wlan.ssw.direction",
        "wlan.ssw.cdown",
        "wlan.ssw.sector_id",
        "wlan.ssw.dmg_ant_id",
        "wlan.sswf.num_sectors",
        "wlan.sswf.num_dmg_ants",
        "wlan.sswf.sector_select",
        "wlan.sswf.dmg_antenna_select",
        "wlan.sswf.snr_report",
    ];
    let Some(rows) = decoded(&file.into_output().unwrap(), &[&text[..], &numbers].concat()) else { return };
    let (all, robot, sensor) = ("ff:ff:ff:ff:ff:ff", "02:00:00:00:00:01", "02:00:00:00:00:07");
    let ssw = "2.123471698";
    let other = "2.123475044";
    let texts =
        [["", all, robot, ssw], ["", robot, sensor, ssw], ["", sensor, robot, other], ["", robot, sensor, other]];
    assert_eq!(rows.iter().map(|row| &row[..4]).collect::<Vec<_>>(), texts);
    let number = |text: &String| match (text.as_str(), text.strip_prefix("0x")) {
        ("True", _) => Some(1),
        ("False", _) => Some(0),
        (_, Some(digits)) => i64::from_str_radix(digits, 16).ok(),
        (decimal, None) => decimal.parse().ok(),
    };
    let found: Vec<Vec<_>> = rows.iter().map(|row| row[4..].iter().map(number).collect()).collect();
    // FCS good, -60 dBm, 60480 MHz, start; then the fields of the frame.
    let start = [1, -60, 60_480, 2_123_456].map(Some);
    let row = |fields: &[Option<i64>]| [&start[..], fields].concat();
    let expected = [
        row(&[Some(414), Some(0), Some(26), Some(37), Some(0), Some(64), Some(1), None, None, None]),
        row(&[Some(32), Some(1), Some(2), Some(5), Some(2), None, None, Some(37), Some(0), Some(0xE4)]),
        row(&[Some(28), None, None, None, None, None, None, Some(5), Some(2), Some(100)]),
        row(&[Some(0), None, None, None, None, None, None, Some(37), Some(1), Some(112)]),
    ];
    assert_eq!(found, expected);
}

#[test]
fn tshark_decodes_the_question_for_all_sectors_and_the_announcement_of_their_report() {
    let measurement =
        |sector, snr| SectorMeasurement { sector: TxSector { antenna: 1, sector }, snr: MeasuredSnr::of(Db(snr)) };
    let heard = [measurement(5, 12.0), measurement(63, 0.25), measurement(0, -8.0)];
    let feedback = SectorFeedback::default();
    let question = SweepBody::Feedback { feedback, refinement: BeamRefinement::of_all_sectors() };
    let question = SweepFrame { duration_us: 61, to: SENSOR, from: ROBOT, body: question };
    let report = SweepFrame { duration_us: 0, to: ROBOT, from: SENSOR, body: SweepBody::Brp { measurements: 3 } };
    let mut file = capture(Technologies::Ieee80211ad);
    file.dmg_frame(&captured(&question, &mut Vec::new(), None)).unwrap();
    let mut octets = Vec::new();
    report.write(Enclosed::Measurements(&heard), &mut octets);
    let start = SimTime::from_nanos(2_123_556_789);
    let airtime = report.airtime();
    file.dmg_frame(&CapturedDmgFrame { start, airtime, octets: &octets, carrier_hz: 60.48e9, power: None }).unwrap();
    let fields = [
        "wlan.fcs.status",
        "wlan.fc.type_subtype",
        "wlan.ra",
        "wlan.ta",
        "wlan.brp.bc_req",
        "wlan.fixed.category_code",
        "wlan.fixed.unprotected_dmg_act",
        "wlan.beam_refine.snr_present",
        "wlan.beam_refine.sector_id_present",
        "wlan.beam_refine.num_measurement",
        "wlan.beam_refine.ch_measure_present",
        "wlan.beam_refine.reserved",
        "wlan.tag.number",
        "wlan.tag.length",
    ];
    let Some(rows) = decoded(&file.into_output().unwrap(), &fields) else { return };
    let rows: Vec<String> = rows.iter().map(|row| row.join(" ").replace("True", "1").replace("False", "0")).collect();
    let (robot, sensor) = ("02:00:00:00:00:01", "02:00:00:00:00:07");
    assert!(rows[0].starts_with("1 ") && rows[0].contains(&format!("{sensor} {robot} 1")), "{rows:?}");
    // Good FCS; Unprotected DMG, BRP; three SNRs and sector IDs, nothing else; both elements. This program reads the second
    // one as if each measurement had a tap, whatever the first one says, so its content is compared elsewhere.
    let [_, report] = &rows[..] else { panic!("{rows:?}") };
    assert!(report.starts_with("1 ") && report.contains(&format!("{robot} {sensor} 0 20 ")), "{report}");
    let end: Vec<&str> = report.split(' ').rev().take(7).collect();
    assert_eq!(end, ["5,6", "153,154", "0", "0", "3", "1", "1"]);
}

#[test]
fn tshark_decodes_the_fields_and_the_payload_of_broadcasts() {
    // 300 octets do not fit in one element; the second beacon has an empty payload.
    let payloads: [Vec<u8>; 2] = [(0..300).map(|i| u8::try_from(i % 251).unwrap()).collect(), Vec::new()];
    let mut file = capture(Technologies::Ieee80211ad);
    for (payload, sector) in payloads.iter().zip([5, 63]) {
        let body = SweepBody::Beacon {
            timestamp_us: 2_123_456,
            cdown: 127 - u16::from(sector),
            sector: TxSector { antenna: 1, sector },
            sequence: 0x5A,
            payload_octets: u16::try_from(payload.len()).unwrap(),
        };
        let frame = SweepFrame { duration_us: 414, to: MacAddress::BROADCAST, from: SENSOR, body };
        let mut octets = Vec::new();
        frame.write(Enclosed::Payload(payload), &mut octets);
        let start = SimTime::from_nanos(2_123_456_789);
        let captured =
            CapturedDmgFrame { start, airtime: frame.airtime(), octets: &octets, carrier_hz: 60.48e9, power: None };
        file.dmg_frame(&captured).unwrap();
    }
    let fields = [
        "_ws.malformed",
        "wlan.fcs.status",
        "wlan.fc.type_subtype",
        "wlan.bssid",
        "wlan.duration",
        "wlan.fixed.timestamp",
        "wlan.ssw.direction",
        "wlan.ssw.cdown",
        "wlan.ssw.sector_id",
        "wlan.ssw.dmg_ant_id",
        "wlan.bic.next_abft",
        "wlan.tag.number",
        "wlan.tag.oui",
        "wlan.tag.vendor.oui.type",
        "wlan.tag.vendor.data",
    ];
    let Some(rows) = decoded(&file.into_output().unwrap(), &fields) else { return };
    let number = |text: &str| match text.strip_prefix("0x") {
        Some(digits) => u64::from_str_radix(digits, 16).ok(),
        None => match text {
            "False" => Some(0),
            "True" => Some(1),
            decimal => decimal.parse().ok(),
        },
    };
    for ((row, payload), sector) in rows.iter().zip(&payloads).zip([5, 63]) {
        assert_eq!((&*row[0], number(&row[1])), ("", Some(1)), "{row:?}");
        // Type 3 (extension), subtype 0 (DMG Beacon).
        assert_eq!(number(&row[2]), Some(0x30));
        assert_eq!(row[3], "02:00:00:00:00:07");
        let numbers: Vec<Option<u64>> = row[4..11].iter().map(|text| number(text)).collect();
        assert_eq!(numbers, [414, 2_123_456, 0, 127 - sector, sector, 1, 15].map(Some));
        let elements = 1 + payload.len() / 251;
        assert_eq!([&row[11], &row[12], &row[13]].map(|text| text.split(',').count()), [elements; 3], "{row:?}");
        assert!(row[11].split(',').all(|id| id == "221") && row[13].split(',').all(|kind| number(kind) == Some(1)));
        // 02:53:58 as a number.
        assert!(row[12].split(',').all(|oui| number(oui) == Some(0x02_5358)), "{row:?}");
        // Behind the type of each element: the sequence number, and then the payload.
        let content: Vec<u8> = row[14].split(',').flat_map(|data| hex(data)[1..].to_vec()).collect();
        assert_eq!(content, [&[0x5A], &payload[..]].concat());
    }
    assert_eq!(rows.len(), 2);
}

#[test]
fn tshark_reads_a_capture_of_both_technologies() {
    let fields = ["frame.interface_id", "frame.time_epoch", "_ws.malformed", "wpan.seq_no", "wlan.ssw.cdown"];
    let Some(rows) = decoded(&both(), &fields) else { return };
    let (ssw, other) = ("2.123471698", "2.123475044");
    let expected = [
        ["0", "5.000352007", "", "5", ""],
        ["1", ssw, "", "", "26"],
        ["1", ssw, "", "", "2"],
        ["1", other, "", "", ""],
        ["1", other, "", "", ""],
    ];
    assert_eq!(rows, expected);
}
