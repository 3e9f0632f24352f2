//! A Bayesian grid on the signal strengths that the robot measured (Sichitiu and Ramadurai 2004).

mod channel;
mod curves;
mod distance_bins;
mod evidence;
mod fitted_channel;
mod report;
mod search;
mod silent_field;
mod tiles;
mod zoom;

use rayon::prelude::*;
use sextant_channel::{Position, ReceptionLog, Stop};
use sextant_kernel::{NodeId, SettingError, Watch, Work};

use self::channel::{Given, SurveyGrid};
use self::curves::Curves;
use self::evidence::{HeardByStops, StrengthEvidence};
pub use self::fitted_channel::FittedChannel;
use self::search::StrengthSearch;
use self::tiles::Tiles;
use self::zoom::{PosteriorDetail, WeighedPlaces};
use crate::error::MapError;
use crate::estimator::{AnyLog, Estimator, EstimatorSettings, Mapper, Messages, ReceiverSetting};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::lattice::Lattice;
use crate::learned::EstimatorFindings;
use crate::log_facts::SoughtHeights;
use crate::log_facts::heights::check_z_range;
use crate::log_facts::reach::{heard_nodes, is_reach_known, reach_m};
use crate::log_facts::search_box::{Limits, SearchBox};
use crate::log_facts::strengths::{Strength, strengths};
use crate::numerics::whole;
use crate::posterior::{Estimate, EstimateKind, FitState};
use crate::ranging::{Ranging, RangingConfig};
use crate::survey_frame::Axes;
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// The Bayesian grid as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RssGridConfig {
    /// Distance of neighbouring grid vertices (m). If absent, a sixtieth of the reach seen in the log, or a fortieth in
    /// space.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub grid_step_m: Option<f64>,
    /// How power falls with distance, and how it scatters. Absent values are those of the channel of the scenario; without
    /// one, they are estimated from the log.
    #[cfg_attr(feature = "config", serde(default))]
    pub ranging: RangingConfig,
    /// Least power at which packets are received (dBm). If absent, that of the radio of the scenario; without one, it is
    /// estimated from the log.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub sensitivity_dbm: Option<f64>,
    /// Hard communication radius (m). If absent in a scenario, that of its channel.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub max_range_m: Option<f64>,
    /// How the place is estimated from the likelihood.
    #[cfg_attr(feature = "config", serde(default = "posterior_mean"))]
    pub estimate: EstimateKind,
    /// Lowest and highest height of a node (m); as of `ml_tm` if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub z_range_m: Option<[f64; 2]>,
}

#[cfg(feature = "config")]
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
///
/// If values of the channel are not given, they are estimated from the log by expectation maximisation: the strengths
/// of silent links are censored at the sensitivity, and a share of the links is silent for other reasons. The sensitivity
/// is that of the faintest receptions. Each node is then searched for within reach of the stops that heard it, on grids
/// that zoom in on the likely part of its box. Stops of `0` of `0` packets are no evidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RssGrid {
    grid_step_m: Option<f64>,
    channel: Channel,
    max_range_m: Option<f64>,
    estimate: EstimateKind,
    z_range_m: Option<[f64; 2]>,
}

/// The channel of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Channel {
    /// It is given.
    Known { ranging: Ranging, sensitivity_dbm: f64 },
    /// It is estimated, but for what is given.
    Fitted(Given),
}

impl TryFrom<RssGridConfig> for RssGrid {
    type Error = SettingError;

    fn try_from(config: RssGridConfig) -> Result<Self, SettingError> {
        let RssGridConfig { grid_step_m, ranging, sensitivity_dbm, max_range_m, estimate, z_range_m } = config;
        if let Some(sigma_db) = ranging.sigma_db {
            SettingError::positive("ranging.sigma_db", sigma_db)?;
        }
        if let Some(sensitivity_dbm) = sensitivity_dbm {
            SettingError::finite("sensitivity_dbm", sensitivity_dbm)?;
        }
        // Absent values are any good ones, so that the others are checked.
        let complete = RangingConfig {
            exponent: Some(ranging.exponent.unwrap_or(2.0)),
            tx_power_dbm: Some(ranging.tx_power_dbm.unwrap_or(0.0)),
            ..ranging
        };
        let law = Ranging::try_from(complete).map_err(|error| error.within("ranging"))?;
        let RangingConfig { exponent, tx_power_dbm, sigma_db, .. } = ranging;
        let channel = match (exponent, tx_power_dbm, sigma_db, sensitivity_dbm) {
            (Some(_), Some(_), Some(_), Some(sensitivity_dbm)) => Channel::Known { ranging: law, sensitivity_dbm },
            _ => Channel::Fitted(Given { ranging, sensitivity_dbm }),
        };
        if let Some(range_m) = max_range_m {
            SettingError::positive("max_range_m", range_m)?;
        }
        check_z_range(z_range_m)?;
        if let Some(step_m) = grid_step_m {
            SettingError::positive("grid_step_m", step_m)?;
        }
        Ok(Self { grid_step_m, channel, max_range_m, estimate, z_range_m })
    }
}

/// Maximum memory for the shared surface and the search of a node (bytes).
const ALLOWED_BYTES: u64 = 1_536_000_000;
/// Bytes per vertex: its log-likelihood of silence, and its entry in the list of a search.
const OCTETS_PER_VERTEX: u64 = 24;
/// A step that is not set grows by this factor until the grid fits the memory.
const COARSER: f64 = 1.1;
/// Number of grid steps over the reach, if no step is set, in the plane and in space.
const STEPS_PER_REACH: [f64; 2] = [60.0, 40.0];
/// Without a hard radius, receptions may be this many standard deviations stronger than the mean.
const REACH_SIGMAS: f64 = 3.0;

impl RssGrid {
    /// The algorithm's name in tables and topics.
    pub const NAME: &'static str = "rss-grid";

    /// The map, computed on the current rayon pool. The result is bit-identical for any number of threads. Nodes that
    /// were never heard with a strength are not placed.
    ///
    /// # Errors
    /// [`MapError::GridTooLarge`]; [`MapError::Missing`] if the channel is to be estimated, and the log has no
    /// strengths; [`MapError::Interrupted`].
    pub fn map(&self, knowledge: &Knowledge<'_>, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
        self.map_and_learn(knowledge, watch).map(|(map, _)| map)
    }

    /// The map, and the channel if it was estimated.
    ///
    /// # Errors
    /// Those of [`map`](Self::map).
    pub fn map_and_learn(
        &self,
        knowledge: &Knowledge<'_>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<FittedChannel>), MapError> {
        let log = knowledge.log;
        let mut map = TopologyMap::of_places(Self::NAME, vec![None; log.node_count()], CoordinateFrame::World);
        map.grid_step_m = self.grid_step_m;
        if log.stops().is_empty() {
            return Ok((map, None));
        }
        match self.channel {
            Channel::Known { ranging, sensitivity_dbm } => {
                self.map_known(log, map, &ranging, sensitivity_dbm, watch).map(|map| (map, None))
            }
            Channel::Fitted(given) => self.map_fitted(log, map, &given, watch),
        }
    }

    /// The step of the grid for a log whose nodes are heard over about `reach_m` (m).
    fn step_m(&self, reach_m: f64, is_spatial: bool) -> f64 {
        self.grid_step_m.unwrap_or(reach_m / STEPS_PER_REACH[usize::from(is_spatial)])
    }

    fn map_fitted(
        &self,
        log: &ReceptionLog,
        mut map: TopologyMap,
        given: &Given,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<FittedChannel>), MapError> {
        let heard = heard_nodes(log);
        let reach_m = reach_m(log, &heard);
        let step_m = self.step_m(reach_m, true);
        let Some(heights) = SoughtHeights::of_log(log.stops(), self.z_range_m, reach_m, step_m) else {
            return Ok((map, None));
        };
        let step_m = self.step_m(reach_m, heights.high_m > heights.low_m);
        map.heights = Some(heights);
        map.grid_step_m = Some(step_m);
        let limits = Limits::new(log, reach_m, heights);
        let nodes: Vec<(HeardByStops, SearchBox)> =
            heard.iter().map(|heard| (HeardByStops::of(log, heard.node), limits.of(heard))).collect();
        if heard.is_empty() {
            return Ok((map, None));
        }
        let stops: Vec<Position> = log.stops().iter().map(|stop| stop.position).collect();
        let survey = SurveyGrid { stops: &stops, heights, step_m, longest_m: longest_m(&stops, &nodes) };
        let channel = FittedChannel::fit(&survey, &nodes, given, watch)?.ok_or(MapError::Missing {
            algorithm: Self::NAME,
            what: "the signal strengths of receptions",
            remedy: "a log has them in the column `rssi_dbm`; `ml_tm` and `self_calibrated` map without",
        })?;
        let evidence = StrengthEvidence::new(channel, survey.longest_m);
        let field = survey.silence(&evidence);
        #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
        let operations = nodes.len() as f64 * 1e5;
        watch.begin(Work { name: Self::NAME, unit: "node", steps: nodes.len() as u64, operations });
        let state = FitState { is_reach_known: is_reach_known(&heard), is_settled: channel.converged };
        let solved: Result<Vec<(Option<Estimate>, u64)>, MapError> = nodes
            .par_iter()
            .map(|(links, within)| {
                watch.check()?;
                watch.advance(1);
                if links.heard.is_empty() {
                    return Ok((None, 0));
                }
                let posterior = WeighedPlaces::of(links, &field, within, PosteriorDetail::Fine);
                let estimate = posterior.estimate(self.estimate);
                let concern = state.concern(estimate.concern);
                Ok((Some(Estimate { concern, ..estimate }), posterior.vertices))
            })
            .collect();
        watch.check()?;
        for (heard, (estimate, vertices)) in heard.iter().zip(solved?) {
            map.estimates[heard.node.index()] = estimate;
            map.vertices_evaluated += vertices;
        }
        Ok((map, Some(channel)))
    }

    fn map_known(
        &self,
        log: &ReceptionLog,
        mut map: TopologyMap,
        ranging: &Ranging,
        sensitivity_dbm: f64,
        watch: &dyn Watch,
    ) -> Result<TopologyMap, MapError> {
        let range_m = self.range_m(ranging, sensitivity_dbm);
        map.heights = SoughtHeights::of(log.stops(), self.z_range_m, range_m);
        let lattice = self.lattice(log.stops(), range_m)?;
        map.grid_step_m = Some(lattice.step_m());
        let nodes: Vec<Vec<Strength>> =
            (0..log.node_count()).map(|node| strengths(log, NodeId::from_index(node))).collect();
        let search = StrengthSearch {
            curves: Curves::new(ranging, sensitivity_dbm, range_m + 2.0 * lattice.half_diagonal_m()),
            lattice: &lattice,
            stops: log.stops(),
            range_m,
            variance: ranging.sigma_db().powi(2),
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

    /// How far a node is heard under a known channel (m).
    fn range_m(&self, ranging: &Ranging, sensitivity_dbm: f64) -> f64 {
        self.max_range_m.unwrap_or_else(|| ranging.distance_m(sensitivity_dbm - REACH_SIGMAS * ranging.sigma_db()))
    }

    /// The lattice, if the likelihoods of all its vertices fit the memory. If no step is set, it is as coarse as it must be.
    fn lattice(&self, stops: &[Stop], range_m: f64) -> Result<Lattice, MapError> {
        let heights = SoughtHeights::of(stops, self.z_range_m, range_m);
        let is_spatial = heights.is_some_and(|heights| heights.high_m > heights.low_m);
        let mut step_m = self.step_m(range_m, is_spatial);
        loop {
            let lattice = self.lattice_of_step(stops, range_m, step_m);
            let is_too_large = matches!(lattice, Err(MapError::GridTooLarge { .. }));
            // With steps of a whole reach, a place tells nothing about its node.
            if !is_too_large || self.grid_step_m.is_some() || COARSER * step_m > range_m {
                return lattice;
            }
            step_m *= COARSER;
        }
    }

    fn lattice_of_step(&self, stops: &[Stop], range_m: f64, step_m: f64) -> Result<Lattice, MapError> {
        #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
        let vertices = match Lattice::covering(stops, range_m, step_m, self.z_range_m, ALLOWED_BYTES) {
            Ok(lattice) if lattice.len().saturating_mul(OCTETS_PER_VERTEX) <= ALLOWED_BYTES => return Ok(lattice),
            Ok(lattice) => lattice.len() as f64,
            // The window of one node is too large already.
            Err(MapError::GridTooLarge { vertices, .. }) => vertices,
            Err(error) => return Err(error),
        };
        #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
        let (bytes, allowed) = (vertices * OCTETS_PER_VERTEX as f64, ALLOWED_BYTES as f64);
        Err(MapError::GridTooLarge {
            vertices,
            bytes: whole(bytes) as u64,
            allowed_bytes: ALLOWED_BYTES,
            step_m,
            suggested_step_m: step_m * (bytes / allowed).sqrt().ceil(),
            memory_key: None,
        })
    }
}

/// A distance that no place in the boxes of the nodes exceeds from a stop (m).
fn longest_m(stops: &[Position], nodes: &[(HeardByStops, SearchBox)]) -> f64 {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    let stops = stops.iter().map(|&stop| <[f64; 3]>::from(stop)).map(|place| (place, place));
    let boxes = nodes.iter().map(|(_, within)| (within.low, within.high));
    for (first, last) in stops.chain(boxes) {
        for axis in 0..3 {
            low[axis] = low[axis].min(first[axis]);
            high[axis] = high[axis].max(last[axis]);
        }
    }
    Position::from(low).distance_m(high.into())
}

impl Estimator for RssGrid {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn axes(&self) -> Axes {
        match self.channel {
            Channel::Known { .. } => Axes::Log,
            Channel::Fitted(_) => Axes::Survey,
        }
    }

    fn uses(&self) -> &'static [KnowledgeKind] {
        match self.channel {
            Channel::Known { .. } => &[KnowledgeKind::RobotRssi, KnowledgeKind::PathLoss],
            Channel::Fitted(_) => &[KnowledgeKind::RobotRssi],
        }
    }

    fn messages(&self) -> Messages {
        Messages::Unknown
    }

    fn check_grid(&self, stops: &[Stop]) -> Result<(), MapError> {
        match self.channel {
            Channel::Known { ranging, sensitivity_dbm } => {
                self.lattice(stops, self.range_m(&ranging, sensitivity_dbm)).map(drop)
            }
            Channel::Fitted(_) => Ok(()),
        }
    }

    fn estimate(
        &self,
        knowledge: &Knowledge<'_>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<EstimatorFindings>), MapError> {
        let (map, channel) = self.map_and_learn(knowledge, watch)?;
        Ok((map, channel.map(EstimatorFindings::new)))
    }
}

impl EstimatorSettings for RssGridConfig {
    const ANY_LOG: Option<AnyLog> = Some(AnyLog {
        name: "rss-grid",
        rank: 5,
        description: "Maximum likelihood of signal strengths, with a channel that is fitted first",
        settings: "{}",
    });

    fn mapper(self) -> Result<Mapper, SettingError> {
        RssGrid::try_from(self).map(Mapper::new)
    }

    fn ranging_mut(&mut self) -> Option<&mut RangingConfig> {
        Some(&mut self.ranging)
    }

    fn receiver_mut(&mut self) -> Option<ReceiverSetting<'_>> {
        let Self { sensitivity_dbm, max_range_m, .. } = self;
        Some(ReceiverSetting { sensitivity_dbm, max_range_m })
    }
}
