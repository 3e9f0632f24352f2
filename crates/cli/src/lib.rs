//! The command line of Sextant: commands, flags, tables on a terminal, signals. The work is done by the library `sextant`.
//!
//! It is a library so that a program in another language can have the same commands: see [`main`].

mod commands;
mod diagnostic;
mod interrupt;
mod invocation;
mod live;
mod paragraph;
mod progress;
mod terminal;

pub use commands::main;
pub use invocation::Invocation;
