//! The tree that beacons build: each station chooses a parent by the expected transmissions to the root.

use sextant_kernel::StationId;

use super::neighbours::Neighbours;
use super::packet::Beacon;

/// A way that is better by so many transmissions than the one told last is told soon (TinyOS: 2 ETX).
const TOLD_SOON_ETX: f64 = 2.0;

/// The place of a station in a tree that beacons build.
///
/// The cost of a station is that of its parent and the link to it; the root has 0. The parent is the neighbour by which the
/// cost is least, but it is kept as long as no other one is better by more than the hysteresis.
#[derive(Clone, Debug)]
pub struct Collection {
    own: StationId,
    is_root: bool,
    hysteresis_etx: f64,
    neighbours: Neighbours,
    parent: Option<StationId>,
    /// The cost that was told in the last beacon.
    told: Option<f64>,
    /// Number of the next beacon.
    number: u8,
}

/// What follows from something that a station heard, or that became of its frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reaction {
    /// The station has another parent, or none, than before.
    pub has_changed_parent: bool,
    /// Its beacons must come soon.
    pub is_inconsistent: bool,
}

impl Collection {
    /// The root of a tree.
    #[must_use]
    pub fn of_root(own: StationId) -> Self {
        Self { is_root: true, ..Self::of_node(own, 0.0) }
    }

    /// A node that changes its parent for another one that is better by more than `hysteresis_etx` transmissions.
    #[must_use]
    pub fn of_node(own: StationId, hysteresis_etx: f64) -> Self {
        let neighbours = Neighbours::default();
        Self { own, is_root: false, hysteresis_etx, neighbours, parent: None, told: None, number: 0 }
    }

    /// To whom it sends packets to the root.
    #[must_use]
    pub fn parent(&self) -> Option<StationId> {
        self.parent
    }

    /// Expected transmissions of a packet to the root; `None` without a way.
    #[must_use]
    pub fn cost(&self) -> Option<f64> {
        if self.is_root { Some(0.0) } else { self.cost_by(self.parent?) }
    }

    /// Expected transmissions of a packet to the parent; `None` without one.
    #[must_use]
    pub fn parent_etx(&self) -> Option<f64> {
        self.neighbours.get(self.parent?)?.link.etx()
    }

    fn cost_by(&self, parent: StationId) -> Option<f64> {
        self.neighbours.get(parent)?.cost_of(self.own)
    }

    /// The beacon to send now.
    pub fn beacon(&mut self) -> Beacon {
        let (parent, cost) = (self.parent, self.cost());
        self.told = cost;
        self.number = self.number.wrapping_add(1);
        Beacon { parent, cost, number: self.number, pulls: cost.is_none() }
    }

    /// A beacon of a neighbour was heard.
    pub fn heard(&mut self, from: StationId, beacon: &Beacon) -> Reaction {
        let is_pulled = beacon.pulls && self.cost().is_some();
        if self.is_root {
            return Reaction { is_inconsistent: is_pulled, has_changed_parent: false };
        }
        self.neighbours.heard(from, beacon, self.parent);
        let reaction = self.choose();
        Reaction { is_inconsistent: reaction.is_inconsistent || is_pulled, ..reaction }
    }

    /// A frame to a neighbour was sent so many times, and acknowledged or not.
    pub fn sent(&mut self, to: StationId, transmissions: u32, acknowledged: u32) -> Reaction {
        let Some(neighbour) = self.neighbours.get_mut(to) else { return Reaction::default() };
        neighbour.link.sent(transmissions, acknowledged);
        self.choose()
    }

    /// A packet came from a station that is `cost` from the root: the way of a packet must lead down. If it does not, there may
    /// be a loop, and beacons must come soon.
    #[must_use]
    pub fn is_uphill(&self, cost: Option<f64>) -> bool {
        match (cost, self.cost()) {
            // In tenths, as costs are told.
            (Some(theirs), Some(own)) => theirs <= (10.0 * own).round() / 10.0,
            (_, None) => true,
            (None, Some(_)) => false,
        }
    }

    /// Chooses the parent.
    fn choose(&mut self) -> Reaction {
        let (before, had_way) = (self.parent, self.parent.and_then(|parent| self.cost_by(parent)));
        let mut best: Option<(StationId, f64)> = None;
        for neighbour in self.neighbours.iter() {
            if let Some(cost) = neighbour.cost_of(self.own)
                && best.is_none_or(|(_, least)| cost < least)
            {
                best = Some((neighbour.station, cost));
            }
        }
        self.parent = match (best, had_way) {
            (Some((_, least)), Some(current)) if least + self.hysteresis_etx >= current => before,
            (best, _) => best.map(|(station, _)| station),
        };
        let cost = self.cost();
        let is_inconsistent = match (self.told, cost) {
            (None, None) => false,
            (Some(told), Some(cost)) => cost + TOLD_SOON_ETX <= told,
            (Some(_), None) | (None, Some(_)) => true,
        };
        Reaction { has_changed_parent: self.parent != before, is_inconsistent }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROOT: StationId = StationId(0);
    const OWN: StationId = StationId(9);

    fn beacon(cost: f64, number: u8) -> Beacon {
        Beacon { parent: None, cost: Some(cost), number, pulls: false }
    }

    /// `from` is heard with each of these numbers.
    fn hear(tree: &mut Collection, from: u32, cost: f64, numbers: &[u8]) {
        for &number in numbers {
            tree.heard(StationId(from), &beacon(cost, number));
        }
    }

    /// One of three beacons of the root arrives, all of those of the other: 3 against 1 + 1.
    #[test]
    fn two_good_hops_are_better_than_a_bad_one() {
        let mut tree = Collection::of_node(OWN, 0.0);
        hear(&mut tree, ROOT.0, 0.0, &[0, 3]);
        assert_eq!((tree.parent(), tree.cost()), (Some(ROOT), Some(2.0)), "two of four");
        hear(&mut tree, 1, 0.5, &[0, 1, 2]);
        assert_eq!((tree.parent(), tree.cost()), (Some(StationId(1)), Some(1.5)));
    }

    #[test]
    fn a_parent_is_kept_until_another_is_better_by_more_than_the_hysteresis() {
        let parent = |hysteresis_etx| {
            let mut tree = Collection::of_node(OWN, hysteresis_etx);
            hear(&mut tree, 1, 2.0, &[0, 1, 2]);
            hear(&mut tree, 2, 0.6, &[0, 1, 2]);
            tree.parent()
        };
        assert_eq!((parent(1.5), parent(1.3)), (Some(StationId(1)), Some(StationId(2))));
    }

    #[test]
    fn a_parent_that_acknowledges_nothing_is_replaced_and_that_is_told_at_once() {
        let mut tree = Collection::of_node(OWN, 1.5);
        hear(&mut tree, 1, 0.0, &[0, 1, 2]);
        hear(&mut tree, 2, 0.0, &[0, 1, 2]);
        assert_eq!(tree.parent(), Some(StationId(1)));
        tree.beacon();
        let frames = (1..20).find(|_| tree.sent(StationId(1), 4, 0).has_changed_parent);
        // Samples of 8, 12 and 16 transmissions: 1.7, 2.73, and 4.06 is more than 1 + 1.5 after the second.
        assert_eq!((frames, tree.parent()), (Some(3), Some(StationId(2))));
    }

    #[test]
    fn a_station_without_a_way_asks_for_beacons_and_is_answered() {
        let mut tree = Collection::of_node(OWN, 1.5);
        let asks = tree.beacon();
        assert!(asks.pulls && asks.cost.is_none());
        let mut root = Collection::of_root(ROOT);
        assert!(root.heard(OWN, &asks).is_inconsistent);
        hear(&mut tree, ROOT.0, 0.0, &[0, 1]);
        let found = tree.heard(ROOT, &beacon(0.0, 2));
        assert_eq!(found, Reaction { has_changed_parent: true, is_inconsistent: true });
    }

    #[test]
    fn a_child_is_no_parent_and_a_packet_must_come_from_farther_away() {
        let mut tree = Collection::of_node(OWN, 1.5);
        for number in 0..3 {
            tree.heard(StationId(4), &Beacon { parent: Some(OWN), ..beacon(3.0, number) });
        }
        assert_eq!(tree.parent(), None);
        assert!(tree.is_uphill(Some(3.0)));
        hear(&mut tree, ROOT.0, 0.0, &[0, 1, 2]);
        assert_eq!((tree.is_uphill(Some(2.0)), tree.is_uphill(Some(1.0))), (false, true));
    }

    /// Ten neighbours fill the table. An eleventh with a cheaper way takes the place of the dearest, one with a dearer way
    /// none.
    #[test]
    fn a_full_table_makes_room_for_a_cheaper_way_only() {
        let mut tree = Collection::of_node(OWN, 0.0);
        for station in 10..20 {
            hear(&mut tree, station, f64::from(station), &[0, 1, 2]);
        }
        hear(&mut tree, 30, 50.0, &[0, 1, 2]);
        assert!(tree.neighbours.get(StationId(30)).is_none());
        hear(&mut tree, 31, 1.0, &[0, 1, 2]);
        assert_eq!((tree.parent(), tree.cost()), (Some(StationId(31)), Some(2.0)));
        assert!(tree.neighbours.get(StationId(19)).is_none() && tree.neighbours.get(StationId(10)).is_some());
    }
}
