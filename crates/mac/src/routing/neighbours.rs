//! The neighbours that a station keeps in its table, with their links and what they told of their way.

use sextant_kernel::StationId;

use super::MOST_LINK_ETX;
use super::estimate::LinkEstimate;
use super::packet::Beacon;

/// Most neighbours in the table, as in TinyOS.
const MOST: usize = 10;
/// A neighbour with a link of more expected transmissions makes room for another one.
const EVICTED_ABOVE_ETX: f64 = 6.5;

/// A neighbour.
#[derive(Clone, Debug)]
pub(super) struct Neighbour {
    pub(super) station: StationId,
    pub(super) link: LinkEstimate,
    /// What its last beacon told.
    parent: Option<StationId>,
    cost: Option<f64>,
}

/// The neighbours in the table.
#[derive(Clone, Debug, Default)]
pub(super) struct Neighbours(Vec<Neighbour>);

impl Neighbour {
    /// Expected transmissions of a packet of the station `own` to the root by way of it; `None` if there is no such way.
    pub(super) fn cost_of(&self, own: StationId) -> Option<f64> {
        let etx = self.link.etx().filter(|&etx| etx < MOST_LINK_ETX)?;
        self.cost.filter(|_| self.parent != Some(own)).map(|cost| cost + etx)
    }

    /// The same while its link is not known, as if that were perfect.
    fn cost_at_best(&self) -> f64 {
        self.cost.unwrap_or(f64::INFINITY) + self.link.etx().unwrap_or(1.0)
    }
}

impl Neighbours {
    pub(super) fn get_mut(&mut self, station: StationId) -> Option<&mut Neighbour> {
        self.0.iter_mut().find(|neighbour| neighbour.station == station)
    }

    pub(super) fn get(&self, station: StationId) -> Option<&Neighbour> {
        self.0.iter().find(|neighbour| neighbour.station == station)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Neighbour> {
        self.0.iter()
    }

    /// A beacon of `station` was heard. In a full table it takes the place of a neighbour with a bad link, or of the one
    /// with the most expensive way, if its own way could be cheaper; never that of `parent`.
    pub(super) fn heard(&mut self, station: StationId, beacon: &Beacon, parent: Option<StationId>) {
        if self.get(station).is_none() && !self.make_room(beacon, parent) {
            return;
        }
        if self.get(station).is_none() {
            self.0.push(Neighbour { station, link: LinkEstimate::default(), parent: None, cost: None });
        }
        if let Some(neighbour) = self.get_mut(station) {
            neighbour.link.heard(beacon.number);
            (neighbour.parent, neighbour.cost) = (beacon.parent, beacon.cost);
        }
    }

    /// Whether there is room for one more, or was made.
    fn make_room(&mut self, beacon: &Beacon, parent: Option<StationId>) -> bool {
        if self.0.len() < MOST {
            return true;
        }
        let others = self.0.iter().enumerate().filter(|(_, neighbour)| Some(neighbour.station) != parent);
        let etx = |neighbour: &Neighbour| neighbour.link.etx().unwrap_or(0.0);
        let bad = others.clone().max_by(|(_, a), (_, b)| etx(a).total_cmp(&etx(b)));
        let victim = bad.filter(|(_, bad)| etx(bad) > EVICTED_ABOVE_ETX).or_else(|| {
            let dearest = others.max_by(|(_, a), (_, b)| a.cost_at_best().total_cmp(&b.cost_at_best()));
            dearest.filter(|(_, dearest)| beacon.cost.is_some_and(|cost| cost + 1.0 < dearest.cost_at_best()))
        });
        let place = victim.map(|(place, _)| place);
        place.map(|place| self.0.remove(place)).is_some()
    }
}
