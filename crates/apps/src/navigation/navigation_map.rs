//! The map that robots and nodes were given.

use sextant_channel::{Bounds, Position};
use sextant_kernel::NodeId;

/// Rank of the neighbour whose distance tells the spacing of the nodes.
const RANK: usize = 4;

/// A map of the nodes that robots and nodes were given: a topology map, or the true places.
#[derive(Clone, Debug, PartialEq)]
pub struct NavigationMap {
    places: Vec<Option<Position>>,
    frame: MapFrame,
    bounds: Bounds,
    spacing_m: f64,
}

/// What is known of the frame of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapFrame {
    /// It is that of the odometry of robots, as in maps from what robots heard.
    Robot,
    /// Its orientation, its handedness and its scale are unknown, as in maps from neighbours alone. Its lengths are no
    /// metres.
    Unknown,
}

impl NavigationMap {
    /// A map with these places of the nodes, by node (m); `None` if a node is not on the map. `None` if fewer than
    /// three nodes are.
    #[must_use]
    pub fn new(places: Vec<Option<Position>>, frame: MapFrame) -> Option<Self> {
        let known: Vec<Position> = places.iter().copied().flatten().collect();
        if known.len() < 3 {
            return None;
        }
        let bounds = Bounds::of(known.iter().copied())?;
        let spacing_m = spacing_m(&known);
        Some(Self { places, frame, bounds, spacing_m })
    }

    /// The place of a node; `None` if it is not on the map.
    #[must_use]
    pub fn place(&self, node: NodeId) -> Option<Position> {
        *self.places.get(node.index())?
    }

    /// The places of all nodes, by node.
    #[must_use]
    pub fn places(&self) -> &[Option<Position>] {
        &self.places
    }

    /// What is known of its frame.
    #[must_use]
    pub fn frame(&self) -> MapFrame {
        self.frame
    }

    /// The smallest box around the nodes.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Typical distance between nodes (m): the median distance to the fourth nearest one. On a square lattice this is
    /// its spacing; if nodes lie at random with n of them on a square metre it is about 1/sqrt(n).
    #[must_use]
    pub fn spacing_m(&self) -> f64 {
        self.spacing_m
    }
}

fn spacing_m(places: &[Position]) -> f64 {
    let rank = RANK.min(places.len() - 1);
    let mut distances = Vec::with_capacity(places.len());
    let mut of_node: Vec<f64> = places
        .iter()
        .map(|&place| {
            distances.clear();
            distances.extend(places.iter().map(|&other| place.distance_m(other)));
            // The node itself comes first.
            *distances.select_nth_unstable_by(rank, f64::total_cmp).1
        })
        .collect();
    let middle = of_node.len() / 2;
    *of_node.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spacing_of_a_square_lattice_is_that_of_its_sites() {
        let site = |i: u32| Some(Position::new(1.5 * f64::from(i % 20), 1.5 * f64::from(i / 20), 0.0));
        let map = NavigationMap::new((0..400).map(site).collect(), MapFrame::Robot).unwrap();
        assert!((map.spacing_m() - 1.5).abs() < 1e-12);
        assert_eq!(map.bounds().max, Position::new(28.5, 28.5, 0.0));
    }

    #[test]
    fn two_places_are_no_map() {
        let places = vec![Some(Position::ORIGIN), None, Some(Position::new(1.0, 0.0, 0.0))];
        assert_eq!(NavigationMap::new(places, MapFrame::Robot), None);
    }
}
