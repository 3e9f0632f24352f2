//! The figures of an experiment.

use std::path::Path;

use super::experiment::{Content, Experiment};
use super::{Runs, sensitivity};
use crate::diagnostic::Failure;
use crate::figure::FileFormat;

/// Draws what `experiment` shows into `out`.
///
/// # Errors
/// If a file cannot be written.
pub fn write_figures(experiment: &Experiment, runs: &Runs, out: &Path) -> Result<(), Failure> {
    let figures = match experiment.content {
        Content::Sensitivity => sensitivity::figures(runs),
        Content::Quantities(_) | Content::WorkedExample => Vec::new(),
    };
    for figure in figures {
        figure.write(out, FileFormat::Svg).map_err(|error| Failure::unwritable(out, &error))?;
    }
    Ok(())
}
