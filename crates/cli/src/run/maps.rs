//! The maps of a run: computed, recorded and measured.

use std::borrow::Cow;

use sextant_channel::Position;
use sextant_kernel::{NodeId, SimTime, Watch};
use sextant_mapper::{Learned, Mapper, Surface, TopologyMap};
use sextant_sim::Survey;

use super::application::MadeMap;
use super::discovery::Discoveries;
use super::distributed::{evaluate_distributed, messages_of_nodes};
use super::evaluation::{self, Evaluation};
use super::simulator::Simulated;
use crate::diagnostic::Failure;
use crate::mapping::MapLogs;
use crate::recording::{FileRecorder, GridPlane, Level, PlacedNode};
use crate::scenario::{NamedMap, Scenario};
use crate::summary::MapSummary;

/// Records and measures the map that the nodes computed, if they did: also what they had when the user interrupted.
pub(super) fn record_distributed(
    scenario: &Scenario,
    simulated: &Simulated,
    maps: &mut Maps<'_>,
) -> Result<(), Failure> {
    let (Some(map), Some(evaluation)) = (scenario.distributed(), evaluate_distributed(scenario, simulated)) else {
        return Ok(());
    };
    let Maps { recorder, end, summaries, made } = maps;
    let end = *end;
    for message in messages_of_nodes(simulated, map) {
        recorder.mapped_node(end, &message)?;
    }
    let summary = evaluation.summary;
    record_map(recorder, end, &map.name, &evaluation.map, (&summary, &evaluation::truth(scenario)))?;
    if let Some(distributed) = &summary.distributed {
        let mut warn = |note: String| recorder.note(end, Level::Warning, &map.name, &note);
        if !distributed.unplaced.is_empty() {
            let (unplaced, all) = (distributed.unplaced.len(), simulated.nodes.len());
            let names = distributed.unplaced.join(", ");
            warn(format!("{unplaced} of {all} nodes could not work out a place: {names}"))?;
        }
        if !distributed.converged {
            warn(distributed.unsettled(simulated.survey.interrupted))?;
        }
    }
    summaries.push(summary);
    made.push(evaluation.made);
    Ok(())
}

/// The maps so far, and where they are recorded.
pub(super) struct Maps<'a> {
    pub(super) recorder: &'a mut FileRecorder,
    /// When they are recorded: the end of the survey.
    pub(super) end: SimTime,
    pub(super) summaries: Vec<MapSummary>,
    /// The maps as applications get them.
    pub(super) made: Vec<MadeMap>,
}

/// Records a map and its main errors.
fn record_map(
    recorder: &mut FileRecorder,
    end: SimTime,
    name: &str,
    map: &TopologyMap,
    (summary, truth): (&MapSummary, &[Position]),
) -> Result<(), Failure> {
    recorder.map(end, name, &placed(map, truth))?;
    for (what, value) in [
        ("position_error_mean_m", summary.position_error_m.map(|error| error.mean)),
        ("connectivity_error", summary.connectivity_error),
    ] {
        if let Some(value) = value {
            recorder.metric(end, &format!("{name}/{what}"), value)?;
        }
    }
    Ok(())
}

/// Computes, records and measures the maps of the scenario in order, until the user interrupts.
pub(super) fn map(
    scenario: &Scenario,
    survey: &Survey,
    discoveries: &Discoveries,
    maps: &mut Maps<'_>,
    watch: &dyn Watch,
) -> Result<(), Failure> {
    watch.check()?;
    let Maps { recorder, summaries, made, .. } = maps;
    let truth = evaluation::truth(scenario);
    let bound_m = evaluation::bound_m(scenario, survey, watch)?;
    for named in scenario.maps() {
        let Evaluation { map, made: own, learned, summary } =
            evaluation::evaluate(scenario, named, (survey, discoveries), bound_m, watch)?;
        record_map(recorder, survey.end, &named.name, &map, (&summary, &truth))?;
        if map.unmapped() > 0 {
            let note = format!("{} of {} nodes were never heard and are not mapped", map.unmapped(), truth.len());
            recorder.note(survey.end, Level::Warning, &named.name, &note)?;
        }
        summaries.push(summary);
        made.push(own);
        record_likelihoods(scenario, named, learned.as_ref(), survey, recorder, watch)?;
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
fn record_likelihoods(
    scenario: &Scenario,
    named: &NamedMap,
    learned: Option<&Learned>,
    survey: &Survey,
    recorder: &mut FileRecorder,
    watch: &dyn Watch,
) -> Result<(), Failure> {
    let logs = MapLogs::from(&survey.logs);
    let log = logs.of(named);
    let fit = match learned {
        Some(Learned::Profile(fit)) => Some(fit),
        _ => None,
    };
    let ml_tm = match (&named.mapper, fit) {
        (Mapper::MlTm(ml_tm), _) => Some(ml_tm.clone()),
        (Mapper::MmTm(mm_tm), fit) => mm_tm.ml_tm(fit),
        (Mapper::FittedMlTm(fitted), Some(fit)) => Some(fitted.with_fit(fit)),
        _ => None,
    };
    let Some(ml_tm) = ml_tm else { return Ok(()) };
    let log = fit.map_or(Cow::Borrowed(log), |fit| Cow::Owned(fit.evidence(log)));
    for name in &scenario.recording().likelihood {
        let at = log.names().iter().position(|other| other == name).expect("the scenario was checked");
        if log.of(NodeId::from_index(at)).is_empty() {
            let note = format!("node {name} was never heard and has no likelihood");
            recorder.note(survey.end, Level::Warning, &named.name, &note)?;
            continue;
        }
        let surface = ml_tm.surface(&log, NodeId::from_index(at), watch)?;
        recorder.likelihood(survey.end, &named.name, name, &plane(&surface))?;
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
