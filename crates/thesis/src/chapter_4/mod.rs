//! The experiments of chapter 4. Numbers of sections and tables are those of the thesis.

mod comparison;
mod energy;
mod place;
mod sectors;

use super::environment::Environment;
use super::experiment::Experiment;
use place::Setup;

/// All experiments, in the order of the thesis.
#[must_use]
pub fn chapter_4() -> Vec<Experiment> {
    vec![
        sectors::experiment("4.5", Setup::Vaa),
        sectors::experiment("4.6", Setup::Vbs),
        sectors::experiment("4.7", Setup::Space),
        comparison::experiment("4.8", Environment::Warehouse),
        comparison::experiment("4.9", Environment::Greenhouse),
        energy::experiment(),
    ]
}
