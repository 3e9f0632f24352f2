//! The robots of a team: each gets a part of the region, a start, and a frame of coordinates.

use sextant_apps::{ControllerConfig, FreeArea, RobotPart, Surroundings, partition};
use sextant_channel::{Bounds, ObstacleField, Position};
use sextant_kernel::{Purpose, Seed, SettingError};
use sextant_mapper::MapConfig;
use sextant_sim::layout::{Region, RegionConfig};
use sextant_sim::{OwnFrameConfig, RobotBody, RobotConfig, World};

use crate::config::team::{FramesConfig, MOST_ROBOTS, TeamConfig};

/// Frames of the robots of a team.
const FRAMES: Purpose = Purpose::new(32);

/// The robots of `team` in `world`; among no obstacles if it is not known.
pub(crate) fn robots(
    team: &TeamConfig,
    world: Option<&World>,
    seed: Seed,
) -> Result<Vec<RobotConfig<ControllerConfig>>, SettingError> {
    let overlap_m = SettingError::not_negative("overlap_m", team.overlap_m)?;
    if !(1..=MOST_ROBOTS).contains(&team.robots) {
        return Err(SettingError::new("robots", team.robots, format!("1 to {MOST_ROBOTS}")));
    }
    let nothing = ObstacleField::default();
    let obstacles = world.map_or(&nothing, |world| &world.obstacles);
    let ground = Ground::new(team, obstacles, seed)?;
    let whole = RobotPart { own: ground.area.bounds(), surveyed: ground.area.bounds() };
    let stops = ground.way(&whole)?.1;
    if stops > 0 && team.robots as usize > stops {
        let allowed = format!("1 to {stops}, one for each stop of the whole path");
        return Err(SettingError::new("robots", team.robots, allowed));
    }
    let cost = |_, part: &RobotPart| ground.way(part).ok().map(|(time_s, _)| time_s);
    let parts = partition(&ground.area, team.robots as usize, team.partition, overlap_m, cost);
    let frames = Frames { seed, reach_m: (whole.own.max - whole.own.min).length_m() };
    let robot = |(number, part): (u32, &RobotPart)| {
        let start_m = ground
            .start(part)
            .ok_or_else(|| SettingError::new("robots", team.robots, "a number so that each part has a free place"))?;
        let frame = match team.frames {
            FramesConfig::Unknown if number > 0 => frames.of(number),
            FramesConfig::Shared | FramesConfig::Unknown => OwnFrameConfig::default(),
        };
        Ok(team.robot(number, start_m, ground.controller(part), frame))
    };
    (0..).zip(&parts).map(robot).collect()
}

/// Leaves the only robot of a team with its own map: there is nothing to join, also in a sweep over the number of robots.
pub(crate) fn stitch_no_lone_robot(team: Option<&TeamConfig>, robots: usize, maps: &mut [MapConfig]) {
    if team.is_some_and(|team| team.robots == 1) && robots < 2 {
        maps.iter_mut().for_each(|map| map.stitch = None);
    }
}

/// What a team divides.
struct Ground<'a> {
    team: &'a TeamConfig,
    /// A robot that surveys all.
    body: RobotBody,
    obstacles: &'a ObstacleField,
    seed: Seed,
    area: FreeArea,
    /// Height at which robots start (m).
    z_m: f64,
    is_planar: bool,
}

impl<'a> Ground<'a> {
    fn new(team: &'a TeamConfig, obstacles: &'a ObstacleField, seed: Seed) -> Result<Self, SettingError> {
        let body = RobotBody::try_from(&team.any_robot())?;
        let Some((key, written)) = team.controller.region() else {
            let allowed = "`automated_s`, `s_path`, `spiral` or `hilbert`: a path over a region that can be divided";
            return Err(SettingError::new("controller", "a path that is not over a region", allowed));
        };
        let key = format!("controller.{key}");
        let written = written.ok_or_else(|| SettingError::missing(&key, "the region that the team divides"))?;
        let region = Region::try_from(written).map_err(|error| error.within(&key))?;
        let z_m = team.start_m.map_or(region.bounds().center().z_m, |start| start.z_m);
        let area = FreeArea::new(&region, obstacles, z_m);
        if area.area_m2(&area.bounds()) <= 0.0 {
            return Err(SettingError::new(key, "a region without a free place", "a region with free places"));
        }
        Ok(Self { team, body, obstacles, seed, area, z_m, is_planar: region.is_planar() })
    }

    /// The controller of a part.
    fn controller(&self, part: &RobotPart) -> ControllerConfig {
        let Bounds { min: min_m, max: max_m } = part.surveyed;
        let region = if self.is_planar {
            RegionConfig::Rectangle { min_m, max_m }
        } else {
            RegionConfig::Box { min_m, max_m }
        };
        self.team.controller.clone().over(region)
    }

    /// Where the robot of a part starts: at the common start, or at the free place nearest to the corner of its part.
    fn start(&self, part: &RobotPart) -> Option<Position> {
        if let Some(start) = self.team.start_m {
            return Some(start);
        }
        let is_free = |place: Position| {
            self.obstacles.is_empty()
                || (self.obstacles.containing(place).is_none()
                    && self.obstacles.distance_m(place) > self.body.radius_m)
        };
        let corner = Position { z_m: self.z_m, ..part.surveyed.min };
        if is_free(corner) {
            return Some(corner);
        }
        let near = self.area.places(part.surveyed, self.z_m).filter(|&place| is_free(place));
        near.min_by(|a, b| a.distance_m(corner).total_cmp(&b.distance_m(corner)))
    }

    /// How long the robot of a part is expected to take (s), and its stops.
    fn way(&self, part: &RobotPart) -> Result<(f64, usize), SettingError> {
        let start = self.team.start_m.unwrap_or(Position { z_m: self.z_m, ..part.surveyed.min });
        let surroundings = Surroundings {
            obstacles: self.obstacles,
            start,
            radius_m: self.body.radius_m,
            seed: self.seed,
            robot: 0,
        };
        let way = self.controller(part).expected_way(&surroundings).map_err(|error| error.within("controller"))?;
        let listened_s = way.stops as f64 * self.body.listen.as_secs_f64();
        Ok((way.length_m / self.body.speed_m_per_s + listened_s, way.stops))
    }
}

/// Random frames of coordinates.
struct Frames {
    seed: Seed,
    /// Offsets are within this in x and y (m).
    reach_m: f64,
}

impl Frames {
    fn of(&self, robot: u32) -> OwnFrameConfig {
        let draw = |what: u64| self.seed.uniform(FRAMES, [u64::from(robot), what, 0]);
        let aside_m = |what: u64| (2.0 * draw(what) - 1.0) * self.reach_m;
        OwnFrameConfig {
            offset_m: Position::new(aside_m(0), aside_m(1), 0.0),
            turn_deg: 360.0 * draw(2) - 180.0,
            mirrored: draw(3) < 0.5,
        }
    }
}
