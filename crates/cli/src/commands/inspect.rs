//! `sextant inspect`: what is inside a recording?

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;

use super::Format;
use crate::diagnostic::Failure;
use crate::recording;

/// What `sextant inspect` is told.
#[derive(Clone, Debug, Args)]
pub struct Arguments {
    /// The recording
    #[arg(value_name = "RUN.mcap")]
    pub recording: PathBuf,
    /// How the answer is printed
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let inspection = recording::inspect(&arguments.recording)?;
    let mut stdout = io::stdout().lock();
    match arguments.format {
        Format::Text => write!(stdout, "{inspection}")?,
        Format::Json => {
            serde_json::to_writer_pretty(&mut stdout, &inspection).map_err(io::Error::from)?;
            writeln!(stdout)?;
        }
    }
    Ok(())
}
