//! Captures of sniffers as logs of robots. `captures/write_captures.py` wrote the captures with the Python package scapy, and
//! mergecap of Wireshark put two of them in one file.

#![expect(clippy::unwrap_used, reason = "a test fails at the first error")]

use std::collections::BTreeSet;
use std::path::Path;

use sextant_logs::{self as robot_log, ReadOptions, RobotLog};

use super::drive::{assert_holds, kept, map, options, path_csv};
use super::pcap::tshark;
use super::program::{Said, unwrapped};

const NAMES: [&str; 3] = ["0x0001", "00:12:4b:00:01:02:03:04", "0x0003"];
/// Of the first time of the path (ns).
const START_NS: u32 = 123_456_000;

/// A folder with the path of the robot.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("path.csv"), path_csv(START_NS)).unwrap();
    folder
}

/// Reads the capture with these octets.
fn read(octets: &[u8], change: impl Fn(&mut ReadOptions)) -> Result<RobotLog, String> {
    let folder = folder();
    let capture = folder.path().join("sniff.pcap");
    std::fs::write(&capture, octets).unwrap();
    let mut options = options();
    options.form.path = Some(folder.path().join("path.csv"));
    change(&mut options);
    robot_log::read(&capture, &options).map_err(|error| error.to_string())
}

fn octets(name: &str) -> Vec<u8> {
    std::fs::read(kept("captures").join(name)).unwrap()
}

fn untouched(_: &mut ReadOptions) {}

#[test]
fn nodes_are_source_addresses_and_levels_are_those_of_tap() {
    let log = read(&octets("tap.pcap"), untouched).unwrap();
    assert_holds(&log, NAMES, [true; 3]);
    let expected = "22 frames are packets; skipped: 8 without a source address (acknowledgements, for example), 1 with a \
        wrong FCS";
    assert!(log.notes[0].ends_with(expected), "{}", log.notes[0]);
}

#[test]
fn frames_without_levels_are_packets_too() {
    let log = read(&octets("fcs.pcap"), untouched).unwrap();
    assert_holds(&log, NAMES, [false; 3]);
    assert!(log.notes[0].contains("1 with a wrong FCS"), "{}", log.notes[0]);
}

#[test]
fn interfaces_of_one_file_have_their_own_link_and_clock() {
    let log = read(&octets("mixed.pcapng"), untouched).unwrap();
    assert_holds(&log, [NAMES[0], NAMES[1], "02:00:00:00:00:02"], [false, false, true]);
}

#[test]
fn a_folder_of_captures_is_one_log() {
    let folder = folder();
    std::fs::write(folder.path().join("1.pcap"), octets("tap.pcap")).unwrap();
    assert_holds(&robot_log::read(folder.path(), &options()).unwrap(), NAMES, [true; 3]);
    let (code, _, stderr) = map(folder.path(), &["--profile", "p0=0.9,plateau_m=1,range_m=3"]).all();
    assert_eq!(code, 0, "{stderr}");
    assert!(unwrapped(&stderr).contains("22 frames are packets"), "{stderr}");
}

#[test]
fn a_short_address_is_named_with_its_pan_if_there_are_several() {
    // The frames of the first node, of which half are secured, once more in another PAN and without FCS.
    let mut frames = octets("mixed.pcapng");
    let first = frames.windows(4).position(|window| window == [0xCD, 0xAB, 0, 0]).unwrap();
    frames[first] = 0xCE;
    let log = read(&frames, untouched).unwrap();
    assert_eq!(log.log.names(), ["0xabce/0x0001", "0xabcd/0x0001", NAMES[1], "02:00:00:00:00:02"]);
    assert!(log.notes[0].contains("several PANs (0xabcd, 0xabce)"), "{}", log.notes[0]);
    let log = read(&frames, |options| options.sniffer.pan = Some(0xABCD)).unwrap();
    assert_eq!(log.log.names(), [NAMES[0], NAMES[1]]);
    assert!(log.notes[0].contains("of another PAN or none"), "{}", log.notes[0]);
}

#[test]
fn a_capture_that_ends_in_a_packet_is_read_as_far_as_it_goes() {
    for name in ["tap.pcap", "mixed.pcapng"] {
        let whole = octets(name);
        let log = read(&whole[..whole.len() - 5], untouched).unwrap();
        assert!(
            log.notes[1].ends_with("ends in the middle of a packet, as after a crash of the sniffer"),
            "{:?}",
            log.notes
        );
        // Wherever it ends, there is an answer.
        for length in (4..whole.len()).step_by(29) {
            if let Err(problem) = read(&whole[..length], untouched) {
                assert!(problem.contains("no frame from which a node was heard"), "{problem}");
            }
        }
    }
}

#[test]
fn a_bad_capture_is_an_error() {
    let tap = octets("tap.pcap");
    let changed = |at: usize, value: &[u8]| {
        let mut octets = tap.clone();
        octets[at..at + value.len()].copy_from_slice(value);
        octets
    };
    let mixed = octets("mixed.pcapng");
    let packet = mixed.windows(4).position(|window| window == [6, 0, 0, 0]).unwrap();
    let mut unknown_interface = mixed.clone();
    unknown_interface[packet + 8] = 7;
    let mut wrong_length = mixed;
    wrong_length[packet + 4] += 4;
    for (octets, expected) in [
        (
            changed(20, &[1, 0]),
            "has frames of link type 1 (Ethernet), which do not say which node was heard; allowed: 195 and 230",
        ),
        (changed(32, &[0, 0, 0, 0x7F]), "is damaged before byte 40: it has a packet of 2130706432 octets"),
        (unknown_interface, "it has a packet of interface 7, which is not described"),
        (wrong_length, "that ends with the length"),
        (tap[..24].to_vec(), "no frame from which a node was heard"),
    ] {
        let problem = read(&octets, untouched).unwrap_err();
        assert!(problem.contains(expected), "{problem}");
    }
    // All check sequences are wrong, as those of sniffers that put other values in their place.
    let wrong = with_ends(|_, end| [end[0], end[1] ^ 0x21]);
    let problem = read(&wrong, untouched).unwrap_err();
    assert!(problem.contains("31 with a wrong FCS") && problem.contains("link type 230"), "{problem}");
    assert!(problem.contains("`fcs=ti`") && problem.contains("`fcs=none`"), "{problem}");
}

/// The capture with check sequences, with what `end` makes of them by the number of the frame.
fn with_ends(end: impl Fn(usize, [u8; 2]) -> [u8; 2]) -> Vec<u8> {
    let mut octets = octets("fcs.pcap");
    let (mut at, mut number) = (24, 0);
    while at < octets.len() {
        let length = u32::from_be_bytes([octets[at + 8], octets[at + 9], octets[at + 10], octets[at + 11]]) as usize;
        at += 16 + length;
        let made = end(number, [octets[at - 2], octets[at - 1]]);
        octets[at - 2..at].copy_from_slice(&made);
        number += 1;
    }
    octets
}

#[test]
fn the_rssi_in_the_place_of_the_check_sequence_is_that_of_the_chip() {
    let right = read(&octets("fcs.pcap"), untouched).unwrap();
    // Every frame with an RSSI of -7 (two's complement), and with the bit of a right check sequence.
    let ti = with_ends(|_, _| [0xF9, 0xEB]);
    for (text, expected_dbm) in [("ti", -80.0), ("ti:-45", -52.0), ("ti:-76", -83.0), ("ti:0", -7.0)] {
        let log = read(&ti, |options| options.sniffer.fcs = text.parse().ok()).unwrap();
        let levels: Vec<_> = log.log.receptions().iter().filter(|at| at.received > 0).map(|at| at.rssi_dbm).collect();
        assert!(!levels.is_empty() && levels.iter().all(|level| *level == Some(expected_dbm)), "{text}: {levels:?}");
        assert_eq!(log.log.names(), NAMES);
        assert!(log.notes.iter().any(|note| note.contains("a chip of Texas Instruments wrote")), "{:?}", log.notes);
    }
    // Without the bit the frame was damaged: here each second one.
    let half = with_ends(|number, _| [0xF9, if number % 2 == 0 { 0x80 } else { 0x6B }]);
    let log = read(&half, |options| options.sniffer.fcs = "ti".parse().ok()).unwrap();
    assert!(log.notes[0].contains("15 with a wrong FCS"), "{}", log.notes[0]);
    // Values of no use: the frames count, and have no strengths. One frame had a wrong check sequence.
    let log = read(&ti, |options| options.sniffer.fcs = "none".parse().ok()).unwrap();
    assert_eq!(log.log.names(), right.log.names());
    assert!(log.log.receptions().iter().all(|at| at.rssi_dbm.is_none()));
    assert!(log.notes[0].contains("23 frames are packets"), "{}", log.notes[0]);
    // Frames that say themselves what stands at their end are read as they say.
    let tap = octets("tap.pcap");
    let usual = read(&tap, untouched).unwrap().log;
    assert_eq!(read(&tap, |options| options.sniffer.fcs = "ti".parse().ok()).unwrap().log, usual);
    let problem =
        read(&with_ends(|_, _| [0xF9, 0x6B]), |options| options.sniffer.fcs = "ti".parse().ok()).unwrap_err();
    assert!(problem.contains("the sniffer has another chip"), "{problem}");
}

#[test]
fn a_capture_with_any_wrong_octet_has_an_answer() {
    let folder = folder();
    let mut options = options();
    options.form.path = Some(folder.path().join("path.csv"));
    for name in ["tap.pcap", "mixed.pcapng"] {
        let whole = octets(name);
        let capture = folder.path().join(name);
        // Each third octet, and one bit after another.
        for at in (0..whole.len()).step_by(3) {
            let mut octets = whole.clone();
            octets[at] ^= 1 << (at % 8);
            std::fs::write(&capture, octets).unwrap();
            // An error or a log, but no panic.
            let _ = robot_log::read(&capture, &options);
        }
    }
}

#[test]
fn a_path_is_required_and_flags_must_fit() {
    let capture = kept("captures/tap.pcap");
    let stderr = map(&capture, &[]).refusal();
    assert!(stderr.contains("give its path with `--path FILE`"), "{stderr}");
    let folder = folder();
    let path = folder.path().join("path.csv").display().to_string();
    let stderr = map(&capture, &["--path", &path, "--packet-topic", "/radio"]).refusal();
    assert!(stderr.contains("`--packet-topic` is for ROS bags, but"), "{stderr}");
    // A path of another day.
    let problem = read(&octets("tap.pcap"), |options| {
        let path = options.form.path.as_ref().unwrap();
        std::fs::write(path, path_csv(START_NS).replace("\n17", "\n16")).unwrap();
    });
    assert!(problem.unwrap_err().contains("both need times of the same clock"));
}

#[test]
fn tshark_finds_the_same_senders_and_levels() {
    let Some(program) = tshark::tshark() else { return };
    for name in ["tap.pcap", "fcs.pcap", "mixed.pcapng"] {
        let fields = ["wpan.src16", "wpan.src64", "wlan.ta", "wpan-tap.rss", "radiotap.dbm_antsignal", "wpan.fcs_ok"];
        let rows = tshark::dissect(&program, Path::new(&kept("captures").join(name)), &fields);
        let mut expected = BTreeSet::new();
        let mut packets = 0;
        for row in &rows {
            let [short, extended, mac, tap, radiotap, is_right] = &row[..] else { panic!("{row:?}") };
            let node = [short, extended, mac].into_iter().find(|name| !name.is_empty());
            if let Some(node) = node.filter(|_| !["0", "False"].contains(&is_right.as_str())) {
                let level = [tap, radiotap].into_iter().find_map(|level| level.parse::<f64>().ok());
                packets += 1;
                expected.insert((node.clone(), level.map(|level| level.to_string())));
            }
        }
        let log = read(&octets(name), untouched).unwrap().log;
        let heard = log.receptions().iter().filter(|at| at.received > 0);
        let found: BTreeSet<_> = heard
            .clone()
            .map(|at| (log.names()[at.node.index()].clone(), at.rssi_dbm.map(|level| level.to_string())))
            .collect();
        assert_eq!(found, expected, "{name}");
        assert_eq!(heard.map(|at| at.received).sum::<u32>(), packets, "{name}");
    }
}
