//! A reception profile estimated from the log itself.

mod belief;
mod curve;
mod dead_stops;
mod expectation;
mod movement;
mod report;
mod scene;
mod wide;

use rayon::prelude::*;
pub use report::NetworkFits;
use sextant_channel::{Position, Reception, ReceptionLog, ReceptionLogBuilder, SectorReport, Stop};
use sextant_kernel::{Interrupted, NodeId, SettingError, Watch, Work};

use crate::error::MapError;
use crate::grid_ml::directions::{CoverageEdge, Directions};
use crate::log_facts::heights::{Heights, SoughtHeights};
use crate::log_facts::reach::heard_nodes;
use crate::log_facts::search_box::SearchBox;
use crate::log_facts::sectors::SectorSettings;
use crate::profile::{FittedConfig, ReceptionProfile, TableProfile, averaged_over_cell};
use crate::survey_frame::SurveyFrame;
use belief::FittedBelief;
use curve::{CurveCounts, FittedCurve};
pub(crate) use dead_stops::add_heard;
use expectation::Round;
use movement::Movement;
pub(crate) use scene::{CurveSample, FitScene, SettledCurve};
pub(crate) use wide::{GridSize, WideSearch};

/// How a reception profile is estimated from a log.
///
/// The method is expectation maximisation. The first step computes the posterior of each node under the current
/// curve. The second step computes the curve of highest likelihood under these posteriors: the isotonic regression of
/// the shares of packets received over distance, weighted by packets sent. Both steps are repeated until the curve
/// converges. The only assumption is that the probability does not rise with distance. Receptions from far beyond the
/// estimated range are left out, and so are stops at which the receiver did not work.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitted {
    max_rounds: u32,
    tolerance: f64,
}

/// A reception profile estimated from a log.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The curve.
    pub curve: TableProfile,
    /// Number of rounds.
    pub rounds: u32,
    /// Whether the curve has converged.
    pub converged: bool,
    /// How far ten rounds moved the nodes at the end, over how uncertain their places are (root mean squares); `None` if there
    /// were fewer rounds.
    pub moved: Option<f64>,
    /// Stops at which the receiver did not work: nothing was heard, although this is nearly impossible for a working
    /// receiver.
    pub dead_stops: Vec<u32>,
    /// Receptions from far beyond the range, as node and stop.
    pub outliers: Vec<(NodeId, u32)>,
    /// Number of nodes from which the curve was estimated.
    pub nodes: usize,
    /// How far nodes are heard, as the log says without a model (m).
    pub reach_m: f64,
    /// Whether the log says so. It does not if each node was heard at one place only.
    pub is_reach_known: bool,
    /// The heights at which nodes are searched for.
    pub heights: SoughtHeights,
}

/// The curve has converged if it changes by less than this share of its statistical error.
const NOISE: f64 = 0.2;
/// Nodes have settled if ten rounds move them by less than this share of how uncertain they are. It adds an eighth to their
/// errors at most.
const SETTLED: f64 = 0.5;
/// Number of nodes whose posteriors are held at a time.
const BLOCK: usize = 128;
/// Approximate number of grid vertices of a node in a round, in a plane and in space.
const VERTICES: [f64; 2] = [160.0, 700.0];
/// Number of rounds before stops are tested, because the first curves reach too far.
const ROUNDS_BEFORE_TESTS: u32 = 6;

impl Fitted {
    /// The profile of `log`; `None` if no node was heard at any stop. `z_range_m` bounds the heights of the nodes
    /// (m). If absent, nodes are at the height of the stops if these are nearly level, otherwise within one reach
    /// below and above them. If the log has sectors with their directions, these are evidence, and a stop that heard nothing
    /// counts only where they point. The result is bit-identical for any number of threads.
    ///
    /// # Errors
    /// If `watch` ends the work.
    pub fn fit(
        &self,
        log: &ReceptionLog,
        z_range_m: Option<[f64; 2]>,
        watch: &dyn Watch,
    ) -> Result<Option<Fit>, MapError> {
        self.fit_with(log, z_range_m, 0.0, &SectorSettings::default(), watch)
    }

    /// The same for a grid of a step (m), with sectors as the settings say.
    pub(crate) fn fit_with(
        &self,
        log: &ReceptionLog,
        z_range_m: Option<[f64; 2]>,
        step_m: f64,
        sectors: &SectorSettings,
        watch: &dyn Watch,
    ) -> Result<Option<Fit>, MapError> {
        let heard_nodes = heard_nodes(log);
        let farthest_m: Vec<f64> = heard_nodes.iter().map(|heard| heard.farthest_m).collect();
        let listed = log.receptions().iter().map(|reception| u64::from(reception.sent)).sum();
        let scene = FitScene::of(log, z_range_m, step_m, &farthest_m);
        let Some(scene) = scene else { return Ok(None) };
        let heard: Vec<(NodeId, SearchBox)> =
            heard_nodes.iter().map(|heard| (heard.node, scene.limits.of(heard))).collect();
        let every = scene.every(heard.len(), log.node_count(), listed);
        let sample: Vec<(NodeId, SearchBox)> = heard.iter().copied().step_by(every).collect();
        let mut heard_at = vec![0; log.stops().len()];
        dead_stops::add_heard(log, &mut heard_at);
        let settled =
            self.settle(&CurveSample { log, nodes: &sample, heard_at: &heard_at }, &scene, sectors, watch)?;
        let Some(settled) = settled else { return Ok(None) };
        let outliers = settled.outliers(log, &heard, &scene, watch)?;
        Ok(Some(settled.fit(&scene, outliers)))
    }

    /// The curve of `sample` after enough rounds; `None` if it has no nodes.
    pub(crate) fn settle(
        &self,
        sample: &CurveSample<'_>,
        scene: &FitScene,
        sectors: &SectorSettings,
        watch: &dyn Watch,
    ) -> Result<Option<SettledCurve>, MapError> {
        let CurveSample { log, nodes: sample, heard_at } = *sample;
        let heights = scene.heights.heights();
        let found = Directions::of(log, sectors, scene.reach_m, heights, CoverageEdge::Tolerant)?;
        let directions = found.as_ref();
        let nodes: Vec<NodeId> = sample.iter().map(|&(node, _)| node).collect();
        let mut beliefs: Vec<FittedBelief> =
            sample.iter().map(|(node, within)| FittedBelief::first(log, *node, within)).collect();
        let Some(mut curve) = FittedCurve::first(log, &nodes, &beliefs, directions) else { return Ok(None) };
        let mut is_dead = vec![false; log.stops().len()];
        let (mut rounds, mut converged) = (0, false);
        let mut movement = Movement::from(&beliefs);
        watch.begin(self.work(log, sample.len(), heights));
        while rounds < self.max_rounds && !converged {
            let round = Round { log, heights, directions, curve: &curve, is_dead: &is_dead, watch };
            let mut counts = CurveCounts::new(curve.bins());
            let mut ln_silence = vec![0.0; is_dead.len()];
            for (sample, beliefs) in sample.chunks(BLOCK).zip(beliefs.chunks_mut(BLOCK)) {
                let expect = |((node, within), belief): (&(NodeId, SearchBox), &FittedBelief)| {
                    watch.check().map(|()| round.expect(*node, within, belief))
                };
                let results: Result<Vec<_>, Interrupted> = sample.par_iter().zip(&*beliefs).map(expect).collect();
                watch.check()?;
                for (result, belief) in results?.into_iter().zip(beliefs) {
                    counts.add(&result.counts);
                    for (stop, ln_missed) in result.silent {
                        ln_silence[stop as usize] += ln_missed;
                    }
                    *belief = result.belief;
                }
            }
            watch.advance(1);
            let next = curve.updated(&counts);
            rounds += 1;
            movement.take(&beliefs);
            let (distance, error) = next.distance(&curve, &counts);
            let is_settled = distance < self.tolerance.max(NOISE * error);
            curve = next;
            if rounds >= ROUNDS_BEFORE_TESTS {
                let found = dead_stops::find(log.stops(), heard_at, &ln_silence, watch)?;
                converged = is_settled && found == is_dead;
                is_dead = found;
            }
        }
        let moved = movement.share();
        Ok(Some(SettledCurve { curve, directions: found, is_dead, rounds, converged, moved, nodes: sample.len() }))
    }

    /// The work of all rounds, if all stops are in reach of each of `nodes` nodes.
    fn work(&self, log: &ReceptionLog, nodes: usize, heights: Heights) -> Work {
        let is_spatial = matches!(heights, Heights::Between(..));
        #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
        let links = nodes as f64 * log.stops().len() as f64;
        Work {
            name: "fitted profile",
            unit: "round",
            steps: self.max_rounds.into(),
            operations: links * VERTICES[usize::from(is_spatial)] * f64::from(self.max_rounds),
        }
    }
}

impl Fit {
    /// Whether more rounds would leave the nodes where they are: the curve has converged, or its changes hardly move them.
    #[must_use]
    pub fn is_settled(&self) -> bool {
        self.converged || self.moved.is_some_and(|moved| moved < SETTLED)
    }

    /// The same with the stops and nodes of the log, if it was fitted in `frame`.
    pub(crate) fn of_log(&self, frame: &SurveyFrame) -> Self {
        let mut dead_stops: Vec<u32> = self.dead_stops.iter().map(|&stop| frame.stop(stop)).collect();
        let far = |&(node, stop): &(NodeId, u32)| (frame.node(node), frame.stop(stop));
        let mut outliers: Vec<(NodeId, u32)> = self.outliers.iter().map(far).collect();
        dead_stops.sort_unstable();
        outliers.sort_unstable();
        Self { dead_stops, outliers, ..self.clone() }
    }

    /// The profile for the vertices of a grid of `grid_step_m`: the mean of the curve over the cell of each.
    ///
    /// # Panics
    /// Never: a fitted curve is above its floor at some distance.
    #[must_use]
    pub fn profile(&self, grid_step_m: f64) -> ReceptionProfile {
        let curve = &self.curve;
        let step_m = curve.step_m();
        let range_m = curve.range_m() + 0.5 * 3.0_f64.sqrt() * grid_step_m;
        let samples = crate::numerics::whole((range_m / step_m).ceil());
        let averaged = (0..=samples)
            .map(|i| averaged_over_cell(|d| curve.probability(d), step_m * i as f64, grid_step_m).clamp(0.0, 1.0));
        let table = TableProfile::new(step_m, averaged.collect(), curve.floor(), curve.ceiling());
        ReceptionProfile::Table(table.unwrap_or_else(|_| curve.clone()))
    }

    /// The part of `log` that is used: without dead stops, and with receptions from far beyond the range replaced by
    /// `0` of `0`. Stops have new indices.
    ///
    /// # Panics
    /// If this is not the fit of `log`.
    #[must_use]
    pub fn evidence(&self, log: &ReceptionLog) -> ReceptionLog {
        self.evidence_of(log, |node| node)
    }

    /// The same for a part of the log, whose nodes are `of_log` in the whole log.
    pub(crate) fn evidence_of(&self, log: &ReceptionLog, of_log: impl Fn(NodeId) -> NodeId) -> ReceptionLog {
        let mut is_dead = vec![false; log.stops().len()];
        self.dead_stops.iter().for_each(|&stop| is_dead[stop as usize] = true);
        let mut kept: Vec<Stop> = Vec::new();
        let new_index: Vec<u32> = log
            .stops()
            .iter()
            .zip(&is_dead)
            .map(|(&stop, &dead)| {
                let index = u32::try_from(kept.len()).expect("a log has less than 2^32 stops");
                if !dead {
                    kept.push(stop);
                }
                index
            })
            .collect();
        let entry = |reception: Reception| {
            let far = self.outliers.binary_search(&(of_log(reception.node), reception.stop)).is_ok();
            let (received, sent) = if far { (0, 0) } else { (reception.received, reception.sent) };
            Reception { stop: new_index[reception.stop as usize], received, sent, ..reception }
        };
        let live = log.receptions().iter().filter(|reception| !is_dead[reception.stop as usize]);
        let mut receptions = ReceptionLogBuilder::default();
        receptions.extend(live.map(entry));
        if log.receptions().sectors().is_some() {
            receptions.keep_sectors();
        }
        // What a sweep said at a reception that is left out is left out too.
        let is_kept = |report: &SectorReport| {
            !is_dead[report.stop as usize]
                && self.outliers.binary_search(&(of_log(report.node), report.stop)).is_err()
        };
        for report in log.sector_reports().filter(is_kept) {
            receptions.report(SectorReport { stop: new_index[report.stop as usize], ..report });
        }
        let evidence = receptions.build(log.names().to_vec(), kept, log.contacts().to_vec());
        match log.sectors() {
            Some(sectors) => evidence.and_then(|evidence| evidence.with_sectors(sectors.clone())),
            None => evidence,
        }
        .expect("a part of a log is a log")
    }
}

/// The places of the stops that heard a node, with the packets heard.
fn receivers(log: &ReceptionLog, node: NodeId) -> impl Iterator<Item = (Position, u32)> + Clone {
    let heard = log.of(node).iter().filter(|reception| reception.received > 0);
    heard.map(|reception| (log.stops()[reception.stop as usize].position, reception.received))
}

impl TryFrom<FittedConfig> for Fitted {
    type Error = SettingError;

    fn try_from(FittedConfig { max_rounds, tolerance }: FittedConfig) -> Result<Self, SettingError> {
        if max_rounds == 0 {
            return Err(SettingError::new("max_rounds", 0, "1 or more"));
        }
        Ok(Self { max_rounds, tolerance: SettingError::positive("tolerance", tolerance)? })
    }
}
