//! The log doctor: what is odd in a log of a robot, what it costs, and what corrects it.
//!
//! Each check is a file and returns a [`Finding`], or nothing for a good log. Some look at what is only known while a log is
//! read (the times of packets, each strength, the poses), others at the reception log, and some at a map of it ([`of_map`]).

mod alike_names;
mod clock;
mod clock_drift;
mod coarse;
mod distance_law;
mod evidence;
mod explained;
mod exponent;
mod extent;
mod far_from_strongest;
mod finding;
mod impossible;
mod lattice;
mod levels;
pub(super) mod listening;
mod losses;
mod motion;
mod moved;
mod no_distance;
mod node_fit;
mod node_strengths;
mod origin;
mod outlying;
mod outlying_strengths;
pub(super) mod part;
mod pile;
mod placed_by;
pub(super) mod repeated;
#[cfg(test)]
mod rivals;
mod route;
mod samples;
mod saturated;
mod shadowing;
mod silence_level;
mod stop_text;
mod survey;
#[cfg(test)]
mod tests;
mod track;
mod twins;
#[cfg(test)]
mod two_frames;
mod wide_sectors;

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::RobotId;
use sextant_mapper::{EstimatorFindings, FrameChange, Stitching, moved_log};

use crate::path::robot_path::Path;
use crate::place::local_plane::LocalPlane;
pub use clock::ClockOffset;
pub(super) use clock::offset;
pub(super) use clock_drift::ClockDrift;
use distance_law::DistanceLaw;
use explained::NodeSums;
pub use finding::Finding;
pub(super) use levels::Levels;
pub use placed_by::PlacedBy;
pub(super) use samples::Samples;
use survey::Survey;

/// What is odd of the paths of robots that heard `log`: poses without a fix or, if there are none, speeds. `plane` is that of the
/// places, if they were given by latitude and longitude.
pub(super) fn of_paths<'p>(
    paths: impl Iterator<Item = &'p Path>,
    log: &ReceptionLog,
    plane: Option<&LocalPlane>,
) -> Vec<Finding> {
    of_survey(&Survey::of_paths(paths, log, plane))
}

/// The same of the places where robots stopped.
pub(super) fn of_stops(log: &ReceptionLog, plane: Option<&LocalPlane>) -> Vec<Finding> {
    of_survey(&Survey::of_stops(log, plane))
}

fn of_survey(survey: &Survey<'_>) -> Vec<Finding> {
    let places = origin::finding(survey).or_else(|| outlying::finding(survey));
    places.or_else(|| motion::finding(survey)).into_iter().collect()
}

/// What is odd of the strengths that were measured.
pub(super) fn of_levels(levels: &Levels) -> Vec<Finding> {
    let checks = [impossible::finding, silence_level::finding, saturated::finding, coarse::finding];
    checks.iter().filter_map(|check| check(levels)).collect()
}

/// The findings without those that come from other ones: stops that are cut by a wrong path are too short, and where it jumps packets
/// seem to be late.
pub(super) fn told_apart(mut findings: Vec<Finding>) -> Vec<Finding> {
    if findings.iter().any(|finding| ["no-fix", "speed"].contains(&finding.check)) {
        findings.retain(|finding| !["short-listening", "clock-drift"].contains(&finding.check));
    }
    findings
}

/// What is odd of a log besides the findings `known`, whatever it was read from. Units and moved nodes are not told of a log
/// whose places or times are known to be wrong, because that would be why.
pub(super) fn of_log(log: &ReceptionLog, known: &[Finding], placed_by: PlacedBy) -> Vec<Finding> {
    let is_known = |checks: &[&str]| known.iter().any(|finding| checks.contains(&finding.check));
    let places = !is_known(&["no-fix", "outlying-stops", "speed", "impossible-strengths"]);
    let times = !is_known(&["clock-offset", "clock-drift"]);
    let extent = places.then(|| extent::finding(log)).flatten();
    let law = (places && times && extent.is_none()).then(|| DistanceLaw::of(log)).flatten();
    let no_distance = law.as_ref().and_then(|law| no_distance::finding(law, placed_by));
    let moved = law.as_ref().and_then(|law| moved::finding(log, law));
    let strengths = places.then(|| outlying_strengths::finding(log)).flatten();
    let names = alike_names::finding(log);
    [
        extent,
        names,
        losses::finding(log),
        twins::finding(log),
        strengths,
        no_distance,
        moved,
        wide_sectors::finding(log),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// The same of each robot's part of a log whose robots have frames of their own.
pub(super) fn of_robots(log: &ReceptionLog, known: &[Finding], placed_by: PlacedBy) -> Vec<Finding> {
    let robots = (0..log.robot_count()).map(RobotId::from_index);
    let of_robot = |robot: RobotId| {
        let part = moved_log(log, |other| (other == robot).then_some(FrameChange::NONE));
        let name = log.robot_name(robot).into_owned();
        let named = move |found: Finding| Finding { odd: format!("robot `{name}`: {}", found.odd), ..found };
        of_log(&part, known, placed_by).into_iter().map(named)
    };
    robots.flat_map(of_robot).collect()
}

/// What is odd of a map of `log` that has its nodes at `places`, with which this was `learned`: its law, and places that what was
/// heard there contradicts.
#[must_use]
pub fn of_map(
    log: &ReceptionLog,
    places: &[Option<Position>],
    learned: Option<&EstimatorFindings>,
    placed_by: PlacedBy,
) -> Vec<Finding> {
    // Places are compared with the stops as the map has them.
    let joined = learned.and_then(|learned| learned.get::<Stitching>()).map(|stitching| stitching.joined_log(log));
    let log = joined.as_ref().unwrap_or(log);
    let nodes = NodeSums::of_map(log, places);
    let exponent = learned.and_then(|learned| learned.path_loss_exponent());
    let exponent = exponent.and_then(|found| exponent::finding(found, &nodes, placed_by));
    let shadowing = learned.and_then(|learned| learned.shadowing());
    let shadowing = shadowing.and_then(|found| shadowing::finding(found, &nodes, placed_by));
    [exponent, shadowing, far_from_strongest::finding(log, places)].into_iter().flatten().collect()
}
