//! The figures of an experiment.

use std::path::Path;

use rayon::prelude::*;

use super::error::ReproductionError;
use super::experiment::Experiment;
use super::runs::Runs;
use super::variant::flat_name;
use sextant::run::{RunRecorder, run};
use sextant::scenario::Scenario;
use sextant_figure::{self as figure, FileFormat, Source};
use sextant_kernel::{Unreported, Watch};
use sextant_recording::disk;
use sextant_recording::output::OutputError;
use sextant_recording::{read_run, read_world};

/// Runs the scenarios `names` from the folder `scenarios`, each with its own seed, and draws their figures into
/// `out`/NAME, by the names of the files: the network with the survey, the maps and their errors.
///
/// # Errors
/// If a run or a file fails, or `watch` stops the work.
pub fn write_pictures(
    names: &[String],
    scenarios: &Path,
    out: &Path,
    watch: &dyn Watch,
) -> Result<(), ReproductionError> {
    names.par_iter().try_for_each(|name| {
        let scenario = Scenario::load(scenarios.join(name))?;
        let folder = out.join(flat_name(name));
        disk::create_folders(&folder).map_err(|error| OutputError::new(&folder, &error))?;
        let recording = folder.join("run.mcap");
        run(&scenario, &mut RunRecorder::new(&recording), &Unreported(watch))?;
        watch.check()?;
        let (run, drawn) = (read_run(&recording)?, read_world(&recording)?);
        let source = Source {
            title: scenario.name(),
            log: run.log(),
            drawn: &drawn,
            sector_displacements: &run.sector_displacements(),
            claimed_obstacles: &run.claimed_obstacles(),
        };
        for figure in figure::all(&source) {
            figure.write(&folder, FileFormat::Svg).map_err(|error| OutputError::new(&folder, &error))?;
        }
        Ok(())
    })
}

/// Draws the figures of `experiment` into `out`.
///
/// # Errors
/// If a file cannot be written.
pub fn write_figures(experiment: &Experiment, runs: &Runs, out: &Path) -> Result<(), ReproductionError> {
    let figures = experiment.charts.iter().map(|chart| chart.figure(runs));
    for figure in figures {
        figure.write(out, FileFormat::Svg).map_err(|error| OutputError::new(out, &error))?;
    }
    Ok(())
}
