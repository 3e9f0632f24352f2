//! What was sent and received between a node and the stops, found by place.

use sextant_channel::{Position, Reception, ReceptionLog};

use crate::cells::CellIndex;

/// Packets between one node and one stop.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub(super) stop: u32,
    pub(super) place: Position,
    pub(super) received: u32,
    pub(super) missed: u32,
}

/// The stops of a log, by place.
#[derive(Debug)]
pub(super) struct Counts<'a> {
    pub(super) log: &'a ReceptionLog,
    cells: CellIndex,
}

impl<'a> Counts<'a> {
    /// Stops are looked for within distances of about `range_m`.
    pub(super) fn new(log: &'a ReceptionLog, range_m: f64) -> Self {
        let places: Vec<Position> = log.stops().iter().map(|stop| stop.position).collect();
        Self { log, cells: CellIndex::new(&places, 0.25 * range_m) }
    }

    /// Calls `found` with each link to a stop within `radius_m` of `place`, for the node with these `receptions`.
    pub(super) fn within(
        &self,
        receptions: &[Reception],
        place: Position,
        radius_m: f64,
        mut found: impl FnMut(Link),
    ) {
        self.cells.within(place, radius_m, |stop| {
            let entry = receptions.binary_search_by_key(&stop, |reception| reception.stop).map(|i| &receptions[i]);
            // A stop without an entry missed one packet.
            let (received, missed) = entry.map_or((0, 1), |entry| (entry.received, entry.sent - entry.received));
            found(Link { stop, place: self.log.stops()[stop as usize].position, received, missed });
        });
    }

    /// Calls `found` with each link beyond `radius_m` of `place` over which something was received.
    pub(super) fn received_beyond(
        &self,
        receptions: &[Reception],
        place: Position,
        radius_m: f64,
        mut found: impl FnMut(Link),
    ) {
        for reception in receptions.iter().filter(|reception| reception.received > 0) {
            let stop = self.log.stops()[reception.stop as usize].position;
            let apart = stop - place;
            if apart.dot(apart) > radius_m * radius_m {
                let (received, missed) = (reception.received, reception.sent - reception.received);
                found(Link { stop: reception.stop, place: stop, received, missed });
            }
        }
    }
}
