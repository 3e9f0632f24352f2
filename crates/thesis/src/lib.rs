//! Reproduction of the tables and figures of the thesis (2018, chapters 3 to 7): published values beside ours.
//!
//! Each experiment has the id of its table or figure, and runs scenarios that ship with the program with several seeds.
//! Nothing is fitted to published values. Where definitions differ, a note says how. Each published value names its table,
//! figure or section, and each conclusion is computed from the runs.

mod chapter_3;
mod chapter_4;
mod chapter_5;
mod chapter_6;
mod chapter_7;
mod chart;
mod claim;
mod comparison_charts;
mod environment;
mod error;
mod experiment;
mod figures;
mod finding;
mod line;
mod published;
mod runs;
mod shipped;

pub use chapter_3::chapter_3;
pub use chapter_4::chapter_4;
pub use chapter_5::chapter_5;
pub use chapter_6::chapter_6;
pub use chapter_7::chapter_7;
pub use chart::{Across, Chart, ChartKind, ChartLine};
pub use claim::{Check, Claim};
pub use error::ReproductionError;
pub use experiment::{Content, Experiment, Quantity};
pub use figures::{write_figures, write_pictures};
pub use finding::{Finding, Verdict};
pub use line::{Line, Ours, write_csv};
pub use published::Published;
pub use runs::{Runs, Term};
pub use shipped::{SHIPPED, write_scenarios};

/// All experiments, in the order of the thesis.
#[must_use]
pub fn experiments() -> Vec<Experiment> {
    let first = chapter_3().into_iter().chain(chapter_4()).chain(chapter_5());
    first.chain(chapter_6()).chain(chapter_7()).collect()
}

#[cfg(test)]
mod tests;
