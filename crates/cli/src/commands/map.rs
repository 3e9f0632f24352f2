//! `sextant map`: from a reception log to maps.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::Seed;
use sextant_mapper::Knowledge;

use super::Format;
use crate::diagnostic::Failure;
use crate::measure::{Truth, in_world, measure};
use crate::recording::{self, Known, ORIGIN_METADATA, SCENARIO_ATTACHMENT};
use crate::scenario::{AlgorithmName, MapSettings};
use crate::summary::{GatheringSummary, MapSummary, Summary, Timing, peak_rss_bytes};
use crate::{robot_log, table};

/// What `sextant map` is told.
#[derive(Clone, Debug, Args)]
pub struct Arguments {
    /// A recording of `run`, or a folder with stops.csv and receptions.csv
    #[arg(value_name = "LOG")]
    pub log: PathBuf,
    /// How likely a packet is received over a distance: `fitted` (estimated from the log itself),
    /// trapezoid:p0=0.95,plateau_m=2,range_m=10[,floor=..,ceiling=..], or channel:exponent=..,sigma_db=..,
    /// tx_power_dbm=..,sensitivity_dbm=..[,max_range_m=..]. If absent, that of the scenario for a recording, `fitted`
    /// for a folder
    #[arg(long, value_name = "PROFILE")]
    pub profile: Option<String>,
    /// Make one map by this algorithm, with the settings that it has by itself, in place of the maps of a recording's
    /// scenario
    #[arg(long, value_enum, value_name = "ALGORITHM")]
    pub algorithm: Option<AlgorithmName>,
    /// Measure the maps against the true places: a CSV file with columns node,x_m,y_m,z_m. For a recording, the
    /// places that it holds if absent
    #[arg(long, value_name = "nodes.csv")]
    pub truth: Option<PathBuf>,
    /// Write the map to this file, with columns node,x_m,y_m,z_m,ties,infeasible and the entries of the covariance, if there is one. Further maps go to files beside it, named after them
    #[arg(long, value_name = "MAP.csv")]
    pub out: Option<PathBuf>,
    /// Also write the results to this file, as one JSON object
    #[arg(long, value_name = "FILE.json")]
    pub summary: Option<PathBuf>,
    /// Threads to compute with; one a core if absent. The results do not depend on it
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Override a setting of the maps, as in a scenario: maps.0.algorithm.ml_tm.grid_step_m=0.5; may be repeated
    #[arg(long, value_name = "K=V", value_parser = crate::scenario::flag)]
    pub set: Vec<String>,
    /// How results are printed
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
    /// No notes on standard error
    #[arg(long)]
    pub quiet: bool,
}

/// A log and what came with it.
struct Input {
    log: ReceptionLog,
    /// The paths of robots, by name, where they are known.
    paths: Vec<(String, Vec<Position>)>,
    scenario: Option<String>,
    truth: Option<BTreeMap<String, Position>>,
    known: Known,
    seed: Seed,
    notes: Vec<String>,
}

#[expect(clippy::disallowed_methods, reason = "the cli times whole stages")]
fn now() -> Instant {
    Instant::now()
}

pub(crate) fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let start = now();
    super::run::set_threads(arguments.threads)?;
    let mut input = read(&arguments.log)?;
    let name = format!("{} of {}", SCENARIO_ATTACHMENT, arguments.log.display());
    let scenario = input.scenario.as_deref().map(|text| (name.as_str(), text));
    let settings = MapSettings::new(scenario, arguments.algorithm, arguments.profile.as_deref(), &arguments.set)?;
    if let Some(path) = &arguments.truth {
        input.truth = Some(robot_log::read_truth(path)?);
    }
    let truth = input.truth.as_ref().and_then(|truth| places(truth, &input.log, &mut input.notes));
    let map_start = now();
    let mut summaries: Vec<MapSummary> = Vec::new();
    let knowledge = Knowledge {
        neighbours: input.known.neighbours.as_ref(),
        beacons: input.known.beacons.as_ref(),
        anchors: &input.known.anchors,
        obstacles: settings.obstacles.as_ref(),
        seed: input.seed,
        ..Knowledge::from(&input.log)
    };
    for named in &settings.maps {
        let (map, learned) =
            named.mapper.map_and_learn(knowledge).map_err(|error| Failure::bad_input(error.to_string()))?;
        let (map, alignment) = in_world(map, truth.as_deref());
        let truth = truth.as_deref().map(|places| Truth { places, anchors: &input.known.anchors });
        let summary = measure(named, &map, learned.as_ref(), truth, &settings.metrics);
        summaries.push(MapSummary { alignment: Some(alignment), ..summary });
        if let Some(out) = &arguments.out {
            let path = if summaries.len() > 1 { beside(out, &named.name) } else { out.clone() };
            robot_log::write_map(&path, input.log.names(), &map)?;
        }
    }
    let summary = Summary {
        gathering: Some(GatheringSummary::of_log(&input.log, &input.paths)),
        maps: summaries,
        timing: Some(Timing {
            wall_s: start.elapsed().as_secs_f64(),
            map_s: Some(map_start.elapsed().as_secs_f64()),
            peak_rss_bytes: peak_rss_bytes(),
            ..Timing::default()
        }),
        ..Summary::default()
    };
    if !arguments.quiet {
        for note in &input.notes {
            // Nobody is left to be told if standard error is gone.
            let _ = writeln!(io::stderr(), "note: {note}");
        }
    }
    if let Some(path) = &arguments.summary {
        summary.write(path)?;
    }
    let mut stdout = io::stdout().lock();
    match arguments.format {
        Format::Text => table::write(&summary, &mut stdout)?,
        Format::Json => stdout.write_all(summary.to_json()?.as_bytes())?,
    }
    Ok(())
}

fn read(path: &Path) -> Result<Input, Failure> {
    if path.is_dir() {
        let log = robot_log::read(path)?;
        let known = Known::default();
        return Ok(Input {
            log,
            paths: Vec::new(),
            scenario: None,
            truth: None,
            known,
            seed: Seed(1),
            notes: Vec::new(),
        });
    }
    let run = recording::read_log(path)?;
    let scenario = run.attachments.iter().rfind(|attachment| attachment.name == SCENARIO_ATTACHMENT);
    let scenario = scenario.map(|attachment| String::from_utf8_lossy(&attachment.data).into_owned());
    let mut notes = Vec::new();
    if run.cut_stops > 0 {
        notes.push(
            "the recording was cut short: its last stop is left out, because it may lack receptions".to_owned(),
        );
    }
    if !run.metadata.contains_key(ORIGIN_METADATA) {
        notes.push("the recording does not say what made it".to_owned());
    }
    let seed = run.metadata.get(ORIGIN_METADATA).and_then(|origin| origin.get("seed")?.parse().ok());
    let known = recording::read_known(path, run.log.node_count())?;
    let truth = recording::read_truth(path)?;
    Ok(Input { log: run.log, paths: run.paths, scenario, truth, known, seed: Seed(seed.unwrap_or(1)), notes })
}

/// The true place of each node of the log. A node whose place is unknown cannot be measured: then nothing is.
fn places(truth: &BTreeMap<String, Position>, log: &ReceptionLog, notes: &mut Vec<String>) -> Option<Vec<Position>> {
    let unknown: Vec<_> = log.names().iter().filter(|name| !truth.contains_key(*name)).collect();
    if let Some(first) = unknown.first() {
        notes.push(format!(
            "the true places of {} of {} nodes are unknown (`{first}`): the maps are not measured",
            unknown.len(),
            log.node_count()
        ));
        return None;
    }
    Some(log.names().iter().map(|name| truth[name]).collect())
}

/// `DIR/MAP.NAME.csv` for `DIR/MAP.csv`.
fn beside(out: &Path, name: &str) -> PathBuf {
    let mut file = out.file_stem().unwrap_or_default().to_owned();
    file.push(format!(".{name}"));
    if let Some(extension) = out.extension() {
        file.push(".");
        file.push(extension);
    }
    out.with_file_name(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn further_maps_are_named_beside_the_first() {
        assert_eq!(beside(Path::new("a/map.csv"), "coarse"), Path::new("a/map.coarse.csv"));
        assert_eq!(beside(Path::new("map"), "coarse"), Path::new("map.coarse"));
    }
}
