//! ML-TM: maximum-likelihood topology maps on a grid (Gunathillake 2018, chapter 3).

use std::borrow::Cow;

use rayon::prelude::*;
#[cfg(feature = "config")]
use serde::{Deserialize, Serialize};
use sextant_channel::{ReceptionLog, Stop};
use sextant_kernel::{NodeId, SettingError, Watch, Work};

use crate::count_rule::CountRule;
use crate::error::MapError;
use crate::estimator::{Estimator, NodeOfLog};
use crate::grid_ml::bounded_search::BoundedSink;
use crate::grid_ml::findings::Findings;
use crate::grid_ml::sector_errors::likeliest_sigma_db;
use crate::grid_ml::solver::{Moments, Peak, Solver, SolverScratch};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::lattice::Lattice;
use crate::learned::EstimatorFindings;
use crate::log_facts::heights::check_z_range;
use crate::log_facts::search_box::SearchBox;
use crate::log_facts::sectors::SectorSettings;
use crate::log_facts::{SectorsConfig, SoughtHeights};
use crate::parts::PartEstimator;
use crate::posterior::{Concern, Estimate, EstimateKind, TieRule};
use crate::profile::{ProfileConfig, ReceptionProfile};
use crate::surface::Surface;
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// ML-TM as written in a scenario.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "config", serde(deny_unknown_fields))]
pub struct MlTmConfig {
    /// Distance of neighbouring grid vertices (m).
    pub grid_step_m: f64,
    /// How likely a packet is received over a distance.
    pub profile: ProfileConfig,
    /// How a reception of several packets counts. If absent: `packets`, or `at_least_one` under a `channel` profile
    /// with `packets_per_stop`, whose curve is that of a whole slot.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub counts: Option<CountRule>,
    /// How the place is estimated from the likelihood.
    #[cfg_attr(feature = "config", serde(default))]
    pub estimate: EstimateKind,
    /// Which place `argmax` takes if several vertices have the highest likelihood.
    #[cfg_attr(feature = "config", serde(default))]
    pub ties: TieRule,
    /// Lowest and highest height of a node (m). If absent, nodes are searched for in the plane of the stops if the
    /// heights of the stops differ by at most a twentieth of the range of the profile; otherwise from one range below
    /// the stops to one range above them.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub z_range_m: Option<[f64; 2]>,
    /// How the antenna sectors in which nodes were heard are used. If absent, the sectors of the log are evidence.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub sectors: Option<SectorsConfig>,
    /// Maximum memory for the grid window of one node (MB); 512 if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub max_memory_mb: Option<u32>,
}

/// Memory allowed for the window of one node (MB).
pub(crate) const DEFAULT_MEMORY_MB: u32 = 512;

impl MlTmConfig {
    /// The argmax on a grid of `grid_step_m`, with defaults for all other settings.
    #[must_use]
    pub fn new(grid_step_m: f64, profile: ProfileConfig) -> Self {
        Self {
            grid_step_m,
            profile,
            counts: None,
            estimate: EstimateKind::default(),
            ties: TieRule::default(),
            z_range_m: None,
            sectors: None,
            max_memory_mb: None,
        }
    }
}

/// The ML-TM algorithm.
///
/// The likelihood of node i at vertex g is the product over all stops of S(d) for each packet received and of 1 −
/// S(d) for each packet missed, a stop without an entry in the log counting as one packet missed, and `0` of `0` as
/// no evidence. If a reception is in a known antenna sector, vertices outside this sector count as if they were
/// beyond R: the reception is impossible there, or has the probability of the floor (chapter 4 of the thesis). The same
/// holds for a stop that heard nothing and vertices outside all sectors of its antenna ([`SilenceRule`]).
///
/// [`SilenceRule`]: crate::SilenceRule
///
/// **Search set.** The vertices nearer than R to every stop that received from the node and in its sector, as far as
/// their likelihood is above zero. If there are none, the node is *infeasible*: its estimate says so, and the search
/// set is all vertices nearer than R to any such stop and in its sector, under the profile clamped at least to
/// `[10⁻⁶, 1 − 10⁻⁶]`. Within the search set the result is exact: the same vertex and the same number of ties as a
/// scan of all vertices with the product over all stops.
#[derive(Clone, Debug, PartialEq)]
pub struct MlTm {
    grid_step_m: f64,
    profile: ReceptionProfile,
    counts: CountRule,
    estimate: EstimateKind,
    ties: TieRule,
    z_range_m: Option<[f64; 2]>,
    sectors: SectorSettings,
    allowed_bytes: u64,
}

impl MlTm {
    /// The algorithm's name in tables and topics.
    pub const NAME: &'static str = "ml-tm";

    /// The same algorithm with another profile. Steps of the grid longer than its range are shortened to it.
    #[must_use]
    pub fn with_profile(&self, profile: ReceptionProfile) -> Self {
        let grid_step_m = self.grid_step_m.min(profile.range_m());
        Self { grid_step_m, profile, ..self.clone() }
    }

    /// The same algorithm, which searches for nodes at these heights.
    pub(crate) fn with_heights(&self, heights: SoughtHeights) -> Self {
        Self { z_range_m: Some([heights.low_m, heights.high_m]), ..self.clone() }
    }

    /// How receptions are counted.
    pub(crate) fn count_rule(&self) -> CountRule {
        self.counts
    }

    /// How the place is estimated.
    pub(crate) fn estimate_kind(&self) -> EstimateKind {
        self.estimate
    }

    /// How sectors are used.
    pub(crate) fn sectors(&self) -> &SectorSettings {
        &self.sectors
    }

    /// The same algorithm on another grid.
    pub(crate) fn with_grid_step_m(&self, grid_step_m: f64) -> Self {
        Self { grid_step_m, ..self.clone() }
    }

    /// Distance of neighbouring vertices (m).
    #[must_use]
    pub fn grid_step_m(&self) -> f64 {
        self.grid_step_m
    }

    /// The reception profile that the likelihood uses.
    #[must_use]
    pub fn profile(&self) -> &ReceptionProfile {
        &self.profile
    }

    /// The lattice on which the nodes of `log` are sought.
    ///
    /// # Errors
    /// [`MapError::GridTooLarge`], [`MapError::NoStops`].
    pub fn lattice(&self, log: &ReceptionLog) -> Result<Lattice, MapError> {
        self.lattice_of(log.stops())
    }

    fn lattice_of(&self, stops: &[Stop]) -> Result<Lattice, MapError> {
        Lattice::covering(stops, self.profile.range_m(), self.grid_step_m, self.z_range_m, self.allowed_bytes)
    }

    /// The map of the nodes in `log`, computed on the current rayon pool. The result is bit-identical for any number
    /// of threads. Nodes that were never heard are not placed. Neither are nodes that were heard only where no vertex
    /// is in range.
    ///
    /// # Errors
    /// [`MapError::GridTooLarge`]; [`MapError::Log`] if a sector of the log is not among those of the settings;
    /// [`MapError::Interrupted`].
    pub fn map(&self, log: &ReceptionLog, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
        self.map_within(log, None, watch)
    }

    /// The same with nodes in their boxes, if they have any.
    pub(crate) fn map_within(
        &self,
        log: &ReceptionLog,
        limits: Option<&[(NodeId, SearchBox)]>,
        watch: &dyn Watch,
    ) -> Result<TopologyMap, MapError> {
        let mut map = TopologyMap {
            algorithm: Self::NAME,
            estimates: vec![None; log.node_count()],
            grid_step_m: Some(self.grid_step_m),
            vertices_evaluated: 0,
            heights: SoughtHeights::of(log.stops(), self.z_range_m, self.profile.range_m()),
            frame: CoordinateFrame::World,
        };
        if log.receptions().is_empty() {
            return Ok(map);
        }
        let log = &*self.counted(log);
        let lattice = self.lattice(log)?;
        let solver = self.solver(&lattice, log, watch)?;
        let mut boxes: Vec<Option<SearchBox>> = vec![None; log.node_count()];
        for &(node, within) in limits.unwrap_or_default() {
            boxes[node.index()] = Some(within);
        }
        watch.begin(Work {
            name: Self::NAME,
            unit: "node",
            steps: log.node_count() as u64,
            operations: solver.operations(log),
        });
        let solved: Result<Vec<(Option<Estimate>, u64)>, MapError> = (0..log.node_count())
            .into_par_iter()
            .with_min_len(32)
            .map_init(
                || solver.scratch(),
                |scratch, node| {
                    let solved = self.estimate(&solver, scratch, log, NodeId::from_index(node), boxes[node].as_ref());
                    watch.check()?;
                    watch.advance(1);
                    Ok(solved)
                },
            )
            .collect();
        map.take_in(solved?);
        Ok(map)
    }

    /// The likelihood of one node over its whole search set, for pictures.
    ///
    /// # Errors
    /// [`MapError::UnknownNode`] and [`MapError::NotHeard`] if there is no such likelihood;
    /// [`MapError::GridTooLarge`], [`MapError::NoStops`]; [`MapError::Interrupted`].
    pub fn surface(&self, log: &ReceptionLog, node: NodeId, watch: &dyn Watch) -> Result<Surface, MapError> {
        let name =
            log.names().get(node.index()).ok_or(MapError::UnknownNode { node: node.0, nodes: log.node_count() })?;
        let log = &*self.counted(log);
        let lattice = self.lattice(log)?;
        let solver = self.solver(&lattice, log, watch)?;
        let mut vertices = Vec::new();
        let search = solver.search(&mut solver.scratch(), log.of(node), f64::INFINITY, &mut vertices);
        watch.check()?;
        Surface::of_vertices(&lattice, &vertices, search.infeasible)
            .ok_or_else(|| MapError::NotHeard { name: name.clone() })
    }

    /// The log with its receptions counted by the rule of the settings.
    pub(crate) fn counted<'a>(&self, log: &'a ReceptionLog) -> Cow<'a, ReceptionLog> {
        self.counts.counted(log)
    }

    /// Checks that sectors of `log` are evidence. `algorithm` is the one that needs them.
    ///
    /// # Errors
    /// [`MapError::Missing`], [`MapError::Log`].
    pub(crate) fn demand_sectors(&self, log: &ReceptionLog, algorithm: &'static str) -> Result<(), MapError> {
        if log.receptions().is_empty() {
            return Ok(());
        }
        if log.receptions().sectors().is_none() {
            return Err(MapError::Missing {
                algorithm,
                what: "the antenna sector of each reception",
                remedy: "a log has it in the column `sector`; `ml_tm` maps without sectors",
            });
        }
        if log.has_headings() {
            return Err(MapError::Missing {
                algorithm,
                what: "the gains of the sectors of an antenna that turns with the robot",
                remedy: "a log has them in `antenna.toml`, and the profile is fitted; `ml_tm` maps without sectors",
            });
        }
        self.sectors.table(log)?.ok_or(MapError::Missing {
            algorithm,
            what: "the directions of the antenna sectors",
            remedy: "a log has them in `sectors.csv`, a scenario in `sectors.layout`; `ml_tm` maps without sectors",
        })?;
        Ok(())
    }

    /// The same algorithm with what is estimated from the whole log, of which `sample` are some of the nodes: the error of
    /// the strengths by which nodes name sectors, if the settings ask for it and do not give it.
    pub(crate) fn with_errors_of(&self, sample: &ReceptionLog, watch: &dyn Watch) -> Result<Self, MapError> {
        let mut fixed = self.clone();
        if let Some(soft) = fixed.sectors.soft.as_mut() {
            let sample = &*self.counted(sample);
            let lattice = self.lattice(sample)?;
            soft.sigma_db = self.sigma_db(&lattice, sample, watch)?.or(soft.sigma_db);
        }
        Ok(fixed)
    }

    /// Whether a sample of the log must be known before a part of it can be mapped.
    pub(crate) fn needs_sample(&self) -> bool {
        self.sectors.soft.is_some_and(|soft| soft.sigma_db.is_none())
    }

    pub(crate) fn solver<'a>(
        &'a self,
        lattice: &'a Lattice,
        log: &'a ReceptionLog,
        watch: &'a dyn Watch,
    ) -> Result<Solver<'a>, MapError> {
        let sigma_db = self.sigma_db(lattice, log, watch)?;
        let sectors = self.sectors.table(log)?.map(|table| (table, &self.sectors));
        Ok(Solver::new(lattice, log.stops(), &self.profile, sectors, sigma_db, watch))
    }

    /// The error of the strengths by which nodes name sectors (dB); `None` if it does not count.
    fn sigma_db(&self, lattice: &Lattice, log: &ReceptionLog, watch: &dyn Watch) -> Result<Option<f64>, MapError> {
        let sectors = self.sectors.table(log)?.map(|table| (table, &self.sectors));
        let with = |sigma_db| Solver::new(lattice, log.stops(), &self.profile, sectors, Some(sigma_db), watch);
        let soft = self.sectors.soft.filter(|_| sectors.is_some());
        Ok(soft.map(|soft| soft.sigma_db.unwrap_or_else(|| likeliest_sigma_db(lattice, log, with))))
    }

    fn estimate(
        &self,
        solver: &Solver<'_>,
        scratch: &mut SolverScratch,
        log: &ReceptionLog,
        node: NodeId,
        within: Option<&SearchBox>,
    ) -> (Option<Estimate>, u64) {
        let receptions = log.of(node);
        let lattice = solver.lattice();
        let mut concern = None;
        scratch.keep_within(within.map(|within| [within.low, within.high]));
        let (search, findings) = match (self.estimate, within) {
            (EstimateKind::Argmax, None) => {
                let mut peak = Peak::default();
                (solver.search(scratch, receptions, 0.0, &mut peak), Findings { peak, moments: None })
            }
            (EstimateKind::Argmax, Some(within)) => {
                let mut bounded = BoundedSink::new(Peak::default(), within, lattice);
                let margin = BoundedSink::<Peak>::MARGIN;
                let search = solver.search(scratch, receptions, margin, &mut bounded);
                concern = bounded.concern();
                (search, Findings { peak: bounded.inner, moments: None })
            }
            (EstimateKind::PosteriorMean, None) => {
                let mut both = (Peak::default(), Moments::new(lattice));
                let search = solver.search(scratch, receptions, Moments::NEGLIGIBLE, &mut both);
                (search, Findings { peak: both.0, moments: Some(both.1) })
            }
            (EstimateKind::PosteriorMean, Some(within)) => {
                let both = (Peak::default(), Moments::new(lattice));
                let mut bounded = BoundedSink::new(both, within, lattice);
                let search = solver.search(scratch, receptions, Moments::NEGLIGIBLE, &mut bounded);
                concern = bounded.concern();
                let (peak, moments) = bounded.inner;
                (search, Findings { peak, moments: Some(moments) })
            }
        };
        let estimate = findings.estimate(lattice, self.ties, search.infeasible);
        let Some(within) = within else { return (estimate, search.evaluated) };
        if let Some(estimate) = estimate {
            return (Some(Estimate { concern, ..estimate }), search.evaluated);
        }
        // No vertex in the box is within range of the receptions.
        let (unbounded, evaluated) = self.estimate(solver, scratch, log, node, None);
        let clamped = unbounded.map(|estimate| Estimate {
            position: within.nearest(estimate.position),
            concern: Some(Concern::AtEdge),
            ..estimate
        });
        (clamped, search.evaluated + evaluated)
    }
}

impl TryFrom<MlTmConfig> for MlTm {
    type Error = SettingError;

    fn try_from(config: MlTmConfig) -> Result<Self, SettingError> {
        let MlTmConfig { grid_step_m, profile, counts, estimate, ties, z_range_m, sectors, max_memory_mb } = config;
        SettingError::positive("grid_step_m", grid_step_m)?;
        let is_of_a_slot = matches!(&profile, ProfileConfig::Channel(channel) if channel.packets_per_stop.is_some());
        let counts = counts.unwrap_or(if is_of_a_slot { CountRule::AtLeastOne } else { CountRule::Packets });
        let profile = ReceptionProfile::for_grid(profile, grid_step_m).map_err(|error| error.within("profile"))?;
        if grid_step_m > profile.range_m() {
            let allowed = format!("above 0, at most the range of the profile ({} m)", profile.range_m());
            return Err(SettingError::new("grid_step_m", grid_step_m, allowed));
        }
        check_z_range(z_range_m)?;
        let sectors =
            SectorSettings::try_from(sectors.unwrap_or_default()).map_err(|error| error.within("sectors"))?;
        let memory_mb = max_memory_mb.unwrap_or(DEFAULT_MEMORY_MB);
        if memory_mb == 0 {
            return Err(SettingError::new("max_memory_mb", 0, "1 or more"));
        }
        let allowed_bytes = u64::from(memory_mb) * 1_000_000;
        Ok(Self { grid_step_m, profile, counts, estimate, ties, z_range_m, sectors, allowed_bytes })
    }
}

/// What a grid uses under a profile, which is fitted to the log if it is not given.
pub(super) fn uses_under(profile: Option<&ReceptionProfile>) -> &'static [KnowledgeKind] {
    match profile {
        Some(ReceptionProfile::Table(_)) => &[KnowledgeKind::RobotReceptions, KnowledgeKind::PathLoss],
        Some(ReceptionProfile::Trapezoid(_)) | None => &[KnowledgeKind::RobotReceptions],
    }
}

impl Estimator for MlTm {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn uses(&self) -> &'static [KnowledgeKind] {
        uses_under(Some(&self.profile))
    }

    fn counts_packets(&self) -> bool {
        self.counts == CountRule::Packets
    }

    fn check_grid(&self, stops: &[Stop]) -> Result<(), MapError> {
        self.lattice_of(stops).map(drop)
    }

    fn profile(&self) -> Option<&ReceptionProfile> {
        Some(&self.profile)
    }

    fn surface(
        &self,
        _: Option<&EstimatorFindings>,
        NodeOfLog { log, node }: NodeOfLog<'_>,
        watch: &dyn Watch,
    ) -> Option<Result<Surface, MapError>> {
        Some(self.surface(log, node, watch))
    }

    fn by_parts(&self) -> Option<&dyn PartEstimator> {
        Some(self)
    }

    fn estimate(
        &self,
        knowledge: &Knowledge<'_>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<EstimatorFindings>), MapError> {
        self.map(knowledge.log, watch).map(|map| (map, None))
    }
}
