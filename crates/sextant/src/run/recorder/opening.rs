//! What a recording says before the first event.

use std::collections::BTreeMap;
use std::path::Path;

use sextant_kernel::{LARGEST_FILE, NodeId, SimTime, read_at_most};
use sextant_recording::messages::SensorsMessage;
use sextant_recording::{FileRecorder, Origin, PlacedNode, RecordingError, Solid};
use sextant_scenario::{DetailConfig, NamedFile, Scenario};
use sextant_sim::{FieldSensorConfig, SensorsConfig};

use crate::run::error::RunError;
use crate::run::observer::RunStart;

/// Names are drawn in worlds of at most this many nodes: more are slow to draw, and cannot be read.
const MOST_NAMES: usize = 500;

/// Records what is known before the first event.
pub(super) fn open(recorder: &mut FileRecorder, scenario: &Scenario) -> Result<(), RunError> {
    let world = scenario.world();
    recorder.origin(Origin {
        scenario: scenario.name(),
        seed: scenario.seed().0,
        version: env!("CARGO_PKG_VERSION"),
    })?;
    if scenario.recording().detail_of(world.nodes.len()) == DetailConfig::Compact {
        recorder.make_compact(DetailConfig::DIFFERENCE, DetailConfig::KEEP)?;
    }
    recorder.scenario(scenario.text())?;
    named_files(recorder, scenario)?;
    let names: Vec<_> = world.nodes.iter().map(|node| node.name.clone()).collect();
    recorder.nodes(&names)?;
    logs(recorder, scenario)?;
    let solids: Vec<_> =
        world.obstacles.obstacles().iter().enumerate().map(|(i, obstacle)| Solid::of(obstacle, i)).collect();
    if !solids.is_empty() {
        recorder.obstacles(SimTime::ZERO, &solids)?;
    }
    let place = |(i, position)| PlacedNode { node: NodeId::from_index(i), position, error_m: None };
    let nodes: Vec<_> = world.nodes.iter().map(|node| node.position).enumerate().map(place).collect();
    recorder.world_nodes(SimTime::ZERO, &nodes)?;
    if world.nodes.len() <= MOST_NAMES {
        let named = world.nodes.iter().map(|node| (node.name.as_str(), node.position));
        recorder.world_names(SimTime::ZERO, named)?;
    }
    let sinks = scenario.config().sinks.iter().map(|sink| sink.position_m).enumerate();
    let sinks: Vec<_> = sinks.map(place).collect();
    if !sinks.is_empty() {
        recorder.world_sinks(SimTime::ZERO, &sinks)?;
    }
    let config = &scenario.config().sensors;
    if *config != SensorsConfig::default() {
        recorder.sensors(&sensors(config))?;
    }
    Ok(())
}

/// Attaches the files that the scenario names, so that a map of the recording needs no other file.
fn named_files(recorder: &mut FileRecorder, scenario: &Scenario) -> Result<(), RunError> {
    let mut attached: BTreeMap<&Path, Vec<u8>> = BTreeMap::new();
    for NamedFile { written, path } in scenario.named_files() {
        let content = read_at_most(path, LARGEST_FILE)
            .map_err(|why| RunError::NamedFile { path: path.clone(), why: why.to_string() })?;
        match attached.get(written.as_path()) {
            Some(same) if *same == content => {}
            Some(_) => return Err(RunError::TwoFiles { written: written.clone() }),
            None => {
                recorder.named_file(&written.to_string_lossy(), &content)?;
                attached.insert(written, content);
            }
        }
    }
    Ok(())
}

/// Records which networks are surveyed, and the sectors of the robots in each.
fn logs(recorder: &mut FileRecorder, scenario: &Scenario) -> Result<(), RecordingError> {
    let surveyed: Vec<_> = scenario.surveyed().iter().map(|network| &scenario.networks()[network.index()]).collect();
    let names: Vec<String> = surveyed.iter().filter_map(|network| network.name.clone()).collect();
    if surveyed.len() > 1 {
        recorder.networks(&names)?;
    }
    for (i, network) in surveyed.iter().enumerate() {
        if let Some(antennas) = network.technology.antennas() {
            let other = network.name.as_deref().filter(|_| i > 0);
            recorder.sectors(other, antennas.robot_sectors())?;
        }
    }
    Ok(())
}

/// Which sensors the nodes have.
fn sensors(config: &SensorsConfig) -> SensorsMessage {
    let of_fields = |value: fn(&FieldSensorConfig) -> Option<f64>| config.fields.as_ref().and_then(value);
    SensorsMessage {
        target_radius_m: config.targets.map(|sensor| sensor.radius_m),
        field_interval_s: of_fields(|sensor| Some(sensor.interval_s)),
        field_offset_snr_db: of_fields(|sensor| sensor.offset_snr_db),
        field_noise_snr_db: of_fields(|sensor| sensor.noise_snr_db),
    }
}

/// Records what the nodes found out of each other, so that the maps can be computed from the recording.
pub(super) fn discoveries(recorder: &mut FileRecorder, start: &RunStart<'_>) -> Result<(), RecordingError> {
    let RunStart { scenario, discoveries } = start;
    let uses_anchors = scenario.maps().iter().any(|map| map.mapper.least_anchors(2) > 0);
    if uses_anchors || scenario.distributed().is_some() {
        recorder.anchors(scenario.anchors())?;
    }
    if let Some(neighbours) = &discoveries.neighbours {
        recorder.neighbours(&neighbours.log)?;
    }
    discoveries.beacons.as_ref().map_or(Ok(()), |beacons| recorder.beacons(&beacons.log))
}
