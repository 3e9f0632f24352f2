//! A Bayesian grid on the signal strengths that the robot measured (Sichitiu and Ramadurai 2004).

mod curves;
mod search;
mod tiles;

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::{NodeId, SettingError, Watch, Work};

use self::curves::Curves;
use self::search::{HeardStop, Search};
use self::tiles::Tiles;
use super::ranging::{Ranging, RangingConfig};
use crate::heights::check_z_range;
use crate::{
    CoordinateFrame, Estimate, EstimateKind, Knowledge, KnowledgeKind, Lattice, MapError, SoughtHeights, TopologyMap,
};

/// The Bayesian grid as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RssGridConfig {
    /// Distance of neighbouring grid vertices (m).
    pub grid_step_m: f64,
    /// How power falls with distance, and how it scatters.
    #[serde(default)]
    pub ranging: RangingConfig,
    /// Least power at which packets are received (dBm). If absent in a scenario, that of its radio.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensitivity_dbm: Option<f64>,
    /// Hard communication radius (m). If absent in a scenario, that of its channel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_range_m: Option<f64>,
    /// How the place is estimated from the likelihood.
    #[serde(default = "posterior_mean")]
    pub estimate: EstimateKind,
    /// Lowest and highest height of a node (m); as of `ml_tm` if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub z_range_m: Option<[f64; 2]>,
}

fn posterior_mean() -> EstimateKind {
    EstimateKind::PosteriorMean
}

/// The Bayesian grid. It uses the strengths of the robot's receptions, which ML-TM does not.
///
/// The log-likelihood of a node at a vertex at distance d from a stop is `−(P − m(d))²/2σ²` for a reception of
/// strength P, `m(d)` being the mean strength, and `log Φ((P_min − m(d))/σ)` for a stop without one, zero beyond the
/// hard radius. Each stop counts as one packet. Vertices beyond the hard radius of a stop that heard the node are
/// ruled out, unless no vertex is left. Bounds of the likelihood over tiles of the grid skip vertices that make no
/// difference. The result is that of a scan of all vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RssGrid {
    grid_step_m: f64,
    ranging: Ranging,
    sensitivity_dbm: f64,
    max_range_m: Option<f64>,
    estimate: EstimateKind,
    z_range_m: Option<[f64; 2]>,
}

impl TryFrom<RssGridConfig> for RssGrid {
    type Error = SettingError;

    fn try_from(config: RssGridConfig) -> Result<Self, SettingError> {
        let RssGridConfig { grid_step_m, ranging, sensitivity_dbm, max_range_m, estimate, z_range_m } = config;
        let ranging = Ranging::try_from(ranging).map_err(|error| error.within("ranging"))?;
        SettingError::positive("ranging.sigma_db", ranging.sigma_db())?;
        let Some(sensitivity_dbm) = sensitivity_dbm.filter(|dbm| dbm.is_finite()) else {
            let found = sensitivity_dbm.map_or_else(|| "absent".to_owned(), |dbm| dbm.to_string());
            return Err(SettingError::new("sensitivity_dbm", found, "a number; in a scenario, that of its radio"));
        };
        if let Some(range_m) = max_range_m {
            SettingError::positive("max_range_m", range_m)?;
        }
        check_z_range(z_range_m)?;
        let grid_step_m = SettingError::positive("grid_step_m", grid_step_m)?;
        Ok(Self { grid_step_m, ranging, sensitivity_dbm, max_range_m, estimate, z_range_m })
    }
}

/// Maximum memory for the shared surface and the search of a node (bytes).
const ALLOWED_BYTES: u64 = 1_536_000_000;
/// Bytes per vertex: its log-likelihood of silence, and its entry in the list of a search.
const OCTETS_PER_VERTEX: u64 = 24;
/// Without a hard radius, receptions may be this many standard deviations stronger than the mean.
const REACH_SIGMAS: f64 = 3.0;

impl RssGrid {
    /// The algorithm's name in tables and topics.
    pub const NAME: &'static str = "rss-grid";

    /// The kinds of knowledge that it uses.
    pub const USES: &'static [KnowledgeKind] = &[KnowledgeKind::RobotRssi, KnowledgeKind::PathLoss];

    /// Distance within which nodes are heard (m).
    fn range_m(&self) -> f64 {
        self.max_range_m
            .unwrap_or_else(|| self.ranging.distance_m(self.sensitivity_dbm - REACH_SIGMAS * self.ranging.sigma_db()))
    }

    /// The map, computed on the current rayon pool. The result is bit-identical for any number of threads. Nodes that
    /// were never heard with a strength are not placed.
    ///
    /// # Errors
    /// [`MapError::GridTooLarge`]; [`MapError::Interrupted`].
    pub fn map(&self, knowledge: &Knowledge<'_>, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
        let log = knowledge.log;
        let mut map = TopologyMap::of_places(Self::NAME, vec![None; log.node_count()], CoordinateFrame::World);
        map.grid_step_m = Some(self.grid_step_m);
        if log.stops().is_empty() {
            return Ok(map);
        }
        let range_m = self.range_m();
        map.heights = SoughtHeights::of(log.stops(), self.z_range_m, range_m);
        let lattice = self.lattice(log, range_m)?;
        let nodes: Vec<Vec<HeardStop>> =
            (0..log.node_count()).map(|node| heard_stops(log, NodeId::from_index(node))).collect();
        let search = Search {
            curves: Curves::new(&self.ranging, self.sensitivity_dbm, range_m + 2.0 * lattice.half_diagonal_m()),
            lattice: &lattice,
            stops: log.stops(),
            range_m,
            variance: self.ranging.sigma_db().powi(2),
            watch,
        };
        let heard: usize = nodes.iter().map(Vec::len).sum();
        #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
        let operations = (heard + log.stops().len()) as f64 * lattice.len() as f64;
        watch.begin(Work { name: Self::NAME, unit: "node", steps: nodes.len() as u64, operations });
        let tiles = Tiles::new(&search)?;
        let solved: Result<Vec<(Option<Estimate>, u64)>, MapError> = nodes
            .par_iter()
            .map(|heard| {
                let solved = search.estimate(&tiles, heard, self.estimate);
                watch.check()?;
                watch.advance(1);
                Ok(solved)
            })
            .collect();
        map.take_in(solved?);
        Ok(map)
    }

    /// The lattice, if the likelihoods of all its vertices fit the memory.
    fn lattice(&self, log: &ReceptionLog, range_m: f64) -> Result<Lattice, MapError> {
        let lattice = Lattice::covering(log.stops(), range_m, self.grid_step_m, self.z_range_m, ALLOWED_BYTES)?;
        let bytes = lattice.len().saturating_mul(OCTETS_PER_VERTEX);
        if bytes <= ALLOWED_BYTES {
            return Ok(lattice);
        }
        #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
        let (vertices, excess) = (lattice.len() as f64, bytes as f64 / ALLOWED_BYTES as f64);
        Err(MapError::GridTooLarge {
            vertices,
            bytes,
            allowed_bytes: ALLOWED_BYTES,
            step_m: self.grid_step_m,
            suggested_step_m: self.grid_step_m * excess.sqrt().ceil(),
        })
    }
}

/// The stops that heard a node with a strength.
fn heard_stops(log: &ReceptionLog, node: NodeId) -> Vec<HeardStop> {
    let receptions = log.of(node).iter().filter(|reception| reception.received > 0);
    receptions
        .filter_map(|reception| {
            let place: Position = log.stops()[reception.stop as usize].position;
            Some(HeardStop { place, rssi_dbm: reception.rssi_dbm? })
        })
        .collect()
}
