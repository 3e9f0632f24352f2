//! The work list of a plan, for people and for other programs.

use std::io::{self, BufReader, Read, Write};
use std::path::Path;

use serde::Serialize;
use serde_json::{Map, Value};
use sextant_recording::ForeignFolder;
use sextant_recording::output::{OutputError, PartFile};

use super::error::CampaignError;
use crate::sweep::{CellRun, ColumnKind, Sweep};
#[cfg(feature = "parquet")]
use crate::sweep::{Column, write_texts};

/// The list with one JSON object a line.
pub(super) const LINES: &str = "work.jsonl";

/// The list in Apache Parquet.
pub(super) const TABLE: &str = "work.parquet";

/// A line of the list.
#[derive(Serialize)]
struct Line<'a> {
    run: usize,
    cell: usize,
    replicate: u32,
    seed: u64,
    /// Runs with the same number share a survey.
    survey: usize,
    settings: Map<String, Value>,
    sha256: &'a str,
    version: &'static str,
}

/// Writes the list of `sweep` to `folder`.
pub(super) fn write(sweep: &Sweep, folder: &Path) -> Result<(), CampaignError> {
    let path = folder.join(LINES);
    let mut file = PartFile::create(&path)?;
    for line in lines(sweep) {
        serde_json::to_writer(&mut file, &line)
            .map_err(std::io::Error::from)
            .and_then(|()| file.write_all(b"\n"))
            .map_err(|error| OutputError::new(&path, &error))?;
    }
    file.finish()?;
    #[cfg(feature = "parquet")]
    write_texts(&folder.join(TABLE), &columns(sweep), lines(sweep).map(|line| Ok(texts(sweep, &line))))?;
    Ok(())
}

/// Rejects a list in the folder of a plan that is not the one of `sweep`. The list in Apache Parquet is for others only.
pub(super) fn check(sweep: &Sweep, plan: &ForeignFolder) -> Result<(), CampaignError> {
    let path = plan.root().join(LINES);
    let unreadable = |error: &io::Error| CampaignError::unreadable(&path, error);
    let mut found = plan.open(&path).map(BufReader::new).map_err(|error| unreadable(&error))?;
    let mut octets = Vec::new();
    for line in lines(sweep) {
        let mut line = serde_json::to_vec(&line).map_err(|error| unreadable(&error.into()))?;
        line.push(b'\n');
        octets.resize(line.len(), 0);
        match found.read_exact(&mut octets) {
            Ok(()) if octets == line => {}
            Err(error) if error.kind() != io::ErrorKind::UnexpectedEof => return Err(unreadable(&error)),
            Ok(()) | Err(_) => return Err(CampaignError::Changed { file: path }),
        }
    }
    match found.read(&mut [0]).map_err(|error| unreadable(&error))? {
        0 => Ok(()),
        _ => Err(CampaignError::Changed { file: path }),
    }
}

/// The lines, in the order of their numbers.
fn lines(sweep: &Sweep) -> impl Iterator<Item = Line<'_>> {
    let work = sweep.work();
    (0..work.len()).map(move |run| {
        let CellRun { cell, replicate } = work.get(run);
        let settings = sweep.keys().iter().zip(sweep.values(cell)).filter(|(_, value)| !value.is_empty());
        let value = |kind, text: String| match kind {
            ColumnKind::Text => Value::String(text),
            ColumnKind::Integer | ColumnKind::Unsigned | ColumnKind::Real => {
                text.parse().map_or(Value::String(text), Value::Number)
            }
        };
        Line {
            run,
            cell,
            replicate,
            seed: sweep.seed_of(replicate),
            survey: work.survey_of(run),
            settings: settings.map(|(key, text)| (key.name.clone(), value(key.kind, text))).collect(),
            sha256: &sweep.cells()[cell].sha256,
            version: env!("CARGO_PKG_VERSION"),
        }
    })
}

#[cfg(feature = "parquet")]
fn columns(sweep: &Sweep) -> Vec<Column> {
    let numbers = ["run", "cell", "replicate", "seed", "survey"]
        .map(|name| Column::new(name, if name == "seed" { ColumnKind::Unsigned } else { ColumnKind::Integer }));
    let texts = ["sha256", "version"].map(|name| Column::new(name, ColumnKind::Text));
    numbers.into_iter().chain(sweep.keys().iter().cloned()).chain(texts).collect()
}

#[cfg(feature = "parquet")]
fn texts(sweep: &Sweep, line: &Line<'_>) -> Vec<String> {
    let numbers = [line.run, line.cell].map(|number| number.to_string());
    let seeds = [line.replicate.to_string(), line.seed.to_string(), line.survey.to_string()];
    let ends = [line.sha256.to_owned(), line.version.to_owned()];
    numbers.into_iter().chain(seeds).chain(sweep.values(line.cell)).chain(ends).collect()
}
