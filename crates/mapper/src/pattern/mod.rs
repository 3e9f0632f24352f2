//! Maps from sectors whose gains are known.
//!
//! An antenna pattern is evidence twice. A node names the sector that it hears best, so that the gains of all sectors tell
//! how likely the name is in each direction, also where patterns have several lobes and no wedge fits. And a node is heard
//! as far as the best sector reaches in its direction: receptions and silence tell more than a distance.
//!
//! The law of this ([`PatternLaw`]) has parameters that the log does not give: how far packets reach, the noise of the
//! strengths, by how much the sectors of this antenna differ from the pattern, how the antenna is turned. They are estimated
//! with the places of the nodes by expectation maximisation (Dempster, Laird and Rubin 1977).

mod blur;
mod evidence;
mod fit;
mod gain_map;
mod hearing;
mod law;
mod naming;
mod places;
mod report;
mod report_law;
mod report_sums;
mod report_views;
mod scene;
mod settled;
mod sight;
mod tiles;
mod way_gains;
mod ways;

use sextant_channel::{Position, ReceptionLog, SectorGains, Stop};
use sextant_kernel::Watch;

use crate::count_rule::CountRule;
use crate::error::MapError;
use crate::log_facts::reach::heard_nodes;
use crate::posterior::EstimateKind;
use crate::topology_map::{CoordinateFrame, TopologyMap};
use evidence::PatternTables;
pub(crate) use evidence::of_report;
use fit::thinned;
use gain_map::GainMap;
pub use law::PatternLaw;
pub use report_law::ReportLaw;
use scene::{AntennaScene, LeastStrengths};
use settled::SettledLaw;
use sight::{Pose, Sight, Turn};
pub(crate) use ways::KnownObstacles;

/// How a log with known gains is mapped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PatternMap {
    /// Cells are at most so wide where a posterior is narrow (m).
    pub(crate) grid_step_m: f64,
    pub(crate) estimate: EstimateKind,
    pub(crate) z_range_m: Option<[f64; 2]>,
    pub(crate) counts: CountRule,
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
    tables: PatternTables,
    /// The greatest gain of any sector in the median direction (dBi).
    usual_dbi: f64,
    /// Whether obstacles were known.
    knows_ways: bool,
}

impl PartialEq for PatternFit {
    fn eq(&self, other: &Self) -> bool {
        self.law == other.law && self.rounds == other.rounds && self.nodes == other.nodes
    }
}

impl PatternFit {
    /// The probability that a packet of a node at `place` is received at a stop.
    #[must_use]
    pub fn probability(&self, place: Position, stop: &Stop) -> f64 {
        let Sight { cell, square } =
            Sight::of(place, &Pose::of(stop), Turn::by(self.law.yaw_rad), self.gains.directions());
        let gain = |sector: usize| self.gains.gain_dbi(cell, sector) + self.law.ripple_db[sector];
        let top_dbi = (0..self.gains.sectors()).map(gain).fold(f64::NEG_INFINITY, f64::max);
        self.law.heard(&self.tables.normal, top_dbi, self.tables.decades.of_root(square))
    }

    /// The probability that a packet is received over a distance in the median direction (m).
    fn usual_probability(&self, distance_m: f64) -> f64 {
        self.law.heard(&self.tables.normal, self.usual_dbi, libm::log10(distance_m.max(1e-3)))
    }
}

impl PatternMap {
    /// The map of the nodes in `log` by the gains of its sectors, and the law that was estimated; none if nothing was
    /// heard. Obstacles that are `known` count. `name` is the algorithm. The result is bit-identical for any number of threads.
    ///
    /// # Errors
    /// If `watch` ends the work.
    pub(crate) fn map(
        &self,
        log: &ReceptionLog,
        gains: &SectorGains,
        known: Option<KnownObstacles<'_>>,
        name: &'static str,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<PatternFit>), MapError> {
        let log = &*self.counts.counted(log);
        let heard = heard_nodes(log);
        let farthest_m: Vec<f64> = heard.iter().map(|heard| heard.farthest_m).collect();
        let least = LeastStrengths::of(log);
        let Some(scene) = AntennaScene::of(self, log, gains, &farthest_m, least) else {
            let places = vec![None; log.node_count()];
            return Ok((TopologyMap::of_places(name, places, CoordinateFrame::World), None));
        };
        let scene = scene.among(known, log);
        let sample = thinned(&scene.boxes(&heard));
        let settled = SettledLaw::of(*self, scene, log, &sample, name, watch)?;
        let map = settled.map(log, &heard, name, watch)?;
        Ok((map, Some(settled.into_fit())))
    }
}
