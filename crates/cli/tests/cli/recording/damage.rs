//! Damaged recordings are recovered, and other files are rejected.

use std::path::{Path, PathBuf};

use sextant_channel::{Reception, ReceptionLog, Stop};
use sextant_kernel::Unwatched;
use sextant_recording::mcap_file::McapFileError;
use sextant_recording::{FileRecorder, RecordingError, TablePiece, inspect, read_log, read_tables, recover};
use tempfile::TempDir;

use super::sample::{self, Numbers};

/// A recording in a temporary folder: the folder, its path, its octets.
fn recorded(log: &ReceptionLog) -> (TempDir, PathBuf, Vec<u8>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("whole.mcap");
    sample::record_file(&path, log);
    let octets = std::fs::read(&path).unwrap();
    (folder, path, octets)
}

/// Checks that the log in `path` is the beginning of `log`; returns its number of stops.
fn assert_prefix(path: &Path, log: &ReceptionLog) -> usize {
    let found = match read_log(path) {
        Ok(run) => run.logs.first().clone(),
        Err(RecordingError::NoLog { .. }) => return 0,
        Err(other) => panic!("{other}"),
    };
    let stops = found.stops().len();
    assert_eq!(found.names(), log.names());
    assert_eq!(found.stops(), &log.stops()[..stops]);
    let expected: Vec<_> = log.receptions().iter().filter(|r| (r.stop as usize) < stops).collect();
    assert_eq!(found.receptions(), expected);
    assert!(log.contacts().starts_with(found.contacts()));
    stops
}

#[test]
fn everything_before_a_cut_is_recovered() {
    let log = sample::log(5, 7, 300);
    let (folder, _, octets) = recorded(&log);
    let (broken, good) = (folder.path().join("broken.mcap"), folder.path().join("good.mcap"));
    let mut numbers = Numbers(1);
    let mut lengths: Vec<usize> =
        (0..200).map(|_| usize::try_from(numbers.below(octets.len() as u64)).unwrap().max(1)).collect();
    lengths.extend([1, 7, 8, 9, octets.len() - 1]);
    lengths.sort_unstable();
    let mut before = 0;
    for length in lengths {
        std::fs::write(&broken, &octets[..length]).unwrap();
        let recovery = recover(&broken, &good, &Unwatched).unwrap();
        assert!(recovery.damage.is_some(), "cut to {length} octets");
        let inspection = inspect(&good).unwrap();
        assert_eq!(inspection.damage, None);
        assert_eq!(inspection.messages, recovery.messages);
        assert!(inspection.metadata.contains_key("recovered"));
        if let Ok(read) = read_log(&good) {
            assert!(read.concern().is_some_and(|concern| concern.contains("was damaged at byte")), "{length}");
        }
        let stops = assert_prefix(&good, &log);
        assert!(stops >= before, "a longer file has at least as many stops");
        before = stops;
        assert_eq!(inspect(&broken).unwrap().damage, recovery.damage);
        assert!(matches!(read_log(&broken), Err(RecordingError::Broken { .. })));
    }
    assert_eq!(before, 300);
}

#[test]
fn a_crash_loses_at_most_the_stops_of_one_chunk() {
    let log = sample::log(6, 4, 300);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let part = folder.path().join("run.mcap.part");
    let mut recorder = FileRecorder::create(&path).unwrap();
    recorder.log(&log).unwrap();
    // No destructor runs, as in a killed process.
    std::mem::forget(recorder);
    let good = folder.path().join("good.mcap");
    let recovery = recover(&part, &good, &Unwatched).unwrap();
    assert!(recovery.damage.is_some());
    let stops = assert_prefix(&good, &log);
    assert!(stops >= 300 - 32, "{stops} of 300 stops");
}

/// Checks that the log in `path` has some of the stops of `log`, each with all its receptions; returns their number.
fn assert_part(path: &Path, log: &ReceptionLog) -> usize {
    let found = read_log(path).unwrap().logs.first().clone();
    let place = |stop: &Stop| log.stops().iter().position(|other| other == stop).expect("a stop of the log");
    let places: Vec<usize> = found.stops().iter().map(place).collect();
    assert!(places.is_sorted());
    let of_stop = |log: &ReceptionLog, stop: usize| -> Vec<_> {
        let receptions = log.receptions().into_iter().filter(|r| r.stop as usize == stop);
        receptions.map(|reception| Reception { stop: 0, ..reception }).collect()
    };
    for (stop, place) in places.into_iter().enumerate() {
        assert_eq!(of_stop(&found, stop), of_stop(log, place), "stop {place}");
    }
    found.stops().len()
}

/// The places of the chunks in a recording: where each begins and ends.
fn chunks(octets: &[u8]) -> Vec<std::ops::Range<usize>> {
    let mut at = mcap::MAGIC.len();
    let mut chunks = Vec::new();
    while octets[at] != mcap::records::op::DATA_END {
        let length = u64::from_le_bytes(octets[at + 1..at + 9].try_into().unwrap());
        let end = at + 9 + usize::try_from(length).unwrap();
        if octets[at] == mcap::records::op::CHUNK {
            chunks.push(at..end);
        }
        at = end;
    }
    chunks
}

#[test]
fn everything_but_damaged_chunks_is_recovered_and_the_copy_says_what_is_missing() {
    let log = sample::log(7, 6, 300);
    let (folder, whole, octets) = recorded(&log);
    let (broken, good) = (folder.path().join("broken.mcap"), folder.path().join("good.mcap"));
    let messages = inspect(&whole).unwrap().messages;
    let chunks = chunks(&octets);
    assert!(chunks.len() > 5, "{} chunks", chunks.len());
    let (middle, next) = (chunks[chunks.len() / 2].clone(), chunks[chunks.len() / 2 + 1].clone());
    // Its content, and its length: what follows is found again.
    for (at, value) in [(middle.end - 9, octets[middle.end - 9] ^ 1), (middle.start + 1, 0), (middle.start + 4, 0x7f)]
    {
        let mut damaged = octets.clone();
        damaged[at] = value;
        std::fs::write(&broken, &damaged).unwrap();
        let recovery = recover(&broken, &good, &Unwatched).unwrap();
        let [gap] = recovery.gaps.as_slice() else { panic!("{:?}", recovery.gaps) };
        assert_eq!(gap.from_byte, middle.start as u64, "octet {at}");
        assert!((middle.end as u64..=next.start as u64).contains(&gap.to_byte), "octet {at}: {gap:?}");
        assert!(gap.from_ns.unwrap() <= gap.to_ns.unwrap(), "{gap:?}");
        let inspection = inspect(&good).unwrap();
        assert_eq!((&inspection.damage, inspection.messages), (&None, recovery.messages));
        assert!(recovery.messages > messages / 2 && recovery.messages < messages, "{recovery:?}");
        assert_eq!(inspection.metadata["gap/1"]["to_byte"], gap.to_byte.to_string());
        let stops = assert_part(&good, &log);
        assert!((250..300).contains(&stops), "{stops} stops");
        assert_eq!(read_log(&good).unwrap().missing_stops, 300 - stops);
        let (mut of_stops, mut of_receptions) = (0, 0);
        let besides = read_tables(&good, &mut |piece| {
            if let TablePiece::Row(row) = piece {
                of_stops += usize::from(row.table == "stops");
                of_receptions += usize::from(row.table == "receptions");
            }
            Ok(())
        })
        .unwrap();
        assert_eq!(besides.concern, read_log(&good).unwrap().concern(), "what is exported says what is missing");
        assert!(besides.concern.unwrap().contains(&format!("{} stops left out", 300 - stops)));
        let receptions = read_log(&good).unwrap().logs.first().receptions().len();
        assert_eq!(of_stops, stops, "what is exported has the same stops");
        // The first stop has a row for each node.
        assert!((receptions..receptions + 6).contains(&of_receptions), "{of_receptions} of {receptions}");
    }
    // Two gaps, of which the first has the schemas of all messages.
    let mut damaged = octets;
    for chunk in [&chunks[0], &middle] {
        damaged[chunk.end - 9] ^= 1;
    }
    std::fs::write(&broken, &damaged).unwrap();
    let recovery = recover(&broken, &good, &Unwatched).unwrap();
    assert_eq!((recovery.gaps.len(), recovery.gaps[0].from_ns), (2, None));
    assert!(recovery.messages > messages / 2, "{recovery:?}");
    let again = folder.path().join("again.mcap");
    recover(&good, &again, &Unwatched).unwrap();
    let gaps = |path: &Path| inspect(path).unwrap().metadata.into_iter().filter(|(name, _)| name.starts_with("gap/"));
    assert!(gaps(&again).eq(gaps(&good)), "a copy of a copy has the same gaps");
}

#[test]
fn an_empty_file_has_nothing_to_recover() {
    let folder = tempfile::tempdir().unwrap();
    let (broken, good) = (folder.path().join("broken.mcap"), folder.path().join("good.mcap"));
    std::fs::write(&broken, []).unwrap();
    let error = recover(&broken, &good, &Unwatched).unwrap_err();
    assert!(
        matches!(error, RecordingError::File(McapFileError::Empty { .. })) && error.to_string().contains("is empty"),
        "{error}"
    );
    assert!(!good.exists());
    for error in [inspect(&broken).unwrap_err(), read_log(&broken).unwrap_err()] {
        assert!(matches!(error, RecordingError::File(McapFileError::Empty { .. })), "{error}");
    }
}

#[test]
fn flipped_bits_are_detected_and_all_else_is_recovered() {
    let log = sample::log(11, 6, 200);
    let (folder, _, octets) = recorded(&log);
    let (broken, good) = (folder.path().join("broken.mcap"), folder.path().join("good.mcap"));
    let mut numbers = Numbers(2);
    let mut found = 0;
    for _ in 0..200 {
        let mut damaged = octets.clone();
        let at = usize::try_from(numbers.below(octets.len() as u64)).unwrap();
        damaged[at] ^= 1 << numbers.below(8);
        std::fs::write(&broken, &damaged).unwrap();
        match recover(&broken, &good, &Unwatched) {
            Ok(recovery) => {
                found += usize::from(recovery.damage.is_some());
                assert_eq!(inspect(&good).unwrap().damage, None);
                // After a flip in the header or an attachment there may be no names of nodes, and so no log to compare.
                if recovery.gaps.iter().all(|gap| gap.from_ns.is_some()) && recovery.messages > 4 {
                    assert_part(&good, &log);
                }
            }
            Err(RecordingError::File(McapFileError::NotMcap { .. })) => found += 1,
            Err(other) => panic!("{other}"),
        }
    }
    assert!(found >= 190, "{found} of 200 flips were found");
}

#[test]
fn a_sound_recording_is_copied_completely() {
    let log = sample::log(12, 5, 50);
    let (folder, path, _) = recorded(&log);
    let copy = folder.path().join("copy.mcap");
    let recovery = recover(&path, &copy, &Unwatched).unwrap();
    assert_eq!(recovery.damage, None);
    assert_eq!(recovery.attachments, 2);
    assert_eq!(read_log(&copy).unwrap(), read_log(&path).unwrap());
    let (a, b) = (inspect(&copy).unwrap(), inspect(&path).unwrap());
    assert_eq!((a.topics, a.attachments, a.metadata), (b.topics, b.attachments, b.metadata));
}

#[test]
fn a_part_file_can_be_recovered_to_its_final_name() {
    let log = sample::log(13, 5, 50);
    let (folder, _, octets) = recorded(&log);
    let part = folder.path().join("run.mcap.part");
    std::fs::write(&part, &octets[..octets.len() * 9 / 10]).unwrap();
    let path = folder.path().join("run.mcap");
    recover(&part, &path, &Unwatched).unwrap();
    assert_prefix(&path, &log);
    assert!(part.exists());
}

#[test]
fn recovery_never_overwrites_its_input() {
    let log = sample::log(14, 3, 5);
    let (folder, path, octets) = recorded(&log);
    let dotted = folder.path().join(".").join("whole.mcap");
    assert!(matches!(recover(&path, &dotted, &Unwatched), Err(RecordingError::SameFile { .. })));
    let mut temporary = path.clone().into_os_string();
    temporary.push(".recovering");
    std::fs::copy(&path, &temporary).unwrap();
    assert!(matches!(recover(temporary.as_ref(), &path, &Unwatched), Err(RecordingError::SameFile { .. })));
    assert_eq!(std::fs::read(&path).unwrap(), octets);
}

/// Writes to `/dev/full` fail like writes to a full disk.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_no_incomplete_copy() {
    let log = sample::log(15, 5, 50);
    let (folder, path, octets) = recorded(&log);
    let out = folder.path().join("good.mcap");
    std::os::unix::fs::symlink("/dev/full", folder.path().join("good.mcap.recovering")).unwrap();
    let error = recover(&path, &out, &Unwatched).unwrap_err();
    assert!(matches!(&error, RecordingError::WriteCopy { path, .. } if *path == out), "{error}");
    assert!(error.is_system_error());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    assert_eq!(std::fs::read(&path).unwrap(), octets);
}

#[test]
fn files_of_other_formats_are_rejected_and_no_file_is_created() {
    let folder = tempfile::tempdir().unwrap();
    let other = folder.path().join("other.mcap");
    std::fs::write(&other, "stop,t_s,x_m,y_m\n").unwrap();
    let out = folder.path().join("out.mcap");
    assert!(matches!(inspect(&other), Err(RecordingError::File(McapFileError::NotMcap { .. }))));
    assert!(matches!(read_log(&other), Err(RecordingError::File(McapFileError::NotMcap { .. }))));
    assert!(matches!(recover(&other, &out, &Unwatched), Err(RecordingError::File(McapFileError::NotMcap { .. }))));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    let missing = folder.path().join("missing.mcap");
    assert!(matches!(read_log(&missing), Err(RecordingError::File(McapFileError::Read { .. }))));
    assert!(matches!(recover(&missing, &out, &Unwatched), Err(RecordingError::File(McapFileError::Read { .. }))));
    assert!(matches!(inspect(folder.path()), Err(RecordingError::File(McapFileError::Read { .. }))));
}

#[test]
fn the_error_of_a_recording_without_a_log_lists_its_topics() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut recorder = FileRecorder::create(&path).unwrap();
    recorder.metric(sextant_kernel::SimTime::ZERO, "x_m", 1.0).unwrap();
    recorder.finish().unwrap();
    let message = read_log(&path).unwrap_err().to_string();
    assert!(message.ends_with("its topics: /metrics"), "{message}");
}
