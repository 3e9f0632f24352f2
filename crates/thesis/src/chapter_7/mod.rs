//! The experiments of chapter 7. Numbers of sections and figures are those of the thesis.

mod beyond;
mod comparison;
mod method;
mod room;
mod seeking;
mod slow_robot;
mod two_sources;

use super::experiment::Experiment;

/// All experiments, in the order of the thesis.
#[must_use]
pub fn chapter_7() -> Vec<Experiment> {
    vec![
        slow_robot::experiment(),
        two_sources::experiment(),
        comparison::experiment(),
        room::experiment(),
        beyond::experiment(),
    ]
}
