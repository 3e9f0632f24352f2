//! Where a robot listens next: the places that make a map of its log better for the way that they take.
//!
//! The log is mapped, the map says what is open of each node ([`Outlook`]), and a plan of [`sextant_apps::next_stops`] puts stops
//! where they bring most for their time. Nothing is known of the true places.

mod error;
mod pace;
mod region;
mod report;

use sextant_channel::{Bounds, ObstacleField, Position};
use sextant_kernel::text::counted;
use sextant_kernel::{RobotId, Watch};
use sextant_logs::LocalPlane;
use sextant_mapper::{Area, Outlook};
use sextant_scenario::MapSettings;

use sextant_apps::next_stops::{Ground, PlanEnd, StopBudget, Terrain, plan};

use crate::mapping::{self, Input};
use crate::summary::Stopwatch;

pub use error::NextError;
pub use pace::{Pace, PaceSource};
use region::Region;
pub use report::{NextStop, NextStops};

/// What is asked of a log.
#[derive(Clone, Debug, PartialEq)]
pub struct NextSettings {
    /// The most stops.
    pub stops: usize,
    /// The stops are within this area; within the reach of the hull of the stops of the log if absent.
    pub area: Option<Area>,
    /// The longest way of all (m); as long as it takes if absent.
    pub way_m: Option<f64>,
    /// Speed between stops (m/s); that of the log if absent.
    pub speed_m_per_s: Option<f64>,
    /// Time of listening at a stop (s); that of the log if absent.
    pub listen_s: Option<f64>,
    /// Radius of the hull of the robot, which stays so far from walls (m).
    pub radius_m: f64,
    /// The robot that drives; the one that listened last if absent.
    pub robot: Option<String>,
}

impl Default for NextSettings {
    fn default() -> Self {
        Self { stops: 10, area: None, way_m: None, speed_m_per_s: None, listen_s: None, radius_m: 0.2, robot: None }
    }
}

/// Places to stop at are so many to a reach, and at most so many in all.
const TO_A_REACH: f64 = 8.0;
const MOST_PLACES: f64 = 4000.0;
/// Nodes that were never heard may be at so many places at most.
const MOST_OPEN: usize = 400;

/// Maps the log of `input` by the first map of `settings`, and says where to listen next. A floor plan of `input` is kept to.
///
/// # Errors
/// If the log cannot be mapped, or it does not tell where to listen; if `watch` ends the work.
pub fn next_stops(
    input: &mut Input,
    settings: &MapSettings,
    next: &NextSettings,
    watch: &dyn Watch,
) -> Result<NextStops, NextError> {
    next.check()?;
    let robot = robot(input, next)?;
    let (summary, maps) = mapping::map(input, settings, None, Stopwatch::start(), watch)?;
    watch.check()?;
    let Some(computed) = maps.first() else { return Err(NextError::NoMap) };
    let log = input.log();
    let profile = computed.named.mapper.profile();
    let outlook = |open: &[Position]| Outlook::of(log, &computed.map, computed.learned.as_ref(), profile, open);
    let reach_m = outlook(&[])?.reach_m();
    let nothing = ObstacleField::default();
    let obstacles = input.floor.as_ref().unwrap_or(&nothing);
    let mut notes = summary.notes;
    let region = Region::new(next.area.as_ref(), log.stops(), reach_m, input.floor.as_ref(), &mut notes);
    let is_inside = |place: Position| region.contains(place);
    let (start, start_time) = robot.last;
    let bounds = region.bounds(start.z_m);
    let terrain = Terrain {
        bounds,
        is_inside: &is_inside,
        obstacles,
        radius_m: next.radius_m,
        step_m: step_m(bounds, reach_m),
    };
    let ground = Ground::new(terrain, start, watch)?;
    let every = ground.places().len().div_ceil(MOST_OPEN);
    let open: Vec<Position> = ground.places().iter().copied().step_by(every).collect();
    let outlook = outlook(&open)?;
    let pace = Pace::new(log, robot.id, next, &mut notes);
    let budget = StopBudget {
        stops: next.stops,
        way_m: next.way_m.unwrap_or(f64::INFINITY),
        speed_m_per_s: pace.speed_m_per_s,
        listen_s: pace.listen_s,
        least_s: pace.least_s(),
    };
    let plan = plan(&outlook, &ground, &budget, watch)?;
    if plan.stops.is_empty() && plan.end == PlanEnd::NothingMore && next.area.is_some() {
        let hears = |place: &Position| outlook.gain(*place).in_reach_m > 0.0;
        if !ground.places().iter().any(hears) {
            return Err(NextError::AreaOutOfReach { away_m: region.away_m(log.stops()), reach_m });
        }
    }
    if outlook.unheard_count() > 0 {
        let count = counted(outlook.unheard_count(), "node");
        notes.push(format!("{count} of the log were never heard: they may be anywhere in the region where they would not have been heard"));
    }
    Ok(NextStops::new(
        &plan,
        &outlook,
        report::Context { input, computed, pace, start_time, robot: robot.name, notes },
    ))
}

/// The robot that drives.
struct Driver {
    id: RobotId,
    name: String,
    /// Where it listened last, and when.
    last: (Position, sextant_kernel::SimTime),
}

fn robot(input: &Input, next: &NextSettings) -> Result<Driver, NextError> {
    let log = input.log();
    let stops = log.stops();
    let mut names = (0..log.robot_count()).map(|robot| log.robot_name(RobotId::from_index(robot)).into_owned());
    let id = match &next.robot {
        Some(name) => {
            let known: Vec<String> = names.clone().collect();
            let at = names.position(|known| known == *name);
            RobotId::from_index(at.ok_or_else(|| NextError::Robot { found: name.clone(), known })?)
        }
        None => stops
            .iter()
            .max_by_key(|stop| stop.time)
            .map(|stop| stop.robot)
            .ok_or(NextError::FewStops { found: 0 })?,
    };
    let mut own = stops.iter().filter(|stop| stop.robot == id);
    let first = own.next().ok_or(NextError::FewStops { found: 0 })?;
    let last = own.clone().max_by_key(|stop| stop.time).unwrap_or(first);
    if stops.len() < 2 {
        return Err(NextError::FewStops { found: stops.len() });
    }
    let is_driving = log.drives().any(|drive| drive.length_m() > 0.0);
    if !is_driving {
        return Err(NextError::NobodyDrives { robots: log.robot_count() });
    }
    let name = log.robot_name(id).into_owned();
    Ok(Driver { id, name, last: (last.position, last.time) })
}

/// Distance of neighbouring places to stop at (m).
fn step_m(bounds: Bounds, reach_m: f64) -> f64 {
    let size = bounds.max - bounds.min;
    (reach_m / TO_A_REACH).max((size.x_m * size.y_m / MOST_PLACES).sqrt())
}

impl NextSettings {
    fn check(&self) -> Result<(), NextError> {
        let above_zero = |what: &'static str, value: Option<f64>| match value {
            Some(found) if !(found.is_finite() && found > 0.0) => {
                Err(NextError::Setting { what, found: found.to_string(), allowed: "a number above 0" })
            }
            _ => Ok(()),
        };
        let not_below_zero = |what: &'static str, value: f64| {
            if value.is_finite() && value >= 0.0 {
                return Ok(());
            }
            Err(NextError::Setting { what, found: value.to_string(), allowed: "a number of at least 0" })
        };
        if self.stops == 0 {
            return Err(NextError::Setting { what: "number of stops", found: "0".to_owned(), allowed: "1 and more" });
        }
        above_zero("way (m)", self.way_m)?;
        above_zero("speed (m/s)", self.speed_m_per_s)?;
        not_below_zero("time of listening (s)", self.listen_s.unwrap_or(0.0))?;
        not_below_zero("radius of the robot (m)", self.radius_m)
    }
}

/// The place of a stop on the earth, if the log has its places there.
fn on_earth(plane: Option<&LocalPlane>, place: Position) -> Option<[f64; 2]> {
    let place = plane?.to_geodetic(place).rounded();
    Some([place.lat_deg, place.lon_deg])
}
