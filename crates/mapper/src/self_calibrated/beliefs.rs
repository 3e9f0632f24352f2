//! The current estimates of the places of all nodes.

use rayon::prelude::*;
use sextant_kernel::Interrupted;

use super::belief::PlaceBelief;
use super::model::ModelSums;
use super::posterior::{KnownBesidesPlace, PosteriorScratch, Tally};
use crate::log_facts::search_box::SearchBox;

/// Number of nodes whose counts are held at a time.
const BLOCK: usize = 512;

/// The beliefs of all nodes that were heard.
#[derive(Debug)]
pub(super) struct Beliefs {
    pub(super) nodes: Vec<PlaceBelief>,
    /// The box in which each node is searched for.
    bounds: Vec<SearchBox>,
    tallies: Vec<Tally>,
    next: Vec<PlaceBelief>,
}

/// The progress of one round.
#[derive(Clone, Copy, Debug)]
pub(super) struct Progress {
    /// Mean distance that the nodes moved (m).
    pub(super) shift_m: f64,
    pub(super) vertices: u64,
}

impl Beliefs {
    pub(super) fn new(nodes: Vec<PlaceBelief>, bounds: Vec<SearchBox>, bins: usize) -> Self {
        let tallies = vec![Tally::new(bins); nodes.len().min(BLOCK)];
        Self { next: nodes.clone(), nodes, bounds, tallies }
    }

    /// Computes the posterior of each node again, and adds their counts to `sums`. The order is that of the nodes for
    /// any number of threads.
    pub(super) fn refine(
        &mut self,
        surroundings: &KnownBesidesPlace<'_>,
        sums: &mut ModelSums,
    ) -> Result<Progress, Interrupted> {
        sums.clear();
        let (mut shift_m, mut vertices) = (0.0, 0);
        let blocks = self.nodes.chunks(BLOCK).zip(self.bounds.chunks(BLOCK)).zip(self.next.chunks_mut(BLOCK));
        for ((before, bounds), after) in blocks {
            let tallies = &mut self.tallies[..before.len()];
            let work = before.par_iter().zip(bounds).zip(after.par_iter_mut()).zip(tallies.par_iter_mut());
            work.with_min_len(8).for_each_init(
                PosteriorScratch::default,
                |scratch, (((before, bounds), after), tally)| {
                    tally.vertices = 0;
                    *after = surroundings.refine(scratch, bounds, before, tally);
                },
            );
            surroundings.watch.check()?;
            for ((before, after), tally) in before.iter().zip(after.iter()).zip(tallies.iter()) {
                shift_m += before.mean.distance_m(after.mean);
                vertices += tally.vertices;
                sums.add(tally);
            }
        }
        for (before, after) in self.nodes.iter().zip(&mut self.next) {
            after.shift_m = before.mean.distance_m(after.mean);
        }
        std::mem::swap(&mut self.nodes, &mut self.next);
        let share = 1.0 / self.nodes.len() as f64;
        Ok(Progress { shift_m: shift_m * share, vertices })
    }

    /// Computes the posteriors of the nodes again whose windows do not hold them, in windows as wide as they have become.
    /// Returns the number of vertices.
    pub(super) fn refine_cramped(&mut self, surroundings: &KnownBesidesPlace<'_>) -> Result<u64, Interrupted> {
        let bins = surroundings.model.bins();
        let work = self.nodes.par_iter_mut().zip(&self.bounds).filter(|(belief, _)| belief.is_cramped);
        let vertices = work.map_init(
            || (PosteriorScratch::default(), Tally::new(bins)),
            |(scratch, tally), (belief, bounds)| {
                tally.vertices = 0;
                let shift_m = belief.shift_m;
                *belief = PlaceBelief { shift_m, ..surroundings.refine(scratch, bounds, belief, tally) };
                tally.vertices
            },
        );
        let vertices = vertices.sum();
        surroundings.watch.check()?;
        Ok(vertices)
    }
}

impl ModelSums {
    fn clear(&mut self) {
        self.received.fill(0.0);
        self.sent.fill(0.0);
        self.stops.fill([0.0; 2]);
    }

    fn add(&mut self, tally: &Tally) {
        for (sum, part) in self.received.iter_mut().zip(&tally.received) {
            *sum += part;
        }
        for (sum, part) in self.sent.iter_mut().zip(&tally.sent) {
            *sum += part;
        }
        for &(stop, [received, expected]) in &tally.stops {
            let [all_received, all_expected] = &mut self.stops[stop as usize];
            *all_received += received;
            *all_expected += expected;
        }
    }
}
