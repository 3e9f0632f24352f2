//! Whether the grids of maps fit the memory, wherever robots stop.

use sextant_apps::{ControllerConfig, PathPart, Surroundings, drive_planned};
use sextant_channel::{Position, Stop};
use sextant_kernel::{RobotId, SettingError, SimTime};
use sextant_mapper::MapError;
use sextant_sim::{Listening, NetworkId, Robot, RobotBody, RobotConfig, RobotTask, RoleConfig, Setup};

use super::MapJob;
use crate::check::errors::Errors;

/// Refuses maps whose grid does not fit the memory. The stops of planned paths are known. A robot that decides on the way
/// stops at its start, and above and below it where its settings allow that.
pub(crate) fn check_grids<'a>(
    maps: impl IntoIterator<Item = (&'a MapJob, Vec<NetworkId>)>,
    setup: &Setup,
    robots: &[RobotConfig<ControllerConfig>],
    errors: &mut Errors,
) {
    let extents: Vec<Extent<'_>> = (setup.robots.iter().enumerate())
        .filter_map(|(number, robot)| Extent::of(number, robot, setup, robots))
        .collect();
    for (i, (map, networks)) in maps.into_iter().enumerate() {
        let is_heard = |extent: &&Extent<'_>| extent.body.networks.iter().any(|id| networks.contains(id));
        let stops: Vec<Stop> = extents.iter().filter(is_heard).flat_map(Extent::stops).collect();
        if stops.is_empty() {
            continue;
        }
        if let Err(error @ MapError::GridTooLarge { .. }) = map.mapper.check_grid(&stops) {
            let is_level = stops.iter().all(|stop| stop.position.z_m.total_cmp(&stops[0].position.z_m).is_eq());
            let allowed = if is_level {
                "settings whose grid fits wherever robots may stop"
            } else {
                "settings whose grid fits wherever robots may stop; `z_range_m` limits its heights"
            };
            errors.refuse(&SettingError::new(format!("maps[{i}].algorithm"), error, allowed));
        }
    }
}

/// Two corners of a box round the stops of a robot, in the frame of its log.
struct Extent<'a> {
    number: usize,
    body: &'a RobotBody,
    corners: [Position; 2],
}

impl<'a> Extent<'a> {
    /// That of robot `number`; `None` if it does not survey.
    fn of(number: usize, robot: &'a Robot, setup: &Setup, configs: &[RobotConfig<ControllerConfig>]) -> Option<Self> {
        let body = &robot.body;
        let RobotTask::Survey(controller) = &robot.task else { return None };
        let config = configs.iter().find(|config| config.name == body.name)?;
        let settings = config.controller.as_ref().filter(|_| config.role == RoleConfig::Survey)?;
        let surroundings = Surroundings {
            obstacles: &setup.world.obstacles,
            start: body.start,
            radius_m: body.radius_m,
            seed: setup.seed,
            robot: number as u64,
        };
        let mut corners: Option<[Position; 2]> = None;
        let mut take = |place: Position| {
            let place = body.frame.of_world(place);
            let [low, high] = corners.unwrap_or([place; 2]);
            corners = Some([each(low, place, f64::min), each(high, place, f64::max)]);
        };
        if settings.is_planned() {
            drive_planned(controller.duplicate(), &surroundings, |part| match part {
                PathPart::Stop(place) => take(place),
                PathPart::Drive { from, to } => {
                    ends_of_listening(body, from, to).into_iter().flatten().for_each(&mut take)
                }
            });
        } else {
            for z_m in settings.height_range_m(&surroundings)? {
                take(Position { z_m, ..body.start });
            }
        }
        corners.map(|corners| Self { number, body, corners })
    }

    fn stops(&self) -> impl Iterator<Item = Stop> {
        let robot = RobotId::from_index(self.number);
        self.corners.map(|position| Stop { robot, time: SimTime::ZERO, position, heading_rad: None }).into_iter()
    }
}

/// The first and the last place where a robot listens on a drive, if it does.
fn ends_of_listening(body: &RobotBody, from: Position, to: Position) -> Option<[Position; 2]> {
    let drive_s = from.distance_m(to) / body.speed_m_per_s;
    let slots = (drive_s / body.listen.as_secs_f64()).floor();
    if body.listening != Listening::AlsoWhileDriving || slots < 1.0 {
        return None;
    }
    let half = (to - from) * (0.5 / slots);
    Some([from + half, to - half])
}

/// A value for each coordinate of two places.
fn each(a: Position, b: Position, value: fn(f64, f64) -> f64) -> Position {
    Position::new(value(a.x_m, b.x_m), value(a.y_m, b.y_m), value(a.z_m, b.z_m))
}
