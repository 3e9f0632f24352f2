//! The program `sextant`: commands, flags, tables on a terminal, signals. The work is done by the library.

mod commands;
mod diagnostic;
mod interrupt;
#[cfg(feature = "live")]
mod live;
mod paragraph;
mod progress;
mod terminal;

use std::process::ExitCode;

fn main() -> ExitCode {
    commands::main(std::env::args_os())
}
