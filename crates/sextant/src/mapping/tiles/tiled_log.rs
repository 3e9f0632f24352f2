//! A log in tiles.

use sextant_channel::{Reception, ReceptionLog, ReceptionLogBuilder};
use sextant_kernel::{NodeId, Watch};
use sextant_logs::RowLog;
use sextant_mapper::{LogParts, PartsError};

use super::plan::Plan;
use super::spill::Spill;
use crate::mapping::{MapLogError, TilesError};
use crate::summary::LogCounts;

/// A log in tiles, whose receptions are in a temporary file.
#[derive(Debug)]
pub(super) struct TiledLog {
    whole: ReceptionLog,
    tiles: Vec<Vec<NodeId>>,
    spill: Spill,
    has_sectors: bool,
    /// The log of a robot, if the file has its rows.
    rows: Option<RowLog>,
}

/// The tile of each node, and its number there.
#[derive(Debug)]
pub(super) struct Router {
    places: Vec<Option<(u32, NodeId)>>,
}

impl Router {
    pub(super) fn new(plan: &Plan, nodes: usize) -> Self {
        let mut places = vec![None; nodes];
        for (tile, of_tile) in (0_u32..).zip(&plan.tiles) {
            for (number, node) in of_tile.iter().enumerate() {
                places[node.index()] = Some((tile, NodeId::from_index(number)));
            }
        }
        Self { places }
    }

    /// Adds a reception to the tile of its node. Whether it was expected: the node belongs to a tile.
    pub(super) fn route(&self, reception: &Reception, spill: &mut Spill) -> Result<bool, TilesError> {
        let Some(&Some((tile, node))) = self.places.get(reception.node.index()) else { return Ok(false) };
        spill.push(tile as usize, &Reception { node, ..*reception }).map(|()| true)
    }
}

impl TiledLog {
    /// The log with the stops and names of `whole` and the receptions in `spill`, by the tiles of `plan`.
    pub(super) fn new(whole: ReceptionLog, plan: Plan, spill: Spill, has_sectors: bool) -> Self {
        Self { whole, tiles: plan.tiles, spill, has_sectors, rows: None }
    }

    /// Hash of all receptions, and of the tiles that they are in.
    pub(super) fn sha256(&self) -> [u8; 32] {
        self.spill.sha256()
    }

    /// The same with the rows of the log of a robot in `spill`. Returns what the user should know of how they became receptions,
    /// and how much the log has.
    pub(super) fn of_rows(
        whole: ReceptionLog,
        plan: Plan,
        spill: Spill,
        mut rows: RowLog,
        watch: &dyn Watch,
    ) -> Result<(Self, Vec<String>, LogCounts), MapLogError> {
        for tile in 0..plan.tiles.len() {
            watch.check()?;
            rows.see(receptions(&spill, tile)?);
        }
        let notes = rows.fix_rule();
        let mut log = Self { rows: Some(rows), ..Self::new(whole, plan, spill, false) };
        let mut counts = LogCounts::default();
        let mut has_sectors = false;
        for tile in 0..log.tiles.len() {
            watch.check()?;
            let part = log.read(tile)?;
            has_sectors |= part.receptions().sectors().is_some();
            counts.add(LogCounts::of(&part), &log.tiles[tile]);
        }
        // Nodes that no row names belong to no tile.
        let mut is_listed = vec![false; log.whole.node_count()];
        log.tiles.iter().flatten().for_each(|node| is_listed[node.index()] = true);
        let unlisted = (0..).map(NodeId).zip(is_listed).filter(|(_, is_listed)| !is_listed).map(|(node, _)| node);
        counts.unheard.extend(unlisted);
        counts.unheard.sort_unstable();
        log.has_sectors = has_sectors;
        Ok((log, notes, counts))
    }
}

/// The receptions or rows of a tile.
fn receptions(spill: &Spill, tile: usize) -> Result<Vec<Reception>, TilesError> {
    let mut all = Vec::new();
    spill.read(tile, |reception| all.push(reception)).map(|()| all)
}

impl LogParts for TiledLog {
    fn whole(&self) -> &ReceptionLog {
        &self.whole
    }

    fn count(&self) -> usize {
        self.tiles.len()
    }

    fn nodes(&self, part: usize) -> &[NodeId] {
        &self.tiles[part]
    }

    fn read(&self, part: usize) -> Result<ReceptionLog, PartsError> {
        let failed = |why: TilesError| PartsError::Read(why.into());
        let mut receptions = match &self.rows {
            Some(rows) => rows.receptions(receptions(&self.spill, part).map_err(failed)?),
            None => {
                let mut receptions = ReceptionLogBuilder::default();
                self.spill.read(part, |reception| receptions.push(reception)).map_err(failed)?;
                receptions
            }
        };
        if self.has_sectors {
            receptions.keep_sectors();
        }
        let names = self.tiles[part].iter().map(|node| self.whole.names()[node.index()].clone()).collect();
        self.whole.part(names, receptions).map_err(|why| PartsError::Map(why.into()))
    }
}
