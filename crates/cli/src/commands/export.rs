//! `sextant export`: the tables of a recording as files.

use std::io::Write;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use sextant::columns::{Align, columns};
use sextant::export::{ExportFormat, ExportedTable, FailedFile, INCOMPLETE, export};
use sextant_kernel::text::{counted, listed};
use sextant_recording::admission::{Replace, admit_folder};

use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::{say, stdout, warn};

/// Arguments of `sextant export`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Arguments {
    /// A recording of `run`
    #[arg(value_name = "RUN.mcap")]
    pub(crate) recording: PathBuf,
    /// The folder for the tables [default: RUN.tables beside the file]. It is created if it does not exist
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// The format of the tables
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: TablesFormat,
    /// Write into a folder that has files; those with other names stay, and are named
    #[arg(long)]
    pub(crate) force: bool,
}

/// The format of the tables.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum TablesFormat {
    /// Comma-separated values
    #[default]
    Csv,
    /// Apache Parquet
    Parquet,
}

impl From<TablesFormat> for ExportFormat {
    fn from(format: TablesFormat) -> Self {
        match format {
            TablesFormat::Csv => Self::Csv,
            TablesFormat::Parquet => Self::Parquet,
        }
    }
}

pub(crate) fn execute(arguments: &Arguments, interrupt: &Interrupt) -> Result<(), Failure> {
    let path = &arguments.recording;
    let folder = arguments.out.clone().unwrap_or_else(|| path.with_extension("tables"));
    admit_folder(&folder, if arguments.force { Replace::Any } else { Replace::Ours }, || false)?;
    // What is not complete is removed when the work ends by itself.
    let _keeper = interrupt.keep();
    let exported = export(path, &folder, arguments.format.into(), interrupt)?;
    let row = |ExportedTable { table, rows, file }: &ExportedTable| {
        vec![table.clone(), counted(usize::try_from(*rows).unwrap_or(usize::MAX), "row"), file.display().to_string()]
    };
    let rows: Vec<_> = exported.tables.iter().map(row).collect();
    let mut stdout = stdout();
    columns(&rows, &[Align::Left, Align::Right, Align::Left], &mut stdout)?;
    for file in &exported.files {
        writeln!(stdout, "{}", file.display())?;
    }
    if let Some(concern) = &exported.concern {
        say(&format!("note: {concern}; `{INCOMPLETE}` in the folder says so too"));
    }
    for FailedFile { name, why } in &exported.failed {
        warn(&format!("the file `{}` of the recording cannot be written: {why}", name.escape_debug()));
    }
    if !exported.stayed.is_empty() {
        let names: Vec<_> = exported.stayed.iter().map(|file| file.display().to_string()).collect();
        warn(&format!("these files were there before and are not of this recording: {}", listed(&names)));
    }
    if !exported.left_out.is_empty() {
        let topics: Vec<_> = exported.left_out.iter().map(String::as_str).collect();
        writeln!(stdout, "no tables: {}", topics.join(", "))?;
    }
    if exported.failed.is_empty() {
        return Ok(());
    }
    let (failed, all) = (exported.failed.len(), exported.failed.len() + exported.files.len());
    Err(Failure::failed(format!(
        "{failed} of {} of the recording cannot be written; all else is",
        counted(all, "file")
    )))
}
