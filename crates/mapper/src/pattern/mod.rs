//! Maps from sectors whose gains are known.
//!
//! An antenna pattern is evidence twice. A node names the sector that it hears best, so that the gains of all sectors tell
//! how likely the name is in each direction, also where patterns have several lobes and no wedge fits. And a node is heard
//! as far as the best sector reaches in its direction: receptions and silence tell more than a distance.
//!
//! The law of this ([`PatternLaw`]) has parameters that the log does not give: how far packets reach, the noise of the
//! strengths, by how much the sectors of this antenna differ from the pattern, how the antenna is turned. They are estimated
//! with the places of the nodes by expectation maximisation (Dempster, Laird and Rubin 1977).

mod evidence;
mod fit;
mod gain_map;
mod hearing;
mod law;
mod naming;
mod places;
mod report;

use rayon::prelude::*;
use sextant_channel::{Position, ReceptionLog, SectorGains};
use sextant_kernel::{NodeId, Watch, Work};

use crate::log_facts::reach::{heard_nodes, is_reach_known, reach_m};
use crate::log_facts::search_box::{Limits, SearchBox};
use crate::posterior::FitState;
use crate::{CoordinateFrame, Estimate, EstimateKind, MapError, SoughtHeights, TopologyMap};
use evidence::Sight;
use fit::{Likelihoods, Survey};
use gain_map::GainMap;
pub use law::PatternLaw;

use crate::numerics::normal::Normal;

/// How a log with known gains is mapped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PatternMap {
    /// Cells are at most so wide where a posterior is narrow (m).
    pub(crate) grid_step_m: f64,
    pub(crate) estimate: EstimateKind,
    pub(crate) z_range_m: Option<[f64; 2]>,
}

/// The law of an antenna that was estimated from a log.
#[derive(Clone, Debug)]
pub struct PatternFit {
    /// The law.
    pub law: PatternLaw,
    /// Standard deviation of the differences of the sectors from the pattern (dB).
    pub ripple_sigma_db: f64,
    /// Rounds of the estimation.
    pub rounds: u32,
    /// Whether more rounds would change nothing.
    pub converged: bool,
    /// Nodes from which the law was estimated.
    pub nodes: usize,
    /// Their receptions with a sector.
    pub named: usize,
    gains: GainMap,
    normal: Normal,
    /// The greatest gain of any sector in the median direction (dBi).
    usual_dbi: f64,
}

impl PartialEq for PatternFit {
    fn eq(&self, other: &Self) -> bool {
        self.law == other.law && self.rounds == other.rounds && self.nodes == other.nodes
    }
}

impl PatternFit {
    /// The probability that a packet of a node at `place` is received at `stop`.
    #[must_use]
    pub fn probability(&self, place: Position, stop: Position) -> f64 {
        let turn = [libm::cos(self.law.yaw_rad), libm::sin(self.law.yaw_rad)];
        let Sight { cell, distance_m } = Sight::of(place, stop, turn);
        let gain = |sector: usize| self.gains.gain_dbi(cell, sector) + self.law.ripple_db[sector];
        let top_dbi = (0..self.gains.sectors()).map(gain).fold(f64::NEG_INFINITY, f64::max);
        self.law.heard(&self.normal, top_dbi, distance_m)
    }

    /// The probability that a packet is received over a distance in the median direction (m).
    fn usual_probability(&self, distance_m: f64) -> f64 {
        self.law.heard(&self.normal, self.usual_dbi, distance_m.max(1e-3))
    }
}

impl PatternMap {
    /// The map of the nodes in `log` by the gains of its sectors, and the law that was estimated; none if nothing was
    /// heard. `name` is the algorithm. The result is bit-identical for any number of threads.
    ///
    /// # Errors
    /// If `watch` ends the work.
    pub(crate) fn map(
        &self,
        log: &ReceptionLog,
        gains: &SectorGains,
        name: &'static str,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<PatternFit>), MapError> {
        let all = heard_nodes(log);
        let mut map = TopologyMap {
            grid_step_m: Some(self.grid_step_m),
            ..TopologyMap::of_places(name, vec![None; log.node_count()], CoordinateFrame::World)
        };
        let reach_m = reach_m(log, &all);
        let heights = SoughtHeights::of_log(log.stops(), self.z_range_m, reach_m, self.grid_step_m);
        let Some(heights) = heights.filter(|_| !all.is_empty()) else { return Ok((map, None)) };
        map.heights = Some(heights);
        let limits = Limits::new(log, reach_m, heights);
        let heard: Vec<(NodeId, SearchBox)> = all.iter().map(|heard| (heard.node, limits.of(heard))).collect();
        let mut columns = vec![None; 256];
        for (at, &id) in gains.identities().iter().enumerate() {
            columns[usize::from(id)] = Some(at);
        }
        let gain_map = GainMap::new(gains);
        let survey = Survey { log, map: &gain_map, columns: &columns, reach_m };
        let found = survey.fit(&heard, name, watch)?;
        let likelihoods = Likelihoods::new(found.law.clone(), &gain_map);
        let state = FitState { is_reach_known: is_reach_known(&all), is_settled: found.is_settled };
        watch.begin(Work { name, unit: "node", steps: heard.len() as u64, operations: 0.0 });
        let solved: Result<Vec<(Option<Estimate>, u64)>, MapError> = heard
            .par_iter()
            .map(|node| {
                watch.check()?;
                let places = likelihoods.places(&survey, node, self.grid_step_m).map(|(_, places)| places);
                watch.advance(1);
                let Some(places) = places else { return Ok((None, 0)) };
                let mut estimate =
                    Estimate::of_places(self.estimate, &places.places, places.mean(), places.likeliest);
                if let Some(covariance) = &mut estimate.covariance {
                    // A node is somewhere in its cell, which may be wider than the step of the map.
                    let wider = (places.step_m * places.step_m - self.grid_step_m * self.grid_step_m).max(0.0) / 12.0;
                    for (axis, row) in covariance.iter_mut().enumerate() {
                        row[axis] += if axis == 2 && node.1.is_level() { 0.0 } else { wider };
                    }
                }
                estimate.concern = state.concern(places.verdict.concern(places.edge_below));
                Ok((Some(estimate), places.evaluated))
            })
            .collect();
        for ((node, _), (estimate, evaluated)) in heard.iter().zip(solved?) {
            map.estimates[node.index()] = estimate;
            map.vertices_evaluated += evaluated;
        }
        let usual_dbi = gain_map.usual_dbi();
        let fit = PatternFit {
            law: found.law,
            ripple_sigma_db: found.ripple_sigma_db,
            rounds: found.rounds,
            converged: found.is_settled,
            nodes: found.nodes,
            named: found.namings,
            gains: gain_map,
            normal: Normal::new(),
            usual_dbi,
        };
        Ok((map, Some(fit)))
    }
}
