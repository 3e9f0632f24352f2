//! The packets between a node and the stops, with an index by place.

use sextant_channel::{CellIndex, Position, Reception, ReceptionLog};
use sextant_kernel::NodeId;

use crate::grid_ml::directions::{Directions, covers};

/// Packets between one node and one stop.
#[derive(Clone, Copy, Debug)]
pub(super) struct CountedLink {
    pub(super) stop: u32,
    pub(super) place: Position,
    pub(super) received: u32,
    pub(super) missed: u32,
    /// The sector of a reception.
    pub(super) sector: Option<u8>,
}

impl CountedLink {
    /// Packets sent.
    pub(super) fn sent(&self) -> u32 {
        self.received.saturating_add(self.missed)
    }
}

/// The entries of the log for one node.
#[derive(Clone, Debug, Default)]
pub(super) struct Record {
    entries: Vec<Reception>,
}

impl Record {
    /// The entry for a stop, if the log has one.
    fn at(&self, stop: u32) -> Option<&Reception> {
        let found = self.entries.binary_search_by_key(&stop, |entry| entry.stop).ok()?;
        Some(&self.entries[found])
    }
}

/// The stops of a log, with an index of their places.
#[derive(Debug)]
pub(super) struct StopCounts<'a> {
    pub(super) log: &'a ReceptionLog,
    /// The sectors of the log, if they are evidence.
    pub(super) directions: Option<Directions>,
    cells: CellIndex,
}

impl<'a> StopCounts<'a> {
    /// Stops will be searched for within distances of about `range_m`.
    pub(super) fn new(log: &'a ReceptionLog, range_m: f64, directions: Option<Directions>) -> Self {
        let places: Vec<Position> = log.stops().iter().map(|stop| stop.position).collect();
        Self { log, directions, cells: CellIndex::new(&places, 0.25 * range_m) }
    }

    /// Reads the entries of the log for `node` into `record`.
    pub(super) fn read(&self, node: NodeId, record: &mut Record) {
        record.entries.clear();
        record.entries.extend(self.log.of(node));
    }

    /// Calls `found` with each link to a stop within `radius_m` of `place`.
    pub(super) fn within(&self, record: &Record, place: Position, radius_m: f64, mut found: impl FnMut(CountedLink)) {
        self.cells.within(place, radius_m, |stop| {
            found(self.link(stop, record.at(stop)));
        });
    }

    /// Calls `found` with each link of `record` to a stop beyond `radius_m` of `place`.
    pub(super) fn recorded_beyond(
        &self,
        record: &Record,
        place: Position,
        radius_m: f64,
        mut found: impl FnMut(CountedLink),
    ) {
        for entry in &record.entries {
            let link = self.link(entry.stop, Some(entry));
            let apart = link.place - place;
            if apart.dot(apart) > radius_m * radius_m {
                found(link);
            }
        }
    }

    /// The link to a stop. One packet is missed if the log has no entry.
    fn link(&self, stop: u32, entry: Option<&Reception>) -> CountedLink {
        let place = self.log.stops()[stop as usize].position;
        let (received, sent) = entry.map_or((0, 1), |entry| (entry.received, entry.sent));
        let sector = entry.and_then(|entry| entry.sector).filter(|_| received > 0);
        CountedLink { stop, place, received, missed: sent - received, sector }
    }

    /// Whether a link says something about a place: a stop that heard nothing does not where no sector points.
    pub(super) fn tells(&self, link: &CountedLink, place: Position) -> bool {
        link.received > 0 || covers(self.directions.as_ref(), place - link.place)
    }
}
