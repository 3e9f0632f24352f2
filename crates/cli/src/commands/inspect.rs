//! `sextant inspect`: the contents of a recording.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;

use super::options::Printing;
use crate::diagnostic::Failure;
use crate::recording;

/// Arguments of `sextant inspect`.
#[derive(Clone, Debug, Args)]
pub struct Arguments {
    /// The recording
    #[arg(value_name = "RUN.mcap")]
    pub recording: PathBuf,
    /// How results are printed.
    #[command(flatten)]
    pub printing: Printing,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let inspection = recording::inspect(&arguments.recording)?;
    Ok(arguments.printing.print(&inspection, |stdout| write!(stdout, "{inspection}"))?)
}
