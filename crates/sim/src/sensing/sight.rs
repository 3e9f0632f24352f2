//! When a node sees a target that passes its radius.

use sextant_channel::{ObstacleField, Position};
use sextant_kernel::SimTime;

use super::crossing::{Passage, instant};
use crate::world::target::Leg;

/// The part of a leg within the radius of a node, and what is seen of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Sight {
    /// When the target comes into sight (`true`) or goes out of it, in order.
    pub(super) changes: Vec<(SimTime, bool)>,
    /// Whether it is in sight at the end of the leg.
    pub(super) ends_in_sight: bool,
}

impl Sight {
    /// Of a target that passes the radius on `leg` in plain sight. `was_in_sight` is what the leg before it said at its end.
    pub(super) fn free(leg: &Leg, passage: &Passage, was_in_sight: bool) -> Self {
        let inside = inside(leg, passage);
        Self::of(vec![(inside.start, inside.end)], &inside, passage, was_in_sight)
    }

    /// The same where solid obstacles hide the target from `eye`.
    pub(super) fn among(
        obstacles: &ObstacleField,
        eye: Position,
        leg: &Leg,
        passage: &Passage,
        was_in_sight: bool,
    ) -> Self {
        let inside = inside(leg, passage);
        let views = obstacles.views(eye, inside.from, inside.to);
        let views = views.iter().map(|&[start, end]| (instant(&inside, start), instant(&inside, end))).collect();
        Self::of(views, &inside, passage, was_in_sight)
    }

    /// From the `views` of the part of the leg that is `inside` the radius, in order. What is seen for no nanosecond is
    /// not seen, and what is hidden for none is not hidden.
    fn of(views: Vec<(SimTime, SimTime)>, inside: &Leg, passage: &Passage, was_in_sight: bool) -> Self {
        let starts_seen = views.first().is_some_and(|&(start, _)| start == inside.start);
        let mut sights = Vec::with_capacity(2 * views.len() + 1);
        if !starts_seen {
            sights.push((inside.start, false));
        }
        for (start, end) in views {
            sights.push((start, true));
            if end < inside.end || passage.left.is_some() {
                sights.push((end, false));
            }
        }
        let mut in_sight = was_in_sight;
        let mut changes: Vec<(SimTime, bool)> = Vec::new();
        for (time, appears) in sights {
            if appears == in_sight {
                continue;
            }
            in_sight = appears;
            if changes.pop_if(|(before, _)| *before == time).is_none() {
                changes.push((time, appears));
            }
        }
        Self { changes, ends_in_sight: in_sight }
    }
}

/// The part of a leg that is within the radius.
fn inside(leg: &Leg, passage: &Passage) -> Leg {
    let (start, end) = (passage.entered.unwrap_or(leg.start), passage.left.unwrap_or(leg.end));
    Leg { from: leg.at(start), to: leg.at(end), start, end }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use sextant_channel::{BoxConfig, Obstacle, ObstacleConfig, ShapeConfig};

    use super::*;

    fn at(seconds: f64) -> SimTime {
        SimTime::ZERO + Duration::from_secs_f64(seconds)
    }

    /// A box from x = -1 to 1 and y = 1 to 2.
    fn wall() -> ObstacleField {
        let shape = ShapeConfig::Box(BoxConfig::new(Position::new(0.0, 1.5, 0.0), [2.0, 1.0, 2.0]));
        let config = ObstacleConfig::absorbing(shape, 1.0);
        ObstacleField::new(vec![Obstacle::try_from(config).unwrap()])
    }

    /// Along y = 3 from x = -10 to 10 in 20 s, seen from the origin within `radius_m`: the shadow is from x = -3 to 3.
    fn sight(radius_m: f64, was_inside: bool, was_in_sight: bool) -> (Vec<(f64, bool)>, bool) {
        let [from, to] = [-10.0, 10.0].map(|x| Position::new(x, 3.0, 0.0));
        let leg = Leg { from, to, start: at(100.0), end: at(120.0) };
        let passage = Passage::of(&leg, Position::ORIGIN, radius_m, was_inside);
        let Sight { changes, ends_in_sight } = Sight::among(&wall(), Position::ORIGIN, &leg, &passage, was_in_sight);
        (changes.into_iter().map(|(time, appears)| (time.as_secs_f64(), appears)).collect(), ends_in_sight)
    }

    #[test]
    fn a_target_is_out_of_sight_in_the_shadow_of_a_wall() {
        // The chord of the radius 5 is from x = -4 to 4.
        let seen = [(106.0, true), (107.0, false), (113.0, true), (114.0, false)];
        assert_eq!(sight(5.0, false, false), (seen.to_vec(), false));
        assert_eq!(sight(50.0, true, true), (vec![(107.0, false), (113.0, true)], true));
        assert_eq!(sight(50.0, false, false), (vec![(100.0, true), (107.0, false), (113.0, true)], true));
        // All of the passage is in the shadow.
        assert_eq!(sight(4.0, false, false), (vec![], false));
    }

    #[test]
    fn a_target_that_turns_in_a_shadow_goes_out_of_sight_once() {
        let place = |x| Position::new(x, 3.0, 0.0);
        let leg = |from, to| Leg { from: place(from), to: place(to), start: at(1.0), end: at(2.0) };
        let passage = Passage { entered: None, left: None, ends_inside: true };
        let sight = |leg: Leg, was| Sight::among(&wall(), Position::ORIGIN, &leg, &passage, was);
        // It turns on the rim of the shadow: what the leg before said holds.
        for was_in_sight in [false, true] {
            let into = sight(leg(-3.0, 0.0), was_in_sight);
            assert_eq!(
                into,
                Sight {
                    changes: was_in_sight.then_some((at(1.0), false)).into_iter().collect(),
                    ends_in_sight: false
                }
            );
            let out = sight(leg(-3.0, -4.0), was_in_sight);
            assert_eq!(
                out,
                Sight {
                    changes: (!was_in_sight).then_some((at(1.0), true)).into_iter().collect(),
                    ends_in_sight: true
                }
            );
        }
        let standing = Leg::standing(place(9.0), at(1.0));
        assert!(
            sight(standing, false).ends_in_sight && !sight(Leg::standing(place(0.0), at(1.0)), true).ends_in_sight
        );
    }

    #[test]
    fn without_obstacles_a_passage_is_in_sight_from_its_rim_to_its_rim() {
        let leg = Leg { from: Position::ORIGIN, to: Position::new(10.0, 0.0, 0.0), start: at(0.0), end: at(10.0) };
        let eye = Position::new(5.0, 3.0, 0.0);
        let passage = Passage::of(&leg, eye, 5.0, false);
        let free = Sight::free(&leg, &passage, false);
        assert_eq!(free, Sight { changes: vec![(at(1.0), true), (at(9.0), false)], ends_in_sight: false });
        assert_eq!(free, Sight::among(&ObstacleField::default(), eye, &leg, &passage, false));
    }
}
