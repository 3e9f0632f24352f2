//! The maps of a run in its recording.

use sextant_channel::Position;
use sextant_kernel::{NodeId, SimTime};
use sextant_mapper::{KnowledgeKind, MapError, NodeOfLog, Surface, TopologyMap};
use sextant_recording::{FileRecorder, GridPlane, Level, PlacedNode};
use sextant_scenario::MapJob;

use crate::mapping::MapLogs;
use crate::run::distributed::messages_of_nodes;
use crate::run::error::RunError;
use crate::run::evaluation;
use crate::run::observer::MapEnd;
use crate::run::simulator::Simulated;

/// Records a map, its main errors, what is to be known of it, and the likelihoods of chosen nodes.
pub(super) fn record(recorder: &mut FileRecorder, map: &MapEnd<'_>) -> Result<(), RunError> {
    match map.named {
        None => record_of_nodes(recorder, map),
        Some(named) => {
            record_snapshots(recorder, map, named)?;
            record_map(recorder, map)?;
            let (unmapped, nodes) = (map.evaluation.map.unmapped(), map.scenario.world().nodes.len());
            if unmapped > 0 {
                let note = format!("{unmapped} of {nodes} nodes were never heard and are not mapped");
                recorder.note(map.time(), Level::Warning, &named.name, &note)?;
            }
            record_likelihoods(recorder, map, named)
        }
    }
}

/// Records the map that the nodes computed, and what each of them found.
fn record_of_nodes(recorder: &mut FileRecorder, end: &MapEnd<'_>) -> Result<(), RunError> {
    let (simulated, name, time) = (end.simulated, end.name(), end.time());
    if let Some(distributed) = end.scenario.distributed() {
        for message in messages_of_nodes(simulated, distributed) {
            recorder.mapped_node(time, &message)?;
        }
    }
    record_map(recorder, end)?;
    if let Some(distributed) = &end.evaluation.summary.distributed {
        let mut warn = |note: String| recorder.note(time, Level::Warning, name, &note);
        if !distributed.unplaced.is_empty() {
            let (unplaced, all) = (distributed.unplaced.len(), simulated.nodes.len());
            let names = distributed.unplaced.join(", ");
            warn(format!("{unplaced} of {all} nodes could not work out a place: {names}"))?;
        }
        if !distributed.converged {
            warn(distributed.unsettled(simulated.survey.interrupted))?;
        }
    }
    Ok(())
}

/// Records how a map grew: the same algorithm on the log as it was at some instants.
fn record_snapshots(recorder: &mut FileRecorder, end: &MapEnd<'_>, named: &MapJob) -> Result<(), RunError> {
    let MapEnd { scenario, simulated: Simulated { survey, .. }, discoveries, watch, .. } = *end;
    if !named.mapper.uses().contains(&KnowledgeKind::RobotReceptions) {
        // It would be the same at each instant.
        return Ok(());
    }
    let truth = evaluation::truth(scenario);
    let snapshots = scenario.recording().snapshots_of_map(end.evaluation.operations) as usize;
    let stops = survey.log().stops();
    let mut last = SimTime::ZERO;
    for snapshot in 1..=snapshots {
        let Some(time) = stops.get(stops.len() * snapshot / (snapshots + 1)).map(|stop| stop.time) else { break };
        if time <= last {
            continue;
        }
        last = time;
        let logs = survey.logs.until(time);
        if let Some(map) = evaluation::map_of_part(scenario, named, &logs, discoveries, watch)? {
            recorder.map(time, &named.name, &placed(&map, &truth))?;
        }
    }
    Ok(())
}

/// Records a map and its main errors.
fn record_map(recorder: &mut FileRecorder, end: &MapEnd<'_>) -> Result<(), RunError> {
    let (name, time, summary) = (end.name(), end.time(), &end.evaluation.summary);
    recorder.map(time, name, &placed(&end.evaluation.map, &evaluation::truth(end.scenario)))?;
    for (what, value) in [
        ("position_error_mean_m", summary.position_error_m.map(|error| error.mean)),
        ("connectivity_error", summary.connectivity_error),
    ] {
        if let Some(value) = value {
            recorder.metric(time, &format!("{name}/{what}"), value)?;
        }
    }
    Ok(())
}

fn placed(map: &TopologyMap, truth: &[Position]) -> Vec<PlacedNode> {
    let place = |(i, (mapped, truth)): (usize, (Option<Position>, &Position))| {
        let position = mapped?;
        Some(PlacedNode { node: NodeId::from_index(i), position, error_m: Some(position.distance_m(*truth)) })
    };
    map.positions().into_iter().zip(truth).enumerate().filter_map(place).collect()
}

/// Records the likelihood of each chosen node, on the plane through its maximum.
fn record_likelihoods(recorder: &mut FileRecorder, end: &MapEnd<'_>, named: &MapJob) -> Result<(), RunError> {
    let MapEnd { scenario, simulated: Simulated { survey, .. }, watch, .. } = end;
    let logs = MapLogs::from(&survey.logs);
    let log = logs.of(named);
    for name in &scenario.recording().likelihood {
        let at = log
            .names()
            .iter()
            .position(|other| other == name)
            .expect("the check of the scenario refuses other names than those of nodes");
        let node = NodeOfLog { log, node: NodeId::from_index(at) };
        match named.mapper.surface(end.learned(), node, *watch) {
            None => return Ok(()),
            Some(Err(MapError::NotHeard { .. })) => {
                let note = format!("node {name} was never heard and has no likelihood");
                recorder.note(survey.end, Level::Warning, &named.name, &note)?;
            }
            Some(surface) => recorder.likelihood(survey.end, &named.name, name, &plane(&surface?))?,
        }
    }
    Ok(())
}

/// The plane through the maximum of a surface.
fn plane(surface: &Surface) -> GridPlane {
    let lattice = &surface.lattice;
    let [columns, rows, _] = lattice.counts();
    let (maximum, _) = surface.maximum();
    let height = |layer: usize| (lattice.position([0, 0, layer]).z_m - maximum.z_m).abs();
    let layer = (0..lattice.counts()[2]).min_by(|&a, &b| height(a).total_cmp(&height(b))).unwrap_or(0);
    let size = columns * rows;
    GridPlane {
        first: lattice.position([0, 0, layer]),
        step_m: lattice.step_m(),
        columns: u32::try_from(columns).expect("fewer than 2^32 columns"),
        values: surface.log_likelihood[layer * size..(layer + 1) * size].to_vec(),
    }
}
