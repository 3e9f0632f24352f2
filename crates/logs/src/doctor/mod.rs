//! The log doctor: what is odd in a log of a robot, what it costs, and what corrects it.
//!
//! Each check is a file and returns a [`Finding`], or nothing for a good log. Some look at what is only known while a log is
//! read (the times of packets, each strength, the poses), others at the reception log, and [`exponent`] at a map of it.

mod clock;
mod coarse;
pub mod exponent;
mod extent;
mod finding;
mod impossible;
mod levels;
pub(super) mod listening;
mod losses;
pub(super) mod motion;
mod moved;
mod node_fit;
pub(super) mod origin;
mod samples;
mod saturated;
#[cfg(test)]
mod tests;
mod twins;
mod wide_sectors;

use sextant_channel::{Position, ReceptionLog};

use super::path::Path;
pub use clock::ClockOffset;
pub(super) use clock::offset;
pub use finding::Finding;
pub(super) use levels::Levels;
pub(super) use samples::Samples;

/// What is odd of the paths of robots: poses without a fix or, if there are none, speeds.
pub(super) fn of_paths(paths: &[Path]) -> Vec<Finding> {
    let places: Vec<Position> = paths.iter().flat_map(Path::poses).map(|pose| pose.position).collect();
    let places_of = |path: &Path| path.poses().iter().map(|pose| (pose.time, pose.position)).collect();
    let speeds = || motion::finding(&paths.iter().map(places_of).collect::<Vec<_>>(), motion::POSES);
    origin::finding(&places, "poses").or_else(speeds).into_iter().collect()
}

/// The same of the places where robots stopped.
pub(super) fn of_stops(log: &ReceptionLog) -> Vec<Finding> {
    let places: Vec<Position> = log.stops().iter().map(|stop| stop.position).collect();
    let of_robot = |robot| {
        let stops = log.stops().iter().filter(move |stop| stop.robot.index() == robot);
        stops.map(|stop| (stop.time, stop.position)).collect()
    };
    let speeds = || motion::finding(&(0..log.robot_count()).map(of_robot).collect::<Vec<_>>(), "stops");
    origin::finding(&places, "stops").or_else(speeds).into_iter().collect()
}

/// What is odd of the strengths that were measured.
pub(super) fn of_levels(levels: &Levels) -> Vec<Finding> {
    [impossible::finding, saturated::finding, coarse::finding].iter().filter_map(|check| check(levels)).collect()
}

/// The findings without those that come from other ones: stops that are cut by a wrong path are too short.
pub(super) fn told_apart(mut findings: Vec<Finding>) -> Vec<Finding> {
    if findings.iter().any(|finding| ["no-fix", "speed"].contains(&finding.check)) {
        findings.retain(|finding| finding.check != "short-listening");
    }
    findings
}

/// What is odd of a log besides the findings `known`, whatever it was read from. Units and moved nodes are not told of a log
/// whose places or times are known to be wrong, because that would be why.
pub(super) fn of_log(log: &ReceptionLog, known: &[Finding]) -> Vec<Finding> {
    let is_known = |checks: &[&str]| known.iter().any(|finding| checks.contains(&finding.check));
    let places = !is_known(&["no-fix", "speed", "impossible-strengths"]);
    let times = !is_known(&["clock-offset"]);
    let extent = places.then(|| extent::finding(log)).flatten();
    let moved = (places && times && extent.is_none()).then(|| moved::finding(log)).flatten();
    [extent, losses::finding(log), twins::finding(log), moved, wide_sectors::finding(log)]
        .into_iter()
        .flatten()
        .collect()
}
