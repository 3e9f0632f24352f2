//! A survey of a list of places.

use serde::{Deserialize, Serialize};
use sextant_channel::Position;
use sextant_kernel::SettingError;
use sextant_sim::{Controller, RobotCommand, Situation};

use crate::itinerary::{Itinerary, Planner, Then};
use crate::surroundings::Surroundings;

/// A survey of a list of places, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct WaypointsConfig {
    /// The places where the robot listens, in this order (m).
    pub places_m: Vec<Position>,
}

/// Drives to each place of a list and listens there. The way round obstacles is planned.
#[derive(Clone, Debug)]
pub struct Waypoints {
    itinerary: Itinerary,
}

impl Waypoints {
    /// The survey that `config` describes.
    ///
    /// # Errors
    /// If the list is empty, or a place is not finite, is inside an obstacle, or cannot be reached.
    pub fn plan(config: &WaypointsConfig, surroundings: &Surroundings<'_>) -> Result<Self, SettingError> {
        if config.places_m.is_empty() {
            return Err(SettingError::new("places_m", "an empty list", "at least one place"));
        }
        let mut planner = Planner::new(surroundings);
        for (i, &place) in config.places_m.iter().enumerate() {
            let [x, y, z] = place.into();
            let refuse = |what: String, allowed: &str| {
                Err(SettingError::new(format!("places_m[{i}]"), format!("[{x}, {y}, {z}]{what}"), allowed))
            };
            if !place.is_finite() {
                return refuse(String::new(), "finite coordinates in metres");
            }
            if !planner.is_free(place) {
                let field = surroundings.obstacles;
                let inside = field.containing(place).and_then(|i| field.obstacles().get(i));
                let what = match inside.map(|obstacle| obstacle.name()) {
                    Some(Some(name)) => format!(", inside obstacle `{name}`"),
                    Some(None) => ", inside an obstacle".into(),
                    None => format!(", {:.3} m from an obstacle", field.distance_m(place)),
                };
                let allowed =
                    format!("a place farther than the robot's radius of {} m from obstacles", surroundings.radius_m);
                return refuse(what, &allowed);
            }
            if !planner.go(place, Then::Listen) {
                return refuse(", with no way to it".into(), "a place that can be reached from the one before");
            }
        }
        Ok(Self { itinerary: planner.finish() })
    }
}

impl Controller for Waypoints {
    fn decide(&mut self, situation: &Situation<'_>) -> RobotCommand {
        self.itinerary.decide(situation)
    }
}
