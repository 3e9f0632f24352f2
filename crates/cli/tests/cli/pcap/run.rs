//! `sextant run --pcap`: the frames that it writes, and its output after an interrupt or a failure.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

use super::packet::{self, Packet};
#[cfg(unix)]
use crate::program::signal;
use crate::program::{Said, scenario, sextant};

/// Runs the smoke scenario in `folder`, with a capture `a.pcap`.
pub(crate) fn run(folder: &Path, words: &[&str]) -> Output {
    run_scenario("smoke.toml", folder, words)
}

/// Runs a scenario in `folder`, with a capture `a.pcap`.
pub(crate) fn run_scenario(name: &str, folder: &Path, words: &[&str]) -> Output {
    let mut command = sextant();
    command.current_dir(folder).arg("run").arg(scenario(name)).args(["--pcap", "a.pcap", "--format", "json"]);
    command.args(words).output().expect("it starts")
}

/// The capture of a run of the smoke scenario, and its summary.
fn captured(words: &[&str]) -> (Vec<u8>, Value) {
    let folder = TempDir::new().unwrap();
    let output = run(folder.path(), words);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(!folder.path().join("a.pcap.part").exists());
    (std::fs::read(folder.path().join("a.pcap")).unwrap(), serde_json::from_slice(&output.stdout).unwrap())
}

fn count(packets: &[Packet]) -> u64 {
    u64::try_from(packets.len()).unwrap()
}

#[test]
fn all_frames_are_captured_in_the_order_of_their_ends() {
    let (file, summary) = captured(&[]);
    let packets = packet::read(&file);
    // A frame that is still on air at the end of the run is not captured.
    let sent = summary["gathering"]["packets_sent"].as_u64().unwrap();
    assert!((sent..=sent + 3).contains(&count(&packets)), "{} packets of {sent}", packets.len());
    assert!(packets.iter().all(|packet| packet.has_good_fcs() && packet.mpdu.len() == 20));
    assert!(packets.iter().all(|packet| packet.rss_dbm().is_none() && packet.channel() == (11, 0)));
    assert!(packets.windows(2).all(|pair| pair[0].stamp_ns <= pair[1].stamp_ns));
    for packet in &packets {
        let (start, end) = packet.span_ns();
        // (6 + 20) octets of 32 us.
        assert_eq!((end - start, end), (832_000, packet.stamp_ns));
    }
    assert_eq!(captured(&["--threads", "2"]).0, file, "the same scenario gives the same octets");
}

#[test]
fn the_capture_of_the_shipped_superframes_has_the_beacons_that_begin_them() {
    let folder = TempDir::new().unwrap();
    run_scenario("mac/beacon-enabled.toml", folder.path(), &["--set", "maps=[]"]).printed();
    let packets = packet::read(&std::fs::read(folder.path().join("a.pcap")).unwrap());
    // The frame type is in the lowest three bits: 0 for beacons, 1 for data.
    let of_type = |kind: u8| packets.iter().filter(|packet| packet.mpdu[0] & 7 == kind).count();
    assert!(of_type(0) > 128 && of_type(1) > of_type(0), "{} beacons of {} frames", of_type(0), packets.len());
}

#[test]
fn a_robot_captures_received_frames_with_their_strength() {
    let words = ["--set", "recording.pcap.robot=surveyor", "--set", "recording.pcap.channel=15"];
    let (file, summary) = captured(&words);
    let packets = packet::read(&file);
    assert_eq!(Some(count(&packets)), summary["gathering"]["packets_received"].as_u64());
    for packet in &packets {
        let (rss, quality) = (packet.rss_dbm().unwrap(), packet.link_quality().unwrap());
        // Received frames are above the sensitivity; their quality grows with the strength up to -50 dBm.
        assert!((-90.0..0.0).contains(&rss), "{rss} dBm");
        assert!(
            (f32::from(quality) - (255.0 * (rss + 90.0) / 40.0).min(255.0)).abs() <= 0.51,
            "{rss} dBm: {quality}"
        );
        assert!(packet.has_good_fcs() && packet.channel() == (15, 0));
    }
}

#[test]
fn acknowledgements_of_robots_are_captured_too() {
    let acknowledged = [
        "--set",
        "traffic.query={ acknowledged = true, mpdu_octets = 20, at_s = 3.5 }",
        "--set",
        "channel.max_range_m=40",
        "--set",
        "robots.0.listen_s=30",
    ];
    let (file, summary) = captured(&acknowledged);
    let packets = packet::read(&file);
    let acknowledgements: Vec<_> = packets.iter().filter(|packet| packet.kind() == 2).collect();
    assert!(summary["gathering"]["packets_received"].as_u64().unwrap() > 5, "{summary:#}");
    assert!(acknowledgements.len() > 5);
    for ack in acknowledgements {
        // It starts 192 us after the end of the acknowledged frame.
        let (start, end) = ack.span_ns();
        assert_eq!((ack.mpdu.len(), end - start), (5, 352_000));
        assert!(ack.has_good_fcs());
        let answered = |frame: &Packet| frame.span_ns().1 + 192_000 == start && frame.sequence() == ack.sequence();
        assert!(packets.iter().any(answered), "nobody sent a frame {} before {start} ns", ack.sequence());
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_a_complete_capture() {
    let folder = TempDir::new().unwrap();
    let child = sextant()
        .current_dir(folder.path())
        .arg("run")
        .arg(scenario("smoke.toml"))
        .args(["--pcap", "a.pcap", "--set", "robots.0.listen_s=2000"])
        .spawn()
        .expect("it starts");
    std::thread::sleep(std::time::Duration::from_millis(700));
    signal(&child, "-INT");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", String::from_utf8_lossy(&output.stderr));
    let packets = packet::read(&std::fs::read(folder.path().join("a.pcap")).unwrap());
    assert!(packets.len() > 1000, "{} packets", packets.len());
    assert!(!folder.path().join("a.pcap.part").exists());
}

#[cfg(unix)]
#[test]
fn a_full_disk_is_an_error_and_the_frames_written_before_are_kept() {
    let folder = TempDir::new().unwrap();
    // A limit on the size of files has the effect of a full disk.
    let script = "trap '' XFSZ; ulimit -f 64; exec \"$0\" run \"$1\" --pcap a.pcap";
    let output = Command::new("bash")
        .args(["-c", script, env!("CARGO_BIN_EXE_sextant")])
        .arg(scenario("smoke.toml"))
        .current_dir(folder.path())
        .output()
        .expect("bash starts");
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{error}");
    assert!(error.contains("cannot write `a.pcap.part`") && error.contains("are kept"), "{error}");
    assert!(!folder.path().join("a.pcap").exists() && folder.path().join("a.pcap.part").exists());
}

#[test]
fn a_shared_output_an_invalid_channel_and_an_unknown_robot_are_rejected() {
    for (words, expected) in [
        (&["--out", "./a.pcap"][..], "are the same file"),
        (&["--summary", "a.pcap"], "are the same file"),
        (&["--set", "recording.pcap.channel=10"], "11 to 26"),
        (&["--set", "recording.pcap.robot=nobody"], "the name of a robot"),
    ] {
        let folder = TempDir::new().unwrap();
        let error = run(folder.path(), words).refusal();
        assert!(error.contains(expected), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "{words:?} leaves nothing behind");
    }
}
