//! A failing disk is reported, also by all later calls.

use std::path::Path;
use std::time::Duration;

use sextant_kernel::SimTime;
use sextant_recording::{Capture, CapturedFrame, FileCapture, RecordingError, Technologies};

use crate::failing_disk::FailingDisk;

const FRAME: CapturedFrame<'_> = CapturedFrame {
    start: SimTime::ZERO,
    airtime: Duration::from_micros(352),
    mpdu: &[0x02, 0x00, 0x05, 0x15, 0xE2],
    channel: 11,
    page: 0,
    signal: None,
};

#[test]
fn every_later_call_returns_the_first_write_error() {
    let mut capture = Capture::new(FailingDisk::new(150), Path::new("a.pcap"), Technologies::Ieee802154).unwrap();
    assert_eq!(capture.frame(&FRAME), Ok(()));
    let first = capture.frame(&FRAME).unwrap_err();
    assert!(matches!(&first, RecordingError::WriteCapture { why, .. } if why == "no space left"), "{first}");
    assert!(first.is_system_error());
    assert_eq!(capture.frame(&FRAME), Err(first.clone()));
    assert_eq!(capture.into_output().err(), Some(first));
    assert!(Capture::new(FailingDisk::new(23), Path::new("a.pcap"), Technologies::Ieee802154).is_err());
}

/// Writes to `/dev/full` fail like writes to a full disk.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_only_the_part_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.pcap");
    let part = folder.path().join("a.pcap.part");
    std::os::unix::fs::symlink("/dev/full", &part).unwrap();
    let mut capture = FileCapture::create(&path, Technologies::Ieee802154).unwrap();
    capture.frame(&FRAME).expect("buffered");
    assert!(matches!(capture.finish(), Err(RecordingError::WriteCapture { .. })));
    assert!(part.is_symlink() && !path.exists());
}

#[test]
fn a_file_gets_its_final_name_when_it_is_complete() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.pcap");
    let mut capture = FileCapture::create(&path, Technologies::Ieee802154).unwrap();
    capture.frame(&FRAME).unwrap();
    assert!(!path.exists() && folder.path().join("a.pcap.part").exists());
    capture.finish().unwrap();
    assert!(path.exists() && !folder.path().join("a.pcap.part").exists());
}
