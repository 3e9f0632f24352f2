//! The packets between a node and the stops, with an index by place.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;

use crate::cells::CellIndex;

/// Packets between one node and one stop.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub(super) stop: u32,
    pub(super) place: Position,
    pub(super) received: u32,
    pub(super) missed: u32,
}

impl Link {
    /// Packets sent.
    pub(super) fn sent(&self) -> u32 {
        self.received.saturating_add(self.missed)
    }
}

/// The entries of the log for one node: stop, packets received and packets missed.
#[derive(Clone, Debug, Default)]
pub(super) struct Record {
    entries: Vec<(u32, u32, u32)>,
}

impl Record {
    /// Packets received and missed at a stop. One packet is missed if the log has no entry.
    fn at(&self, stop: u32) -> (u32, u32) {
        match self.entries.binary_search_by_key(&stop, |&(stop, ..)| stop) {
            Ok(found) => (self.entries[found].1, self.entries[found].2),
            Err(_) => (0, 1),
        }
    }
}

/// The stops of a log, with an index of their places.
#[derive(Debug)]
pub(super) struct Counts<'a> {
    pub(super) log: &'a ReceptionLog,
    cells: CellIndex,
}

impl<'a> Counts<'a> {
    /// Stops will be searched for within distances of about `range_m`.
    pub(super) fn new(log: &'a ReceptionLog, range_m: f64) -> Self {
        let places: Vec<Position> = log.stops().iter().map(|stop| stop.position).collect();
        Self { log, cells: CellIndex::new(&places, 0.25 * range_m) }
    }

    /// Reads the entries of the log for `node` into `record`.
    pub(super) fn read(&self, node: NodeId, record: &mut Record) {
        record.entries.clear();
        let receptions = self.log.of(node).iter();
        record.entries.extend(receptions.map(|entry| (entry.stop, entry.received, entry.sent - entry.received)));
    }

    /// Calls `found` with each link to a stop within `radius_m` of `place`.
    pub(super) fn within(&self, record: &Record, place: Position, radius_m: f64, mut found: impl FnMut(Link)) {
        self.cells.within(place, radius_m, |stop| {
            let (received, missed) = record.at(stop);
            found(Link { stop, place: self.log.stops()[stop as usize].position, received, missed });
        });
    }

    /// Calls `found` with each link of `record` to a stop beyond `radius_m` of `place`.
    pub(super) fn recorded_beyond(
        &self,
        record: &Record,
        place: Position,
        radius_m: f64,
        mut found: impl FnMut(Link),
    ) {
        for &(stop, received, missed) in &record.entries {
            let position = self.log.stops()[stop as usize].position;
            let apart = position - place;
            if apart.dot(apart) > radius_m * radius_m {
                found(Link { stop, place: position, received, missed });
            }
        }
    }
}
