//! All results as one object.

use std::path::Path;

use serde_json::{Value, json};

use super::results::Results;
use super::tally::by_chapter;
use sextant_recording::output::{OutputError, write_file};

/// All results as one object: version, seed of the first run if it is not that of the scenarios, experiments with their
/// lines, and the verdicts of each chapter.
#[must_use]
pub fn json(results: &[Results], first_seed: Option<u64>) -> Value {
    let experiments: Vec<_> = results.iter().map(Results::json).collect();
    let verdicts = by_chapter(results).into_iter().map(|(name, tally)| {
        let mut counts = tally.json();
        counts["of"] = json!(name);
        counts
    });
    let verdicts: Vec<_> = verdicts.collect();
    let mut all = json!({"version": env!("CARGO_PKG_VERSION"), "experiments": experiments, "verdicts": verdicts});
    if let Some(seed) = first_seed {
        all["first_seed"] = json!(seed);
    }
    json!({"reproduction": all})
}

/// The file with that object.
const FILE: &str = "reproduction.json";

/// Whether the folder `path` is that of an earlier reproduction.
#[must_use]
pub fn is_reproduction(path: &Path) -> bool {
    content(path).is_some_and(|content| content["reproduction"]["experiments"].is_array())
}

/// The seed of the first run of the reproduction in the folder `path`, if it is not that of the scenarios.
#[must_use]
pub fn first_seed(path: &Path) -> Option<u64> {
    content(path)?["reproduction"]["first_seed"].as_u64()
}

fn content(path: &Path) -> Option<Value> {
    std::fs::read(path.join(FILE)).ok().and_then(|text| serde_json::from_slice(&text).ok())
}

/// Writes that object to `reproduction.json` in the folder `out`.
///
/// # Errors
/// If the file cannot be written.
pub fn write_json(results: &[Results], first_seed: Option<u64>, out: &Path) -> Result<(), OutputError> {
    write_file(&out.join(FILE), format!("{:#}\n", json(results, first_seed)).as_bytes())
}
