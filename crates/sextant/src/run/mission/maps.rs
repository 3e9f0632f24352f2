//! The maps that missions are given.

use sextant_apps::navigation::MapFrame;
use sextant_channel::Position;
use sextant_mapper::{CoordinateFrame, Reflection, Similarity, TopologyMap};
use sextant_scenario::{MissionMap, PlannedMission, Scenario};

use crate::measure::Placement;
use crate::run::error::RunError;

/// A map that was computed in this run, as a mission gets it: not aligned to the truth.
#[derive(Clone, Debug, PartialEq)]
pub struct UnalignedMap {
    /// Its name.
    pub name: String,
    places: Vec<Option<Position>>,
    frame: MapFrame,
}

impl UnalignedMap {
    /// Of a map that was computed. Of one that is only known part by part it is the largest part.
    #[must_use]
    pub fn new(name: &str, map: &TopologyMap) -> Self {
        let mut places = map.positions();
        let frame = match &map.frame {
            CoordinateFrame::World | CoordinateFrame::AlignedToAnchors => MapFrame::Robot,
            CoordinateFrame::Relative(part_of) => {
                let largest = largest(part_of, &places);
                for (place, part) in places.iter_mut().zip(part_of) {
                    *place = place.filter(|_| Some(*part) == largest);
                }
                MapFrame::Unknown
            }
        };
        Self { name: name.to_owned(), places, frame }
    }
}

/// The part with the most places; the first of them if several have as many.
fn largest(part_of: &[u32], places: &[Option<Position>]) -> Option<u32> {
    let placed = |part: u32| part_of.iter().zip(places).filter(|(of, place)| **of == part && place.is_some()).count();
    let last = *part_of.iter().max()?;
    (0..=last).max_by_key(|&part| (placed(part), std::cmp::Reverse(part)))
}

/// The map of an application: places of the nodes, what is known of its frame, and where it is in the world.
pub(super) struct WorkingMap {
    pub(super) places: Vec<Option<Position>>,
    pub(super) frame: MapFrame,
    pub(super) placement: Placement,
}

impl WorkingMap {
    /// The map of `application`, which is one of those that were `made` or is known before.
    pub(super) fn of(
        scenario: &Scenario,
        mission: &PlannedMission,
        made: &[&UnalignedMap],
    ) -> Result<Self, RunError> {
        let truth: Vec<Position> = scenario.world().nodes.iter().map(|node| node.position).collect();
        let (places, frame) = match &mission.map {
            MissionMap::Physical => {
                let places = truth.into_iter().map(Some).collect();
                return Ok(Self { places, frame: MapFrame::Robot, placement: Placement::of_truth() });
            }
            MissionMap::File { places, .. } => (places.clone(), frame_of(places, &truth)),
            MissionMap::Computed(name) => {
                let made = made.iter().find(|made| made.name == *name);
                let made = made.expect("the check of the scenario refuses unknown maps, and all are made before");
                (made.places.clone(), made.frame)
            }
        };
        let reflection = match frame {
            MapFrame::Robot => Reflection::Forbidden,
            MapFrame::Unknown => Reflection::Allowed,
        };
        let neighbourhood_m = scenario.metrics().neighbourhood_m.first().copied().unwrap_or(NEIGHBOURHOOD_M);
        let placement =
            Placement::of_map(&places, &truth, reflection, neighbourhood_m).ok_or_else(|| RunError::FewPlaces {
                map: mission.map.name().to_owned(),
                application: mission.name.clone(),
                places: places.iter().flatten().count(),
            })?;
        Ok(Self { places, frame, placement })
    }
}

/// The frame of a map that was made elsewhere. One that lies, as it is, much farther from the nodes than when it is aligned
/// is in a frame of its own: turned, mirrored, moved or of another scale.
fn frame_of(places: &[Option<Position>], truth: &[Position]) -> MapFrame {
    let known = places.iter().zip(truth).filter_map(|(place, &truth)| Some(((*place)?, truth)));
    let pairs: Vec<(Position, Position)> = known.collect();
    let Ok(aligned) = Similarity::fit(&pairs, Reflection::Allowed) else { return MapFrame::Robot };
    let share = 1.0 / pairs.len() as f64;
    let middle = pairs.iter().fold(Position::ORIGIN, |sum, pair| sum + pair.1 * share);
    let mean = |distance_m: &dyn Fn(&(Position, Position)) -> f64| share * pairs.iter().map(distance_m).sum::<f64>();
    let as_it_is_m = mean(&|&(place, truth)| place.distance_m(truth));
    let aligned_m = mean(&|&(place, truth)| aligned.apply(place).distance_m(truth));
    let extent_m = mean(&|&(_, truth)| truth.distance_m(middle));
    if as_it_is_m > FARTHER * aligned_m + OF_EXTENT * extent_m { MapFrame::Unknown } else { MapFrame::Robot }
}

/// A map is in a frame of its own if its places are so many times farther from the nodes than those of the aligned map, and by
/// more than this share of the usual distance of nodes from their middle.
const FARTHER: f64 = 2.0;
const OF_EXTENT: f64 = 0.05;

/// Radius of the neighbourhood of a place if the metrics have none (m).
const NEIGHBOURHOOD_M: f64 = 5.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_of_a_file_that_lies_elsewhere_than_the_nodes_is_in_a_frame_of_its_own() {
        let truth: Vec<Position> =
            (0..36_u8).map(|i| Position::new(f64::from(i % 6), f64::from(i / 6), 0.0)).collect();
        let noise = |i: usize| 0.1 * ((7 * i % 5) as f64 - 2.0);
        let of = |change: &dyn Fn(Position) -> Position| {
            let noisy =
                |(i, &place): (usize, &Position)| Some(change(place) + Position::new(noise(i), noise(i + 3), 0.0));
            frame_of(&truth.iter().enumerate().map(noisy).collect::<Vec<_>>(), &truth)
        };
        assert_eq!(of(&|place| place), MapFrame::Robot);
        assert_eq!(of(&|place| Position::new(-place.x_m, place.y_m, 0.0)), MapFrame::Unknown);
        assert_eq!(of(&|place| Position::new(-place.y_m, place.x_m, 0.0)), MapFrame::Unknown);
        assert_eq!(of(&|place| place + Position::new(3.0, 0.0, 0.0)), MapFrame::Unknown);
    }

    #[test]
    fn the_largest_part_of_a_relative_map_is_kept() {
        let place = |x_m: f64| Some(Position::new(x_m, 0.0, 0.0));
        let places = vec![place(0.0), place(1.0), place(2.0), None, place(4.0), None];
        let parts = CoordinateFrame::Relative(vec![0, 1, 1, 0, 1, 0]);
        let map = TopologyMap::of_places("tpm", places.clone(), parts);
        let made = UnalignedMap::new("tpm", &map);
        assert_eq!(made.places, [None, place(1.0), place(2.0), None, place(4.0), None]);
        assert_eq!(made.frame, MapFrame::Unknown);
        let world = TopologyMap::of_places("ml-tm", places.clone(), CoordinateFrame::World);
        assert_eq!(
            UnalignedMap::new("ml-tm", &world),
            UnalignedMap { name: "ml-tm".into(), places, frame: MapFrame::Robot }
        );
    }
}
