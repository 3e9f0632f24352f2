//! The report of maps that were computed from a log.

use sextant::mapping::{self, ComputedMap, Input, MapLogError};
use sextant::scenario::MapSettings;
use sextant::summary::{Stopwatch, Summary};
use sextant_kernel::{NodeId, SimTime, Watch};
use sextant_recording::{Places, RecordedWorld};

use super::document::{DocumentKind, Report};
use super::frame::Frame;
use super::map::{Map, NodeDetails, Snapshot, errors};
use super::run::known_places;
use super::survey::{Contacts, Survey};
use super::world::{Body, Marks, Solid, Way, World};

impl Report {
    /// Maps the log `input` as `settings` say, and reports the maps, which are returned beside it. `file` names the log, and notes
    /// are told as `reworded` says. Nothing if `watch` stops the work.
    ///
    /// # Errors
    /// If a map cannot be computed, or a recording cannot be read.
    pub fn of_log<'a>(
        file: &str,
        input: &mut Input,
        settings: &'a MapSettings,
        reworded: fn(&str) -> String,
        watch: &dyn Watch,
    ) -> Result<Option<(Self, Vec<ComputedMap<'a>>)>, MapLogError> {
        let drawn = mapping::drawn(input)?;
        let (mut summary, maps) = mapping::map(input, settings, None, Stopwatch::start(), watch)?;
        if summary.interrupted {
            return Ok(None);
        }
        summary.notes.iter_mut().for_each(|note| *note = reworded(note));
        let title = file.rsplit_once('.').map_or(file, |(stem, _)| if stem.is_empty() { file } else { stem });
        let mut report = Self::new(DocumentKind::Log, title, file);
        report.notes = summary.notes.clone();
        // The page has no times: the same log gives the same page.
        report.summary = Some(Summary { timing: None, ..summary }.to_json());
        report.scenario = input.scenario.clone();
        report.world = Some(world(input, &drawn, &maps));
        Ok(Some((report, maps)))
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
