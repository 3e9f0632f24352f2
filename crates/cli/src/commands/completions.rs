//! `sextant completions`: completion scripts for shells.

use std::io::{self, Write};

use clap::{Args, Command};
use clap_complete::Shell;

use crate::diagnostic::Failure;

/// Arguments of `sextant completions`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Arguments {
    /// The shell
    #[arg(value_enum)]
    pub(crate) shell: Shell,
}

/// Prints the completion script of the command line `words`.
pub(crate) fn execute(arguments: &Arguments, mut words: Command) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut words, "sextant", &mut script);
    io::stdout().write_all(&script)?;
    Ok(())
}
