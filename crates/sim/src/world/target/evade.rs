//! Targets that flee from robots.

use std::f64::consts::{FRAC_PI_4, PI};
use std::time::Duration;

use serde::{Deserialize, Serialize};
use sextant_channel::{ObstacleField, Position};
use sextant_kernel::{Seed, SettingError, SimTime};

use super::super::layout::{Region, RegionConfig};
use super::gait::{CLEARANCE_M, Gait, Ground, LEAST_LEG_M, MARGIN_M, StraightConfig, Stroll, TurnConfig};
use super::leg::Leg;
use super::{inside, speed};

/// Angle between the directions that a fleeing target compares (rad): 15 degrees.
const FAN_RAD: f64 = PI / 12.0;

/// A target that flees, as written in a scenario. While it sees no robot, it walks at random as in `random_walk`. It
/// looks around at each turn and at least once in `decide_s`. If robots are in sight, it goes where the nearest of them
/// will be farthest from it, of directions 15 degrees apart, as far as the border of the region and obstacles let it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct EvadeConfig {
    /// Where it starts (m).
    pub start_m: Position,
    /// Speed (m/s).
    pub speed_m_per_s: f64,
    /// Distance within which it sees robots (m). Obstacles do not matter.
    pub sight_m: f64,
    /// Longest time between two looks around (s).
    pub decide_s: f64,
    /// How far it goes between two turns while it sees no robot.
    pub straight: StraightConfig,
    /// How much it turns then; any direction is as likely as any other if absent.
    #[serde(default)]
    pub turn: TurnConfig,
    /// The region that it does not leave. In a flat region it stays at one height.
    pub region: RegionConfig,
}

/// A target that flees from robots.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Evasion {
    start: Position,
    speed_m_per_s: f64,
    sight_m: f64,
    decide: Duration,
    gait: Gait,
    region: Region,
}

impl EvadeConfig {
    /// The target among `obstacles`.
    pub(super) fn build(&self, obstacles: &ObstacleField) -> Result<Evasion, SettingError> {
        let region = Region::try_from(&self.region).map_err(|error| error.within("region"))?;
        let start = inside("start_m", self.start_m, &region, obstacles)?;
        let speed_m_per_s = speed("speed_m_per_s", self.speed_m_per_s)?;
        Ok(Evasion {
            start,
            speed_m_per_s,
            sight_m: SettingError::in_range("sight_m", self.sight_m, 0.0, 1e6)?,
            decide: Duration::from_secs_f64(SettingError::in_range("decide_s", self.decide_s, 1e-2, 1e6)?),
            gait: Gait::new(self.straight, self.turn, speed_m_per_s)?,
            region,
        })
    }
}

impl Evasion {
    pub(super) fn start(&self) -> Position {
        self.start
    }

    /// Target number `number`, at its start.
    pub(super) fn begin(self, number: u64, seed: Seed) -> Evader {
        Evader { stroll: Stroll::new(self.gait, &self.region, number, seed), evasion: self }
    }
}

/// A target that flees, on its way.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Evader {
    evasion: Evasion,
    stroll: Stroll,
}

impl Evader {
    /// The leg that begins at `from` at the time `start`, with robots at these places. A target that cannot go anywhere
    /// waits until it looks around again.
    pub(super) fn leg(
        &mut self,
        from: Position,
        start: SimTime,
        obstacles: &ObstacleField,
        robots: &[Position],
    ) -> Leg {
        let Evasion { speed_m_per_s, sight_m, decide, region, .. } = &self.evasion;
        let most_m = speed_m_per_s * decide.as_secs_f64();
        let in_sight = || robots.iter().copied().filter(|robot| robot.distance_m(from) <= *sight_m);
        let nearest = in_sight().min_by(|a, b| a.distance_m(from).total_cmp(&b.distance_m(from)));
        let to = match nearest {
            None => self.stroll.step(from, |_| most_m, Ground { region, obstacles }).map(|(to, _)| to),
            Some(nearest) => {
                let away = from - nearest;
                let away_m = away.length_m();
                let ahead = if away_m > 0.0 { away * (1.0 / away_m) } else { self.stroll.direction() };
                let ends = directions(ahead, region.is_planar())
                    .filter_map(|direction| reach(from, direction, most_m, Ground { region, obstacles }));
                let distance_m =
                    |place: Position| in_sight().map(|robot| robot.distance_m(place)).fold(f64::INFINITY, f64::min);
                let best = ends.reduce(|best, end| if distance_m(end.0) > distance_m(best.0) { end } else { best });
                // Where it stands may be best.
                let best = best.filter(|&(place, _)| distance_m(place) > distance_m(from));
                best.map(|(place, direction)| {
                    self.stroll.set_out_in(direction);
                    place
                })
            }
        };
        match to {
            Some(to) => Leg::new(from, to, start, *speed_m_per_s),
            None => Leg { from, to: from, start, end: start + *decide },
        }
    }
}

/// The directions that a target compares, that straight `ahead` first, then by angle.
fn directions(ahead: Position, is_planar: bool) -> impl Iterator<Item = Position> {
    // Ahead in the plane of a flat region, even if the robot is above it.
    let level = Position::new(ahead.x_m, ahead.y_m, 0.0);
    let ahead = match level.length_m() {
        level_m if !is_planar => {
            if level_m < 1e-6 {
                Position::new(0.0, 0.0, ahead.z_m.signum())
            } else {
                ahead
            }
        }
        level_m if level_m < 1e-6 => Position::new(1.0, 0.0, 0.0),
        level_m => level * (1.0 / level_m),
    };
    let left = Position::new(-ahead.y_m, ahead.x_m, 0.0);
    let left = if left.length_m() < 1e-6 { Position::new(0.0, 1.0, 0.0) } else { left * (1.0 / left.length_m()) };
    let above = ahead.cross(left);
    // To the left and to the right in a plane; in space also to all sides between them.
    let sides = if is_planar { 2 } else { 8 };
    let aside = move |side: u32| {
        let around = FRAC_PI_4 * f64::from(side);
        match side {
            _ if !is_planar => left * libm::cos(around) + above * libm::sin(around),
            0 => left,
            _ => left * -1.0,
        }
    };
    let tilted = move |number: u32| {
        let (angle, aside) = (FAN_RAD * f64::from(number / sides), aside(number % sides));
        let direction = ahead * libm::cos(angle) + aside * libm::sin(angle);
        direction * (1.0 / direction.length_m())
    };
    (0..=12 * sides).map(tilted)
}

/// How far a target gets from `from` in `direction` (of length one), at most `most_m`: the place, if it is another one.
fn reach(
    from: Position,
    direction: Position,
    most_m: f64,
    Ground { region, obstacles }: Ground<'_>,
) -> Option<(Position, Position)> {
    let inside_m = (region.way_out(from, direction).distance_m - MARGIN_M).clamp(0.0, most_m);
    let length_m = obstacles.clearance_m(from, direction, inside_m, CLEARANCE_M);
    let to = from + direction * length_m;
    (length_m >= LEAST_LEG_M && region.contains(to)).then_some((to, direction))
}
