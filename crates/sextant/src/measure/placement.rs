//! Where the places of a map are in the world.

use sextant_channel::Position;
use sextant_mapper::{Reflection, Similarity};

/// Places of which none is farther from the line through them than this share of their extent are on a line.
const SLIMMEST: f64 = 0.1;

/// Where the places of a map are in the world. The map as a whole is brought onto the true places of its nodes by a
/// similarity, then the neighbourhood of each place by one of its own (Gunathillake 2018, section 6.4: Procrustes analysis
/// with the nodes around the robot).
#[derive(Clone, Debug)]
pub(crate) struct Placement {
    /// `None` for the true places themselves.
    whole: Option<Similarity>,
    /// Where the first similarity brings each node, and its true place (m).
    pairs: Vec<(Position, Position)>,
    neighbourhood_m: f64,
}

impl Placement {
    /// The places of a map that are those of the world.
    #[must_use]
    pub(crate) fn of_truth() -> Self {
        Self { whole: None, pairs: Vec::new(), neighbourhood_m: 0.0 }
    }

    /// Those of a map with these `places` of nodes whose true places are `truth`. `reflection` says whether the map as a
    /// whole may be a mirror image; its parts may not. The nodes within `neighbourhood_m` of a place are its
    /// neighbourhood. `None` if the nodes determine no similarity.
    #[must_use]
    pub(crate) fn of_map(
        places: &[Option<Position>],
        truth: &[Position],
        reflection: Reflection,
        neighbourhood_m: f64,
    ) -> Option<Self> {
        let known = places.iter().zip(truth).filter_map(|(place, &truth)| Some(((*place)?, truth)));
        let pairs: Vec<(Position, Position)> = known.collect();
        let whole = Similarity::fit(&pairs, reflection).ok()?;
        let pairs = pairs.into_iter().map(|(place, truth)| (whole.apply(place), truth)).collect();
        Some(Self { whole: Some(whole), pairs, neighbourhood_m })
    }

    /// The place in the world that a place on the map stands for. If fewer than three nodes are around it, or they are on
    /// a line, the similarity of the whole map decides alone.
    #[must_use]
    pub(crate) fn in_world(&self, place: Position) -> Position {
        let Some(whole) = &self.whole else { return place };
        self.refined(whole.apply(place))
    }

    /// The place in the world of a place that the first similarity has brought there.
    fn refined(&self, place: Position) -> Position {
        let is_near = |pair: &&(Position, Position)| pair.0.distance_m(place) <= self.neighbourhood_m;
        let near: Vec<(Position, Position)> = self.pairs.iter().filter(is_near).copied().collect();
        let is_broad = |of: fn(&(Position, Position)) -> Position| !is_line(&near.iter().map(of).collect::<Vec<_>>());
        if near.len() < 3 || !is_broad(|pair| pair.0) || !is_broad(|pair| pair.1) {
            return place;
        }
        Similarity::fit(&near, Reflection::Forbidden).map_or(place, |own| own.apply(place))
    }

    /// Distances of the nodes of the map from where they really are (m); none for the true places.
    #[must_use]
    pub(crate) fn errors_m(&self) -> Vec<f64> {
        self.pairs.iter().map(|&(place, truth)| self.refined(place).distance_m(truth)).collect()
    }
}

/// Whether `places` are on a line, or nearly so.
fn is_line(places: &[Position]) -> bool {
    let share = 1.0 / places.len().max(1) as f64;
    let middle = places.iter().fold(Position::ORIGIN, |sum, &place| sum + place * share);
    let arms: Vec<Position> = places.iter().map(|&place| place - middle).collect();
    let length_m = |arm: Position| arm.dot(arm).sqrt();
    let Some(&longest) = arms.iter().max_by(|a, b| length_m(**a).total_cmp(&length_m(**b))) else { return true };
    let reach_m = length_m(longest);
    let aside_m = |arm: Position| {
        let along = arm.dot(longest) / reach_m;
        (arm.dot(arm) - along * along).max(0.0).sqrt()
    };
    arms.into_iter().all(|arm| aside_m(arm) <= SLIMMEST * reach_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice() -> Vec<Position> {
        (0..36_u8).map(|i| Position::new(f64::from(i % 6), f64::from(i / 6), 0.0)).collect()
    }

    /// Turned by 90 degrees, three times as large and moved; mirrored if asked.
    fn changed(place: Position, mirror: f64) -> Position {
        Position::new(7.0 - 3.0 * place.y_m, 1.0 + 3.0 * mirror * place.x_m, 0.0)
    }

    #[test]
    fn a_turned_scaled_and_mirrored_map_is_undone() {
        let truth = lattice();
        let map: Vec<_> = truth.iter().map(|&place| Some(changed(place, -1.0))).collect();
        let placement = Placement::of_map(&map, &truth, Reflection::Allowed, 2.0).unwrap();
        let place = Position::new(2.3, 4.1, 0.0);
        assert!(placement.in_world(changed(place, -1.0)).distance_m(place) < 1e-9);
        assert!(placement.errors_m().iter().all(|&error_m| error_m < 1e-9));
        // A map in the frame of a robot cannot be a mirror image: the parts keep what the whole got wrong.
        let forbidden = Placement::of_map(&map, &truth, Reflection::Forbidden, 2.0);
        assert!(forbidden.is_none_or(|placement| placement.in_world(changed(place, -1.0)).distance_m(place) > 0.1));
    }

    #[test]
    fn each_half_of_a_bent_map_is_straight_again() {
        let truth = lattice();
        // The right half is shifted north by two metres.
        let bent = |place: Position| place + Position::new(0.0, if place.x_m > 2.5 { 2.0 } else { 0.0 }, 0.0);
        let map: Vec<_> = truth.iter().map(|&place| Some(bent(place))).collect();
        let placement = Placement::of_map(&map, &truth, Reflection::Forbidden, 1.2).unwrap();
        for place in [Position::new(0.4, 2.6, 0.0), Position::new(4.6, 2.6, 0.0)] {
            let error_m = placement.in_world(bent(place)).distance_m(place);
            assert!(error_m < 0.15, "{error_m} m");
        }
        let whole = placement.whole.as_ref().unwrap().apply(bent(Position::new(0.4, 2.6, 0.0)));
        assert!(whole.distance_m(Position::new(0.4, 2.6, 0.0)) > 0.3, "the whole map alone is worse");
    }

    #[test]
    fn few_nodes_or_nodes_on_a_line_do_not_turn_a_place() {
        let truth: Vec<_> = (0..9_u8).map(|i| Position::new(f64::from(i), f64::from(i % 2) * 0.01, 0.0)).collect();
        assert!(is_line(&truth) && !is_line(&lattice()));
        let mut truth = truth;
        truth.push(Position::new(4.0, 9.0, 0.0));
        let map: Vec<_> = truth.iter().map(|&place| Some(place)).collect();
        let placement = Placement::of_map(&map, &truth, Reflection::Forbidden, 3.0).unwrap();
        for place in [Position::new(4.5, 1.0, 0.0), Position::new(4.5, 8.0, 0.0)] {
            assert!(placement.in_world(place).distance_m(place) < 1e-9);
        }
        assert!(Placement::of_map(&map[..2], &truth[..2], Reflection::Forbidden, 3.0).is_none());
        assert!(Placement::of_truth().in_world(truth[3]).distance_m(truth[3]) < 1e-12);
    }
}
