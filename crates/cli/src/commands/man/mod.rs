//! `sextant man`: the manual, as a manual page or in Markdown.

mod markdown;
mod roff;

use std::io::{self, Write};

use clap::{Args, Command, ValueEnum};

use crate::diagnostic::Failure;

/// Arguments of `sextant man`.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// How the manual is written
    #[arg(long, value_enum, default_value = "roff")]
    format: Format,
}

/// How the manual is written.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Format {
    /// The manual page, for `man`
    Roff,
    /// The reference of the commands, for the guide
    Markdown,
}

/// Prints the manual of the command line `words`.
pub(crate) fn execute(arguments: &Arguments, words: Command) -> Result<(), Failure> {
    let mut command = words.disable_help_subcommand(true);
    command.build();
    let page = match arguments.format {
        Format::Roff => roff::page(command)?,
        Format::Markdown => markdown::page(&command).into_bytes(),
    };
    io::stdout().write_all(&page)?;
    Ok(())
}
