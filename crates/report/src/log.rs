//! The report of maps that were computed from a log.

use sextant::mapping::{ComputedMap, Input};
use sextant::summary::Summary;
use sextant_kernel::{NodeId, SimTime};
use sextant_recording::{Places, RecordedWorld};

use super::document::{DocumentKind, Report};
use super::frame::Frame;
use super::map::{Map, NodeDetails, Snapshot, errors};
use super::run::known_places;
use super::survey::{Contacts, Survey};
use super::world::{Body, Marks, Solid, Way, World};

impl Report {
    /// A report of `maps` of the log `input`. `file` names the log, `drawn` is what else is known of the world
    /// ([`sextant::mapping::drawn`]), and `summary` are the results.
    #[must_use]
    pub fn of_log(
        file: &str,
        input: &Input,
        drawn: &RecordedWorld,
        maps: &[ComputedMap<'_>],
        summary: &Summary,
    ) -> Self {
        let title = file.rsplit_once('.').map_or(file, |(stem, _)| if stem.is_empty() { file } else { stem });
        let mut report = Self::new(DocumentKind::Log, title, file);
        report.notes = summary.notes.clone();
        report.summary = Some(Summary { timing: None, ..summary.clone() }.to_json());
        report.scenario = input.scenario.clone();
        report.world = Some(world(input, drawn, maps));
        report
    }
}

fn world(input: &Input, drawn: &RecordedWorld, computed: &[ComputedMap<'_>]) -> World {
    let log = input.log();
    let stops = || input.logs.iter().flat_map(|named| named.log.stops());
    let placed: Vec<Places> = computed.iter().map(places).collect();
    let all = drawn.nodes.values().copied().chain(stops().map(|stop| stop.position));
    let all = all.chain(placed.iter().flat_map(|places| places.values()).copied());
    let frame = Frame::around(all, stops().map(|stop| stop.time));
    let nodes = log.node_count();
    let end = stops().map(|stop| stop.time).max().unwrap_or(SimTime::ZERO);
    let map = |(computed, places): (&ComputedMap<'_>, &Places)| Map {
        name: computed.named.name.clone(),
        snapshots: vec![Snapshot::of(end, places, &frame)],
        errors_m: errors(nodes, places, &drawn.nodes, &drawn.anchors),
        details: NodeDetails::of_map(&computed.map),
    };
    World {
        frame,
        names: log.names().to_vec(),
        truth_m: known_places(&drawn.nodes, nodes, &frame),
        anchors: Marks::of(&drawn.anchors, &frame),
        sinks: Marks::of(&drawn.sinks, &frame),
        obstacles: drawn.obstacles.iter().map(|solid| Solid::of(solid, &frame)).collect(),
        robots: robots(input, drawn, &frame),
        surveys: input.logs.iter().map(|named| Survey::of(named, &frame)).collect(),
        contacts: (!log.contacts().is_empty()).then(|| Contacts {
            times_s: frame.times(log.contacts().iter().map(|contact| contact.time)),
            places_m: frame.places(log.contacts().iter().map(|contact| contact.position)),
        }),
        maps: computed.iter().zip(&placed).map(map).collect(),
        ..World::default()
    }
}

/// The places on a map.
fn places(computed: &ComputedMap<'_>) -> Places {
    let positions = computed.map.positions().into_iter().enumerate();
    positions.filter_map(|(node, place)| Some((NodeId::from_index(node), place?))).collect()
}

/// The robots: each goes straight from stop to stop, at the times of the stops.
fn robots(input: &Input, drawn: &RecordedWorld, frame: &Frame) -> Vec<Body> {
    let log = input.log();
    let body = |(name, path): &(String, Vec<_>)| {
        let is_its = |robot| log.robot_name(robot) == name.as_str();
        let points: Vec<_> =
            log.stops().iter().filter(|stop| is_its(stop.robot)).map(|stop| (stop.time, stop.position)).collect();
        let has_times = points.windows(2).any(|pair| pair[0].0 < pair[1].0);
        let way = if has_times { Way::timed(&points, frame) } else { Way::untimed(path, frame) };
        Body { name: name.clone(), way }
    };
    let believed = drawn
        .believed_paths
        .iter()
        .map(|(name, path)| Body { name: format!("{name}, as believed"), way: Way::untimed(path, frame) });
    drawn.paths.iter().map(body).chain(believed).collect()
}
