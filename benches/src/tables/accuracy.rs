//! Prints a table of the accuracy of the maps of scenarios: the mean position error, averaged over seeds, with half
//! the width of its 95 % interval (Student); the posterior bound; and the coverage of the 95 % regions.
//!
//! Usage: `accuracy [RUNS [SCENARIO.toml..]]`, by default 10 runs (seeds 1 to 10) of the scenarios in
//! `scenarios/accuracy`.

use std::io::Write;
use std::path::{Path, PathBuf};

use sextant::run::run;
use sextant::scenario::Scenario;
use sextant_kernel::Unwatched;
use sextant_study::sweep::Mean;

use crate::tables::{Outcome, Words};

/// The measurements of one map, one value for each run.
#[derive(Default)]
struct Series {
    error_m: Vec<f64>,
    coverage: Vec<f64>,
    seconds: Vec<f64>,
}

pub(crate) fn print(mut words: Words) -> Outcome<()> {
    let runs: u64 = match words.next() {
        Some(word) => word.parse().map_err(|_| format!("`{word}` is not a number of runs"))?,
        None => 10,
    };
    let mut paths: Vec<PathBuf> = words.map(PathBuf::from).collect();
    if paths.is_empty() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/accuracy");
        paths = ["circular", "sparse", "concave"].map(|name| folder.join(format!("{name}.toml"))).to_vec();
    }
    let mut out = std::io::stdout().lock();
    writeln!(
        out,
        "| scenario | map | mean position error [m] | over the bound | bound [m] | in 95 % region | mapping [s] |"
    )?;
    writeln!(out, "| --- | --- | --- | --- | --- | --- | --- |")?;
    for path in &paths {
        rows(&mut out, path, runs)?;
    }
    Ok(())
}

/// The rows of one scenario.
fn rows(out: &mut impl Write, path: &Path, runs: u64) -> Outcome<()> {
    let mut names: Vec<String> = Vec::new();
    let mut series: Vec<Series> = Vec::new();
    let mut bounds_m: Vec<f64> = Vec::new();
    for seed in 1..=runs {
        let scenario = Scenario::load_with(path, &[], Some(seed))?;
        let run = run(&scenario, &mut (), &Unwatched)?;
        bounds_m.extend(run.maps().iter().find_map(|map| map.summary.posterior_bound_m));
        names = run.maps().iter().map(|map| map.name.clone()).collect();
        series.resize_with(names.len(), Series::default);
        for (map, series) in run.maps().iter().zip(&mut series) {
            series.seconds.push(map.wall_s);
            series.error_m.extend(map.summary.position_error_m.map(|error| error.mean));
            series.coverage.extend(map.summary.coverage_95);
        }
    }
    let scenario = path.file_stem().unwrap_or_default().to_string_lossy();
    let mean = |values: &[f64]| Mean::of(values).map(|mean| mean.mean);
    let bound_m = mean(&bounds_m);
    for (name, Series { error_m, coverage, seconds }) in names.iter().zip(&series) {
        let Some(error) = Mean::of(error_m) else { continue };
        let half_width = error.half_width_95.map_or_else(String::new, |half_width| format!(" ± {half_width:.3}"));
        let optional = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.3}"));
        writeln!(
            out,
            "| {scenario} | {name} | {:.3}{half_width} | {} | {} | {} | {:.2} |",
            error.mean,
            optional(bound_m.map(|bound_m| error.mean / bound_m)),
            optional(bound_m),
            optional(mean(coverage)),
            mean(seconds).unwrap_or_default(),
        )?;
    }
    Ok(())
}
