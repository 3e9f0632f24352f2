//! Recordings are read back equal.

use std::path::PathBuf;

use sextant_channel::{Anchor, EvenSectorsConfig, Position, SectorConfig, SectorTable};
use sextant_kernel::NodeId;
use sextant_recording::{
    FileRecorder, ORIGIN_METADATA, SCENARIO_ATTACHMENT, SUMMARY_ATTACHMENT, inspect, read_known, read_log, read_truth,
};

use super::sample;

#[test]
fn a_reception_log_is_read_back_equal_with_its_unheard_nodes() {
    let folder = tempfile::tempdir().unwrap();
    for (nodes, stops) in [(1, 1), (2, 40), (9, 333)] {
        let path = folder.path().join("run.mcap");
        let log = sample::log(7, nodes, stops);
        sample::record_file(&path, &log);
        let run = read_log(&path).unwrap();
        assert_eq!(run.log(), &log);
        assert_eq!(run.missing_stops, 0);
        assert_eq!(run.metadata[ORIGIN_METADATA]["seed"], "42");
        assert_eq!(run.metadata[ORIGIN_METADATA]["version"], "1.2.3");
        let names: Vec<&str> = run.attachments.iter().map(|attachment| attachment.name.as_str()).collect();
        assert_eq!(names, [SCENARIO_ATTACHMENT, SUMMARY_ATTACHMENT]);
        assert_eq!(run.attachment(SCENARIO_ATTACHMENT).unwrap().data, b"name = \"sample\"\n");
        assert_eq!(run.attachment("other"), None);
    }
}

#[test]
fn what_nodes_know_of_each_other_is_read_back_equal() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    sample::record_file(&path, &sample::log(8, 5, 3));
    let known = read_known(&path, 5).unwrap();
    assert_eq!((&known.neighbours, &known.beacons), (&Some(sample::links(5)), &Some(sample::links(5))));
    let anchor = Anchor { node: NodeId(0), position: Position::new(7.0, 8.0, 9.0) };
    assert_eq!(known.anchors, [anchor]);
    let error = read_known(&path, 4).unwrap_err().to_string();
    assert!(error.contains("node 4") && error.contains("/neighbours"), "{error}");
}

#[test]
fn true_positions_are_read_separately_from_the_log() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let log = sample::log(8, 5, 3);
    sample::record_file(&path, &log);
    let truth = read_truth(&path).unwrap().unwrap();
    assert_eq!(truth.len(), 5);
    for placed in sample::truth(&log) {
        assert_eq!(truth[&log.names()[placed.node.index()]], placed.position);
    }

    let without = folder.path().join("without.mcap");
    let mut recorder = FileRecorder::create(&without).unwrap();
    recorder.log(&log).unwrap();
    recorder.finish().unwrap();
    assert_eq!(read_truth(&without).unwrap(), None);
    assert_eq!(read_log(&without).unwrap().log(), &log);
}

#[test]
fn equal_runs_give_equal_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let log = sample::log(9, 8, 200);
    let bytes: Vec<Vec<u8>> = ["a.mcap", "b.mcap"]
        .map(|name| {
            let path = folder.path().join(name);
            sample::record_file(&path, &log);
            std::fs::read(path).unwrap()
        })
        .into();
    assert_eq!(bytes[0], bytes[1]);
    let other = folder.path().join("c.mcap");
    sample::record_file(&other, &sample::log(10, 8, 200));
    assert_ne!(std::fs::read(other).unwrap(), bytes[0]);
}

#[test]
fn a_recording_gets_its_final_name_when_it_is_complete() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let part = PathBuf::from(format!("{}.part", path.display()));
    let mut recorder = FileRecorder::create(&path).unwrap();
    recorder.log(&sample::log(1, 3, 3)).unwrap();
    assert!(part.exists() && !path.exists());
    recorder.finish().unwrap();
    assert!(!part.exists() && path.exists());
}

#[test]
fn an_inspection_counts_messages_by_topic() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let log = sample::log(3, 6, 100);
    sample::record_file(&path, &log);
    let inspection = inspect(&path).unwrap();
    let count = |topic: &str| inspection.topics.iter().find(|t| t.topic == topic).map(|t| t.messages);
    assert_eq!(count("/stops"), Some(100));
    assert_eq!(count("/receptions"), Some(log.receptions().len() as u64));
    assert_eq!(count("/robot/surveyor/contacts"), Some(13));
    assert_eq!(count("/robot/scout/contacts"), Some(7));
    assert_eq!(inspection.topics.len(), 31);
    assert_eq!(inspection.messages, inspection.topics.iter().map(|topic| topic.messages).sum::<u64>());
    assert_eq!(inspection.damage, None);
    assert_eq!(inspection.start_s, Some(0.0));
    let last = log.stops()[99].time.as_secs_f64();
    assert!((inspection.end_s.unwrap() - last).abs() < 1e-9);
    assert_eq!(inspection.attachments.len(), 2);
    let text = inspection.to_string();
    assert!(text.starts_with("complete, ") && text.contains("sextant.Reception"), "{text}");
}

#[test]
fn two_robots_share_one_numbering_of_stops() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let log = sample::log(4, 4, 10);
    assert_eq!(log.robot_count(), 2);
    let mut recorder = FileRecorder::create(&path).unwrap();
    recorder.nodes(log.names()).unwrap();
    for (index, stop) in (0..).zip(log.stops()) {
        let here: Vec<_> = log.receptions().iter().filter(|r| r.stop == index).collect();
        recorder.stop(None, &log.robot_name(stop.robot), index, stop, &here).unwrap();
    }
    log.contacts().iter().for_each(|contact| recorder.contact(&log.robot_name(contact.robot), contact).unwrap());
    recorder.finish().unwrap();
    assert_eq!(read_log(&path).unwrap().log(), &log);
}

#[test]
fn the_directions_of_sectors_are_read_back_equal() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    // Four rings of 64 sectors: angles without a short binary form, and every identity.
    let elevations_deg = vec![[-90.0, -30.1], [-30.1, 0.2], [0.2, 30.3], [30.3, 90.0]];
    let even = EvenSectorsConfig { azimuth_sectors: 64, first_azimuth_deg: 0.1, elevations_deg };
    let sectors = SectorTable::try_from(even).unwrap();
    let log = sample::log(11, 5, 40).with_sectors(sectors).unwrap();
    let mut recorder = FileRecorder::create(&path).unwrap();
    recorder.log(&log).unwrap();
    recorder.finish().unwrap();
    let read = read_log(&path).unwrap();
    assert_eq!(read.logs, log.into());
}

#[test]
fn a_sector_that_occurs_twice_or_is_missing_is_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let one = |sector| SectorConfig {
        sector,
        azimuth_from_deg: 350.0,
        azimuth_to_deg: 10.0,
        elevation_from_deg: -90.0,
        elevation_to_deg: 90.0,
    };
    let record = |times: usize| {
        let mut recorder = FileRecorder::create(&path).unwrap();
        let table = SectorTable::new([one(3)]).unwrap();
        (0..times).for_each(|_| recorder.sectors(None, &table).unwrap());
        recorder.log(&sample::log(12, 5, 40)).unwrap();
        recorder.finish().unwrap();
        read_log(&path).unwrap_err().to_string()
    };
    let twice = record(2);
    assert!(twice.contains("/sectors") && twice.contains('3'), "{twice}");
    let missing = record(1);
    assert!(missing.contains("sector"), "{missing}");
}
