//! The search for targets as a mission.

use std::sync::Arc;

use sextant_channel::{Bounds, Position};
use sextant_kernel::SettingError;
use sextant_sim::{Applications, ReadySimulation, Setup, Simulation, TargetMotionConfig};

use super::config::{DetarskConfig, PGConfig};
use super::doubt::Doubt;
use super::outbox::MessageCounts;
use super::settings::TargetSearch;
use super::station::{SearchRecord, SearchStation};
use crate::mission::{
    Mission, MissionGoal, MissionOutcome, MissionPlace, MissionRobots, MissionSettings, MissionTeam,
};
use crate::navigation::NavigationMap;

impl MissionSettings for DetarskConfig {
    fn key(&self) -> &'static str {
        "detarsk"
    }

    fn name(&self) -> &'static str {
        "detarsk"
    }

    fn check_world(&self, place: &MissionPlace<'_>) -> Result<(), SettingError> {
        check_sensed(self.key(), place)?;
        if !place.has_sink {
            let allowed = "at least one sink in the network, in `[[sinks]]`: nodes tell it of the first detection";
            return Err(SettingError::new("algorithm", "`detarsk`, without a sink", allowed));
        }
        check_ways(place)
    }

    fn check_robots(&self, robots: &MissionRobots<'_>) -> Result<(), SettingError> {
        check_speeds(robots)
    }

    fn check(&self, place: &MissionPlace<'_>) -> Result<Arc<dyn Mission>, SettingError> {
        let places = place.world.nodes.iter().map(|node| node.position);
        let doubt = || place.world.sensors.targets.and_then(|sensor| Doubt::new(&sensor, places));
        Ok(Arc::new(TargetSearch::detarsk(self)?.among(doubt())?))
    }
}

impl MissionSettings for PGConfig {
    fn key(&self) -> &'static str {
        "p_g"
    }

    fn name(&self) -> &'static str {
        "p-g"
    }

    fn check_world(&self, place: &MissionPlace<'_>) -> Result<(), SettingError> {
        check_sensed(self.key(), place)?;
        check_ways(place)
    }

    fn check_robots(&self, robots: &MissionRobots<'_>) -> Result<(), SettingError> {
        check_speeds(robots)
    }

    fn check(&self, place: &MissionPlace<'_>) -> Result<Arc<dyn Mission>, SettingError> {
        Ok(Arc::new(TargetSearch::pseudo_gradient(self, place.radio())?))
    }
}

impl Mission for TargetSearch {
    fn goal(&self) -> MissionGoal {
        MissionGoal::Targets
    }

    fn prepare(
        self: Arc<Self>,
        map: &Arc<NavigationMap>,
        team: MissionTeam<'_>,
        setup: Setup,
    ) -> Result<ReadySimulation<'static, MissionOutcome>, SettingError> {
        let simulation = Simulation::with(setup, self.stations(map, team))?;
        Ok(simulation.ready(|own| outcome(&own.each(SearchStation::into_record))))
    }
}

/// Refuses a world without targets, and nodes that do not detect them.
fn check_sensed(algorithm: &str, place: &MissionPlace<'_>) -> Result<(), SettingError> {
    if place.world.targets.is_empty() {
        let allowed = format!("another algorithm, or targets in `[[world.targets]]`: `{algorithm}` searches them");
        return Err(SettingError::new("algorithm", format!("`{algorithm}`, without targets"), allowed));
    }
    if place.sensors.targets.is_none() {
        let allowed = format!("a table `[sensors.targets]`: with `{algorithm}` nodes detect targets");
        return Err(SettingError::new("algorithm", format!("`{algorithm}`, without sensors of targets"), allowed));
    }
    Ok(())
}

/// Refuses targets that never come near a node.
fn check_ways(place: &MissionPlace<'_>) -> Result<(), SettingError> {
    let radius_m = place.sensors.targets.map_or(0.0, |sensor| sensor.radius_m);
    let Some(world) = Bounds::of(place.world.nodes.iter().map(|node| node.position)) else { return Ok(()) };
    for (i, target) in place.targets.iter().enumerate() {
        let places = match &target.motion {
            TargetMotionConfig::Waypoints(way) => way.places_m.clone(),
            TargetMotionConfig::RandomWalk(walk) => vec![walk.start_m],
            TargetMotionConfig::Wander(visit) => vec![visit.from_m, visit.to_m],
            TargetMotionConfig::Evade(flight) => vec![flight.start_m],
        };
        let Some(way) = Bounds::of(places) else { continue };
        let pairs = |of: fn(Position) -> f64| (of(way.min), of(way.max), of(world.min), of(world.max));
        let axes = [pairs(|place| place.x_m), pairs(|place| place.y_m), pairs(|place| place.z_m)];
        if axes.iter().any(|&(low, high, least, most)| low > most + radius_m || high < least - radius_m) {
            let found = format!("target `{}`, whose way is outside the world", target.name);
            let allowed = format!(
                "targets that come within {radius_m} m of the box around the nodes (see `world.targets[{i}]`)"
            );
            return Err(SettingError::new("algorithm", found, allowed));
        }
    }
    Ok(())
}

/// Refuses robots that are slower than the targets that they search.
fn check_speeds(robots: &MissionRobots<'_>) -> Result<(), SettingError> {
    if robots.may_be_slower {
        return Ok(());
    }
    let speed = |motion: &TargetMotionConfig| match motion {
        TargetMotionConfig::Waypoints(way) if way.places_m.len() < 2 => 0.0,
        TargetMotionConfig::Waypoints(way) => way.speed_m_per_s,
        TargetMotionConfig::RandomWalk(walk) => walk.speed_m_per_s,
        TargetMotionConfig::Wander(visit) => visit.speed_m_per_s,
        TargetMotionConfig::Evade(flight) => flight.speed_m_per_s,
    };
    let targets = robots.targets.iter().map(|target| (speed(&target.motion), &target.name));
    let Some((fastest, target)) = targets.max_by(|a, b| a.0.total_cmp(&b.0)) else { return Ok(()) };
    let Some(slow) = robots.bodies.iter().find(|robot| robot.speed_m_per_s < fastest) else { return Ok(()) };
    let found = format!(
        "`{}` with {} m/s, slower than the target `{target}` with {fastest} m/s",
        slow.name, slow.speed_m_per_s
    );
    let allowed = "robots that are at least as fast as the targets; `allow_slower = true` permits others";
    Err(SettingError::new("robots", found, allowed))
}

/// What all stations together did.
fn outcome(records: &Applications<SearchRecord>) -> MissionOutcome {
    let mut counts = MessageCounts::default();
    let mut outcome = MissionOutcome::default();
    for record in records.nodes.iter().chain(&records.robots).chain(&records.sinks) {
        counts += match record {
            SearchRecord::Node(node) => {
                *outcome.steps.entry("unacknowledged").or_default() += node.failures;
                node.sent
            }
            SearchRecord::Robot(robot) => {
                *outcome.steps.entry("decisions").or_default() += robot.steps.len() as u64;
                *outcome.steps.entry("filter_fallbacks").or_default() += u64::from(robot.fallbacks);
                *outcome.steps.entry("blocked").or_default() += robot.blocked;
                robot.sent
            }
            SearchRecord::Sink(sink) => *sink,
        };
    }
    let MessageCounts { requests, answers, tree, detections, alarms, claims, gradients, octets, refused } = counts;
    outcome.messages.extend([
        ("requests", requests),
        ("answers", answers),
        ("tree", tree),
        ("detections", detections),
        ("alarms", alarms),
        ("claims", claims),
        ("gradients", gradients),
        ("refused", refused),
    ]);
    MissionOutcome { octets, ..outcome }.without_zeros()
}
