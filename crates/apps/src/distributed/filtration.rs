//! Node filtration: does the place of a node agree with those of its neighbours?

use sextant_channel::Position;

/// The error of neighbour scattering, E_NS (Gunathillake 2018, eq. 5.8): the share of the neighbours that a node has
/// received and that lie beyond the radius of communication by the coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scattering {
    /// Neighbours with coordinates.
    pub neighbours: usize,
    /// Those that are too far away.
    pub scattered: usize,
}

/// What the filtration makes of a node.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Category {
    /// It becomes an anchor (C_a).
    NewAnchor,
    /// Its coordinates are good (C_g).
    Good,
    /// Its coordinates are bad, or it has none (C_b).
    #[default]
    Bad,
}

impl Scattering {
    /// That of a node at `place` among `neighbours` (m), of which each lies within `range_m` in truth. Without a place
    /// there is none.
    pub(super) fn of(place: Option<Position>, neighbours: impl Iterator<Item = Position>, range_m: f64) -> Self {
        let Some(place) = place else { return Self::default() };
        neighbours.fold(Self::default(), |sum, neighbour| Self {
            neighbours: sum.neighbours + 1,
            scattered: sum.scattered + usize::from(place.distance_m(neighbour) > range_m),
        })
    }

    /// The share; `None` without neighbours.
    #[must_use]
    pub fn share(&self) -> Option<f64> {
        (self.neighbours > 0).then(|| self.scattered as f64 / self.neighbours as f64)
    }
}

impl Category {
    /// The category of a node with this scattering; without neighbours it is bad. A node that is not `sure` of its place
    /// does not become an anchor.
    pub(super) fn of(scattering: Scattering, new_anchor_below: f64, bad_above: f64, is_sure: bool) -> Self {
        match scattering.share() {
            Some(share) if share <= new_anchor_below && is_sure => Self::NewAnchor,
            Some(share) if share <= bad_above => Self::Good,
            _ => Self::Bad,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_beyond_the_radius_are_scattered() {
        let neighbours = [1.0, 6.9, 7.0, 7.1, 20.0].map(|x_m| Position::new(x_m, 0.0, 0.0));
        let scattering = Scattering::of(Some(Position::ORIGIN), neighbours.into_iter(), 7.0);
        assert_eq!(scattering, Scattering { neighbours: 5, scattered: 2 });
        assert_eq!(scattering.share(), Some(0.4));
        assert_eq!(Scattering::of(None, neighbours.into_iter(), 7.0).share(), None);
    }

    #[test]
    fn a_node_without_neighbours_is_bad() {
        let of =
            |scattered, neighbours, is_sure| Category::of(Scattering { neighbours, scattered }, 0.1, 0.2, is_sure);
        assert_eq!(of(0, 0, true), Category::Bad);
        assert_eq!(of(1, 10, true), Category::NewAnchor);
        assert_eq!(of(1, 10, false), Category::Good);
        assert_eq!([of(2, 10, true), of(3, 10, true)], [Category::Good, Category::Bad]);
    }
}
