//! Tables of recordings.

use std::path::Path;

use sextant::export::ExportFormat;
use sextant::{RunRecorder, Scenario, Unwatched, export};

use super::SHORT;
use super::trial::{Trial, contents};

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
