//! Wireshark decodes every frame, and finds every check sequence correct.

use std::io::Write;
use std::process::Command;

use super::packet;
use super::run::{run, run_scenario};
use crate::program::Said;

/// Environment variable with the name of the program tshark. If it is set, tshark must exist.
const VARIABLE: &str = "SEXTANT_TSHARK";

/// The program, if it exists. If the variable names it, it must exist.
pub(crate) fn tshark() -> Option<String> {
    let program = std::env::var(VARIABLE).unwrap_or_else(|_| "tshark".to_owned());
    let is_there = Command::new(&program).arg("--version").output().is_ok_and(|output| output.status.success());
    if is_there {
        return Some(program);
    }
    assert!(std::env::var_os(VARIABLE).is_none(), "`{program}` does not start, but {VARIABLE} names it");
    // The test harness does not capture this, so a skipped check is visible.
    let _ = writeln!(std::io::stderr(), "skipped: tshark is not installed; set {VARIABLE} to its program");
    None
}

/// Values of `fields` of every packet of the capture.
pub(crate) fn dissect(program: &str, file: &std::path::Path, fields: &[&str]) -> Vec<Vec<String>> {
    let mut command = Command::new(program);
    // The FCS of IEEE 802.11 is checked on request only.
    command.arg("-r").arg(file).args(["-T", "fields", "-o", "wlan.check_checksum:TRUE"]);
    for field in fields {
        command.args(["-e", field]);
    }
    let text = command.output().unwrap().printed();
    text.lines().map(|line| line.split('\t').map(str::to_owned).collect()).collect()
}

/// Checks for the smoke run with `words` that tshark reads the same as our own parser.
fn agrees(words: &[&str]) {
    let Some(program) = tshark() else { return };
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), words).printed();
    let file = folder.path().join("a.pcap");
    let packets = packet::read(&std::fs::read(&file).unwrap());
    let fields = [
        "wpan.fcs_ok",
        "wpan.seq_no",
        "wpan-tap.rss",
        "wpan-tap.ch_num",
        "wpan-tap.lqi",
        "wpan.frame_type",
        "_ws.malformed",
        "frame.time_epoch",
    ];
    let rows = dissect(&program, &file, &fields);
    assert_eq!(rows.len(), packets.len());
    assert!(packets.len() > 20, "{} packets", packets.len());
    for (row, packet) in rows.iter().zip(&packets) {
        let [fcs_ok, sequence, rss, channel, lqi, kind, malformed, epoch] = &row[..] else { panic!("{row:?}") };
        assert!(matches!(fcs_ok.as_str(), "1" | "True"), "{row:?}");
        assert_eq!(sequence.parse(), Ok(packet.sequence()));
        assert_eq!(u64::from_str_radix(kind.trim_start_matches("0x"), 16), Ok(u64::from(packet.kind())));
        assert_eq!(channel.parse(), Ok(packet.channel().0));
        assert_eq!(lqi.parse().ok(), packet.link_quality());
        match packet.rss_dbm() {
            None => assert_eq!(rss, ""),
            Some(dbm) => {
                let found: f32 = rss.parse().unwrap();
                assert!((found - dbm).abs() <= 0.01, "{found} dBm, not {dbm}");
            }
        }
        assert_eq!(malformed, "");
        let (seconds, fraction) = epoch.split_once('.').unwrap();
        let nanos = 1_000_000_000 * seconds.parse::<u64>().unwrap() + fraction.parse::<u64>().unwrap();
        assert_eq!((fraction.len(), nanos), (9, packet.stamp_ns));
    }
}

#[test]
fn tshark_decodes_the_frames_that_a_robot_receives() {
    agrees(&["--set", "recording.pcap.robot=surveyor", "--set", "recording.pcap.channel=26"]);
}

#[test]
fn tshark_decodes_all_frames_and_acknowledgements() {
    agrees(&[
        "--set",
        "traffic.query={ acknowledged = true, mpdu_octets = 20, at_s = 3.5 }",
        "--set",
        "channel.max_range_m=40",
        "--set",
        "robots.0.listen_s=30",
    ]);
}

#[test]
fn tshark_decodes_beacons_and_their_superframes() {
    let Some(program) = tshark() else { return };
    let folder = tempfile::tempdir().unwrap();
    let words = ["--set", "maps=[]"];
    run_scenario("mac/beacon-enabled.toml", folder.path(), &words).printed();
    let fields = [
        "wpan.frame_type",
        "wpan.fcs_ok",
        "_ws.malformed",
        "wpan.beacon_order",
        "wpan.superframe_order",
        "wpan.cap",
        "wpan.bcn_coord",
        "wpan.gts.count",
        "frame.time_epoch",
    ];
    let rows = dissect(&program, &folder.path().join("a.pcap"), &fields);
    let is_beacon = |row: &&Vec<String>| row[0] == "0x0000" || row[0] == "0x00" || row[0] == "0";
    assert!(rows.iter().all(|row| row[1] != "0" && row[1] != "False" && row[2].is_empty()));
    let beacons: Vec<_> = rows.iter().filter(is_beacon).collect();
    assert!(beacons.len() > 128 && rows.len() > 2 * beacons.len(), "{} beacons of {}", beacons.len(), rows.len());
    for beacon in &beacons {
        assert_eq!((beacon[3].as_str(), beacon[4].as_str(), beacon[5].as_str()), ("4", "2", "13"), "{beacon:?}");
        assert!(matches!(beacon[6].as_str(), "1" | "True") && beacon[7] == "2", "{beacon:?}");
    }
    // Beacons are sent every 245.76 ms, also while the robot drives.
    let micros = |row: &Vec<String>| {
        let (seconds, fraction) = row[8].split_once('.').unwrap();
        1_000_000 * seconds.parse::<u64>().unwrap() + fraction.parse::<u64>().unwrap() / 1000
    };
    let first = micros(beacons[0]);
    assert!(beacons.iter().all(|beacon| (micros(beacon) - first) % 245_760 == 0));
}
