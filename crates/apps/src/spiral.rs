//! An Archimedean spiral.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};
use sextant_channel::Position;
use sextant_kernel::SettingError;
use sextant_sim::layout::{Region, RegionConfig};
use sextant_sim::{Controller, RobotCommand, Situation, StopsLeftOut};

use crate::itinerary::{Itinerary, MAX_STOPS, Then};
use crate::route::{number, whole};
use crate::surroundings::Surroundings;

/// Number of steps in which half the lane spacing is searched for the region, on each side of the spiral.
const LOOKS: i32 = 8;

/// A spiral over a region, as written in a scenario (thesis, section 3.4).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SpiralConfig {
    /// The spiral runs round the centre of the bounding box of this region. Parts of the spiral that are farther than
    /// half the lane spacing from the region are skipped: the robot drives straight to the next part, with stops on
    /// the way.
    pub region: RegionConfig,
    /// Distance between neighbouring turns (m).
    pub lane_spacing_m: f64,
    /// Distance between stops along the path (m).
    #[serde(default = "default_stop_spacing_m")]
    pub stop_spacing_m: f64,
    /// Height of the path (m). If absent, the height of the robot's start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
}

fn default_stop_spacing_m() -> f64 {
    1.0
}

/// Drives along an Archimedean spiral and stops at equal distances along it: from the centre outwards, or inwards if
/// the robot starts nearer to the outer end. Stops inside an obstacle are left out, and the way round the obstacle is
/// planned.
#[derive(Clone, Debug)]
pub struct Spiral {
    itinerary: Itinerary,
}

impl Spiral {
    /// The spiral that `config` describes.
    ///
    /// # Errors
    /// If a value is invalid, or no stop can be reached.
    pub fn plan(config: &SpiralConfig, surroundings: &Surroundings<'_>) -> Result<Self, SettingError> {
        let region = Region::try_from(&config.region).map_err(|error| error.within("region"))?;
        let spacing_m = SettingError::positive("lane_spacing_m", config.lane_spacing_m)?;
        let stop_spacing_m = SettingError::positive("stop_spacing_m", config.stop_spacing_m)?;
        let z_m = SettingError::finite("height_m", config.height_m.unwrap_or(surroundings.start.z_m))?;
        let bounds = region.bounds();
        let center = bounds.center();
        // The corners of the bounding box are nearer than this, and one full turn lies beyond them.
        let reach_m = 0.5 * (bounds.max - bounds.min).length_m() + spacing_m;
        let arm = Arm { spacing_m };
        let (turns, length_m) = (reach_m / spacing_m, arm.length_m(reach_m / spacing_m * TAU));
        for (key, value, count, what) in [
            ("lane_spacing_m", spacing_m, turns, "turns"),
            ("stop_spacing_m", stop_spacing_m, length_m / stop_spacing_m, "stops"),
        ] {
            if count > MAX_STOPS {
                let found = format!("{value}, which makes {count:.0} {what}");
                return Err(SettingError::new(key, found, format!("a spacing that makes at most {MAX_STOPS:.0}")));
            }
        }
        let places: Vec<Position> = arm
            .stops(stop_spacing_m, reach_m)
            .filter(|&place| arm.is_near(place, |place| region.contains(center + place)))
            .map(|place| Position { z_m, ..center + place })
            .collect();
        let mut stops = with_stops_between(&places, stop_spacing_m);
        let distance_m = |stop: Option<&Position>| stop.map_or(0.0, |stop| stop.distance_m(surroundings.start));
        if distance_m(stops.last()) < distance_m(stops.first()) {
            stops.reverse();
        }
        let itinerary = Itinerary::through(stops.into_iter().map(|place| (place, Then::Listen)), surroundings)?;
        Ok(Self { itinerary })
    }
}

impl Controller for Spiral {
    fn decide(&mut self, situation: &Situation<'_>) -> RobotCommand {
        self.itinerary.decide(situation)
    }

    fn left_out(&self) -> StopsLeftOut {
        self.itinerary.left_out()
    }
}

/// An Archimedean spiral round the origin: its radius grows by `spacing_m` a turn, r = b θ with b = spacing / 2π.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Arm {
    spacing_m: f64,
}

impl Arm {
    /// Length from the middle to the angle θ (m): b/2 (θ √(1 + θ²) + arsinh θ).
    fn length_m(self, angle_rad: f64) -> f64 {
        let b = self.spacing_m / TAU;
        0.5 * b * (angle_rad * libm::hypot(angle_rad, 1.0) + libm::asinh(angle_rad))
    }

    /// The angle at which the length from the middle is `length_m` (Newton's method; the slope is b √(1 + θ²)).
    fn angle_rad(self, length_m: f64) -> f64 {
        const ROUNDS: u32 = 64;
        let b = self.spacing_m / TAU;
        // θ²b/2 is below the length, so this start is above the root, and all steps go down.
        let mut angle_rad = (2.0 * length_m / b).sqrt();
        for _ in 0..ROUNDS {
            let step_rad = (self.length_m(angle_rad) - length_m) / (b * libm::hypot(angle_rad, 1.0));
            angle_rad -= step_rad;
            if step_rad.abs() <= 1e-14 * angle_rad {
                break;
            }
        }
        angle_rad
    }

    /// Places at equal distances along the spiral, from the centre up to the distance `reach_m` from it.
    fn stops(self, stop_spacing_m: f64, reach_m: f64) -> impl Iterator<Item = Position> {
        let place = move |stop: u32| {
            let angle_rad = self.angle_rad(f64::from(stop) * stop_spacing_m);
            let radius_m = self.spacing_m * angle_rad / TAU;
            Position::new(radius_m * libm::cos(angle_rad), radius_m * libm::sin(angle_rad), 0.0)
        };
        (0..).map(place).take_while(move |place| place.length_m() <= reach_m)
    }

    /// Whether the region holds a place within half the lane spacing of `place`, on the line through `place` and the
    /// centre. If all such places are kept, each point of the region is within half the lane spacing of the spiral.
    fn is_near(self, place: Position, contains: impl Fn(Position) -> bool) -> bool {
        let radius_m = place.length_m();
        let along = if radius_m > 0.0 { place * (1.0 / radius_m) } else { Position::new(1.0, 0.0, 0.0) };
        let aside_m = |look: i32| 0.5 * self.spacing_m * f64::from(look) / f64::from(LOOKS);
        (-LOOKS..=LOOKS).any(|look| contains(place + along * aside_m(look)))
    }
}

/// `places`, with further places between neighbours that are much farther apart than `spacing_m`.
fn with_stops_between(places: &[Position], spacing_m: f64) -> Vec<Position> {
    let mut stops: Vec<Position> = places.first().copied().into_iter().collect();
    for leg in places.windows(2) {
        let (from, along) = (leg[0], leg[1] - leg[0]);
        let pieces = number(whole((along.length_m() / spacing_m).round().max(1.0)));
        let mut piece = 1.0;
        while piece < pieces {
            stops.push(from + along * (piece / pieces));
            piece += 1.0;
        }
        stops.push(leg[1]);
    }
    stops
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_angle_of_a_length_has_that_length() {
        let arm = Arm { spacing_m: 1.3 };
        for length_m in [1e-9, 1e-3, 0.2, 1.0, 17.0, 1e3, 1e6] {
            let angle_rad = arm.angle_rad(length_m);
            assert!((arm.length_m(angle_rad) / length_m - 1.0).abs() < 1e-12, "{length_m}: {angle_rad}");
        }
        assert!(arm.angle_rad(0.0).abs() <= 0.0);
    }

    #[test]
    fn the_length_of_a_spiral_is_that_of_many_short_pieces() {
        const PIECES: u32 = 200_000;
        let arm = Arm { spacing_m: 0.7 };
        let end_rad = 9.3 * TAU;
        let at = |i: u32| {
            let angle_rad = end_rad * f64::from(i) / f64::from(PIECES);
            let radius_m = 0.7 * angle_rad / TAU;
            Position::new(radius_m * angle_rad.cos(), radius_m * angle_rad.sin(), 0.0)
        };
        let pieces_m: f64 = (0..PIECES).map(|i| at(i).distance_m(at(i + 1))).sum();
        assert!((arm.length_m(end_rad) / pieces_m - 1.0).abs() < 1e-7, "{pieces_m}");
    }
}
