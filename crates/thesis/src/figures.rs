//! The figures of an experiment.

use std::path::Path;

use rayon::prelude::*;

use super::error::ReproductionError;
use super::experiment::{Content, Experiment};
use super::runs::{Runs, Term};
use sextant::run::{RunRecorder, run};
use sextant::scenario::Scenario;
use sextant::summary::{Measure, NODE_ERRORS, measures::node_errors};
use sextant_figure::{self as figure, Curves, Figure, FileFormat, Series, Source};
use sextant_kernel::{Unreported, Watch};
use sextant_recording::output::OutputError;
use sextant_recording::{read_drawn, read_run};

/// Runs the scenarios `names` from the folder `scenarios`, each with its own seed, and draws their figures into
/// `out`/NAME: the network with the survey, the maps and their errors.
///
/// # Errors
/// If a run or a file fails, or `watch` stops the work.
pub fn write_pictures(
    names: &[&str],
    scenarios: &Path,
    out: &Path,
    watch: &dyn Watch,
) -> Result<(), ReproductionError> {
    names.par_iter().try_for_each(|name| {
        let scenario = Scenario::load(&scenarios.join(name))?;
        let folder = out.join(scenario.name());
        std::fs::create_dir_all(&folder).map_err(|error| OutputError::new(&folder, &error))?;
        let recording = folder.join("run.mcap");
        run(&scenario, &mut RunRecorder::new(&recording), &Unreported(watch))?;
        watch.check()?;
        let (run, drawn) = (read_run(&recording)?, read_drawn(&recording)?);
        let displacements = run.sector_displacements();
        let source =
            Source { title: scenario.name(), log: run.log(), drawn: &drawn, sector_displacements: &displacements };
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
    let mut figures = match &experiment.content {
        Content::Computed { figures, .. } => figures(runs),
        Content::Quantities(_) => Vec::new(),
    };
    figures.extend(distribution(experiment, runs));
    figures.extend(experiment.charts.iter().map(|chart| chart.figure(runs)));
    for figure in figures {
        figure.write(out, FileFormat::Svg).map_err(|error| OutputError::new(out, &error))?;
    }
    Ok(())
}

/// The distribution of the connectivity errors of the nodes, with a curve for each scenario and map.
fn distribution(experiment: &Experiment, runs: &Runs) -> Option<Figure> {
    let mut series = Vec::new();
    for &(scenario, map) in experiment.distributions {
        let share = |share| runs.mean(&Term::new(scenario, Measure::OfMap(map, share)));
        let point = |(error, number)| Some((error, share(number)?.mean));
        let points = NODE_ERRORS.into_iter().zip(node_errors::ALL.iter().copied()).filter_map(point).collect();
        let name = format!("{map}, {}", scenario.trim_start_matches("ml-tm/").trim_end_matches(".toml"));
        series.push(Series { name, points, half_widths: Vec::new() });
    }
    let curves = Curves {
        title: "Connectivity error of the nodes".to_owned(),
        note: "share of the nodes that lose at most this share of their neighbours; mean over the runs".to_owned(),
        across: "neighbours lost".to_owned(),
        up: "share of the nodes".to_owned(),
        series,
    };
    (!curves.series.is_empty()).then(|| curves.figure(&format!("{}-cdf", experiment.id)))
}
