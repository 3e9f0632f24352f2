//! A log in parts in the frame of its survey.

use sextant_channel::ReceptionLog;
use sextant_kernel::{NodeId, Watch};

use super::{LogParts, PartsError, each_part};
use crate::learned::EstimatorFindings;
use crate::posterior::PlacePrior;
use crate::survey_frame::{HeardStops, Survey};
use crate::topology_map::TopologyMap;

/// A log in parts in the frame of its survey: the same parts, without nodes that were never heard.
#[derive(Debug)]
pub(super) struct SurveyParts<'a> {
    parts: &'a dyn LogParts,
    survey: Survey,
    /// The nodes of each part, in ascending order.
    nodes: Vec<Vec<NodeId>>,
}

impl<'a> SurveyParts<'a> {
    /// `parts` in the frame of their survey; `None` if nothing was heard.
    pub(super) fn of(parts: &'a dyn LogParts, watch: &dyn Watch) -> Result<Option<Self>, PartsError> {
        let whole = parts.whole();
        let mut heard = HeardStops::none(whole.stops().len());
        heard.take(whole);
        each_part(parts, watch, &mut |_, log| {
            heard.take(log);
            Ok(())
        })?;
        let Some(mut draft) = heard.draft(whole) else { return Ok(None) };
        each_part(parts, watch, &mut |nodes, log| {
            draft.take(nodes.iter().copied(), log);
            Ok(())
        })?;
        let survey = Survey::new(draft.frame(whole.stops().len()), whole);
        let of_part = |part: usize| survey.order(parts.nodes(part).iter().copied()).into_iter().map(|(node, _)| node);
        let nodes = (0..parts.count()).map(|part| of_part(part).collect()).collect();
        Ok(Some(Self { parts, survey, nodes }))
    }

    /// What is known of the places of nodes, in this frame.
    pub(super) fn prior(&self, prior: &PlacePrior) -> PlacePrior {
        self.survey.prior(prior)
    }

    /// The map of a part in the frame of the log.
    pub(super) fn map_in_log(&self, part: usize, map: TopologyMap) -> TopologyMap {
        let nodes = self.parts.nodes(part);
        let in_part: Vec<usize> =
            self.survey.order(nodes.iter().copied()).into_iter().map(|(_, in_part)| in_part).collect();
        self.survey.frame.map_in_log(map, &in_part, nodes.len())
    }

    /// What was learned, in the frame of the log.
    pub(super) fn learned_in_log(&self, learned: EstimatorFindings) -> EstimatorFindings {
        learned.in_log(&self.survey.frame).unwrap_or(learned)
    }
}

impl LogParts for SurveyParts<'_> {
    fn whole(&self) -> &ReceptionLog {
        &self.survey.whole
    }

    fn count(&self) -> usize {
        self.parts.count()
    }

    fn nodes(&self, part: usize) -> &[NodeId] {
        &self.nodes[part]
    }

    fn read(&self, part: usize) -> Result<ReceptionLog, PartsError> {
        let log = self.parts.read(part)?;
        Ok(self.survey.part(self.parts.nodes(part).iter().copied(), &log).2)
    }
}
