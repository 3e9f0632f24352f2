//! The stages of `map`: compute, measure, write, summarise.

use std::path::{Path, PathBuf};

use sextant_kernel::Watch;
use sextant_mapper::{EstimatorFindings, FrameKnowledge, Knowledge, TopologyMap};
use sextant_scenario::{MapJob, MapSettings};

use super::error::MapLogError;
use super::input::Input;
use super::logs::MapLogs;
use super::notes;
use crate::measure::{Subject, Truth, in_world, measure};
use crate::summary::{GatheringSummary, LogCounts, MapSummary, Stopwatch, Summary, Timing, peak_rss_bytes};

/// A map that was computed from a log.
#[derive(Clone, Debug)]
pub struct ComputedMap<'a> {
    /// Its name and its algorithm.
    pub named: &'a MapJob,
    /// The map, in world coordinates.
    pub map: TopologyMap,
    /// What else was estimated from the log.
    pub learned: Option<EstimatorFindings>,
}

/// Computes the maps of `settings` from the log of `input`, measures them if the true positions are known, writes them to
/// the file `out` and files beside it, and returns the results and the maps. `start` is when the work began. If `watch` stops the
/// work, the results are those of the finished maps.
///
/// # Errors
/// If a map cannot be computed or a file cannot be written.
pub fn map<'a>(
    input: &mut Input,
    settings: &'a MapSettings,
    out: Option<&Path>,
    start: Stopwatch,
    watch: &dyn Watch,
) -> Result<(Summary, Vec<ComputedMap<'a>>), MapLogError> {
    let counts = LogCounts::of(input.log());
    let stages = Stages { settings, out, start, watch, counts };
    stages.run(input, &mut |input, job| {
        let logs = MapLogs::from(&input.logs);
        let (mut map, learned) = job.mapper.map_and_learn(knowledge(input, settings, logs.knowledge(job)), watch)?;
        if let Some(path) = &input.estimated_path {
            path.widen(&mut map);
        }
        Ok((map, learned))
    })
}

/// What a map may know: of its `logs`, and with them.
pub(super) fn knowledge<'a>(input: &'a Input, settings: &'a MapSettings, logs: Knowledge<'a>) -> Knowledge<'a> {
    Knowledge {
        // Latitudes and longitudes are those of all robots.
        frames: if input.plane.is_some() { FrameKnowledge::SharedByAll } else { logs.frames },
        neighbours: input.known.neighbours.as_ref(),
        beacons: input.known.beacons.as_ref(),
        anchors: &input.known.anchors,
        obstacles: input.floor.as_ref().or(settings.obstacles.as_ref()),
        prior: input.prior.as_ref(),
        seed: input.seed,
        ..logs
    }
}

/// A map, and what was learned with it.
pub(super) type Solved = Result<(TopologyMap, Option<EstimatorFindings>), MapLogError>;

/// The stages of all maps, whichever way they are computed.
pub(super) struct Stages<'a, 'w> {
    pub(super) settings: &'a MapSettings,
    pub(super) out: Option<&'w Path>,
    pub(super) start: Stopwatch,
    pub(super) watch: &'w dyn Watch,
    /// What the log of the input has.
    pub(super) counts: LogCounts,
}

impl<'a> Stages<'a, '_> {
    /// Computes each map by `solve`, measures it, writes it, and summarises all.
    pub(super) fn run(
        self,
        input: &mut Input,
        solve: &mut dyn FnMut(&Input, &MapJob) -> Solved,
    ) -> Result<(Summary, Vec<ComputedMap<'a>>), MapLogError> {
        let Self { settings, out, start, watch, counts } = self;
        let truth = input.true_places();
        let dimensions = input.true_dimensions;
        if let (Some(name), None) = (&input.odometry, &input.estimated_path) {
            input.notes.push(notes::of_odometry(name));
        }
        input.notes.extend(notes::of_log(input.log(), &counts));
        let map_start = Stopwatch::start();
        let mut summaries: Vec<MapSummary> = Vec::new();
        let mut maps = Vec::new();
        let mut interrupted = false;
        let mut found: Vec<String> = Vec::new();
        for named in &settings.maps {
            let made = solve(input, named).and_then(|(map, learned)| {
                let (map, alignment) = in_world(map, truth.as_deref());
                let truth =
                    truth.as_deref().map(|places| Truth { places, anchors: &input.known.anchors, dimensions });
                let subject = Subject::new(named, MapLogs::from(&input.logs).of(named));
                let names = input.log().names();
                let summary = measure(&subject, &map, learned.as_ref(), names, truth, &settings.metrics, watch)?;
                Ok((ComputedMap { named, map, learned }, alignment, summary))
            });
            let (computed, alignment, summary) = match made {
                Err(MapLogError::Interrupted(_)) => {
                    interrupted = true;
                    break;
                }
                made => made?,
            };
            summaries.push(MapSummary { alignment: Some(alignment), ..summary }.judged());
            if let Some(out) = out {
                let path = file_of(out, summaries.len() - 1, &named.name);
                sextant_logs::write_map(&path, input.log().names(), &computed.map, input.plane.as_ref())?;
            }
            if input.recording.is_none() {
                let (places, learned) = (computed.map.positions(), computed.learned.as_ref());
                for note in notes::of_map(input, &places, learned, truth.as_deref()) {
                    if !found.contains(&note) {
                        found.push(note);
                    }
                }
            }
            maps.push(computed);
        }
        input.notes.extend(found);
        let summary = Summary {
            gathering: Some(GatheringSummary::of_log(input.log(), &counts, &input.paths)),
            interrupted,
            notes: input.notes.clone(),
            path: input.estimated_path.as_ref().map(|path| path.fit.value()),
            maps: summaries,
            timing: Some(Timing {
                wall_s: start.elapsed_s(),
                map_s: Some(map_start.elapsed_s()),
                peak_rss_bytes: peak_rss_bytes(),
                ..Timing::default()
            }),
            ..Summary::default()
        };
        Ok((summary, maps))
    }
}

/// The files that the maps of `settings` are written to: the file `out`, and files beside it.
#[must_use]
pub fn map_files(out: &Path, settings: &MapSettings) -> Vec<PathBuf> {
    settings.maps.iter().enumerate().map(|(i, map)| file_of(out, i, &map.name)).collect()
}

/// The file of the map of this number and name.
fn file_of(out: &Path, number: usize, name: &str) -> PathBuf {
    if number == 0 { out.to_owned() } else { beside(out, name) }
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
    fn further_maps_have_the_name_of_the_map_in_their_file_name() {
        assert_eq!(beside(Path::new("a/map.csv"), "coarse"), Path::new("a/map.coarse.csv"));
        assert_eq!(beside(Path::new("map"), "coarse"), Path::new("map.coarse"));
    }
}
