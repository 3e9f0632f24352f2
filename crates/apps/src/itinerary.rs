//! A path planned before the start.

use sextant_channel::Position;
use sextant_kernel::SettingError;
use sextant_sim::{CommandOutcome, Controller, Ending, RobotCommand, Situation, StopsLeftOut};

use crate::route::Search;
use crate::surroundings::Surroundings;

/// Extra distance that a planned path keeps from obstacles, beyond the radius of the hull (m). Blocked robots halt
/// this near to an obstacle.
const MARGIN_M: f64 = 5e-3;
/// Step of the lattice for path planning (m).
const LATTICE_M: f64 = 0.25;
/// How far a planned way may pass outside the bounding box of the obstacles, in units of hull radius plus lattice
/// step.
const DETOUR: f64 = 4.0;
/// Number of consecutive drives that may be blocked before the robot gives up.
const MAX_BLOCKED: u32 = 16;

/// Maximum number of stops of one path.
pub(crate) const MAX_STOPS: f64 = 1e6;

/// What happens at the end of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Then {
    /// The robot listens.
    Listen,
    /// The robot drives on.
    Pass,
}

/// A path planned before the start: drives, some of which end with a stop.
#[derive(Clone, Debug, Default)]
pub(crate) struct Itinerary {
    legs: Vec<(Position, Then)>,
    /// Number of legs begun.
    begun: usize,
    /// Number of consecutive blocked drives.
    blocked: u32,
    /// Stops that are no part of it.
    left_out: StopsLeftOut,
}

/// Plans a path among obstacles.
pub(crate) struct Planner<'a> {
    surroundings: &'a Surroundings<'a>,
    itinerary: Itinerary,
    here: Position,
}

impl<'a> Planner<'a> {
    pub(crate) fn new(surroundings: &'a Surroundings<'a>) -> Self {
        Self { surroundings, itinerary: Itinerary::default(), here: surroundings.start }
    }

    /// Whether the robot can stand at `place`.
    pub(crate) fn is_free(&self, place: Position) -> bool {
        let Surroundings { obstacles, radius_m, .. } = *self.surroundings;
        obstacles.is_empty()
            || (obstacles.containing(place).is_none() && obstacles.distance_m(place) > radius_m + MARGIN_M)
    }

    /// Adds the way to `place`. Returns `false` and changes nothing if there is no way.
    pub(crate) fn go(&mut self, place: Position, then: Then) -> bool {
        if !self.is_free(place) {
            return false;
        }
        let Some(way) = self.way(place) else { return false };
        let last = way.len() - 1;
        let leg = |(i, to)| (to, if i == last { then } else { Then::Pass });
        self.itinerary.legs.extend(way.into_iter().enumerate().map(leg));
        self.here = place;
        true
    }

    /// Counts a stop as left out.
    fn leave_out(&mut self, place: Position) {
        let is_free = self.is_free(place);
        let left_out = &mut self.itinerary.left_out;
        if is_free {
            left_out.unreachable += 1;
        } else {
            left_out.in_obstacles += 1;
        }
    }

    fn way(&self, place: Position) -> Option<Vec<Position>> {
        let Surroundings { obstacles, radius_m, .. } = *self.surroundings;
        let Some(bounds) = obstacles.bounds() else { return Some(vec![place]) };
        let passable = |a: Position, b: Position| {
            let length_m = a.distance_m(b);
            length_m <= 0.0 || obstacles.clearance_m(a, b - a, length_m, radius_m + MARGIN_M) >= length_m
        };
        let bounds = bounds.grown(DETOUR * (radius_m + LATTICE_M));
        Search { bounds, step_m: LATTICE_M, reach_m: 0.0 }.way_over(self.here, place, passable)
    }

    /// The planned path.
    pub(crate) fn finish(self) -> Itinerary {
        self.itinerary
    }
}

impl Itinerary {
    /// The way through `places`, in order. Places that are inside an obstacle, or that cannot be reached, are left
    /// out.
    ///
    /// # Errors
    /// If no stop can be reached. The error names the key `region`.
    pub(crate) fn through(
        places: impl IntoIterator<Item = (Position, Then)>,
        surroundings: &Surroundings<'_>,
    ) -> Result<Self, SettingError> {
        let mut planner = Planner::new(surroundings);
        for (place, then) in places {
            if !planner.go(place, then) && then == Then::Listen {
                planner.leave_out(place);
            }
        }
        let itinerary = planner.finish();
        if itinerary.stops() == 0 {
            let found = "a region with no stop that can be reached";
            return Err(SettingError::new("region", found, "a region with free places"));
        }
        Ok(itinerary)
    }

    /// Number of stops.
    pub(crate) fn stops(&self) -> usize {
        self.legs.iter().filter(|(_, then)| *then == Then::Listen).count()
    }
}

impl Controller for Itinerary {
    fn decide(&mut self, situation: &Situation<'_>) -> RobotCommand {
        let (to, then) = match self.begun {
            0 => (situation.position, Then::Pass),
            begun => self.legs[begun - 1],
        };
        match situation.outcome {
            CommandOutcome::Arrived => {
                self.blocked = 0;
                if then == Then::Listen {
                    return RobotCommand::Listen;
                }
            }
            CommandOutcome::Blocked(_) => {
                self.blocked += 1;
                if self.blocked > MAX_BLOCKED {
                    return RobotCommand::Finish(Ending::Stuck);
                }
                // This is near enough to count as arrived.
                if then == Then::Listen && situation.position.distance_m(to) <= 2.0 * MARGIN_M {
                    return RobotCommand::Listen;
                }
            }
            CommandOutcome::Started | CommandOutcome::Listened(_) => {}
        }
        match self.legs.get(self.begun) {
            Some(&(to, _)) => {
                self.begun += 1;
                RobotCommand::Drive(to)
            }
            None => RobotCommand::Finish(Ending::Complete),
        }
    }

    fn left_out(&self) -> StopsLeftOut {
        self.left_out
    }
}
