//! The program `sextant`.

use std::process::ExitCode;

fn main() -> ExitCode {
    sextant_cli::main(&sextant_cli::Invocation::of_process())
}
