//! A disk that fails is reported, once and for all.

use std::path::Path;

use sextant::recording::{FileRecorder, Recorder, RecordingError};

use super::sample;
use crate::failing_disk::FailingDisk;

#[test]
fn the_first_write_error_answers_every_later_call() {
    let log = sample::log(1, 5, 200);
    for room in [40, 300, 3_000, 10_000] {
        let mut recorder = Recorder::new(FailingDisk::new(room), Path::new("run.mcap")).unwrap();
        let first = sample::record_all(&mut recorder, &log).unwrap_err();
        assert!(first.to_string().contains("no room for it"), "{first}");
        assert!(first.is_of_the_system());
        assert_eq!(recorder.metric(log.stops()[0].time, "x_m", 1.0), Err(first.clone()));
        assert_eq!(recorder.summary("{}"), Err(first.clone()));
        assert_eq!(recorder.into_output().err(), Some(first));
    }
}

#[test]
fn a_writer_without_room_for_the_header_fails_at_once() {
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
    // Each write of the summary section is small; the footer is the last.
    for missing in [1, 100, 500] {
        let disk = FailingDisk::new(whole.len() - missing);
        let mut recorder = Recorder::new(disk, Path::new("run.mcap")).unwrap();
        recorder.log(&log).unwrap();
        assert!(matches!(recorder.into_output(), Err(RecordingError::Write { .. })), "{missing} octets short");
    }
}

/// `/dev/full` answers every write as a full disk does.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_the_part_file_and_no_recording() {
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
fn a_recording_in_a_missing_folder_or_over_a_folder_is_refused_before_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing").join("run.mcap");
    let error = FileRecorder::create(&missing).err().unwrap();
    assert!(
        matches!(&error, RecordingError::Create { path, .. } if path.starts_with(missing.parent().unwrap())),
        "{error}"
    );
    assert!(error.is_of_the_system());
    assert!(matches!(FileRecorder::create(folder.path()), Err(RecordingError::Create { .. })));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
