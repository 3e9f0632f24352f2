//! Prints a table of times or errors: `cargo run --release -p sextant-benches -- TABLE ..`.

mod tables;

use std::process::ExitCode;

fn main() -> ExitCode {
    match tables::print() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
