//! A path laid out beforehand.

use sextant_channel::Position;
use sextant_kernel::SettingError;
use sextant_sim::{CommandOutcome, Controller, Ending, RobotCommand, Situation};

use crate::route::Search;
use crate::surroundings::Surroundings;

/// How much farther from obstacles a planned path keeps than the hull needs (m): robots halt this near.
const MARGIN_M: f64 = 5e-3;
/// Step of the lattice on which ways are looked for (m).
const LATTICE_M: f64 = 0.25;
/// How far beyond the obstacles a way may lead round them, in radii of the hull and steps of the lattice.
const DETOUR: f64 = 4.0;
/// Drives in a row that an unforeseen obstacle may block before the robot gives up.
const MAX_BLOCKED: u32 = 16;

/// Stops of one path, at most.
pub(crate) const MAX_STOPS: f64 = 1e6;

/// What happens at the end of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Then {
    /// The robot listens.
    Listen,
    /// The robot drives on.
    Pass,
}

/// A path laid out beforehand: drives, some of which end with a stop.
#[derive(Clone, Debug, Default)]
pub(crate) struct Itinerary {
    legs: Vec<(Position, Then)>,
    /// Legs begun.
    begun: usize,
    /// Drives blocked in a row.
    blocked: u32,
}

/// Lays a path out among obstacles.
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

    /// Adds the way to `place`; `false` and no change if there is none.
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

    /// The path laid out.
    pub(crate) fn finish(self) -> Itinerary {
        self.itinerary
    }
}

impl Itinerary {
    /// The way through `places` in turn. A place that an obstacle covers, or encloses, is left out.
    ///
    /// # Errors
    /// If no stop can be reached, naming the key `region`.
    pub(crate) fn through(
        places: impl IntoIterator<Item = (Position, Then)>,
        surroundings: &Surroundings<'_>,
    ) -> Result<Self, SettingError> {
        let mut planner = Planner::new(surroundings);
        for (place, then) in places {
            planner.go(place, then);
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
                // So near counts as there.
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
}
