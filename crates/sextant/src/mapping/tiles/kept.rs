//! Tiles that are kept in a folder, so that a map can be made in pieces, by several machines, or go on after an interruption.

use std::io;
use std::path::{Path, PathBuf};

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;
use sextant_kernel::text::hexadecimal;
use sextant_mapper::{
    Concern, CoordinateFrame, Estimate, HeightReason, LogParts, PartsError, SoughtHeights, TopologyMap,
};
use sextant_recording::ForeignFolder;
use sextant_recording::disk;
use sextant_recording::output::store::NumberRange;
use sextant_recording::output::{CsvFile, EmptyCell, write_file};
use sextant_scenario::{MapJob, MapSettings};
use sha2::{Digest, Sha256};

use super::tiled_log::TiledLog;
use crate::mapping::{Input, TilesError};

/// Begins the first line of a tile.
const MARK: &str = "sextant-tile-2";

/// The most that is read of a tile (octets).
const LARGEST_TILE: u64 = 1 << 30;

/// A folder with finished tiles, and which tiles are to be made.
#[derive(Clone, Debug)]
pub struct KeptTiles {
    /// The folder. Somebody else may have made the tiles in it.
    pub folder: PathBuf,
    /// The tiles to make, from 0; all if absent.
    pub only: Option<NumberRange>,
}

/// The tiles of one map, with those that are kept.
#[derive(Debug)]
pub(super) struct KeptLog<'a> {
    log: &'a TiledLog,
    folder: PathBuf,
    only: Option<NumberRange>,
    /// What the tiles are of: the log, the settings and the version.
    identity: String,
    name: &'static str,
}

impl KeptTiles {
    /// Rejects tiles that a log in so many `tiles` has not.
    pub(super) fn check(&self, tiles: usize) -> Result<(), TilesError> {
        match self.only {
            Some(only) if only.end > tiles => Err(TilesError::NoSuchTiles { found: only, tiles }),
            _ => Ok(()),
        }
    }

    /// Creates the folder if it does not exist.
    pub(super) fn open(&self) -> Result<(), TilesError> {
        disk::create_folders(&self.folder).map_err(|why| unwritten(&self.folder, &why))
    }

    /// The tiles of the map `job` of `input`, which are in the subfolder with its name.
    pub(super) fn of_map<'a>(
        &self,
        log: &'a TiledLog,
        input: &Input,
        settings: &MapSettings,
        job: &MapJob,
    ) -> Result<KeptLog<'a>, TilesError> {
        let folder = self.folder.join(&job.name);
        disk::create_folders(&folder).map_err(|why| unwritten(&folder, &why))?;
        let mut digest = Sha256::new();
        let version = env!("CARGO_PKG_VERSION");
        let known = (&settings.obstacles, &input.prior, &input.known.anchors, input.seed);
        for text in [format!("{version} {job:?} {known:?}"), format!("{:?}", log.whole().stops())] {
            digest.update(text);
        }
        digest.update(log.sha256());
        let identity = hexadecimal(&digest.finalize());
        Ok(KeptLog { log, folder, only: self.only, identity, name: job.mapper.name() })
    }
}

impl KeptLog<'_> {
    fn path(&self, tile: usize) -> PathBuf {
        self.folder.join(format!("{tile:06}.csv"))
    }

    /// What a tile is of: its nodes are those of no other one.
    fn identity(&self, tile: usize) -> String {
        let nodes: Vec<String> = self.log.nodes(tile).iter().map(|node| node.0.to_string()).collect();
        hexadecimal(&Sha256::digest(format!("{} {tile} {}", self.identity, nodes.join(" "))))
    }

    /// The map of a tile as text.
    fn written(&self, tile: usize, map: &TopologyMap) -> CsvFile {
        let mut file = CsvFile::headless(EmptyCell::Bare);
        let number = |number: Option<f64>| number.map_or_else(String::new, |number| format!("{number:?}"));
        let (reason, span_m) = match map.heights.map(|heights| heights.reason) {
            None => ("", None),
            Some(HeightReason::Settings) => ("settings", None),
            Some(HeightReason::LevelStops) => ("level-stops", None),
            Some(HeightReason::UnevenStops(span_m)) => ("uneven-stops", Some(span_m)),
            Some(HeightReason::Reach) => ("reach", None),
        };
        let (low_m, high_m) = (map.heights.map(|heights| heights.low_m), map.heights.map(|heights| heights.high_m));
        file.row([
            MARK.to_owned(),
            self.identity(tile),
            map.estimates.len().to_string(),
            map.vertices_evaluated.to_string(),
            number(map.grid_step_m),
            reason.to_owned(),
            number(span_m),
            number(low_m),
            number(high_m),
        ]);
        for (i, estimate) in map.estimates.iter().enumerate() {
            let Some(estimate) = estimate else { continue };
            let Position { x_m, y_m, z_m } = estimate.position;
            let place = [x_m, y_m, z_m].map(|number| format!("{number:?}"));
            let covariance = estimate.covariance.iter().flatten().flatten().map(|entry| format!("{entry:?}"));
            let row = [i.to_string()].into_iter().chain(place).chain([
                number(estimate.log_likelihood),
                estimate.ties.to_string(),
                u8::from(estimate.infeasible).to_string(),
                estimate.concern.map_or("", Concern::name).to_owned(),
            ]);
            file.row(row.chain(covariance));
        }
        file
    }

    /// The map in the text of a tile; why it is none.
    fn read_text(&self, tile: usize, text: &str) -> Result<TopologyMap, String> {
        let nodes = self.nodes(tile).len();
        let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text.as_bytes());
        let mut records = reader.records().map(|record| record.map_err(|error| error.to_string()));
        let head = records.next().ok_or("it is empty")??;
        if head.get(0) != Some(MARK) {
            return Err(format!("its first line is not `{MARK}`"));
        }
        if head.get(1) != Some(&self.identity(tile)) {
            return Err("it is another tile, or of another log, of other settings or of another version".to_owned());
        }
        let misfit = || "its first line is broken".to_owned();
        let count: usize = head.get(2).and_then(|text| text.parse().ok()).ok_or_else(misfit)?;
        if count != nodes {
            return Err(format!("it has {count} nodes, not {nodes}"));
        }
        let mut map = TopologyMap {
            estimates: vec![None; nodes],
            vertices_evaluated: head.get(3).and_then(|text| text.parse().ok()).ok_or_else(misfit)?,
            grid_step_m: optional(&head, 4).ok_or_else(misfit)?,
            heights: heights(&head).ok_or_else(misfit)?,
            ..TopologyMap::of_places(self.name, Vec::new(), CoordinateFrame::World)
        };
        for (i, record) in records.enumerate() {
            let (node, estimate) = estimate(&record?)
                .filter(|(node, _)| *node < nodes)
                .ok_or_else(|| format!("line {} is broken", i + 2))?;
            if map.estimates[node].replace(estimate).is_some() {
                return Err(format!("line {} is of a node that it has before", i + 2));
            }
        }
        Ok(map)
    }
}

impl LogParts for KeptLog<'_> {
    fn whole(&self) -> &ReceptionLog {
        self.log.whole()
    }

    fn count(&self) -> usize {
        self.log.count()
    }

    fn nodes(&self, part: usize) -> &[NodeId] {
        self.log.nodes(part)
    }

    fn read(&self, part: usize) -> Result<ReceptionLog, PartsError> {
        self.log.read(part)
    }

    fn is_wanted(&self, part: usize) -> bool {
        self.only.is_none_or(|only| only.has(part))
    }

    fn made(&self, part: usize) -> Result<Option<TopologyMap>, PartsError> {
        let path = self.path(part);
        let kept = ForeignFolder::new(self.folder.parent().unwrap_or(&self.folder));
        let text = match kept.read_text(&path, LARGEST_TILE) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            other => other.map_err(|error| TilesError::Kept { path: path.clone(), why: error.to_string() }),
        };
        let read = |text: String| self.read_text(part, &text);
        let map = text.and_then(|text| read(text).map_err(|why| TilesError::Kept { path, why }));
        map.map(Some).map_err(|error| PartsError::Read(error.into()))
    }

    fn keep(&self, part: usize, map: &TopologyMap) -> Result<(), PartsError> {
        let path = self.path(part);
        // Two processes may make the same tile; both files have the same octets.
        write_file(&path, self.written(part, map).bytes())
            .map_err(|error| PartsError::Read(TilesError::Kept { path: error.path, why: error.why }.into()))
    }
}

fn unwritten(path: &Path, why: &io::Error) -> TilesError {
    TilesError::Kept { path: path.to_owned(), why: why.to_string() }
}

/// A number, or nothing where the text is empty; `None` if it is neither.
fn optional(record: &csv::StringRecord, at: usize) -> Option<Option<f64>> {
    match record.get(at)? {
        "" => Some(None),
        text => finite(text).map(Some),
    }
}

/// A number that a place may have.
fn finite(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite())
}

fn heights(head: &csv::StringRecord) -> Option<Option<SoughtHeights>> {
    let span_m = optional(head, 6)?;
    let reason = match head.get(5)? {
        "" => return Some(None),
        "settings" => HeightReason::Settings,
        "level-stops" => HeightReason::LevelStops,
        "uneven-stops" => HeightReason::UnevenStops(span_m?),
        "reach" => HeightReason::Reach,
        _ => return None,
    };
    Some(Some(SoughtHeights { low_m: optional(head, 7)??, high_m: optional(head, 8)??, reason }))
}

/// The number of a node in its tile, and where it is.
fn estimate(record: &csv::StringRecord) -> Option<(usize, Estimate)> {
    let number = |at: usize| finite(record.get(at)?);
    let concern = match record.get(7)? {
        "" => None,
        name => Some(Concern::ALL.into_iter().find(|one| one.name() == name)?),
    };
    let covariance = match record.len() {
        8 => None,
        17 => {
            let mut entries = [[0.0; 3]; 3];
            for (at, entry) in (8..17).zip(entries.iter_mut().flatten()) {
                *entry = number(at)?;
            }
            Some(entries)
        }
        _ => return None,
    };
    let estimate = Estimate {
        position: Position::new(number(1)?, number(2)?, number(3)?),
        log_likelihood: match record.get(4)? {
            "" => None,
            text => Some(text.parse().ok().filter(|number: &f64| !number.is_nan())?),
        },
        ties: record.get(5)?.parse().ok()?,
        infeasible: match record.get(6)? {
            "0" => false,
            "1" => true,
            _ => return None,
        },
        concern,
        covariance,
    };
    Some((record.get(0)?.parse().ok()?, estimate))
}
