//! Tables of times and errors, and what is needed to make them.

mod accuracy;
mod grid_solver;
mod large_recording;
mod regret;
mod robot_logs;
mod soak;

use std::error::Error;

/// What a table needs: a mistake ends it.
pub(crate) type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;
/// The words after the name of a table.
pub(crate) type Words = std::iter::Skip<std::env::Args>;

/// The tables by their names, each with what it prints.
const TABLES: [(&str, &str, fn(Words) -> Outcome<()>); 6] = [
    ("accuracy", "errors of the maps of scenarios over seeds", accuracy::print),
    ("regret", "how much worse an estimator is than the best of several", regret::print),
    ("robot-logs", "how well each estimator maps logs of robots", robot_logs::print),
    ("grid-solver", "times of the grid solver beside NumPy", grid_solver::print),
    ("large-recording", "writes the recording of a large survey", large_recording::print),
    ("soak", "mixed work for hours, with its memory and its open files", soak::print),
];

/// Prints the table that the words of the command line name.
pub(crate) fn print() -> Outcome<()> {
    let mut words = std::env::args().skip(1);
    let name = words.next().unwrap_or_default();
    match TABLES.iter().find(|table| table.0 == name) {
        Some((_, _, print)) => print(words),
        None => {
            let known: Vec<String> = TABLES.iter().map(|(name, what, _)| format!("\n  {name:<16} {what}")).collect();
            Err(format!("`{name}` is no table; allowed:{}", known.concat()).into())
        }
    }
}
