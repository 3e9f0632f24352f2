//! Recordings and captures of runs, and copies of broken ones.

use std::fs;
use std::path::Path;

use sextant::{RunCapture, RunRecorder, Scenario, Unwatched};
use sextant_recording::{read_log, recover};

use super::trial::{Left, SHORT, Trial, undisturbed};

/// A small survey, read once.
fn survey() -> Scenario {
    Scenario::parse(SHORT).expect("it works without a disaster")
}

fn record(scenario: &Scenario, path: &Path) -> Result<(), String> {
    let run = sextant::run(scenario, &mut RunRecorder::new(path), &Unwatched);
    run.map(|_| ()).map_err(|error| error.to_string())
}

/// The recording of `scenario`, in memory.
fn recorded(scenario: &Scenario) -> Vec<u8> {
    undisturbed(&|folder| record(scenario, &folder.join("a.mcap")), "a.mcap")
}

/// Recovers what was left under the temporary name, and returns the number of its messages; nothing if not even a copy of it
/// can be made.
fn recovered(left: &Left<'_>, all: u64) -> Option<u64> {
    let part = left.folder.join("a.mcap.part");
    if !part.exists() {
        return None;
    }
    let copy = left.folder.join("copy.mcap");
    let recovery = recover(&part, &copy, &Unwatched).ok()?;
    assert!(recovery.messages <= all, "{left}");
    if recovery.messages > 0 {
        read_log(&copy).unwrap_or_else(|error| panic!("{left}: {error}"));
    }
    Some(recovery.messages)
}

#[test]
fn a_recording_is_the_old_one_or_the_new_one_and_its_part_can_be_recovered() {
    let (scenario, other) = (survey(), survey().with("seed", 7).expect("it works without a disaster"));
    let (new, old) = (recorded(&scenario), recorded(&other));
    let whole = tempfile::tempdir().expect("it works without a disaster");
    let path = whole.path().join("a.mcap");
    fs::write(&path, &new).expect("it works without a disaster");
    let all =
        recover(&path, &whole.path().join("copy.mcap"), &Unwatched).expect("it works without a disaster").messages;
    let prepare = |folder: &Path| fs::write(folder.join("a.mcap"), &old).expect("it works without a disaster");
    let work = |folder: &Path| record(&scenario, &folder.join("a.mcap"));
    let most = std::cell::Cell::new(0);
    let disasters = Trial { prepare: &prepare, work: &work }.each(|left| {
        left.check_whole("a.mcap", Some(&old), &new);
        let messages = recovered(left, all);
        if left.has_power() && left.told.is_err() && left.read("a.mcap") != Some(new.clone()) {
            most.set(most.get().max(messages.unwrap_or(0)));
        }
    });
    assert!(disasters > 80, "{disasters}");
    assert!(most.get() * 2 > all, "of {all} messages at most {} were recovered", most.get());
}

#[test]
fn a_recovered_copy_is_the_old_one_or_the_new_one_and_the_broken_file_stays() {
    let whole = recorded(&survey());
    let broken = &whole[..whole.len() * 3 / 4];
    let work = |folder: &Path| {
        let recovery = recover(&folder.join("broken.mcap"), &folder.join("a.mcap"), &Unwatched);
        recovery.map(|_| ()).map_err(|error| error.to_string())
    };
    let prepare = |folder: &Path| {
        fs::write(folder.join("broken.mcap"), broken).expect("it works without a disaster");
        fs::write(folder.join("a.mcap"), b"old").expect("it works without a disaster");
    };
    let folder = tempfile::tempdir().expect("it works without a disaster");
    prepare(folder.path());
    work(folder.path()).expect("it works without a disaster");
    let new = fs::read(folder.path().join("a.mcap")).expect("it works without a disaster");
    Trial { prepare: &prepare, work: &work }.each(|left| {
        left.check_whole("a.mcap", Some(b"old"), &new);
        assert!(left.read("broken.mcap").as_deref() == Some(broken), "{left}");
    });
}

#[test]
fn a_capture_is_whole_or_not_there() {
    let scenario = survey();
    let work = |folder: &Path| {
        let run = sextant::run(&scenario, &mut RunCapture::new(&folder.join("a.pcap")), &Unwatched);
        run.map(|_| ()).map_err(|error| error.to_string())
    };
    let new = undisturbed(&work, "a.pcap");
    let disasters = Trial { prepare: &|_| {}, work: &work }.each(|left| left.check_whole("a.pcap", None, &new));
    assert!(disasters > 40, "{disasters}");
}
