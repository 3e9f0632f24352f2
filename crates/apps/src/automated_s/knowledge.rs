//! What a survey robot knows: where it listened, what it heard there, and which obstacles it met.

use sextant_channel::{Bounds, Position};
use sextant_sim::{HeardNode, Situation};

use super::rules::Rules;
use super::visit::Visit;
use crate::route::{Search, distance_to_drive_m};

/// A node, as the robot knows it.
#[derive(Clone, Copy, Debug, Default)]
struct Acquaintance {
    /// Total number of packets heard.
    packets: u32,
    /// The strongest signal heard from it (dBm), and the stop where it was heard.
    best: Option<(f64, usize)>,
    /// How often the robot returned to that stop for it.
    returns: u32,
}

/// A free place that the robot saw, but where it did not stop.
#[derive(Clone, Copy, Debug)]
struct Opening {
    place: Position,
    /// The stop nearest to it, and how far that is (m).
    nearest: (usize, f64),
}

/// Everything the robot has learned.
#[derive(Clone, Debug, Default)]
pub(super) struct Knowledge {
    pub(super) visits: Vec<Visit>,
    nodes: Vec<Acquaintance>,
    /// Free places at one lane spacing, and at half of it, from stops that heard a node.
    openings: Vec<Opening>,
    /// Known points on obstacles.
    contacts: Vec<Position>,
    /// Radius of the robot's own hull, as its first contact showed (m).
    hull_m: f64,
}

/// The four directions along which the robot looks at each stop.
const CROSS: [Position; 4] = [
    Position::new(1.0, 0.0, 0.0),
    Position::new(0.0, 1.0, 0.0),
    Position::new(-1.0, 0.0, 0.0),
    Position::new(0.0, -1.0, 0.0),
];
/// Up and down: two more directions if the lanes are in layers.
const UP_AND_DOWN: [Position; 2] = [Position::new(0.0, 0.0, 1.0), Position::new(0.0, 0.0, -1.0)];
/// Number of directions in which the robot looks when it meets an obstacle.
const ROUND: u32 = 16;

impl Knowledge {
    /// Records a stop: the nodes heard, and the directions that are free. Places that `rules` do not allow do not
    /// count as free.
    pub(super) fn note_stop(&mut self, situation: &Situation<'_>, heard: &[HeardNode], rules: &Rules) {
        let settings = &rules.settings;
        self.nodes.resize(situation.node_count.max(self.nodes.len()), Acquaintance::default());
        let place = situation.position;
        let stop = self.visits.len();
        let mut audible = 0;
        for heard in heard.iter().filter(|heard| heard.packets > 0) {
            audible += 1;
            let Some(node) = self.nodes.get_mut(heard.node.index()) else { continue };
            node.packets = node.packets.saturating_add(heard.packets);
            if node.best.is_none_or(|(loudest_dbm, _)| heard.rssi_dbm > loudest_dbm) {
                node.best = Some((heard.rssi_dbm, stop));
                node.returns = 0;
            }
        }
        let is_silent = audible < settings.silent_below_nodes;
        let mut opened = Vec::new();
        let mut look = |direction: Position, range_m: f64| {
            let clear_m = situation.clearance_m(direction, range_m);
            if clear_m < range_m {
                self.add_contact(place + direction * (clear_m + self.hull_m));
            }
            let free = [1.0, 0.5].map(|share| share * range_m).into_iter().filter(|&far_m| clear_m >= far_m);
            let open = free.map(|far_m| place + direction * far_m).filter(|&place| !is_silent && rules.allow(place));
            opened.extend(open);
            clear_m
        };
        for direction in CROSS {
            look(direction, settings.lane_spacing_m);
        }
        let clear_m = match settings.layers {
            Some(layers) => UP_AND_DOWN.map(|direction| look(direction, layers.spacing_m)),
            None => [0.0; 2],
        };
        self.visits.push(Visit { place, audible, is_silent, clear_m });
        self.add_openings(&opened);
    }

    /// Records which openings the last stop is near to, and the openings seen from it.
    fn add_openings(&mut self, opened: &[Position]) {
        let Some((stop, visit)) = self.visits.iter().enumerate().next_back() else { return };
        for opening in &mut self.openings {
            let far_m = visit.place.distance_m(opening.place);
            if far_m < opening.nearest.1 {
                opening.nearest = (stop, far_m);
            }
        }
        for &place in opened {
            let distances = self.visits.iter().map(|visit| visit.place.distance_m(place)).enumerate();
            let nearest = distances.min_by(|(_, a), (_, b)| a.total_cmp(b)).unwrap_or((stop, 0.0));
            self.openings.push(Opening { place, nearest });
        }
    }

    /// Records an obstacle that the robot met, and looks for further points in all directions.
    pub(super) fn note_contact(&mut self, situation: &Situation<'_>, contact: Position, range_m: f64) {
        let place = situation.position;
        if self.hull_m <= 0.0 {
            self.hull_m = place.distance_m(contact);
        }
        self.contacts.push(contact);
        for i in 0..ROUND {
            let angle_rad = std::f64::consts::TAU * f64::from(i) / f64::from(ROUND);
            let direction = Position::new(libm::cos(angle_rad), libm::sin(angle_rad), 0.0);
            let clear_m = situation.clearance_m(direction, range_m);
            if clear_m < range_m {
                self.add_contact(place + direction * (clear_m + self.hull_m));
            }
        }
    }

    /// Adds a point on an obstacle unless a point near it is known.
    fn add_contact(&mut self, contact: Position) {
        let near_m = 0.5 * self.hull_m;
        if self.contacts.iter().all(|known| known.distance_m(contact) > near_m) {
            self.contacts.push(contact);
        }
    }

    /// Number of stops.
    pub(super) fn stops(&self) -> usize {
        self.visits.len()
    }

    /// Whether the last stop heard enough nodes not to count as silent.
    pub(super) fn hears_somebody(&self) -> bool {
        self.visits.last().is_some_and(|visit| !visit.is_silent)
    }

    /// Whether one of the stops with these numbers is within `radius_m` of `place`.
    pub(super) fn was_near(&self, place: Position, radius_m: f64, stops: std::ops::Range<usize>) -> bool {
        self.visits[stops].iter().any(|visit| visit.place.distance_m(place) <= radius_m)
    }

    /// Whether each node was heard `packets` times.
    pub(super) fn heard_all(&self, packets: u32) -> bool {
        !self.nodes.is_empty() && self.nodes.iter().all(|node| node.packets >= packets)
    }

    /// Whether there are nodes that were never heard, or that were heard fewer than `packets` times although the
    /// robot returned `returns` times for them.
    pub(super) fn misses_nodes(&self, packets: u32, returns: u32) -> bool {
        let is_missed =
            |node: &Acquaintance| node.packets < packets && (node.packets == 0 || node.returns >= returns);
        self.nodes.iter().any(is_missed)
    }

    /// The nearest free place in the network without a stop within `radius_m`.
    pub(super) fn nearest_opening(&self, here: Position, radius_m: f64) -> Option<Position> {
        let uncovered = self.openings.iter().filter(|opening| opening.nearest.1 > radius_m);
        nearest(uncovered.map(|opening| opening.place), here)
    }

    /// The nearest gap: a free place without a stop within `radius_m`, whose nearest stop heard at least half as many
    /// nodes as the stop that heard most.
    pub(super) fn nearest_gap(&self, here: Position, radius_m: f64) -> Option<Position> {
        let most = self.visits.iter().map(|visit| visit.audible).max()?;
        let is_gap = |opening: &&Opening| {
            let (visit, far_m) = opening.nearest;
            far_m > radius_m && 2 * self.visits[visit].audible >= most
        };
        nearest(self.openings.iter().filter(is_gap).map(|opening| opening.place), here)
    }

    /// Forgets the openings at `place`, because they need no visit or cannot be reached.
    pub(super) fn give_up_opening(&mut self, place: Position) {
        self.openings.retain(|opening| opening.place != place);
    }

    /// The nearest stop at which a node with missing packets was heard with the strongest signal. The robot returns
    /// at most `returns` times for each node.
    pub(super) fn place_to_listen_again(&mut self, here: Position, packets: u32, returns: u32) -> Option<Position> {
        let wanted = |node: &Acquaintance| node.packets < packets && node.returns < returns;
        let place = |node: &Acquaintance| Some(self.visits[node.best?.1].place);
        let target = nearest(self.nodes.iter().filter(|node| wanted(node)).filter_map(place), here)?;
        let visits = &self.visits;
        for node in self.nodes.iter_mut().filter(|node| wanted(node)) {
            if node.best.is_some_and(|(_, stop)| visits[stop].place == target) {
                node.returns += 1;
            }
        }
        Some(target)
    }

    /// A way to `to` that avoids all known points on obstacles, in steps of `lattice_m`. Unknown space counts as free
    /// (Koenig and Likhachev 2005). The first drive is free as far as the range sensors see, which is `range_m`.
    pub(super) fn way(
        &self,
        situation: &Situation<'_>,
        to: Position,
        lattice_m: f64,
        range_m: f64,
    ) -> Option<Vec<Position>> {
        let here = situation.position;
        let bounds = Bounds::of(self.visits.iter().map(|visit| visit.place))?.grown(range_m);
        let keep_m = self.hull_m + 0.5 * lattice_m;
        let is_free = |a: Position, b: Position| {
            self.contacts.iter().all(|&contact| {
                // A robot that stands close to an obstacle may leave it.
                let (from_m, to_m) = (a.distance_m(contact), b.distance_m(contact));
                distance_to_drive_m(contact, a, b) >= keep_m.min(from_m) && (to_m >= keep_m || to_m >= from_m)
            })
        };
        let passable = |a: Position, b: Position| {
            let length_m = a.distance_m(b);
            if a != here {
                // The goal may be close to an obstacle: the robot has been there, or has seen that it is free.
                return (b == to && length_m <= keep_m + lattice_m) || is_free(a, b);
            }
            let seen_m = length_m.min(range_m);
            length_m <= 0.0
                || situation.clearance_m(b - a, seen_m) >= seen_m
                    && (seen_m >= length_m || is_free(a + (b - a) * (seen_m / length_m), b))
        };
        let search = Search { bounds, step_m: lattice_m, reach_m: keep_m + lattice_m };
        search.way_over(here, to, passable)
    }
}

fn nearest(places: impl Iterator<Item = Position>, here: Position) -> Option<Position> {
    places.min_by(|a, b| a.distance_m(here).total_cmp(&b.distance_m(here)))
}
