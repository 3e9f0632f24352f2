//! The experiments of chapter 3. Numbers of sections, tables, figures and equations are those of the thesis.

mod comparison;
mod energy;
mod method;
mod sensitivity;
mod space;
mod trajectories;
mod worked_example;

use super::experiment::Experiment;

/// All experiments, in the order of the thesis.
#[must_use]
pub fn chapter_3() -> Vec<Experiment> {
    vec![
        worked_example::experiment(),
        trajectories::experiment(),
        sensitivity::experiment(),
        comparison::experiment(),
        space::ball(),
        space::cylinder(),
        energy::experiment(),
    ]
}
