//! `sextant completions`: so that the shell knows the words.

use std::io::{self, Write};

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use super::Cli;
use crate::diagnostic::Failure;

/// What `sextant completions` is told.
#[derive(Clone, Debug, Args)]
pub struct Arguments {
    /// The shell
    #[arg(value_enum)]
    pub shell: Shell,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Cli::command(), "sextant", &mut script);
    io::stdout().write_all(&script)?;
    Ok(())
}
