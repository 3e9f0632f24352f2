//! All results as one object.

use std::path::Path;

use serde_json::{Value, json};

use super::results::Results;
use super::tally::by_chapter;
use sextant_recording::output::{OutputError, write_file};

/// All results as one object: version, experiments with their lines, and the verdicts of each chapter.
#[must_use]
pub fn json(results: &[Results]) -> Value {
    let experiments: Vec<_> = results.iter().map(Results::json).collect();
    let verdicts = by_chapter(results).into_iter().map(|(name, tally)| {
        let mut counts = tally.json();
        counts["of"] = json!(name);
        counts
    });
    let verdicts: Vec<_> = verdicts.collect();
    json!({"reproduction": {"version": env!("CARGO_PKG_VERSION"), "experiments": experiments, "verdicts": verdicts}})
}

/// The file with that object.
const FILE: &str = "reproduction.json";

/// Whether the folder `path` is that of an earlier reproduction.
#[must_use]
pub fn is_reproduction(path: &Path) -> bool {
    let content: Option<Value> =
        std::fs::read(path.join(FILE)).ok().and_then(|text| serde_json::from_slice(&text).ok());
    content.is_some_and(|content| content["reproduction"]["experiments"].is_array())
}

/// Writes that object to `reproduction.json` in the folder `out`.
///
/// # Errors
/// If the file cannot be written.
pub fn write_json(results: &[Results], out: &Path) -> Result<(), OutputError> {
    write_file(&out.join(FILE), format!("{:#}\n", json(results)).as_bytes())
}
