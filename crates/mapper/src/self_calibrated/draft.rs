//! The state of a self-calibrated map while it is computed.

use sextant_kernel::{Interrupted, Watch};

use super::belief::PlaceBelief;
use super::beliefs::Beliefs;
use super::counts::StopCounts;
use super::model::{Model, ModelSums};
use super::posterior::{KnownBesidesPlace, Obstacles};
use super::settings::ObstacleKnowledge;
use super::shadows::Shadows;
use super::start::Start;
use super::tomography::{Division, Tomography};
use super::window::RoundDetail;
use crate::absorption::AbsorptionMap;
use crate::log_facts::search_box::Limits;
use crate::posterior::Cell;

/// Number of rounds in which all stops have the same efficiency, because the first curves are too rough to compare
/// stops.
const EQUAL_ROUNDS: u32 = 2;
/// Number of rounds of tomography the first time, and each time after that.
const FIRST_IMPROVEMENT: usize = 40;
const IMPROVEMENT: usize = 15;

/// Maximum number of rounds for a long log, whose rounds take long.
const LONG_LOG_ROUNDS: u32 = 30;
/// Maximum number of times that windows are widened in the end.
const WIDENINGS: usize = 8;

/// The current positions, curve, efficiencies and obstacles.
#[derive(Debug)]
pub(super) struct CalibrationDraft<'a> {
    counts: &'a StopCounts<'a>,
    pub(super) beliefs: Beliefs,
    pub(super) model: Model,
    sums: ModelSums,
    tomography: Option<Tomography>,
    shadows: Shadows,
    /// Whether the absorption found is used.
    is_obstructed: bool,
    /// Whether curve and efficiencies are fitted.
    fits: bool,
    detail: RoundDetail,
    watch: &'a dyn Watch,
    pub(super) rounds: u32,
    pub(super) vertices: u64,
}

impl<'a> CalibrationDraft<'a> {
    pub(super) fn new(counts: &'a StopCounts<'a>, start: &Start, limits: &Limits, watch: &'a dyn Watch) -> Self {
        let model = Model::new(start.range_m, counts.log.stops().len());
        let bounds: Vec<_> = start.nodes.iter().map(|heard| limits.of(heard)).collect();
        let nodes = start.nodes.iter().zip(&bounds).map(|(heard, bounds)| PlaceBelief {
            node: heard.node,
            mean: bounds.nearest(heard.middle),
            highest: f64::NEG_INFINITY,
            covariance: [[0.0; 3]; 3],
            cell: Cell::default(),
            concern: None,
            is_cramped: false,
            shift_m: 0.0,
        });
        let nodes = nodes.collect();
        Self {
            counts,
            beliefs: Beliefs::new(nodes, bounds, model.bins()),
            sums: model.sums(),
            model,
            tomography: None,
            shadows: Shadows::default(),
            is_obstructed: false,
            fits: start.is_rich,
            detail: RoundDetail::of_pairs(counts.log.receptions().len()),
            watch,
            rounds: 0,
            vertices: 0,
        }
    }

    /// Searches for obstacles from now on, in cells of `cell_m` that cover the places of the nodes, which are known
    /// to about `slack_m`.
    pub(super) fn seek_obstacles(&mut self, knowledge: ObstacleKnowledge, cell_m: f64, slack_m: f64) {
        let tomography = Tomography::new(self.counts.log, &self.beliefs.nodes, cell_m, slack_m, knowledge);
        self.tomography = Some(tomography);
    }

    /// Runs rounds on a grid of `step_m` until a round moves the nodes by less than `tolerance_m` on average. Returns
    /// whether this happened before the total number of rounds reached `most_rounds`. At least one round is run.
    pub(super) fn stage(&mut self, step_m: f64, tolerance_m: f64, most_rounds: u32) -> Result<bool, Interrupted> {
        let most_rounds =
            if self.detail == RoundDetail::Coarse { most_rounds.min(LONG_LOG_ROUNDS) } else { most_rounds };
        if self.tomography.is_some() && !self.is_obstructed {
            self.look_for_obstacles()?;
        } else {
            self.improve_obstacles(FIRST_IMPROVEMENT)?;
        }
        loop {
            let shift_m = self.refine(step_m)?;
            if self.fits {
                self.fit();
            }
            if shift_m < tolerance_m {
                return Ok(true);
            }
            if self.rounds >= most_rounds {
                return Ok(false);
            }
            self.improve_obstacles(IMPROVEMENT)?;
        }
    }

    /// Widens the windows of nodes that do not hold their posteriors, under the last curve, until they do. If packets
    /// arrive even over the longest distance in the log, they may arrive over any: the curve then goes on as it ends.
    pub(super) fn widen(&mut self, step_m: f64) -> Result<(), Interrupted> {
        if self.fits && self.model.is_at_bound() {
            self.model.extrapolate(&self.sums);
            self.beliefs.nodes.iter_mut().for_each(|belief| belief.is_cramped = true);
        }
        for _ in 0..WIDENINGS {
            if !self.beliefs.nodes.iter().any(|belief| belief.is_cramped) {
                break;
            }
            let map = self.tomography.as_ref().filter(|_| self.is_obstructed).map(|tomography| &tomography.map);
            let logarithms = (self.detail == RoundDetail::Coarse).then(|| self.model.logarithms());
            let surroundings = KnownBesidesPlace {
                counts: self.counts,
                model: &self.model,
                obstacles: map.map(|map| Obstacles { map, shadows: &self.shadows }),
                step_m,
                detail: self.detail,
                logarithms: logarithms.as_ref(),
                watch: self.watch,
            };
            self.vertices += self.beliefs.refine_cramped(&surroundings)?;
        }
        Ok(())
    }

    /// The obstacles, if they were searched for and found, with the evidence of each.
    pub(super) fn into_obstacles(self) -> Result<Option<AbsorptionMap>, Interrupted> {
        let Some(mut tomography) = self.tomography.filter(|_| self.is_obstructed) else { return Ok(None) };
        tomography.draw(self.counts, &self.beliefs.nodes, &self.model, Division::Nodes, self.watch)?;
        tomography.map.claims = tomography.claims(&self.model, FIRST_IMPROVEMENT, self.watch)?;
        Ok(Some(tomography.map))
    }

    /// Computes the posteriors of all nodes. Returns the mean distance that they moved (m).
    fn refine(&mut self, step_m: f64) -> Result<f64, Interrupted> {
        let map = self.tomography.as_ref().filter(|_| self.is_obstructed).map(|tomography| &tomography.map);
        if let Some(map) = map {
            self.shadows.trace(map, self.counts.log.stops(), self.model.range_m(), self.watch)?;
        }
        let logarithms = (self.detail == RoundDetail::Coarse).then(|| self.model.logarithms());
        let surroundings = KnownBesidesPlace {
            counts: self.counts,
            model: &self.model,
            obstacles: map.map(|map| Obstacles { map, shadows: &self.shadows }),
            step_m,
            detail: self.detail,
            logarithms: logarithms.as_ref(),
            watch: self.watch,
        };
        let progress = self.beliefs.refine(&surroundings, &mut self.sums)?;
        self.rounds += 1;
        self.watch.advance(1);
        self.vertices += progress.vertices;
        Ok(progress.shift_m)
    }

    fn fit(&mut self) {
        if self.rounds <= EQUAL_ROUNDS {
            self.sums.stops.fill([0.0; 2]);
        }
        self.model.fit(&self.sums);
    }

    /// Uses obstacles if they explain the log.
    fn look_for_obstacles(&mut self) -> Result<(), Interrupted> {
        let Some(tomography) = &mut self.tomography else { return Ok(()) };
        tomography.draw(self.counts, &self.beliefs.nodes, &self.model, Division::Lines, self.watch)?;
        self.is_obstructed = tomography.is_warranted(&self.model, FIRST_IMPROVEMENT, self.watch)?;
        if self.is_obstructed {
            tomography.improve(&self.model, FIRST_IMPROVEMENT, self.watch)?;
        }
        Ok(())
    }

    fn improve_obstacles(&mut self, rounds: usize) -> Result<(), Interrupted> {
        if let Some(tomography) = self.tomography.as_mut().filter(|_| self.is_obstructed) {
            tomography.draw(self.counts, &self.beliefs.nodes, &self.model, Division::Lines, self.watch)?;
            tomography.improve(&self.model, rounds, self.watch)?;
        }
        Ok(())
    }
}
