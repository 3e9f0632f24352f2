//! The report of a recording.

use std::path::Path;

use serde_json::Value;
use sextant_channel::Position;
use sextant_kernel::{NodeId, SimTime};
use sextant_recording::{
    self as recording, ORIGIN_METADATA, Places, RecordedCourse, RecordedRun, RecordedWorld, SCENARIO_ATTACHMENT,
    SUMMARY_ATTACHMENT,
};

use super::column::Column;
use super::document::{DocumentKind, Report};
use super::error::ReportError;
use super::frame::Frame;
use super::map::{Map, NodeDetails, Snapshot, errors};
use super::missions::ReportedMission;
use super::plane::Plane;
use super::survey::{Contacts, Survey};
use super::tree::{Deaths, Tree};
use super::world::{Body, Marks, PhaseSpan, Solid, Way, World};

/// More receptions make a page of a few hundred megabytes, which browsers do not open.
const MOST_RECEPTIONS: usize = 20_000_000;

impl Report {
    /// A report of the recording `path` of a run.
    ///
    /// # Errors
    /// If the recording cannot be read, is damaged, has nothing to show, or has too many receptions for a page.
    pub fn of_recording(path: &Path) -> Result<Self, ReportError> {
        let run = recording::read_run(path)?;
        let receptions: usize = run.logs.iter().map(|named| named.log.receptions().len()).sum();
        if receptions > MOST_RECEPTIONS {
            return Err(ReportError::TooLarge { path: path.to_owned(), receptions, allowed: MOST_RECEPTIONS });
        }
        let drawn = recording::read_world(path)?;
        let course = recording::read_course(path)?;
        let summary = summary(&run);
        let RecordedWorld { maps, targets, fields, applications, sinks, .. } = &drawn;
        let is_empty = maps.is_empty() && targets.is_empty() && fields.is_empty() && sinks.is_empty();
        if is_empty && applications.is_empty() && run.log().stops().is_empty() && summary.is_none() {
            return Err(ReportError::Empty { path: path.to_owned() });
        }
        let file = path.file_name().unwrap_or_default().to_string_lossy();
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let about = run.metadata.get(ORIGIN_METADATA);
        let said = |key: &str| about.and_then(|about| about.get(key)).cloned();
        let mut report = Self::new(DocumentKind::Run, &said("scenario").unwrap_or_else(|| stem.into_owned()), &file);
        report.origin.scenario = said("scenario");
        report.origin.seed = said("seed");
        report.origin.version = said("version");
        report.notes.extend(run.concern().map(|concern| format!("{}.", concern.replacen('t', "T", 1))));
        report.notes.extend(summary.as_deref().map(notes).unwrap_or_default());
        if let Some(text) = run.attachment(SCENARIO_ATTACHMENT) {
            report.scenario = Some(String::from_utf8_lossy(&text.data).into_owned());
        }
        let frame = frame(&run, &drawn, &course);
        report.applications = drawn.applications.iter().map(|one| ReportedMission::of(one, &frame)).collect();
        report.world = Some(world(&run, &drawn, &course, frame));
        report.summary = summary;
        Ok(report)
    }
}

/// The text of the summary in the recording, if there is one.
fn summary(run: &RecordedRun) -> Option<String> {
    let text = String::from_utf8_lossy(&run.attachment(SUMMARY_ATTACHMENT)?.data).into_owned();
    serde_json::from_str::<Value>(&text).is_ok().then_some(text)
}

/// What the user should know, by the summary.
fn notes(summary: &str) -> Vec<String> {
    let Ok(summary) = serde_json::from_str::<Value>(summary) else { return Vec::new() };
    let is_interrupted = |part: &Value| part.get("interrupted").is_some_and(|interrupted| interrupted == true);
    let ended = (is_interrupted(&summary) || summary.get("gathering").is_some_and(is_interrupted)).then(|| {
        let at = summary.pointer("/simulation/sim_time_s").and_then(Value::as_f64);
        let at = at.map_or_else(String::new, |time_s| format!(" at {time_s:.1} s of simulated time"));
        format!("The run was interrupted{at}: what would have followed is missing.")
    });
    let told: Option<Vec<String>> = summary.get("notes").and_then(|notes| serde_json::from_value(notes.clone()).ok());
    ended.into_iter().chain(told.unwrap_or_default()).collect()
}

/// The zero of the recording.
fn frame(run: &RecordedRun, drawn: &RecordedWorld, course: &RecordedCourse) -> Frame {
    let stops = || run.logs.iter().flat_map(|named| named.log.stops());
    let corners = drawn.obstacles.iter().flat_map(|solid| &solid.vertices).copied();
    let maps = drawn.maps.iter().flat_map(|(_, places)| places.values()).copied();
    let ways = course.robots.iter().flat_map(|(_, way)| way.points());
    let places = drawn.nodes.values().copied().chain(drawn.sinks.values().copied()).chain(corners).chain(maps);
    let places = places.chain(stops().map(|stop| stop.position)).chain(ways.clone().map(|(_, place)| *place));
    let times = stops().map(|stop| stop.time).chain(ways.map(|(time, _)| *time));
    Frame::around(places, times)
}

fn world(run: &RecordedRun, drawn: &RecordedWorld, course: &RecordedCourse, frame: Frame) -> World {
    let log = run.log();
    let nodes = log.node_count().max(drawn.nodes.keys().last().map_or(0, |node| node.index() + 1));
    let name = |node: usize| log.names().get(node).cloned().unwrap_or_else(|| format!("node {node}"));
    let contacts: Vec<_> = log.contacts().iter().collect();
    World {
        frame,
        names: (0..nodes).map(name).collect(),
        truth_m: known_places(&drawn.nodes, nodes, &frame),
        anchors: Marks::of(&drawn.anchors, &frame),
        sinks: Marks::of(&drawn.sinks, &frame),
        obstacles: drawn.obstacles.iter().map(|solid| Solid::of(solid, &frame)).collect(),
        robots: robots(drawn, course, &frame),
        surveys: surveys(run, &frame),
        contacts: (!contacts.is_empty()).then(|| Contacts {
            times_s: frame.times(contacts.iter().map(|contact| contact.time)),
            places_m: frame.places(contacts.iter().map(|contact| contact.position)),
        }),
        maps: maps(drawn, course, nodes, &frame),
        targets: drawn.targets.iter().map(|target| Body::of_target(target, &frame)).collect(),
        likelihoods: drawn
            .likelihoods
            .iter()
            .map(|surface| Plane::new(&surface.map, Some(&surface.node), None, &surface.plane, &frame))
            .collect(),
        fields: Plane::of_fields(&drawn.fields, &frame),
        tree: Tree::of(drawn, &frame),
        deaths: Deaths::of(drawn, &frame),
        phases: course.phases.iter().map(|phase| PhaseSpan::of(phase, &frame)).collect(),
    }
}

/// The places of all nodes, if at least one is known.
pub(super) fn known_places(places: &Places, nodes: usize, frame: &Frame) -> Option<Column> {
    let place = |node: usize| -> Option<Position> { places.get(&NodeId::from_index(node)).copied() };
    (!places.is_empty()).then(|| frame.known_places((0..nodes).map(place)))
}

/// The surveys with stops.
fn surveys(run: &RecordedRun, frame: &Frame) -> Vec<Survey> {
    run.logs.iter().filter(|named| !named.log.stops().is_empty()).map(|named| Survey::of(named, frame)).collect()
}

/// The robots with paths first, in their order, then those that only have transforms.
fn robots(drawn: &RecordedWorld, course: &RecordedCourse, frame: &Frame) -> Vec<Body> {
    let in_paths = drawn.paths.iter().map(|(name, _)| name);
    let mut names: Vec<&String> = in_paths.collect();
    let rest: Vec<&String> =
        course.robots.iter().map(|(name, _)| name).filter(|name| !names.contains(name)).collect();
    names.extend(rest);
    let body = |name: &String| {
        let way =
            course.robots.iter().find(|(other, _)| other == name).map(|(_, way)| Way::timed(way.points(), frame));
        let path = drawn.paths.iter().find(|(other, _)| other == name).map(|(_, path)| Way::untimed(path, frame));
        way.or(path).map(|way| Body { name: name.clone(), way })
    };
    names.into_iter().filter_map(body).collect()
}

fn maps(drawn: &RecordedWorld, course: &RecordedCourse, nodes: usize, frame: &Frame) -> Vec<Map> {
    let of_nodes = (!drawn.mapped_nodes.is_empty()).then(|| drawn.maps.first()).flatten().map(|(name, _)| name);
    let map = |(name, last): &(String, Places)| {
        let snapshots = course.maps.iter().find(|(other, _)| other == name).map_or(&[][..], |(_, maps)| maps);
        let snapshots: Vec<_> =
            snapshots.iter().map(|(time, places): &(SimTime, Places)| Snapshot::of(*time, places, frame)).collect();
        Map {
            name: name.clone(),
            snapshots,
            errors_m: errors(nodes, last, &drawn.nodes, &drawn.anchors),
            details: of_nodes
                .filter(|of_nodes| *of_nodes == name)
                .and_then(|_| NodeDetails::of_nodes(&course.mapped_nodes, nodes)),
        }
    };
    drawn.maps.iter().map(map).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interrupted_run_is_told_before_all_other_notes() {
        let interrupted = r#"{"simulation": {"sim_time_s": 12.25}, "interrupted": true, "notes": ["n"]}"#;
        let told = "The run was interrupted at 12.2 s of simulated time: what would have followed is missing.";
        assert_eq!(notes(interrupted), [told, "n"]);
        let gathering = notes(r#"{"gathering": {"interrupted": true}}"#);
        assert_eq!(gathering, ["The run was interrupted: what would have followed is missing."]);
        assert!(notes(r#"{"gathering": {"interrupted": false}}"#).is_empty() && notes("{").is_empty());
    }
}
