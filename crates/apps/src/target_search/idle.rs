//! What a robot does before a target is detected.

use sextant_channel::{Bounds, Position};

use super::config::BeforeDetection;
use super::geometric_median::geometric_median;

/// Decisions without coming nearer after which a place is given up: an obstacle may be there.
const PATIENCE: u32 = 5;
/// Most lanes of a patrol.
const MOST_LANES: f64 = 5.0;

/// Where a robot drives before a target is detected, on the map. Robots share the map: each has a part of the nodes,
/// next to those of the others.
#[derive(Clone, Debug)]
pub(super) struct Idle {
    rule: BeforeDetection,
    /// The number of the robot.
    number: usize,
    /// How many robots there are.
    robots: usize,
    /// The places that it visits, and the next one; not known before it is asked.
    way: Option<Vec<Position>>,
    next: usize,
    /// How near it has come to the next place (m), and how often it has come no nearer since.
    nearest_m: f64,
    stalled: u32,
}

impl Idle {
    /// For the robot with this number of so many.
    pub(super) fn new(rule: BeforeDetection, number: usize, robots: usize) -> Self {
        Self { rule, number, robots, way: None, next: 0, nearest_m: f64::INFINITY, stalled: 0 }
    }

    /// Whether it drives, and captures what it meets.
    pub(super) fn drives(&self) -> bool {
        self.rule != BeforeDetection::Wait
    }

    /// Where to drive next from `place`, if anywhere. A place is visited if it is within `near_m`. `nodes` are the places of
    /// all nodes on the map.
    pub(super) fn goal(
        &mut self,
        place: Position,
        near_m: f64,
        nodes: impl Iterator<Item = Position>,
    ) -> Option<Position> {
        if !self.drives() {
            return None;
        }
        let way = match &mut self.way {
            Some(way) => way,
            None => {
                let own = part(nodes.collect(), self.number, self.robots);
                let mut way = match self.rule {
                    BeforeDetection::Wait => Vec::new(),
                    BeforeDetection::Center => geometric_median(&own).into_iter().collect(),
                    BeforeDetection::Patrol => lanes(&own, 2.0 * near_m),
                };
                let far_m = |at: Option<&Position>| at.map_or(0.0, |at| at.distance_m(place));
                if far_m(way.last()) < far_m(way.first()) {
                    way.reverse();
                }
                self.way.insert(way)
            }
        };
        let left_m = place.distance_m(*way.get(self.next)?);
        self.stalled = if left_m < self.nearest_m { 0 } else { self.stalled + 1 };
        self.nearest_m = self.nearest_m.min(left_m);
        if left_m <= near_m || self.stalled >= PATIENCE {
            if way.len() == 1 {
                return None;
            }
            (self.nearest_m, self.stalled) = (f64::INFINITY, 0);
            self.next += 1;
            if self.next == way.len() {
                // Back again.
                way.reverse();
                self.next = 1;
            }
        }
        way.get(self.next).copied()
    }
}

/// The part of the nodes that belongs to a robot: as many as to each other one, along the longer side of the map.
fn part(mut nodes: Vec<Position>, number: usize, robots: usize) -> Vec<Position> {
    let Some(Bounds { min, max }) = Bounds::of(nodes.iter().copied()) else { return nodes };
    let along = |p: &Position| if max.x_m - min.x_m >= max.y_m - min.y_m { p.x_m } else { p.y_m };
    nodes.sort_by(|a, b| along(a).total_cmp(&along(b)));
    let end = |number: usize| nodes.len() * number / robots.max(1);
    nodes[end(number)..end(number + 1)].to_vec()
}

/// The ends of lanes along the longer side of the box around `nodes`, in order: as many as there is room for with
/// `least_m` from lane to lane, but not more than [`MOST_LANES`].
fn lanes(nodes: &[Position], least_m: f64) -> Vec<Position> {
    let Some(bounds) = Bounds::of(nodes.iter().copied()) else { return Vec::new() };
    let (size, center) = (bounds.max - bounds.min, bounds.center());
    let is_wide = size.x_m >= size.y_m;
    let (long_m, short_m) = if is_wide { (size.x_m, size.y_m) } else { (size.y_m, size.x_m) };
    let count = (short_m / least_m).floor().clamp(1.0, MOST_LANES);
    let lane_m = short_m / count;
    // Half a lane from each border.
    let half_m = 0.5 * (long_m - lane_m).max(0.0);
    let (mut way, mut number, mut side) = (Vec::new(), 0.5, -1.0);
    while number < count {
        let across_m = number * lane_m - 0.5 * short_m;
        for end_m in [side * half_m, -side * half_m] {
            let (x_m, y_m) = if is_wide { (end_m, across_m) } else { (across_m, end_m) };
            way.push(center + Position::new(x_m, y_m, 0.0));
        }
        number += 1.0;
        side = -side;
    }
    way
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64) -> Position {
        Position::new(x, y, 0.0)
    }

    #[test]
    fn lanes_run_along_the_longer_side_and_turn_at_their_ends() {
        let corners = [at(0.0, 0.0), at(40.0, 9.0)];
        let expected = [at(1.5, 1.5), at(38.5, 1.5), at(38.5, 4.5), at(1.5, 4.5), at(1.5, 7.5), at(38.5, 7.5)];
        assert_eq!(lanes(&corners, 2.6), expected);
        let upright = corners.map(|p| at(p.y_m, p.x_m));
        assert_eq!(lanes(&upright, 2.6), expected.map(|p| at(p.y_m, p.x_m)));
        assert_eq!(lanes(&corners, 0.1).len(), 10, "five lanes at most");
        assert_eq!(lanes(&corners, 50.0), [at(4.5, 4.5), at(35.5, 4.5)]);
    }

    #[test]
    fn robots_share_the_map_and_one_that_waits_drives_nowhere() {
        let nodes: Vec<Position> = (0..20).map(|i| at(f64::from(i), 0.3 * f64::from(i % 2))).collect();
        let goal =
            |rule, number, robots| Idle::new(rule, number, robots).goal(at(0.0, 0.0), 0.5, nodes.iter().copied());
        assert_eq!(goal(BeforeDetection::Wait, 0, 1), None);
        let center = |number, robots| goal(BeforeDetection::Center, number, robots).expect("a place").x_m;
        assert!((center(0, 1) - 9.5).abs() < 0.6);
        assert!((center(0, 2) - 4.5).abs() < 0.6 && (center(1, 2) - 14.5).abs() < 0.6);
    }

    #[test]
    fn a_patrol_goes_there_and_back_from_its_nearer_end_and_a_robot_at_the_centre_stays() {
        let nodes = [at(0.0, 0.0), at(10.0, 2.0)];
        let mut patrol = Idle::new(BeforeDetection::Patrol, 0, 1);
        let mut goal = |from| patrol.goal(from, 1.0, nodes.into_iter()).expect("a place");
        assert_eq!(goal(at(12.0, 0.0)), at(9.0, 1.0));
        assert_eq!(goal(at(9.0, 1.5)), at(1.0, 1.0));
        assert_eq!(goal(at(4.0, 1.5)), at(1.0, 1.0));
        assert_eq!(goal(at(1.0, 1.0)), at(9.0, 1.0));
        // It is in an obstacle.
        assert!((0..4).all(|_| goal(at(6.0, 1.0)) == at(9.0, 1.0)));
        assert_eq!([goal(at(6.0, 1.0)), goal(at(6.0, 1.0))], [at(9.0, 1.0), at(1.0, 1.0)]);
        let mut center = Idle::new(BeforeDetection::Center, 0, 1);
        let goal = center.goal(at(0.0, 0.0), 1.0, nodes.into_iter()).expect("a place");
        assert_eq!(center.goal(goal, 1.0, nodes.into_iter()), None);
    }
}
