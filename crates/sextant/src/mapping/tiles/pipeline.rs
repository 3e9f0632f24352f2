//! The stages of a map tile by tile.

use std::fmt;
use std::path::{Path, PathBuf};

use sextant_channel::Reception;
use sextant_kernel::text::counted;
use sextant_kernel::{Interrupted, Watch};
use sextant_mapper::{EstimatorFindings, Knowledge, TopologyMap};
use sextant_recording as recording;
use sextant_scenario::{MapJob, MapSettings};

use super::budget::{Budget, free_bytes};
use super::kept::KeptTiles;
use super::plan::{Plan, tiles};
use super::spill::Spill;
use super::survey::{Survey, looked};
use super::tile_count::TileCount;
use super::tiled_log::{Router, TiledLog};
use crate::Summary;
use crate::mapping::TilesError;
use crate::mapping::pipeline::{Stages, knowledge};
use crate::mapping::{ComputedMap, Input, MapLogError};
use crate::summary::{LogCounts, Stopwatch};

/// How a log is divided, and what that takes.
#[derive(Clone, Debug)]
pub struct Tiling {
    plan: Plan,
    nodes: usize,
    stops: usize,
    receptions: u64,
    spilled_bytes: u64,
    memory_bytes: u64,
}

impl Tiling {
    /// The tiles of a log with this `survey`, read into `input`.
    ///
    /// # Errors
    /// If an algorithm cannot map tile by tile, the tiles are smaller than the reach, or the memory is too small.
    pub fn new(
        input: &Input,
        survey: &Survey,
        settings: &MapSettings,
        count: TileCount,
    ) -> Result<Self, MapLogError> {
        let census = &survey.census;
        let first = input.logs.names().next();
        for job in &settings.maps {
            job.mapper.check_parts()?;
            if let Some(network) =
                job.network.as_deref().filter(|&network| first.is_some_and(|first| first != network))
            {
                return Err(TilesError::Networks { map: job.name.clone(), network: network.to_owned() }.into());
            }
        }
        let (stops, nodes) = (input.log().stops().len(), input.log().node_count());
        let tiles = tiles(count, census, [stops, nodes], free_bytes())?;
        let plan = Plan::new(census, tiles);
        let budget = Budget::of(census, stops, nodes);
        Ok(Self {
            nodes,
            stops,
            receptions: census.receptions(),
            spilled_bytes: census.columns.spilled_bytes() * census.receptions(),
            memory_bytes: budget.fixed_bytes + budget.of_tile(plan.most_receptions, plan.most_nodes),
            plan,
        })
    }
}

impl Tiling {
    /// Number of tiles.
    #[must_use]
    pub fn tiles(&self) -> usize {
        self.plan.tiles.len()
    }
}

impl fmt::Display for Tiling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let megabytes = |bytes: u64| bytes.div_ceil(1_000_000);
        write!(
            f,
            "{} with {} receptions at {} in {} of at most {} receptions: about {} MB of memory, and {} MB in a temporary file",
            counted(self.nodes, "node"),
            self.receptions,
            counted(self.stops, "stop"),
            counted(self.plan.tiles.len(), "tile"),
            self.plan.most_receptions,
            megabytes(self.memory_bytes),
            megabytes(self.spilled_bytes)
        )
    }
}

/// Where a map of tiles goes, and its tiles.
#[derive(Clone, Copy, Debug, Default)]
pub struct TileFolders<'a> {
    /// The file of the map. The temporary file is beside it, or in the folder of the system for such files.
    pub out: Option<&'a Path>,
    /// Tiles that are not made again. Each one that is made is kept there.
    pub kept: Option<&'a KeptTiles>,
}

/// Computes the maps of `settings` tile by tile, and does with them what [`map`](crate::mapping::map) does.
///
/// # Errors
/// If a map cannot be computed or a file cannot be written.
pub fn map_tiles<'a>(
    input: &mut Input,
    survey: Survey,
    tiling: Tiling,
    settings: &'a MapSettings,
    TileFolders { out, kept }: TileFolders<'_>,
    start: Stopwatch,
    watch: &dyn Watch,
) -> Result<(Summary, Vec<ComputedMap<'a>>), MapLogError> {
    let (log, counts) = tiled(input, survey, tiling, out, watch)?;
    let stages = Stages { settings, out, start, watch, counts };
    stages.run(input, &mut |input, job| mapped(input, &log, settings, job, kept, watch))
}

/// Makes tiles of the maps of `settings`, and keeps them: no map is written. Returns how many tiles there are of each map.
///
/// # Errors
/// If a tile cannot be made or kept, or there is none of those that are asked for.
pub fn make_tiles(
    input: &mut Input,
    survey: Survey,
    tiling: Tiling,
    settings: &MapSettings,
    kept: &KeptTiles,
    watch: &dyn Watch,
) -> Result<usize, MapLogError> {
    let tiles = tiling.plan.tiles.len();
    kept.check(tiles)?;
    kept.open()?;
    // The temporary file must not be that of another process which makes tiles of this log.
    let own = kept.folder.join(format!("{}", std::process::id()));
    let (log, _) = tiled(input, survey, tiling, Some(&own), watch)?;
    for job in &settings.maps {
        mapped(input, &log, settings, job, Some(kept), watch)?;
    }
    Ok(tiles)
}

/// The map `job`, with the tiles that are `kept`.
fn mapped(
    input: &Input,
    log: &TiledLog,
    settings: &MapSettings,
    job: &MapJob,
    kept: Option<&KeptTiles>,
    watch: &dyn Watch,
) -> Result<(TopologyMap, Option<EstimatorFindings>), MapLogError> {
    let knowledge = knowledge(input, settings, Knowledge::from(input.log()));
    Ok(match kept {
        Some(kept) => job.mapper.map_parts(&kept.of_map(log, input, settings, job)?, knowledge, watch)?,
        None => job.mapper.map_parts(log, knowledge, watch)?,
    })
}

/// Puts the receptions of a log into the tiles of its plan.
fn tiled(
    input: &mut Input,
    survey: Survey,
    tiling: Tiling,
    out: Option<&Path>,
    watch: &dyn Watch,
) -> Result<(TiledLog, LogCounts), MapLogError> {
    let Survey { census, rows } = survey;
    let mut spill = Spill::create(&temporary(out), tiling.plan.tiles.len(), tiling.spilled_bytes)?;
    let router = Router::new(&tiling.plan, tiling.nodes);
    let mut pass = SecondPass { router: &router, spill: &mut spill, count: 0, failed: None, watch };
    let read = match (&rows, &input.recording) {
        (Some(rows), _) => rows.rows(&mut |row, _| pass.take(&row)).map_err(MapLogError::from),
        (None, Some(path)) => {
            let network = input.logs.names().next();
            recording::stream_log(path, network, &mut |reception, _| Ok(pass.take(&reception)?))
                .map(|_| ())
                .map_err(MapLogError::from)
        }
        (None, None) => Ok(()),
    };
    if let Some(why) = pass.failed {
        return Err(why.into());
    }
    read?;
    if pass.count != tiling.receptions {
        return Err(TilesError::Changed.into());
    }
    spill.finish()?;
    drop(router);
    let whole = input.log().clone();
    match rows {
        Some(rows) => {
            let (log, notes, counts) = TiledLog::of_rows(whole, tiling.plan, spill, rows, watch)?;
            input.notes.extend(notes);
            Ok((log, counts))
        }
        None => Ok((TiledLog::new(whole, tiling.plan, spill, census.columns.sectors), census.log_counts())),
    }
}

/// The second pass over a log, which puts each reception into its tile.
struct SecondPass<'a> {
    router: &'a Router,
    spill: &'a mut Spill,
    count: u64,
    failed: Option<TilesError>,
    watch: &'a dyn Watch,
}

impl SecondPass<'_> {
    /// Takes a reception. An error of the tiles ends the pass, and is told later.
    fn take(&mut self, reception: &Reception) -> Result<(), Interrupted> {
        match self.router.route(reception, self.spill) {
            Ok(true) => looked(&mut self.count, self.watch),
            Ok(false) => {
                self.failed = Some(TilesError::Changed);
                Err(Interrupted)
            }
            Err(why) => {
                self.failed = Some(why);
                Err(Interrupted)
            }
        }
    }
}

/// The temporary file: `MAP.csv.tiles.part`.
fn temporary(out: Option<&Path>) -> PathBuf {
    let Some(out) = out else {
        return std::env::temp_dir().join(format!("sextant-{}.tiles.part", std::process::id()));
    };
    let mut path = out.as_os_str().to_owned();
    path.push(".tiles.part");
    path.into()
}
