//! Tables of times and errors, and what is needed to make them.

mod accuracy;
mod cross_validation;
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

/// Something that is printed, or written.
struct Table {
    name: &'static str,
    what: &'static str,
    print: fn(Words) -> Outcome<()>,
}

const fn table(name: &'static str, what: &'static str, print: fn(Words) -> Outcome<()>) -> Table {
    Table { name, what, print }
}

const TABLES: [Table; 7] = [
    table("accuracy", "errors of the maps of scenarios over seeds", accuracy::print),
    table("regret", "how much worse an estimator is than the best of several", regret::print),
    table("robot-logs", "how well each estimator maps logs of robots", robot_logs::print),
    table("cross-validation", "constants of `auto` learnt with each site left out", cross_validation::print),
    table("grid-solver", "times of the grid solver beside NumPy", grid_solver::print),
    table("large-recording", "writes the recording of a large survey", large_recording::print),
    table("soak", "mixed work for hours, with its memory and its open files", soak::print),
];

/// Prints the table that the words of the command line name.
pub(crate) fn print() -> Outcome<()> {
    let mut words = std::env::args().skip(1);
    let name = words.next().unwrap_or_default();
    match TABLES.iter().find(|table| table.name == name) {
        Some(table) => (table.print)(words),
        None => {
            let known: Vec<String> =
                TABLES.iter().map(|Table { name, what, .. }| format!("\n  {name:<16} {what}")).collect();
            Err(format!("`{name}` is no table; allowed:{}", known.concat()).into())
        }
    }
}
