//! `sextant completions`: so that the shell knows the words.

use std::io::{self, Write};

use clap::{Args, Command};
use clap_complete::Shell;

use crate::diagnostic::Failure;

/// What `sextant completions` is told.
#[derive(Clone, Debug, Args)]
pub struct Arguments {
    /// The shell
    #[arg(value_enum)]
    pub shell: Shell,
}

/// Prints completions for `words`, the words of the program.
pub(crate) fn execute(arguments: &Arguments, mut words: Command) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut words, "sextant", &mut script);
    io::stdout().write_all(&script)?;
    Ok(())
}
