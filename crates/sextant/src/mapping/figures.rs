//! The figures of maps that were computed from a log.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::{NodeId, RobotId};
use sextant_mapper::{CurveFinding, ReceptionProfile};

use super::input::Input;
use super::logs::MapLogs;
use super::pipeline::ComputedMap;
use crate::measure::Dimensions;
use sextant_figure::{self as figure, EstimatedMap, Figure, Model, ReceptionCurve, Source};
use sextant_recording::{self as recording, RecordedWorld, RecordingError, Solid};

/// What figures show of a log besides its maps: true positions, obstacles and paths.
///
/// # Errors
/// If the log is that of a recording, and this cannot be read.
pub fn drawn(input: &Input) -> Result<RecordedWorld, RecordingError> {
    let recorded = input.recording.as_deref().map(recording::read_world).transpose()?;
    let truth = input.truth.as_ref();
    let place = |(node, name): (usize, &String)| Some((NodeId::from_index(node), *truth?.get(name)?));
    let nodes = input.log().names().iter().enumerate().filter_map(place).collect();
    let mut drawn = match recorded {
        Some(RecordedWorld { sinks, anchors, obstacles, paths, .. }) => {
            RecordedWorld { nodes, sinks, anchors, obstacles, paths, ..RecordedWorld::default() }
        }
        None => RecordedWorld { nodes, paths: paths_of_stops(input.log()), ..RecordedWorld::default() },
    };
    if let Some(log) = &input.believed_log {
        drawn.believed_paths = paths_of_stops(log);
    }
    let floor = input.floor.iter().flat_map(|floor| floor.obstacles()).enumerate();
    drawn.obstacles.extend(floor.map(|(index, obstacle)| Solid::of(obstacle, index)));
    Ok(drawn)
}

/// The path of each robot, as straight lines between its stops.
fn paths_of_stops(log: &ReceptionLog) -> Vec<(String, Vec<Position>)> {
    let robots = (0..log.robot_count()).map(RobotId::from_index);
    let path = |robot| {
        let stops = log.stops().iter().filter(|stop| stop.robot == robot);
        (log.robot_name(robot).into_owned(), stops.map(|stop| stop.position).collect::<Vec<_>>())
    };
    robots.map(path).filter(|(_, path)| path.len() > 1).collect()
}

/// The figures of `maps`. `title` names the log, and `drawn` is what else is known of the world.
#[must_use]
pub fn figures(title: &str, input: &Input, drawn: RecordedWorld, maps: &[ComputedMap<'_>]) -> Vec<Figure> {
    let places = |map: &ComputedMap<'_>| {
        let place = |(node, place): (usize, Option<Position>)| Some((NodeId::from_index(node), place?));
        (map.named.name.clone(), map.map.positions().into_iter().enumerate().filter_map(place).collect())
    };
    let mut drawn = drawn;
    if input.true_dimensions == Dimensions::Plane
        && let Some(map) = maps.first()
    {
        // True places without heights are at the height of the map, so that errors are those in the plane.
        let positions = map.map.positions();
        for (node, place) in &mut drawn.nodes {
            place.z_m = positions[node.index()].map_or(place.z_m, |mapped| mapped.z_m);
        }
    }
    let drawn = RecordedWorld { maps: maps.iter().map(places).collect(), ..drawn };
    let source = Source { title, log: input.log(), drawn: &drawn, sector_displacements: &[], claimed_obstacles: &[] };
    let estimated = |map| estimated(map, input);
    figure::all_of_maps(&source, &maps.iter().map(estimated).collect::<Vec<_>>())
}

/// A map with its curves.
fn estimated<'a>(computed: &'a ComputedMap<'_>, input: &'a Input) -> EstimatedMap<'a> {
    let ComputedMap { named, map, learned } = computed;
    let logs = MapLogs::from(&input.logs);
    let model = |curve: CurveFinding<'a>| Model {
        name: curve.name.to_owned(),
        probability: curve.probability,
        of_stops: curve.of_stops,
        range_m: curve.range_m,
    };
    let learned_curves = learned.as_ref().map(|learned| learned.curves()).unwrap_or_default();
    let mut curves: Vec<ReceptionCurve<'a>> = Vec::new();
    for curve in learned_curves {
        let network = curve.network;
        let Some(log) = network.map_or(Some(logs.of(named)), |network| logs.named(network)) else { continue };
        curves.push(ReceptionCurve { network, log, model: Some(model(curve)) });
    }
    if curves.is_empty() {
        let model = named.mapper.profile().map(of_profile);
        curves.push(ReceptionCurve { network: None, log: logs.of(named), model });
    }
    EstimatedMap {
        name: &named.name,
        map,
        curves,
        obstacles: learned.as_ref().and_then(|learned| learned.obstacles()),
    }
}

fn of_profile(profile: &ReceptionProfile) -> Model<'_> {
    Model {
        name: "given profile".to_owned(),
        probability: Box::new(|distance_m| profile.probability(distance_m)),
        of_stops: Vec::new(),
        range_m: Some(profile.range_m()),
    }
}
