//! The neighbours that a station of RPL keeps.

use sextant_kernel::{SimTime, StationId};

use super::link::LinkStatistics;
use super::rank::Rank;

/// Most neighbours in the table, as in Contiki-NG.
const MOST: usize = 16;

/// A neighbour.
#[derive(Clone, Debug)]
pub(super) struct Neighbour {
    pub(super) station: StationId,
    /// The rank that it told last; infinite if that was forgotten.
    pub(super) rank: Rank,
    /// Its number of requests for registrations.
    pub(super) dtsn: u8,
    pub(super) link: LinkStatistics,
    /// Since when the way by it is better than that by the parent.
    pub(super) better_since: Option<SimTime>,
}

/// The neighbours in the table.
#[derive(Clone, Debug, Default)]
pub(super) struct Neighbours(Vec<Neighbour>);

impl Neighbours {
    pub(super) fn get(&self, station: StationId) -> Option<&Neighbour> {
        self.0.iter().find(|neighbour| neighbour.station == station)
    }

    pub(super) fn get_mut(&mut self, station: StationId) -> Option<&mut Neighbour> {
        self.0.iter_mut().find(|neighbour| neighbour.station == station)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Neighbour> {
        self.0.iter()
    }

    pub(super) fn iter_mut(&mut self) -> impl Iterator<Item = &mut Neighbour> {
        self.0.iter_mut()
    }

    /// The entry of a neighbour that told this rank. In a full table it takes the place of the one by which a station would have
    /// the greatest rank, as `rank_via` says, if its own rank is less; never that of those that are `kept`.
    pub(super) fn entry(
        &mut self,
        station: StationId,
        rank: Rank,
        rank_via: impl Fn(Rank, &LinkStatistics) -> Rank,
        kept: impl Fn(StationId) -> bool,
    ) -> Option<&mut Neighbour> {
        if let Some(place) = self.0.iter().position(|neighbour| neighbour.station == station) {
            return self.0.get_mut(place);
        }
        let link = LinkStatistics::default();
        if self.0.len() >= MOST {
            let others = self.0.iter().enumerate().filter(|(_, neighbour)| !kept(neighbour.station));
            let via = |neighbour: &Neighbour| rank_via(neighbour.rank, &neighbour.link);
            let (place, worst) = others.max_by_key(|(_, neighbour)| (via(neighbour), neighbour.station))?;
            if rank_via(rank, &link) >= via(worst) {
                return None;
            }
            self.0.remove(place);
        }
        self.0.push(Neighbour { station, rank, dtsn: 0, link, better_since: None });
        self.0.last_mut()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_table_makes_room_for_a_shorter_way_only() {
        let mut table = Neighbours::default();
        let via = |rank: Rank, link: &LinkStatistics| rank.plus(link.etx().into());
        for station in 0..16 {
            let rank = Rank(1000 + 10 * station);
            assert!(table.entry(StationId(station.into()), rank, via, |_| false).is_some());
        }
        assert!(table.entry(StationId(20), Rank(1150), via, |_| false).is_none(), "not better than the worst");
        assert!(table.entry(StationId(21), Rank(900), via, |kept| kept == StationId(15)).is_some());
        assert!(table.get(StationId(14)).is_none() && table.get(StationId(15)).is_some());
    }
}
