//! Ways over listed places.

use serde::{Deserialize, Serialize};
use sextant_channel::{ObstacleField, Position};
use sextant_kernel::{SettingError, SimTime};

use super::leg::Leg;
use super::speed;
use crate::station::LONGEST_S;

/// The shortest way between two places (m): shorter ones would take no time that matters, and never end if they are repeated.
pub(crate) const LEAST_LEG_M: f64 = 1e-3;

/// A way over listed places, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct WaypointsConfig {
    /// The places in order, each `[x, y]` or `[x, y, z]`; the first one is the start (m).
    pub places_m: Vec<Position>,
    /// Speed (m/s).
    pub speed_m_per_s: f64,
    /// What it does at the last place.
    #[serde(default)]
    pub at_end: AtEnd,
}

/// What a target, or a node, does at its last place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum AtEnd {
    /// It stays there.
    #[default]
    Stay,
    /// It goes to the first place, and over all places again.
    Loop,
    /// It is gone from the world; not for nodes, which stay in it.
    Leave,
}

/// A way over listed places.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Waypoints {
    places: Vec<Position>,
    speed_m_per_s: f64,
    at_end: AtEnd,
}

impl WaypointsConfig {
    /// The way among `obstacles`.
    pub(crate) fn build(&self, obstacles: &ObstacleField) -> Result<Waypoints, SettingError> {
        if self.places_m.is_empty() {
            return Err(SettingError::new("places_m", "an empty list", "at least one place"));
        }
        for (i, &place) in self.places_m.iter().enumerate() {
            if let Some((found, allowed)) = obstacles.fault(place) {
                return Err(SettingError::new(format!("places_m[{i}]"), found, allowed));
            }
        }
        if self.at_end == AtEnd::Leave && self.places_m.len() < 2 {
            let allowed = "`stay` or `loop`, or at least two places in `places_m`";
            return Err(SettingError::new("at_end", "leave, with one place", allowed));
        }
        let way = Waypoints {
            places: self.places_m.clone(),
            speed_m_per_s: speed("speed_m_per_s", self.speed_m_per_s)?,
            at_end: self.at_end,
        };
        for i in 0..way.leg_count() {
            let (from, to) = way.ends(i);
            let key = format!("places_m[{}]", (i + 1) % way.places.len());
            let [x, y, z] = to.into();
            let length_m = from.distance_m(to);
            if length_m < LEAST_LEG_M {
                let found = format!("[{x}, {y}, {z}], {length_m} m from the place before it");
                return Err(SettingError::new(
                    key,
                    found,
                    format!("a place at least {LEAST_LEG_M} m from the one before it"),
                ));
            }
            if length_m / way.speed_m_per_s > LONGEST_S {
                let found = format!("[{x}, {y}, {z}], {length_m} m from the place before it");
                let allowed = format!("a place that it reaches within {LONGEST_S} s at {} m/s", way.speed_m_per_s);
                return Err(SettingError::new(key, found, allowed));
            }
            if let Some(crossed) = obstacles.blocking(from, to) {
                let obstacle = obstacles.obstacles()[crossed].name();
                let obstacle = obstacle.map_or_else(|| crossed.to_string(), |name| format!("`{name}`"));
                let found = format!("[{x}, {y}, {z}], behind obstacle {obstacle} as seen from the place before it");
                return Err(SettingError::new(
                    key,
                    found,
                    "a place that a straight way outside all obstacles reaches",
                ));
            }
        }
        Ok(way)
    }
}

impl Waypoints {
    pub(crate) fn start(&self) -> Position {
        self.places[0]
    }

    /// Whether the target is gone after its last leg.
    pub(super) fn leaves(&self) -> bool {
        self.at_end == AtEnd::Leave
    }

    /// Number of legs before the target stays, is gone or repeats its way.
    fn leg_count(&self) -> usize {
        match (self.at_end, self.places.len()) {
            (_, 1) => 0,
            (AtEnd::Stay | AtEnd::Leave, places) => places - 1,
            (AtEnd::Loop, places) => places,
        }
    }

    /// The ends of leg number `i`.
    fn ends(&self, i: usize) -> (Position, Position) {
        let place = |i: usize| self.places[i % self.places.len()];
        (place(i), place(i + 1))
    }

    /// Leg number `i`, which begins at `start`; `None` if the target stays where it is, or is gone.
    pub(crate) fn leg(&self, i: usize, start: SimTime) -> Option<Leg> {
        let count = self.leg_count();
        let i = match self.at_end {
            AtEnd::Stay | AtEnd::Leave => i,
            AtEnd::Loop if count == 0 => return None,
            AtEnd::Loop => i % count,
        };
        let (from, to) = (i < count).then(|| self.ends(i))?;
        Some(Leg::new(from, to, start, self.speed_m_per_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn legs_that_take_no_time_or_for_ever_are_refused() {
        let way = |x_m: f64, speed_m_per_s: f64, at_end: AtEnd| {
            let places_m = vec![Position::ORIGIN, Position::new(x_m, 0.0, 0.0)];
            let config = WaypointsConfig { places_m, speed_m_per_s, at_end };
            config.build(&ObstacleField::default()).map(drop).map_err(|error| error.to_string())
        };
        let refused = |x_m, speed_m_per_s, at_end| way(x_m, speed_m_per_s, at_end).expect_err("a mistake");
        assert_eq!(way(1e-3, 1e3, AtEnd::Loop), Ok(()));
        for x_m in [0.0, 1e-9, 9e-4] {
            let message = refused(x_m, 1e3, AtEnd::Loop);
            assert!(message.contains("a place at least 0.001 m from the one before it"), "{message}");
        }
        let message = refused(1e9, 0.5, AtEnd::Stay);
        assert!(message.contains("reaches within 1000000000 s at 0.5 m/s"), "{message}");
    }
}
