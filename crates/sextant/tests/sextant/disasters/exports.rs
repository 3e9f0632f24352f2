//! Tables of recordings.

use std::fs;
use std::path::Path;

use sextant::export::ExportFormat;
use sextant::{RunRecorder, Scenario, Unwatched, export};

use super::trial::{SHORT, Trial};

/// What all of a folder has, by name.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).expect("it works without a disaster") {
        let path = entry.expect("it works without a disaster").path();
        if path.is_file() {
            let name = path.file_name().expect("it works without a disaster").to_string_lossy().into_owned();
            files.push((name, fs::read(&path).expect("it works without a disaster")));
        }
    }
    files.sort();
    files
}

#[test]
fn each_exported_table_is_whole_or_not_there() {
    let outside = tempfile::tempdir().expect("it works without a disaster");
    let recording = outside.path().join("run.mcap");
    sextant::run(
        &Scenario::parse(SHORT).expect("it works without a disaster"),
        &mut RunRecorder::new(&recording),
        &Unwatched,
    )
    .expect("it works without a disaster");
    let work = |folder: &Path| {
        let exported = export(&recording, &folder.join("tables"), ExportFormat::Csv, &Unwatched);
        // A file of the recording that cannot be written is told, and the others are written.
        match exported.map_err(|error| error.to_string())?.failed.pop() {
            Some(failed) => Err(failed.why),
            None => Ok(()),
        }
    };
    let whole = tempfile::tempdir().expect("it works without a disaster");
    work(whole.path()).expect("it works without a disaster");
    let all = contents(&whole.path().join("tables"));
    let disasters = Trial { prepare: &|_| {}, work: &work }.each(|left| {
        for (name, content) in &all {
            left.check_whole(&format!("tables/{name}"), None, content);
        }
    });
    assert!(disasters > 200 && all.len() > 5, "{disasters} disasters of {} tables", all.len());
}
