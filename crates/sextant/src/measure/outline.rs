//! The properties of a map in the summary, without the truth.

use sextant_kernel::NodeId;
use sextant_mapper::{
    Concern, EstimatorFindings, HeightReason, KnowledgeKind, PositionError, RangeFit, SoughtHeights, TopologyMap,
};

use super::subject::Subject;
use crate::summary::{ConcernSummary, ErrorSummary, HeightsSource, HeightsSummary, LearnedSummary, MapSummary};

/// The properties of a map of nodes with these `names`, without the truth.
#[must_use]
pub(crate) fn outline(
    subject: &Subject<'_>,
    map: &TopologyMap,
    learned: Option<&EstimatorFindings>,
    names: &[String],
) -> MapSummary {
    let concern = |(node, concern): (NodeId, Concern)| ConcernSummary { node: names[node.index()].clone(), concern };
    let name = subject.name;
    let learned_summary =
        |learned: &EstimatorFindings| LearnedSummary { keys: learned.keys(map), lines: learned.lines(name, map) };
    let at_bound =
        |learned: &EstimatorFindings| learned.at_bound().iter().map(|node| names[node.index()].clone()).collect();
    let coincident = map.coincident();
    MapSummary {
        name: (name != map.algorithm).then(|| name.to_owned()),
        algorithm: map.algorithm.to_owned(),
        knowledge: knowledge(subject, learned),
        networks: subject.networks.clone(),
        concerns: map.concerns().map(concern).collect(),
        heights: map.heights.map(HeightsSummary::from),
        coincident: (coincident > 0).then_some(coincident),
        mapped: map.mapped(),
        unmapped: map.unmapped(),
        ambiguous: Some(map.estimates.iter().flatten().filter(|estimate| estimate.ties > 1).count()),
        infeasible: Some(map.infeasible()),
        grid_step_m: map.grid_step_m,
        vertices_evaluated: (map.vertices_evaluated > 0).then_some(map.vertices_evaluated),
        learned: learned.map(learned_summary).unwrap_or_default(),
        at_bound: learned.map(at_bound).unwrap_or_default(),
        ..MapSummary::default()
    }
}

/// What a map used: what its estimator uses, and ranges where nodes were placed by them.
fn knowledge(subject: &Subject<'_>, learned: Option<&EstimatorFindings>) -> Vec<KnowledgeKind> {
    let mut knowledge = subject.knowledge.clone();
    let has_ranges = learned.is_some_and(|learned| learned.get::<RangeFit>().is_some());
    if has_ranges && !knowledge.contains(&KnowledgeKind::RobotRanges) {
        knowledge.push(KnowledgeKind::RobotRanges);
    }
    knowledge
}

impl From<SoughtHeights> for HeightsSummary {
    fn from(SoughtHeights { low_m, high_m, reason }: SoughtHeights) -> Self {
        let (from, uneven_m) = match reason {
            HeightReason::Settings => (HeightsSource::Settings, None),
            HeightReason::LevelStops => (HeightsSource::Stops, None),
            HeightReason::UnevenStops(span_m) => (HeightsSource::Stops, Some(span_m)),
            HeightReason::Reach => (HeightsSource::Reach, None),
        };
        Self { low_m, high_m, from, uneven_m }
    }
}

impl From<PositionError> for ErrorSummary {
    fn from(PositionError { mean, median, p80, p90, p95, max }: PositionError) -> Self {
        Self { mean, median, p80, p90, p95, max }
    }
}
