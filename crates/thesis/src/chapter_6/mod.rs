//! The experiments of chapter 6. Numbers of sections, tables and figures are those of the thesis.

mod course;
mod effort;
mod filters;
mod maps;
mod subject;
mod time;

use super::experiment::Experiment;

/// All experiments, in the order of the thesis.
#[must_use]
pub fn chapter_6() -> Vec<Experiment> {
    vec![
        time::experiment(),
        course::of_prediction(),
        course::of_distance(),
        effort::experiment(),
        maps::experiment(),
        filters::experiment(),
    ]
}
