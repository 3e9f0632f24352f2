//! The ways down that a station keeps if stations know those below them.

use std::collections::BTreeMap;

use sextant_kernel::{SimTime, StationId};

/// A way down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Route {
    next: StationId,
    /// Number of the message that told it.
    number: u8,
    until: SimTime,
}

/// What a message told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Learned {
    /// Something that those above do not know.
    News,
    /// What the last message of this number told: it came again, or went round.
    Known,
}

/// The table has no room for one more way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TableFull;

/// The ways down of a station, one for each station below it (RFC 6550, 9.8: storing mode).
#[derive(Clone, Debug)]
pub struct RouteTable {
    routes: BTreeMap<StationId, Route>,
    most: usize,
}

impl RouteTable {
    /// A table with room for so many ways.
    #[must_use]
    pub fn new(most: usize) -> Self {
        Self { routes: BTreeMap::new(), most }
    }

    /// `target` can be reached by way of `next` until then, says its message of this number.
    ///
    /// # Errors
    /// If it is not in the table, and that is full.
    pub fn learn(
        &mut self,
        target: StationId,
        next: StationId,
        number: u8,
        until: SimTime,
    ) -> Result<Learned, TableFull> {
        if self.routes.len() >= self.most && !self.routes.contains_key(&target) {
            return Err(TableFull);
        }
        let before = self.routes.insert(target, Route { next, number, until });
        Ok(if before.is_some_and(|before| before.number == number) { Learned::Known } else { Learned::News })
    }

    /// `target` can no longer be reached by way of `next`: whether that was the way.
    pub fn forget(&mut self, target: StationId, next: StationId) -> bool {
        let is_by_it = self.routes.get(&target).is_some_and(|route| route.next == next);
        is_by_it && self.routes.remove(&target).is_some()
    }

    /// The next station on the way to `target`.
    #[must_use]
    pub fn next(&self, target: StationId, now: SimTime) -> Option<StationId> {
        self.routes.get(&target).filter(|route| now < route.until).map(|route| route.next)
    }

    /// Removes ways that have expired.
    pub fn expire(&mut self, now: SimTime) {
        self.routes.retain(|_, route| now < route.until);
    }

    /// Number of ways.
    #[must_use]
    pub fn len(&self) -> usize {
        self.routes.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.routes.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_lasts_until_it_expires_or_its_next_station_takes_it_back() {
        let (s, at) = (StationId, SimTime::from_secs);
        let mut table = RouteTable::new(2);
        assert_eq!(table.learn(s(5), s(1), 1, at(10)), Ok(Learned::News));
        assert_eq!(table.learn(s(6), s(1), 1, at(20)), Ok(Learned::News));
        assert_eq!(table.learn(s(6), s(1), 1, at(20)), Ok(Learned::Known));
        assert_eq!(table.learn(s(7), s(1), 1, at(20)), Err(TableFull));
        assert_eq!(table.learn(s(5), s(2), 2, at(10)), Ok(Learned::News), "a way that is known may change");
        assert!(!table.forget(s(5), s(1)), "the way goes by another one");
        assert_eq!((table.next(s(5), at(9)), table.next(s(5), at(10))), (Some(s(2)), None));
        table.expire(at(10));
        assert_eq!((table.len(), table.learn(s(7), s(1), 1, at(20))), (1, Ok(Learned::News)));
        assert!(table.forget(s(7), s(1)) && table.forget(s(6), s(1)) && table.is_empty());
    }
}
