//! Files that are no log: each command says what they are and what helps, and nothing is called a recording of `run` but one.

#![expect(clippy::unwrap_used, reason = "a test fails at the first error")]

use std::path::Path;
use std::process::Output;

use super::drive::kept;
use super::program::{Said, folder, sextant};

/// Runs the program.
fn run(words: &[&str]) -> Output {
    sextant().args(words).output().unwrap()
}

/// A pcap file with this magic number and link type, and these frames, a second apart.
fn pcap(magic: [u8; 4], link: u8, frames: &[&[u8]]) -> Vec<u8> {
    let mut octets = [&magic[..], &[2, 0, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 255, 255, 0, 0, link, 0, 0, 0]].concat();
    for (second, frame) in (1_700_000_000_u32..).zip(frames) {
        let length = u32::try_from(frame.len()).unwrap().to_le_bytes();
        octets.extend([&second.to_le_bytes()[..], &[0; 4], &length, &length, frame].concat());
    }
    octets
}

const MICROSECONDS: [u8; 4] = [0xD4, 0xC3, 0xB2, 0xA1];
const ETHERNET: u8 = 1;
const WITHOUT_FCS: u8 = 230;

#[test]
fn files_that_are_no_log_are_told_by_all_commands_that_read_logs() {
    let folder = tempfile::tempdir().unwrap();
    let modified = pcap([0x34, 0xCD, 0xB2, 0xA1], 195, &[]);
    for (name, octets, expected) in [
        ("sniff.pcap.gz", &b"\x1f\x8b\x08\0\0\0\0\0"[..], "is compressed with gzip; unpack it: `gunzip -k"),
        ("sniff.pcap", &modified, "is a modified pcap capture (magic number a1b2cd34); make a plain capture"),
        (
            "walk.csv",
            b"version https://git-lfs.github.com/spec/v1\noid sha256:1\nsize 3\n",
            "is a pointer of Git LFS",
        ),
        (
            "zigbee.dcf",
            b"#Format=4\r\n# SNA v2.2.0.4 SUS:20090709 ACT:819705\r\n1 0 5 01 2\r\n",
            "is a capture of a Daintree SNA",
        ),
        (
            "a.datalog",
            b"\x01\x02\x03\x04\xff\xfe",
            "is neither the log of a robot nor a recording of `run`, but binary data that begin with the octets 01 02 03 04 ff fe",
        ),
        ("readme.md", b"# A survey\nof our house\n", "but a text that begins with `# A survey`"),
        ("empty.csv", b"", "is empty; record or copy it again"),
        ("page.csv", b"<!DOCTYPE html>\n<html></html>\n", "is a web page"),
        (
            "table.xlsx",
            b"PK\x03\x04\x14\0\0\0[Content_Types].xml xl/workbook.xml",
            "is a table of a spreadsheet program",
        ),
        ("table.parquet", b"PAR1\x15\0", "is a Parquet table"),
        (
            "walk.kml",
            b"<?xml version=\"1.0\"?><kml xmlns=\"http://www.opengis.net/kml/2.2\"/>",
            "is a track of Google Earth",
        ),
        (
            "map.geojson",
            b"{\"type\": \"FeatureCollection\", \"features\": []}",
            "is GeoJSON, which has places without times",
        ),
        ("notes.json", b"{\"a\": 1}", "is JSON"),
        ("utf16.csv", b"\xff\xfes\0t\0o\0p\0", "is text in UTF-16; save it as UTF-8"),
    ] {
        let file = folder.path().join(name).display().to_string();
        std::fs::write(&file, octets).unwrap();
        // Flags for logs of robots do not make a recording of it.
        for words in [
            &["map", &file][..],
            &["inspect", &file],
            &["map", &file, "--pan", "0xabcd"],
            &["map", &file, "--tiles", "2"],
        ] {
            let stderr = run(words).refusal();
            assert!(stderr.contains(expected), "{words:?}: {stderr}\nshould say: {expected}");
            assert!(
                !stderr.contains("is a recording of `run`") && !stderr.contains("MCAP file"),
                "{words:?}: {stderr}"
            );
        }
    }
}

#[test]
fn empty_recordings_and_tables_without_rows_are_told_by_all_commands() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    std::fs::write(path("z.mcap"), "").unwrap();
    std::fs::write(path("t.csv"), "cell,replicate,seed,map,error,sweep\n").unwrap();
    let (good, out) = (path("good.mcap"), path("out"));
    for (words, why) in [
        (["inspect", &path("z.mcap"), "--threads", "1"], "is empty"),
        (["figure", &path("z.mcap"), "--out", &out], "is empty"),
        (["export", &path("z.mcap"), "--out", &out], "is empty"),
        (["recover", &path("z.mcap"), "--out", &good], "is empty"),
        (["figure", &path("t.csv"), "--out", &out], "has no rows"),
        (["report", &path("t.csv"), "--out", &path("t.html")], "has no rows"),
    ] {
        let (code, _, message) = run(&words).all();
        assert!(code == 2 && message.contains(why), "{words:?}: {code}: {message}");
    }
    let files = std::fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(files, 2, "nothing is written");
}

#[test]
fn parts_of_logs_and_true_positions_that_are_other_files_are_told_too() {
    let folder = folder(&[
        ("path.csv", "t_s,x_m,y_m\n0,0,0\n9,9,0\n"),
        ("packets.csv", "t_s,node,rssi_dbm\n1,lamp,-50\n5,lamp,-60\n"),
    ]);
    let pages = self::folder(&[
        ("page.html", "<html><body>not found</body></html>"),
        ("walk.gpx", "<!doctype html><title>sign in</title>"),
    ]);
    let file = |name: &str| folder.path().join(name).display().to_string();
    let page = |name: &str| pages.path().join(name).display().to_string();
    let (log, page, gpx) = (folder.path().display().to_string(), page("page.html"), page("walk.gpx"));
    for words in [
        &["map", &log, "--truth", &page][..],
        &["map", &log, "--path", &page],
        &["map", &log, "--packets", &page],
        &["map", &log, "--names", &page],
        &["map", &log, "--path", &gpx],
        &["map", &file("packets.csv"), "--path", &gpx],
    ] {
        let stderr = run(words).refusal();
        assert!(stderr.contains("is a web page"), "{words:?}: {stderr}");
    }
    // Commands for recordings say the same.
    let (tables, copy, pictures) = (file("tables"), file("copy.mcap"), file("pictures"));
    for words in [
        &["export", &page, "--out", &tables][..],
        &["recover", &page, "--out", &copy],
        &["figure", &page, "--out", &pictures],
    ] {
        let stderr = run(words).refusal();
        assert!(stderr.contains("is not an MCAP file, but a web page"), "{words:?}: {stderr}");
    }
}

#[test]
fn a_file_of_another_program_in_mcap_is_no_recording_of_run() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("other.mcap");
    let mut writer = mcap::Writer::new(std::fs::File::create(&file).unwrap()).unwrap();
    let channel = writer.add_channel(0, "/chatter", "json", &std::collections::BTreeMap::new()).unwrap();
    let header = mcap::records::MessageHeader { channel_id: channel, sequence: 0, log_time: 1, publish_time: 1 };
    writer.write_to_known_channel(&header, b"{}").unwrap();
    writer.finish().unwrap();
    let file = file.display().to_string();
    let stderr = run(&["map", &file]).refusal();
    assert!(stderr.contains("has no reception log") && stderr.contains("/chatter"), "{stderr}");
    let stderr = run(&["map", &file, "--skip-no-fix"]).refusal();
    assert!(stderr.contains("is an MCAP file that is no ROS bag"), "{stderr}");
    assert!(!stderr.contains("recording of `run`"), "{stderr}");
}

#[test]
fn a_capture_of_a_network_of_cables_does_not_ask_for_a_path() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("cable.pcap");
    std::fs::write(&file, pcap(MICROSECONDS, ETHERNET, &[&[0; 60], &[0; 60]])).unwrap();
    let file = file.display().to_string();
    let stderr = run(&["map", &file]).refusal();
    assert!(
        stderr.contains("has frames of link type 1 (Ethernet), which do not say which node was heard"),
        "{stderr}"
    );
    let stdout = run(&["inspect", &file]).printed();
    assert!(
        stdout.contains("a capture of 2 frames") && stdout.contains("link type 1 (Ethernet): 2 frames"),
        "{stdout}"
    );
    assert!(stdout.contains("it cannot be mapped as it is") && !stdout.contains("--path"), "{stdout}");
}

#[test]
fn a_capture_without_a_path_has_contents() {
    // Data from 0x0001, 0x0001 and 0x0002 in PAN 0xabcd, and an acknowledgement.
    let data = |from: u8| [0x41, 0x88, 0x07, 0xCD, 0xAB, 0x00, 0x00, from, 0x00, 0x55];
    let octets = pcap(MICROSECONDS, WITHOUT_FCS, &[&data(1), &data(1), &data(2), &[0x02, 0x00, 0x6A]]);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("sniff.pcap");
    std::fs::write(&file, octets).unwrap();
    let file = file.display().to_string();
    let stdout = run(&["inspect", &file]).printed();
    for expected in [
        "a capture of 4 frames from 2023-11-14T22:13:20Z to 2023-11-14T22:13:23Z",
        "link type 230 (IEEE 802.15.4 without FCS): 4 frames",
        "of no node: 1 without a source address",
        "2 nodes heard:",
        "give its path with `--path FILE`",
    ] {
        assert!(stdout.contains(expected), "{stdout}\nshould say: {expected}");
    }
    let stdout = run(&["inspect", &file, "--format", "json"]).printed();
    let json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    let senders = json["capture"]["senders"].as_array().unwrap();
    let found: Vec<_> =
        senders.iter().map(|at| (at["node"].as_str().unwrap(), at["frames"].as_u64().unwrap())).collect();
    assert_eq!(found, [("0x0001", 2), ("0x0002", 1)]);
    let stdout = run(&["inspect", &kept("captures/tap.pcap").display().to_string()]).printed();
    assert!(stdout.contains("dBm") && stdout.contains("283 (IEEE 802.15.4 TAP)"), "{stdout}");
}

#[test]
fn ranges_are_not_taken_for_packets() {
    let files = [
        ("path.csv", "t_s,x_m,y_m\n0,0,0\n9,9,0\n"),
        ("ranges.csv", "t_s,node,range_m\n1,5,65.4\n2,5,66.1\n"),
        ("nodes.csv", "node,x_m,y_m\n5,1,1\n"),
    ];
    // By its name, or by its columns, whatever its name is.
    for folder in [folder(&files), folder(&[files[0], ("uwb.csv", files[1].1)])] {
        let stdout = run(&["inspect", &folder.path().display().to_string()]).printed();
        assert!(stdout.contains("2 ranges to 1 node"), "{stdout}");
    }
    // Ranges alone are no log: they need places.
    let lonely = folder(&[files[1]]);
    let (code, _, stderr) = run(&["map", &lonely.path().display().to_string()]).all();
    assert!(code == 2 && stderr.contains("path=FILE") || stderr.contains("--path"), "{stderr}");
    // A log with packets has both.
    let whole = folder(&[files[0], files[1], ("packets.csv", "t_s,node,rssi_dbm\n1,lamp,-50\n5,lamp,-60\n")]);
    let stdout = run(&["inspect", &whole.path().display().to_string()]).printed();
    assert!(stdout.contains("2 ranges to 1 node") && stdout.contains("2 named, 1 heard"), "{stdout}");
}

#[test]
fn a_folder_without_a_log_says_what_it_has() {
    let folder = folder(&[("walk.gpx.gz", "\u{1f}"), ("photo.jpg", "x")]);
    let stderr = run(&["map", &folder.path().display().to_string()]).refusal();
    assert!(stderr.contains("has no log") && stderr.contains("its other files: photo.jpg, walk.gpx.gz"), "{stderr}");
    let missing = Path::new("/nonexistent/log").display().to_string();
    let stderr = run(&["map", &missing]).refusal();
    assert!(stderr.contains("cannot read"), "{stderr}");
}
