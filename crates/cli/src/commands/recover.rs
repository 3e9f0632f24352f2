//! `sextant recover`: save what is whole in a broken recording.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;

use super::Format;
use crate::diagnostic::Failure;
use crate::recording;

/// What `sextant recover` is told.
#[derive(Clone, Debug, Args)]
pub struct Arguments {
    /// The broken recording, RUN.mcap.part after a crash
    #[arg(value_name = "BROKEN.mcap")]
    pub broken: PathBuf,
    /// Where the sound copy goes
    #[arg(long, value_name = "GOOD.mcap")]
    pub out: PathBuf,
    /// How the answer is printed
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let recovery = recording::recover(&arguments.broken, &arguments.out)?;
    let mut stdout = io::stdout().lock();
    match arguments.format {
        Format::Text => {
            let (messages, out) = (recovery.messages, arguments.out.display());
            match &recovery.damage {
                Some(damage) => writeln!(
                    stdout,
                    "{messages} messages saved in {out}; the recording is broken at byte {}: {}",
                    damage.at_byte, damage.why
                )?,
                None => writeln!(stdout, "{messages} messages copied to {out}; the recording was not broken")?,
            }
        }
        Format::Json => {
            serde_json::to_writer_pretty(&mut stdout, &recovery).map_err(io::Error::from)?;
            writeln!(stdout)?;
        }
    }
    Ok(())
}
