//! The figures of maps that were computed from a log.

use sextant_channel::Position;
use sextant_kernel::{NodeId, RobotId};
use sextant_mapper::{
    AbsorptionMap, CalibratedCurve, Calibration, EstimatorFit, Fit, Learned, LinkFit, Mapper, ReceptionProfile,
};

use super::input::Input;
use super::logs::MapLogs;
use super::pipeline::ComputedMap;
use crate::measure::Dimensions;
use sextant_figure::{self as figure, EstimatedMap, Figure, Model, ReceptionCurve, Source};
use sextant_recording::{self as recording, Drawn, RecordingError};

/// What figures show of a log besides its maps: true positions, obstacles and paths.
///
/// # Errors
/// If the log is that of a recording, and this cannot be read.
pub fn drawn(input: &Input) -> Result<Drawn, RecordingError> {
    let recorded = input.recording.as_deref().map(recording::read_drawn).transpose()?;
    let truth = input.truth.as_ref();
    let place = |(node, name): (usize, &String)| Some((NodeId::from_index(node), *truth?.get(name)?));
    let nodes = input.log().names().iter().enumerate().filter_map(place).collect();
    Ok(match recorded {
        Some(Drawn { sinks, anchors, obstacles, paths, .. }) => {
            Drawn { nodes, sinks, anchors, obstacles, paths, ..Drawn::default() }
        }
        None => Drawn { nodes, paths: paths_of_stops(input), ..Drawn::default() },
    })
}

/// The path of each robot, as straight lines between its stops.
fn paths_of_stops(input: &Input) -> Vec<(String, Vec<Position>)> {
    let log = input.log();
    let robots = (0..log.robot_count()).map(RobotId::from_index);
    let path = |robot| {
        let stops = log.stops().iter().filter(|stop| stop.robot == robot);
        (log.robot_name(robot).into_owned(), stops.map(|stop| stop.position).collect::<Vec<_>>())
    };
    robots.map(path).filter(|(_, path)| path.len() > 1).collect()
}

/// The figures of `maps`. `title` names the log, and `drawn` is what else is known of the world.
#[must_use]
pub fn figures(title: &str, input: &Input, drawn: Drawn, maps: &[ComputedMap<'_>]) -> Vec<Figure> {
    let places = |map: &ComputedMap<'_>| {
        let place = |(node, place): (usize, Option<Position>)| Some((NodeId::from_index(node), place?));
        (map.named.name.clone(), map.map.positions().into_iter().enumerate().filter_map(place).collect())
    };
    let mut drawn = drawn;
    if input.true_dimensions == Dimensions::Plane
        && let Some(map) = maps.first()
    {
        // True places without heights are at the height of the map, so that errors are those in the plane.
        for (node, place) in &mut drawn.nodes {
            place.z_m = map.map.positions()[node.index()].map_or(place.z_m, |mapped| mapped.z_m);
        }
    }
    let drawn = Drawn { maps: maps.iter().map(places).collect(), ..drawn };
    let source = Source { title, log: input.log(), drawn: &drawn, sector_displacements: &[] };
    let estimated = |map| estimated(map, input);
    figure::all_of_maps(&source, &maps.iter().map(estimated).collect::<Vec<_>>())
}

/// A map with its curves.
fn estimated<'a>(computed: &'a ComputedMap<'_>, input: &'a Input) -> EstimatedMap<'a> {
    let ComputedMap { named, map, learned } = computed;
    let logs = MapLogs::from(&input.logs);
    let curves = match (learned, &named.mapper) {
        (Some(Learned::Profiles(fits)), Mapper::Joint(_)) => fits
            .iter()
            .filter_map(|(network, fit)| {
                let log = logs.named(network)?;
                Some(ReceptionCurve { network: Some(network), log, model: Some(of_fit(fit)) })
            })
            .collect(),
        (learned, mapper) => {
            let model = learned.as_ref().and_then(of_learned).or_else(|| given(mapper).map(of_profile));
            vec![ReceptionCurve { network: None, log: logs.of(named), model }]
        }
    };
    EstimatedMap { name: &named.name, map, curves, obstacles: learned.as_ref().and_then(obstacles) }
}

/// What absorbs, if it was estimated with a map.
fn obstacles(learned: &Learned) -> Option<&AbsorptionMap> {
    let calibration = match learned {
        Learned::Calibration(calibration) => calibration,
        Learned::Choice(choice) => match choice.fit.as_ref()? {
            EstimatorFit::Calibration(calibration) => calibration,
            EstimatorFit::Links(_) | EstimatorFit::Profile(_) => return None,
        },
        _ => return None,
    };
    calibration.obstacles.as_ref()
}

/// The curve that was estimated from the log of a map.
fn of_learned(learned: &Learned) -> Option<Model<'_>> {
    match learned {
        Learned::Profile(fit) => Some(of_fit(fit)),
        Learned::Calibration(calibration) => of_calibration(calibration),
        Learned::Links(fit) => Some(of_links(fit)),
        Learned::Choice(choice) => match choice.fit.as_ref()? {
            EstimatorFit::Links(fit) => Some(of_links(fit)),
            EstimatorFit::Profile(fit) => Some(of_fit(fit)),
            EstimatorFit::Calibration(calibration) => of_calibration(calibration),
        },
        _ => None,
    }
}

fn of_fit(fit: &Fit) -> Model<'_> {
    Model {
        name: "fitted curve".to_owned(),
        probability: Box::new(|distance_m| fit.curve.probability(distance_m)),
        of_stops: Vec::new(),
        range_m: Some(fit.curve.range_m()),
    }
}

fn of_links(fit: &LinkFit) -> Model<'_> {
    Model {
        name: "law of links".to_owned(),
        probability: Box::new(|distance_m| fit.probability(distance_m)),
        of_stops: Vec::new(),
        range_m: None,
    }
}

fn of_calibration(calibration: &Calibration) -> Option<Model<'_>> {
    let curve = calibration.curve.as_ref()?;
    let stops = calibration.efficiency.len().max(1) as f64;
    let mean = calibration.efficiency.iter().sum::<f64>() / stops;
    Some(Model {
        name: "calibrated curve over clear links".to_owned(),
        probability: Box::new(|distance_m| curve.probability(distance_m)),
        of_stops: calibration.efficiency.iter().map(|efficiency| efficiency / mean.max(1e-9)).collect(),
        range_m: Some(CalibratedCurve::range_m(curve)),
    })
}

/// The profile that the settings of a map give.
fn given(mapper: &Mapper) -> Option<&ReceptionProfile> {
    match mapper {
        Mapper::MlTm(ml_tm) => Some(ml_tm.profile()),
        Mapper::MmTm(mm_tm) => mm_tm.profile(),
        _ => None,
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
