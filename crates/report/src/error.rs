//! Errors of reports.

use std::path::PathBuf;

use sextant_recording::RecordingError;
use sextant_study::sweep::TableError;

/// Why there is no report.
#[derive(Clone, Debug, thiserror::Error)]
pub enum ReportError {
    /// The recording cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The table cannot be read.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The recording has nothing to show.
    #[error(
        "`{}` has no maps, stops, sinks, targets, fields or summary, so there is nothing to report",
        .path.display()
    )]
    Empty {
        /// The recording.
        path: PathBuf,
    },
    /// The recording has more receptions than a page can hold.
    #[error(
        "`{}` has {receptions} receptions, and a browser has to hold all of them; allowed: at most {allowed}; \
         `sextant figure` draws any number", .path.display()
    )]
    TooLarge {
        /// The recording.
        path: PathBuf,
        /// Receptions in all networks.
        receptions: usize,
        /// How many are allowed.
        allowed: usize,
    },
    /// A file or folder cannot be read.
    #[error("`{}` cannot be read: {why}", .path.display())]
    Read {
        /// The file or folder.
        path: PathBuf,
        /// The system's answer.
        why: String,
    },
    /// The file is neither the table of a sweep nor one of a reproduction.
    #[error(
        "`{}` is no table that a report can show: its columns are {}; allowed: those of a sweep (cell, replicate, seed, ..) \
         and of a reproduction (what, published, ..)",
        .path.display(), shown(.columns)
    )]
    NotATable {
        /// The file.
        path: PathBuf,
        /// Its columns.
        columns: Vec<String>,
    },
}

/// Names of columns as a text that is not too long.
fn shown(columns: &[String]) -> String {
    const MOST: usize = 12;
    let first = columns.iter().take(MOST).map(String::as_str).collect::<Vec<_>>().join(", ");
    match columns.len() {
        0 => "none".to_owned(),
        1..=MOST => first,
        _ => first + ", ..",
    }
}
