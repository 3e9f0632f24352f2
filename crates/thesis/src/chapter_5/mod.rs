//! The experiments of chapter 5. Numbers of sections and tables are those of the thesis.

mod anchors;
mod comparison;
mod energy;
mod heard;
mod scattering;
mod subject;
mod swept;

use super::experiment::Experiment;

/// All experiments, in the order of the thesis.
#[must_use]
pub fn chapter_5() -> Vec<Experiment> {
    vec![
        scattering::experiment(),
        anchors::of_static(),
        heard::experiment(),
        anchors::of_hybrid(),
        comparison::experiment(),
        energy::experiment(),
    ]
}
