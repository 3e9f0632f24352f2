//! The part of a world that is simulated: what is near a listener.
//!
//! A listener is a robot that surveys. Nobody hears a node that is farther from every listener than a signal
//! reaches. It could still hold back nodes that are heard, by their carrier sense, and disturb them. So the halo of a listener is
//! as wide as both reaches together. Nodes beyond it rest: the frames of their schedule are counted, and not sent.

mod cover;
mod record;

use std::collections::BTreeMap;

use sextant_channel::Position;
use sextant_kernel::StationId;

use cover::Cover;

pub use record::{AllSimulated, SimulatedPart};

/// The halos round the listeners.
pub(crate) struct Halo {
    radius_m: f64,
    cover: Cover,
    /// Whether each station is a listener.
    listens: Vec<bool>,
    /// Where the halo of each listener was drawn last.
    drawn_at: BTreeMap<StationId, Position>,
    /// Stations that have come into a halo, and have not been told yet.
    reached: Vec<StationId>,
}

impl Halo {
    /// Halos of `radius_m` among nodes at `places`, in the order of the stations, round those that `listen`.
    pub(crate) fn new(radius_m: f64, places: impl Iterator<Item = Position> + Clone, listens: Vec<bool>) -> Self {
        let cover = Cover::new(places, radius_m, step_m(radius_m));
        Self { radius_m, cover, listens, drawn_at: BTreeMap::new(), reached: Vec::new() }
    }

    /// Whether a station is a listener.
    pub(crate) fn is_listener(&self, station: StationId) -> bool {
        self.listens[station.index()]
    }

    /// How far a listener may still move until its halo must be drawn anew (m).
    pub(crate) fn slack_m(&self, station: StationId, place: Position) -> f64 {
        match self.drawn_at.get(&station) {
            Some(drawn_at) => step_m(self.radius_m) - drawn_at.distance_m(place),
            None => 0.0,
        }
    }

    /// Draws the halo of a listener round `place`. It holds until the listener has moved by a step.
    pub(crate) fn draw(&mut self, station: StationId, place: Position) {
        self.drawn_at.insert(station, place);
        self.cover.draw(station, place, &mut self.reached);
    }

    /// How far a listener moves until its halo is drawn anew (m).
    pub(crate) fn step_m(&self) -> f64 {
        step_m(self.radius_m)
    }

    /// Whether a node is beyond all halos.
    pub(crate) fn is_outside(&self, node: StationId) -> bool {
        !self.cover.holds(node)
    }

    /// Whether stations have come into a halo.
    #[inline]
    pub(crate) fn has_reached(&self) -> bool {
        !self.reached.is_empty()
    }

    /// Takes the stations that have come into a halo.
    pub(crate) fn take_reached(&mut self) -> Vec<StationId> {
        std::mem::take(&mut self.reached)
    }

    /// Gives the emptied list back.
    pub(crate) fn give_back(&mut self, mut reached: Vec<StationId>) {
        reached.clear();
        self.reached = reached;
    }

    /// Radius of the halos (m).
    pub(crate) fn radius_m(&self) -> f64 {
        self.radius_m
    }

    /// How far nodes in a halo may be from its listener (m).
    pub(crate) fn reach_m(&self) -> f64 {
        self.cover.reach_m() + step_m(self.radius_m)
    }

    /// A station does not listen any more: it has no halo.
    pub(crate) fn lift(&mut self, station: StationId) {
        self.listens[station.index()] = false;
        self.cover.lift(station);
    }
}

/// How far a listener moves until its halo is drawn anew (m).
fn step_m(radius_m: f64) -> f64 {
    radius_m / 8.0
}
