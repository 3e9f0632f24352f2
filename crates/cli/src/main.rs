//! The program `sextant`.

use std::process::ExitCode;

fn main() -> ExitCode {
    sextant::commands::main(std::env::args_os())
}
