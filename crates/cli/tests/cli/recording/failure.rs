//! A failing disk is reported, also by all later calls.

use std::path::Path;

use sextant_recording::{FileRecorder, Recorder, RecordingError};

use super::sample;
use crate::failing_disk::FailingDisk;

#[test]
fn every_later_call_returns_the_first_write_error() {
    let log = sample::log(1, 5, 200);
    for room in [40, 300, 3_000, 10_000] {
        let mut recorder = Recorder::new(FailingDisk::new(room), Path::new("run.mcap")).unwrap();
        let first = sample::record_all(&mut recorder, &log).unwrap_err();
        assert!(first.to_string().contains("no space left"), "{first}");
        assert!(first.is_system_error());
        assert_eq!(recorder.metric(log.stops()[0].time, "x_m", 1.0), Err(first.clone()));
        assert_eq!(recorder.summary("{}"), Err(first.clone()));
        assert_eq!(recorder.into_output().err(), Some(first));
    }
}

#[test]
fn a_writer_without_space_for_the_header_fails_at_once() {
    let disk = FailingDisk::new(3);
    assert!(matches!(Recorder::new(disk, Path::new("run.mcap")), Err(RecordingError::Write { .. })));
}

#[test]
fn an_error_in_the_summary_section_is_not_lost() {
    let log = sample::log(1, 2, 3);
    let mut whole = Vec::new();
    let mut recorder = Recorder::new(&mut whole, Path::new("run.mcap")).unwrap();
    recorder.log(&log).unwrap();
    recorder.into_output().unwrap();
    // Each write of the summary section is small, and the footer is the last one.
    for missing in [1, 100, 500] {
        let disk = FailingDisk::new(whole.len() - missing);
        let mut recorder = Recorder::new(disk, Path::new("run.mcap")).unwrap();
        recorder.log(&log).unwrap();
        assert!(matches!(recorder.into_output(), Err(RecordingError::Write { .. })), "{missing} octets short");
    }
}

/// Writes to `/dev/full` fail like writes to a full disk.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_only_the_part_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let part = folder.path().join("run.mcap.part");
    std::os::unix::fs::symlink("/dev/full", &part).unwrap();
    let mut recorder = FileRecorder::create(&path).unwrap();
    let recorded = recorder.log(&sample::log(1, 5, 200));
    let finished = recorder.finish();
    assert!(matches!(recorded, Err(RecordingError::Write { .. })));
    assert_eq!(finished, recorded);
    assert!(part.is_symlink() && !path.exists());
}

#[test]
fn a_recording_in_a_missing_folder_or_over_a_folder_is_rejected_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing").join("run.mcap");
    let error = FileRecorder::create(&missing).err().unwrap();
    assert!(
        matches!(&error, RecordingError::Create { path, .. } if path.starts_with(missing.parent().unwrap())),
        "{error}"
    );
    assert!(error.is_system_error());
    assert!(matches!(FileRecorder::create(folder.path()), Err(RecordingError::Create { .. })));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
