//! `sextant man`: the manual, as manual pages or in Markdown.

mod markdown;
mod roff;

use std::io::{self, Write};

use clap::{Args, Command, ValueEnum};
use sextant_kernel::text::printable;

use crate::diagnostic::Failure;

/// Arguments of `sextant man`.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The command whose page is printed, with its parts: `run`, `antenna show`. One page of all commands if absent
    #[arg(value_name = "COMMAND", conflicts_with = "format")]
    command: Vec<String>,
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
        _ if !arguments.command.is_empty() => roff::page_of(find(&command, &arguments.command)?)?,
        Format::Roff => roff::page(command)?,
        Format::Markdown => markdown::page(&command).into_bytes(),
    };
    io::stdout().write_all(&page)?;
    Ok(())
}

/// The command that `words` name, one part each.
fn find<'c>(program: &'c Command, words: &[String]) -> Result<&'c Command, Failure> {
    words.iter().try_fold(program, |command, word| {
        command.find_subcommand(word).ok_or_else(|| Failure::bad_input(unknown(command, word)))
    })
}

/// The message for a word that is no part of `command`.
fn unknown(command: &Command, word: &str) -> String {
    let (name, word) = (command.get_name(), printable(word));
    let known: Vec<_> = command.get_subcommands().map(|known| format!("`{}`", known.get_name())).collect();
    match known.as_slice() {
        [] => format!("`{name}` has no commands of its own, but `{word}` was found after it"),
        known => format!("`{name}` has no command `{word}`; it has {}", known.join(", ")),
    }
}
