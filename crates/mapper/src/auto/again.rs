//! The map of a log that has grown: by the estimator that was chosen for it before.

use sextant_channel::ReceptionLog;
use sextant_kernel::Watch;

use super::widths::{enlarge, slow_fall};
use super::{Auto, Candidate, Choice, EstimatorFit, STEPS_PER_REACH, join_opinions, settles};
use crate::error::MapError;
use crate::log_facts::reach::{heard_nodes, reach_m};
use crate::posterior::PlacePrior;
use crate::topology_map::TopologyMap;

impl Auto {
    /// The map of `log`, with the choice that was made before for a part of it. No stop is left out and no other estimator tried,
    /// and the search for a law of links begins at the one of then. `None` if nothing was chosen before, if that estimator does not
    /// suit the log, or if it does not settle now.
    pub(super) fn map_again(
        &self,
        log: &ReceptionLog,
        prior: Option<&PlacePrior>,
        watch: &dyn Watch,
    ) -> Result<Option<(TopologyMap, Option<Choice>)>, MapError> {
        let Some(before) = self.before.as_deref() else { return Ok(None) };
        let reach_m = reach_m(log, &heard_nodes(log));
        let fitted = self.fitted.with_grid_step_m(reach_m / STEPS_PER_REACH);
        let law = match &before.fit {
            Some(EstimatorFit::Links(fit)) => Some(fit.law),
            _ => None,
        };
        let own_share = before.opinions.as_ref().map_or(1.0, |opinions| opinions.own_share);
        let link_model = law.map_or(self.link_model, |law| self.link_model.with_first_law(law));
        let link_model = link_model.with_own_share(own_share);
        let others = [Candidate::SelfCalibrated(&self.self_calibrated), Candidate::Fitted(&fitted)];
        let others = others.into_iter().chain(self.pattern(log, reach_m)).filter(|_| prior.is_none());
        let mut all = std::iter::once(Candidate::LinkModel(&link_model)).chain(others);
        let Some(candidate) = all.find(|candidate| candidate.name() == before.chosen) else { return Ok(None) };
        let (mut map, fit) = candidate.map(log, prior, watch)?;
        let links = match &fit {
            Some(EstimatorFit::Links(fit)) => Some(fit),
            _ => None,
        };
        if links.is_none() && !settles(&map, fit.as_ref()) {
            return Ok(None);
        }
        let enlargement = links.map_or(before.enlargement, |_| slow_fall(fit.as_ref()).powi(2));
        enlarge(&mut map, enlargement);
        let opinions = match (links, &before.opinions) {
            (Some(fit), Some(before)) => join_opinions(&mut map, log, fit, (before.gain, enlargement), watch)?,
            _ => None,
        };
        map.algorithm = Self::NAME;
        let choice = Choice { fit, enlargement, opinions, ..before.clone() };
        Ok(Some(if map.mapped() == 0 { (map, None) } else { (map, Some(choice)) }))
    }
}
