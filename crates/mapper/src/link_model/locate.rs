//! Where a node is under a law that is known.

use super::links::NodeLinks;
use super::posterior::{GridPosterior, HeardLinks, PriorGrid};
use super::unknown::wider;
use super::window::Bounds;
use super::with_law::{ModelWithLaw, VERTICES};
use crate::log_facts::search_box::SearchBox;
use crate::posterior::{Concern, Estimate, Verdict};

impl ModelWithLaw<'_> {
    /// Where `node` is, and the number of vertices looked at.
    pub(super) fn locate(&self, node: &NodeLinks) -> (Estimate, u64) {
        let heard = (self.hearing, self.outages);
        let mut evidence = HeardLinks::new(node, self.links, self.window, heard, !self.law.has_independent_links());
        let [coarse, fine] = VERTICES[usize::from(self.is_spatial)];
        let mut scratch = Vec::new();
        let coarse = evidence.grid(self.window, coarse);
        let first = evidence.posterior(&self.law, &coarse, &mut scratch);
        self.weigh(&mut evidence, &coarse, &first);
        let second = evidence.posterior(&self.law, &coarse, &mut scratch);
        self.weigh(&mut evidence, &coarse, &second);
        let fine = evidence.fine_grid(self.window, &coarse, &second, fine);
        let posterior = evidence.posterior(&self.law, &fine, &mut scratch);
        let concern = self.concern(node, [(&coarse, &second), (&fine, &posterior)]);
        let (unknown_m2, concern) = self.unknown(node, &evidence, &posterior, concern);
        let vertices = (2 * coarse.vertices.len() + fine.vertices.len()) as u64;
        let GridPosterior { mean, covariance, highest, .. } = posterior;
        let estimate = Estimate {
            position: mean,
            log_likelihood: Some(highest),
            ties: 1,
            covariance: Some(wider(covariance.map(|row| row.map(|entry| entry * self.inflation)), unknown_m2)),
            infeasible: false,
            concern,
        };
        (estimate, vertices)
    }

    /// Weighs silence and margins where a posterior places the node.
    fn weigh(&self, evidence: &mut HeardLinks<'_>, grid: &PriorGrid, posterior: &GridPosterior) {
        let expected = evidence.expected(&self.law, grid, posterior, self.links);
        let pairs = evidence.pairs(&expected, self.hearing);
        evidence.set_outages(self.outages, &pairs);
        evidence.refine(&self.law, expected, self.links, self.hearing);
    }

    /// What the window says of a posterior. The coarse grid spans all of the window, and the fine one its likely part.
    fn concern(&self, node: &NodeLinks, [coarse, fine]: [(&PriorGrid, &GridPosterior); 2]) -> Option<Concern> {
        let mut verdict = Verdict::default();
        let (grid, posterior) = coarse;
        for (log_density, log_likelihood) in grid.logarithms(posterior) {
            verdict.take_dense(log_density, log_likelihood);
        }
        let Bounds { low, high } = self.window.of(node);
        let area = SearchBox { low, high, is_guessed: self.window.is_guessed() };
        let (grid, posterior) = fine;
        let shares = || grid.vertices.iter().zip(posterior.shares.iter().copied());
        let best = shares().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(&place, _)| place);
        let is_on_border = best.and_then(|best| self.window.to_border_m(best)).is_some_and(|to_m| to_m < grid.step_m);
        let highest = shares().map(|(_, share)| share).fold(0.0, f64::max);
        let at_edge = shares().filter(|(vertex, _)| area.is_at_edge(**vertex, grid.step_m));
        let edge_below = libm::log(highest / at_edge.map(|(_, share)| share).fold(0.0, f64::max));
        verdict.concern(if is_on_border { 0.0 } else { edge_below })
    }
}
