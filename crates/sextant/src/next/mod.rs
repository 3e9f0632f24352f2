//! Where a robot listens next: the places that make a map of its log better for the way that they take.
//!
//! The log is mapped, the map says what is open of each node ([`Outlook`]), and a plan of [`sextant_apps::next_stops`] puts stops
//! where they bring most for their time. Nothing is known of the true places.

mod error;
mod figure;
mod pace;
mod region;
mod report;

use sextant_channel::{Bounds, ObstacleField, Position, Stop};
use sextant_kernel::text::counted;
use sextant_kernel::{RobotId, Watch};
use sextant_logs::LocalPlane;
use sextant_mapper::{Area, Outlook, OutlookError, RangeFit};
use sextant_scenario::{AlgorithmName, MapSettings, ScenarioErrors};

use sextant_apps::next_stops::{Ground, PlanEnd, StopBudget, Terrain, plan};

use crate::mapping::{self, ComputedMap, Input};
use crate::summary::Stopwatch;

pub use error::NextError;
pub use figure::figure;
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
/// Beyond this share of the reach between neighbouring places, stops that would hear a node are missed.
const FAR_APART: f64 = 0.25;
/// Nodes that were never heard may be at about so many places at most.
const MOST_OPEN: f64 = 400.0;
/// The golden ratio less 1: its multiples, without their whole parts, are spread evenly over 0 to 1.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// The map from which it is told, by `algorithm` or by the usual one of a log ([`AlgorithmName::usual`]), whatever maps the scenario
/// of the log has.
///
/// # Errors
/// All errors found.
pub fn map_settings(
    input: &Input,
    algorithm: Option<AlgorithmName>,
    profile: Option<&str>,
    network: Option<&str>,
) -> Result<MapSettings, ScenarioErrors> {
    let algorithm = algorithm.unwrap_or_else(|| AlgorithmName::usual(profile));
    input.map_settings(Some(algorithm), profile, network, &[])
}

/// Maps the log of `input` by the first map of `settings`, and says where to listen next. A floor plan of `input` is kept to. The map is
/// returned beside it.
///
/// # Errors
/// If the log cannot be mapped, or it does not tell where to listen; if `watch` ends the work.
pub fn next_stops<'a>(
    input: &mut Input,
    settings: &'a MapSettings,
    next: &NextSettings,
    watch: &dyn Watch,
) -> Result<(NextStops, ComputedMap<'a>), NextError> {
    next.check()?;
    let robot = robot(input, next)?;
    let has_packets = input.log().receptions().iter().any(|reception| reception.received > 0);
    if !has_packets && !input.log().ranges().is_empty() {
        return Err(NextError::Ranges { has_packets });
    }
    let (summary, maps) = mapping::map(input, settings, None, Stopwatch::start(), watch)?;
    watch.check()?;
    let Some(computed) = maps.into_iter().next() else { return Err(NextError::NoMap) };
    let log = input.log();
    let profile = computed.named.mapper.profile();
    let outlook = |open: &[Position]| Outlook::of(log, &computed.map, computed.learned.as_ref(), profile, open);
    let is_of_ranges = computed.learned.as_ref().is_some_and(|learned| learned.get::<RangeFit>().is_some());
    let reach_m = match outlook(&[]) {
        Err(OutlookError::NoLaw { .. }) if is_of_ranges => return Err(NextError::Ranges { has_packets }),
        outlook => outlook?.reach_m(),
    };
    let nothing = ObstacleField::default();
    let obstacles = input.floor.as_ref().unwrap_or(&nothing);
    let mut notes = summary.notes;
    let region = Region::new(next.area.as_ref(), log.stops(), reach_m, input.floor.as_ref(), &mut notes);
    let is_inside = |place: Position| region.contains(place);
    let (start, start_time) = robot.last;
    let mut bounds = region.bounds(start.z_m);
    if computed.map.unmapped() == 0 && region.away_m(log.stops()) <= 2.0 * reach_m {
        bounds = near_stops(bounds, log.stops(), reach_m);
    }
    let step_m = step_m(bounds, reach_m);
    if step_m > FAR_APART * reach_m {
        notes.push(format!(
            "the area is large: places are sought only every {step_m:.1} m, and nodes are heard within {reach_m:.1} m; give a smaller area"
        ));
    }
    let terrain = Terrain { bounds, is_inside: &is_inside, obstacles, radius_m: next.radius_m, step_m };
    let ground = Ground::new(terrain, start, watch)?;
    let outlook = outlook(&open_places(ground.places()))?;
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
        let away_m = region.away_m(log.stops());
        let hears = |place: &Position| outlook.gain(*place).in_reach_m > 0.0;
        if away_m > reach_m && !ground.places().iter().any(hears) {
            return Err(NextError::AreaOutOfReach { away_m, reach_m });
        }
    }
    if outlook.unheard_count() > 0 {
        let count = counted(outlook.unheard_count(), "node");
        notes.push(format!("{count} of the log were never heard: they may be anywhere in the region where they would not have been heard"));
    }
    let context = report::Context { input, computed: &computed, pace, start_time, robot: robot.name, notes };
    Ok((NextStops::new(&plan, &outlook, context), computed))
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
    let last = last_stop(stops, id).ok_or(NextError::FewStops { found: 0 })?;
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

/// Where a robot listened last, in whatever order the stops are listed.
fn last_stop(stops: &[Stop], robot: RobotId) -> Option<&Stop> {
    stops.iter().filter(|stop| stop.robot == robot).max_by_key(|stop| stop.time)
}

/// The part of a box in which nodes that were heard at `stops` can be heard: they are within the reach of a stop, and heard within the
/// reach. All of the box if it has no such part.
fn near_stops(bounds: Bounds, stops: &[Stop], reach_m: f64) -> Bounds {
    let Some(near) = Bounds::of(stops.iter().map(|stop| stop.position)) else { return bounds };
    let near = near.grown(2.0 * reach_m);
    let (mut min, mut max) = (bounds.min, bounds.max);
    (min.x_m, min.y_m) = (min.x_m.max(near.min.x_m), min.y_m.max(near.min.y_m));
    (max.x_m, max.y_m) = (max.x_m.min(near.max.x_m), max.y_m.min(near.max.y_m));
    if min.x_m <= max.x_m && min.y_m <= max.y_m { Bounds { min, max } } else { bounds }
}

/// The places at which nodes that were never heard may be. A fixed stride over the rows of places would take few of their columns.
fn open_places(places: &[Position]) -> Vec<Position> {
    let share = MOST_OPEN / places.len() as f64;
    let is_open = |number: usize| (number as f64 * GOLDEN).fract() < share;
    places.iter().enumerate().filter(|(number, _)| is_open(*number)).map(|(_, place)| *place).collect()
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

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use sextant_kernel::SimTime;

    use super::*;

    fn stop(robot: u32, time_s: u64, x_m: f64) -> Stop {
        let time = SimTime::from_secs(time_s);
        Stop { robot: RobotId(robot), time, position: Position::new(x_m, 0.0, 0.0), heading_rad: None }
    }

    #[test]
    fn a_robot_listened_last_at_the_stop_with_the_latest_time_wherever_it_is_listed() {
        let stops = [stop(0, 30, 3.0), stop(1, 50, 5.0), stop(0, 10, 1.0), stop(0, 20, 2.0)];
        assert_eq!(last_stop(&stops, RobotId(0)), Some(&stops[0]));
        assert_eq!(last_stop(&stops, RobotId(1)), Some(&stops[1]));
        assert_eq!(last_stop(&stops, RobotId(2)), None);
    }

    #[test]
    fn places_are_sought_only_where_nodes_that_were_heard_can_be_heard() {
        let at = |x_m: f64, y_m: f64| Position::new(x_m, y_m, 0.0);
        let stops = [stop(0, 0, 0.0), stop(0, 10, 20.0)];
        let large = Bounds { min: at(-5.0, -9000.0), max: at(9000.0, 9000.0) };
        assert_eq!(near_stops(large, &stops, 10.0), Bounds { min: at(-5.0, -20.0), max: at(40.0, 20.0) });
        // A lattice over all of it would be coarser than the reach.
        assert!(step_m(large, 10.0) > 100.0 && step_m(near_stops(large, &stops, 10.0), 10.0) < 2.0);
        let far = Bounds { min: at(900.0, 900.0), max: at(910.0, 910.0) };
        assert_eq!(near_stops(far, &stops, 10.0), far);
    }

    #[test]
    fn nodes_that_were_never_heard_may_be_in_each_row_and_column() {
        // 2000 places: each fifth one would be in ten of the fifty columns.
        let place = |number: u32| Position::new(f64::from(number % 50), f64::from(number / 50), 0.0);
        let open = open_places(&(0..2000).map(place).collect::<Vec<_>>());
        let different =
            |of: fn(&Position) -> f64| open.iter().map(|place| of(place).to_bits()).collect::<BTreeSet<_>>().len();
        assert!((395..=405).contains(&open.len()), "{}", open.len());
        assert_eq!((different(|place| place.x_m), different(|place| place.y_m)), (50, 40));
        assert_eq!(open_places(&open[..100]).len(), 100);
    }
}
