//! What is fitted to what: the facts of a log before a fit, the nodes that a curve is fitted to, and the curve after it.

use rayon::prelude::*;
use sextant_channel::ReceptionLog;
use sextant_kernel::{Interrupted, NodeId, Watch};

use super::Fit;
use super::curve::FittedCurve;
use super::expectation::Round;
use crate::grid_ml::directions::Directions;
use crate::log_facts::heights::{Heights, SoughtHeights};
use crate::log_facts::reach::{known_reach_m, reach_of_m};
use crate::log_facts::search_box::{Limits, SearchBox};

/// Maximum number of nodes from which the curve is estimated, in a plane and in space. This gives an accuracy of a
/// few thousandths.
const ENOUGH_NODES: [usize; 2] = [512, 192];
/// Number of listed packets from which the curve is estimated, if so many are listed, and least number of nodes for them.
const ENOUGH_PACKETS: u64 = 200_000;
const LEAST_NODES: u64 = 64;

/// What a log says before a curve is fitted to it.
#[derive(Debug)]
pub(crate) struct FitScene {
    pub(super) reach_m: f64,
    is_reach_known: bool,
    pub(super) heights: SoughtHeights,
    pub(crate) limits: Limits,
}

impl FitScene {
    /// That of a log with the stops of `log`, whose nodes were heard up to `farthest_m` from the middle of their stops, on a
    /// grid of a step (m); `None` without stops.
    pub(crate) fn of(
        log: &ReceptionLog,
        z_range_m: Option<[f64; 2]>,
        step_m: f64,
        farthest_m: &[f64],
    ) -> Option<Self> {
        let reach_m = reach_of_m(log, farthest_m.iter().copied());
        let heights = SoughtHeights::of_log(log.stops(), z_range_m, reach_m, step_m)?;
        let is_reach_known = known_reach_m(farthest_m.iter().copied()).is_some();
        Some(Self { reach_m, is_reach_known, heights, limits: Limits::new(log, reach_m, heights) })
    }

    /// The curve is fitted to every how many of `heard` nodes that were heard. Of all `nodes`, the log lists `listed`
    /// packets.
    pub(crate) fn every(&self, heard: usize, nodes: usize, listed: u64) -> usize {
        let is_spatial = !matches!(self.heights.heights(), Heights::Level(_));
        let enough = ENOUGH_NODES[usize::from(is_spatial)].min(nodes_with_enough(nodes, listed));
        heard.div_ceil(enough).max(1)
    }
}

/// The nodes to which a curve is fitted, in a log that has them at least.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CurveSample<'a> {
    pub(crate) log: &'a ReceptionLog,
    /// With the box of each.
    pub(crate) nodes: &'a [(NodeId, SearchBox)],
    /// The packets of all nodes that each stop heard.
    pub(crate) heard_at: &'a [u64],
}

/// A curve after its last round.
#[derive(Debug)]
pub(crate) struct SettledCurve {
    pub(super) curve: FittedCurve,
    pub(super) directions: Option<Directions>,
    pub(super) is_dead: Vec<bool>,
    pub(super) rounds: u32,
    pub(super) converged: bool,
    pub(super) moved: Option<f64>,
    pub(super) nodes: usize,
}

impl SettledCurve {
    /// The receptions of the nodes `heard` of `log` from far beyond the range of the curve, in order.
    pub(crate) fn outliers(
        &self,
        log: &ReceptionLog,
        heard: &[(NodeId, SearchBox)],
        scene: &FitScene,
        watch: &dyn Watch,
    ) -> Result<Vec<(NodeId, u32)>, Interrupted> {
        let Self { curve, directions, is_dead, .. } = self;
        let heights = scene.heights.heights();
        let round = Round { log, heights, directions: directions.as_ref(), curve, is_dead, watch };
        let outliers = heard.par_iter().flat_map_iter(|(node, within)| round.outliers(*node, within)).collect();
        watch.check().map(|()| outliers)
    }

    /// The fit, with the outliers of all nodes, in order.
    pub(crate) fn fit(&self, scene: &FitScene, outliers: Vec<(NodeId, u32)>) -> Fit {
        let Self { curve, is_dead, rounds, converged, moved, nodes, .. } = self;
        let dead_stops = (0..).zip(is_dead).filter(|(_, dead)| **dead).map(|(stop, _)| stop).collect();
        Fit {
            curve: curve.table(),
            rounds: *rounds,
            converged: *converged,
            moved: *moved,
            dead_stops,
            outliers,
            nodes: *nodes,
            reach_m: scene.reach_m,
            is_reach_known: scene.is_reach_known,
            heights: scene.heights,
        }
    }
}

/// Number of nodes that together have enough packets, if a log of `nodes` nodes lists `listed` packets.
fn nodes_with_enough(nodes: usize, listed: u64) -> usize {
    let enough = (ENOUGH_PACKETS.saturating_mul(nodes as u64) / listed.max(1)).max(LEAST_NODES);
    usize::try_from(enough).unwrap_or(usize::MAX)
}
