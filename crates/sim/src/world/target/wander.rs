//! Visits: a target enters a region, walks at random in it, and leaves it at a given place and time.

use std::sync::Arc;
use std::time::Duration;

use serde::{Deserialize, Serialize};
use sextant_channel::{ObstacleField, Position};
use sextant_kernel::{Seed, SettingError, SimTime};

use super::super::layout::{Region, RegionConfig};
use super::gait::{CLEARANCE_M, Gait, Ground, LEAST_LEG_M, MARGIN_M, StraightConfig, Stroll, TurnConfig};
use super::leg::Leg;
use super::speed;

/// Ways tried before a visit is refused.
const ATTEMPTS: u32 = 500;
/// Last turns tried on one way before the next way is tried.
const LAST_TURNS: u32 = 100;
/// Most legs of a way.
const MOST_LEGS: usize = 100_000;
/// A way home is straight if the length that is left is longer than it by less than this (m).
const HOME_M: f64 = 1e-9;

/// A visit, as written in a scenario. The target enters at one place, walks at random straight pieces in a region at
/// constant speed, and is gone from the world at another place exactly when its time is over. At each turn the length
/// that is left suffices for the way to the exit; the last piece goes straight there. The whole way is planned before the
/// simulation begins.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct WanderConfig {
    /// Where it enters (m): in the region, on its border or outside. A straight way leads into the region.
    pub from_m: Position,
    /// Where it leaves (m): in the region, on its border or outside.
    pub to_m: Position,
    /// Time from its start to its end (s).
    pub duration_s: f64,
    /// Speed (m/s).
    pub speed_m_per_s: f64,
    /// How far it goes between two turns.
    pub straight: StraightConfig,
    /// How much it turns; any direction is as likely as any other if absent.
    #[serde(default)]
    pub turn: TurnConfig,
    /// The region in which it walks. In a flat region it stays at one height.
    pub region: RegionConfig,
}

/// What a way must keep to.
struct Visit<'a> {
    from: Position,
    to: Position,
    length_m: f64,
    region: &'a Region,
    obstacles: &'a ObstacleField,
}

impl WanderConfig {
    /// The way of target number `number` among `obstacles`: its legs.
    pub(super) fn build(
        &self,
        number: u64,
        obstacles: &ObstacleField,
        seed: Seed,
    ) -> Result<Arc<[Leg]>, SettingError> {
        let region = Region::try_from(&self.region).map_err(|error| error.within("region"))?;
        for (key, place) in [("from_m", self.from_m), ("to_m", self.to_m)] {
            check_end(key, place, &region, obstacles)?;
        }
        let speed_m_per_s = speed("speed_m_per_s", self.speed_m_per_s)?;
        let duration_s = SettingError::in_range("duration_s", self.duration_s, 1e-3, 1e7)?;
        let gait = Gait::new(self.straight, self.turn, speed_m_per_s)?;
        let (from, to) = (self.from_m, self.to_m);
        let visit = Visit { from, to, length_m: speed_m_per_s * duration_s, region: &region, obstacles };
        let straight_m = from.distance_m(to);
        if visit.length_m < straight_m - HOME_M {
            let found = format!("{duration_s}: enough for {} m", visit.length_m);
            let allowed =
                format!("at least {} s, for the {straight_m} m from `from_m` to `to_m`", straight_m / speed_m_per_s);
            return Err(SettingError::new("duration_s", found, allowed));
        }
        if visit.length_m > MOST_LEGS as f64 * gait.mean_m() {
            let found = format!("{} m on average, on a way of {} m", gait.mean_m(), visit.length_m);
            let allowed = format!("at least {} m: at most {MOST_LEGS} turns", visit.length_m / MOST_LEGS as f64);
            return Err(SettingError::new("straight", found, allowed));
        }
        let mut stroll = Stroll::new(gait, &region, number, seed);
        let places = (0..ATTEMPTS).find_map(|_| visit.way(&mut stroll)).ok_or_else(|| {
            let found = format!("{duration_s}: no way of {} m was found in {ATTEMPTS} attempts", visit.length_m);
            let allowed = "a time for which there is a way from `from_m` to `to_m` whose last piece is straight, \
                           in the region and outside all obstacles";
            SettingError::new("duration_s", found, allowed)
        })?;
        Ok(legs(&places, Duration::from_secs_f64(duration_s)))
    }
}

/// Refuses an end of a visit that no way reaches.
fn check_end(key: &str, place: Position, region: &Region, obstacles: &ObstacleField) -> Result<(), SettingError> {
    if let Some((found, allowed)) = obstacles.fault(place) {
        return Err(SettingError::new(key, found, allowed));
    }
    let height_m = region.bounds().min.z_m;
    if region.is_planar() && (place.z_m - height_m).abs() > 0.0 {
        let [x, y, z] = place.into();
        let allowed = format!("a place at the height of the flat region, {height_m} m");
        return Err(SettingError::new(key, format!("[{x}, {y}, {z}]"), allowed));
    }
    Ok(())
}

impl Visit<'_> {
    /// The places of a way in their order; `None` if it leads nowhere.
    fn way(&self, stroll: &mut Stroll) -> Option<Vec<Position>> {
        let mut places = vec![self.from];
        let (mut here, mut left_m) = (self.from, self.length_m);
        if left_m - here.distance_m(self.to) < HOME_M {
            return self.is_free(here).then(|| vec![here, self.to]);
        }
        stroll.set_out();
        if !self.region.contains(here) || self.region.is_on_side(here) {
            let inside = self.entrance(stroll)?;
            left_m -= here.distance_m(inside);
            here = inside;
            places.push(here);
        }
        if left_m < here.distance_m(self.to) {
            return None;
        }
        let mut last_turns = 0;
        while places.len() < 4 * MOST_LEGS {
            let home = self.to - here;
            let walked = stroll.step(
                here,
                |ahead| turning_back_m(home, left_m, ahead),
                Ground { region: self.region, obstacles: self.obstacles },
            );
            let (there, length_m) = walked?;
            if left_m - length_m - there.distance_m(self.to) < HOME_M {
                if self.is_free(there) {
                    places.extend([there, self.to]);
                    return Some(places);
                }
                last_turns += 1;
                if last_turns == LAST_TURNS {
                    return None;
                }
                stroll.set_out();
                continue;
            }
            (here, left_m) = (there, left_m - length_m);
            places.push(here);
        }
        None
    }

    /// A place just inside the region on a straight way from the start, which lies outside, to a random place in it. The
    /// walk goes on in that direction.
    fn entrance(&self, stroll: &mut Stroll) -> Option<Position> {
        let bounds = self.region.bounds();
        let size = bounds.max - bounds.min;
        let mut share = || stroll.uniform();
        let aim = bounds.min + Position::new(size.x_m * share(), size.y_m * share(), size.z_m * share());
        if !self.region.contains(aim) || !self.region.is_left_once(aim, self.from) {
            return None;
        }
        let whole_m = self.from.distance_m(aim);
        let ahead = (aim - self.from) * (1.0 / whole_m);
        let inside_m = (self.region.way_in_m(self.from, aim) + 2.0 * MARGIN_M).min(whole_m);
        let free_m = self.obstacles.clearance_m(self.from, ahead, inside_m, CLEARANCE_M);
        let inside = self.from + ahead * inside_m;
        if free_m < inside_m || !self.region.contains(inside) {
            return None;
        }
        stroll.set_out_in(ahead);
        Some(inside)
    }

    /// Whether the straight way from `place` to the exit is outside all obstacles, and in the region until it leaves
    /// it for good.
    fn is_free(&self, place: Position) -> bool {
        let home_m = place.distance_m(self.to);
        if home_m <= 0.0 {
            return true;
        }
        let is_inside = || {
            let ahead = (self.to - place) * (1.0 / home_m);
            self.region.way_out(place, ahead).distance_m >= home_m - 2.0 * MARGIN_M
        };
        let leaves = || !self.region.contains(self.to) && self.region.is_left_once(place, self.to);
        self.obstacles.blocking(place, self.to).is_none() && (is_inside() || leaves())
    }
}

/// How far a target with `left_m` to go may go on in the direction `ahead` (of length one) before the way back to `home`,
/// seen from it, is as long as what is left (m).
///
/// `t` metres ahead `|home - t ahead| = left - t`, so `t = (left² - |home|²) / (2 (left - ahead · home))`: the place is
/// on the ellipsoid with the foci here and home.
fn turning_back_m(home: Position, left_m: f64, ahead: Position) -> f64 {
    let home_m = home.length_m();
    let over = 2.0 * (left_m - ahead.dot(home));
    if over > 0.0 { (left_m - home_m).max(0.0) * (left_m + home_m) / over } else { left_m }
}

/// The legs over `places` in `duration`, at constant speed.
fn legs(places: &[Position], duration: Duration) -> Arc<[Leg]> {
    let lengths_m = || places.windows(2).map(|ends| ends[0].distance_m(ends[1]));
    let whole_m: f64 = lengths_m().sum();
    let mut walked_m = 0.0;
    let mut start = SimTime::ZERO;
    let last = places.len() - 2;
    let leg = |(i, (ends, length_m)): (usize, (&[Position], f64))| {
        walked_m += length_m;
        let share = if i == last || whole_m <= 0.0 { 1.0 } else { (walked_m / whole_m).min(1.0) };
        let end = SimTime::ZERO + if share < 1.0 { duration.mul_f64(share).min(duration) } else { duration };
        let leg = Leg { from: ends[0], to: ends[1], start, end };
        start = end;
        leg
    };
    places.windows(2).zip(lengths_m()).enumerate().map(leg).collect()
}

const _: () = assert!(HOME_M < LEAST_LEG_M);
