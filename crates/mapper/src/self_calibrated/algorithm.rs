//! The self-calibrated map.

use sextant_channel::{Position, ReceptionLog, Stop};
use sextant_kernel::{Interrupted, NodeId, SettingError, Watch, Work};

use super::belief::PlaceBelief;
use super::counts::StopCounts;
use super::draft::CalibrationDraft;
use super::model::CalibratedCurve;
use super::settings::{ObstacleKnowledge, SelfCalibratedConfig, Settings};
use super::start::Start;
use crate::absorption::AbsorptionMap;
use crate::error::MapError;
use crate::estimator::{AnyLog, Estimator, EstimatorSettings, Mapper};
use crate::grid_ml::directions::{CoverageEdge, Directions};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::learned::EstimatorFindings;
use crate::link_dependence::LinkDependence;
use crate::log_facts::SoughtHeights;
use crate::log_facts::heights::are_level;
use crate::log_facts::reach::{is_reach_known, reach_m};
use crate::log_facts::search_box::Limits;
use crate::log_facts::sectors::SectorSettings;
use crate::numerics::normal::{below, quantile};
use crate::posterior::{Estimate, FitState};
use crate::survey_frame::Axes;
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// Number of grid steps over the range seen in the log, if no step is set, in the plane and in space.
const STEPS_PER_RANGE: [f64; 2] = [60.0, 40.0];
/// Largest step of the first stage, as a share of the range.
const COARSEST: f64 = 0.12;
/// Width of a cell that may absorb, as a share of the range.
const CELL: f64 = 0.05;
/// Approximate number of vertices of the window of a node, in the plane and in space.
const VERTICES: [f64; 2] = [300.0, 3000.0];
/// A stage ends when a round moves the nodes by less than this share of its step on average.
const SETTLED: f64 = 0.05;

/// Self-calibrated maps: the positions of the nodes, the reception curve, the efficiency of each stop and the
/// obstacles, all estimated from one log.
///
/// The model: a packet sent at distance d is received at stop s with the probability `e_s Φ(z(d) − A)`. Φ is the normal
/// distribution function, z falls with distance in any way, A is what obstacles absorb along the straight line in standard
/// deviations of the shadowing (radio tomography; Wilson and Patwari 2010), `e_s` is the efficiency of the stop.
///
/// A map uses which packets were received at which stops. If obstacles are searched for, it may also use where the
/// robot drove and which obstacles it met. If the log has antenna sectors with their directions, a place outside the sector
/// of a reception is fifty times less likely, and a stop that heard nothing says nothing about places to which no sector
/// points. A map does not use the channel, anchors or signal strengths.
#[derive(Clone, Debug, PartialEq)]
pub struct SelfCalibrated {
    settings: Settings,
}

/// What was estimated together with a self-calibrated map.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// Probability that a packet is received over a clear link at a stop of average efficiency. `None` if the log has
    /// too few receptions to estimate it; the map then uses a trapezoid over the range seen in the log.
    pub curve: Option<CalibratedCurve>,
    /// Efficiency of each stop: of the packets that reach it, the share that it receives.
    pub efficiency: Vec<f64>,
    /// The knowledge of obstacles that was used. It may be less than the settings ask for, if it does not apply.
    pub knowledge: ObstacleKnowledge,
    /// The obstacles; `None` if they were not searched for, or explain nothing.
    pub obstacles: Option<AbsorptionMap>,
    /// Number of rounds of positions, curve and obstacles.
    pub rounds: u32,
    /// Whether the last round moved the nodes by less than a twentieth of the grid step on average, no node has a
    /// [`Concern`](crate::Concern), and the curve is not at its bound.
    pub converged: bool,
    /// Nodes that may be farther away. A node is searched for in a box within reach of the stops that heard it. If it
    /// is at the border of this box, its place is not reliable.
    pub at_bound: Vec<NodeId>,
    /// Whether the curve extends beyond the log: packets still arrive over the longest distance in the log.
    pub curve_at_bound: bool,
    /// How much the packets of a link depend on each other, where it was looked at.
    pub dependence: Option<LinkDependence>,
}

impl Calibration {
    /// The shares of packets that arrive at a stop of average efficiency; `None` without a curve.
    pub(crate) fn shares(&self) -> Option<CalibratedShares<'_>> {
        let curve = self.curve.as_ref()?;
        let is_free = self.obstacles.is_none();
        let scores = if is_free { Vec::new() } else { curve.probabilities().iter().copied().map(quantile).collect() };
        Some(CalibratedShares { curve, obstacles: self.obstacles.as_ref(), scores })
    }

    /// How much the packets of a link of `log` depend on each other; `None` without a curve.
    fn dependence_in(&self, log: &ReceptionLog, map: &TopologyMap) -> Option<LinkDependence> {
        let shares = self.shares()?;
        let usual = self.efficiency.iter().sum::<f64>() / self.efficiency.len().max(1) as f64;
        let share = |place, number: usize, stop: &Stop| {
            let efficiency = self.efficiency.get(number).map_or(1.0, |own| own / usual.max(1e-9));
            (efficiency * shares.at(place, stop.position)).min(1.0)
        };
        LinkDependence::of(log, map, share)
    }
}

/// The shares of packets that arrive under a calibration.
pub(crate) struct CalibratedShares<'a> {
    curve: &'a CalibratedCurve,
    obstacles: Option<&'a AbsorptionMap>,
    /// The normal quantile of the share in each bin of the curve, where there are obstacles.
    scores: Vec<f64>,
}

impl CalibratedShares<'_> {
    /// The share between two places, through the obstacles.
    pub(crate) fn at(&self, place: Position, stop: Position) -> f64 {
        let distance_m = place.distance_m(stop);
        match self.obstacles {
            Some(obstacles) => below(self.scores[self.curve.bin(distance_m)] - obstacles.absorbed(place, stop)),
            None => self.curve.probability(distance_m),
        }
    }
}

impl SelfCalibrated {
    /// The algorithm's name in tables and topics.
    pub const NAME: &'static str = "self-calibrated";

    /// The map of the nodes in `log`, with a covariance for each node, and what else was estimated (`None` if nothing
    /// was heard), computed on the current rayon pool. The result is bit-identical for any number of threads. Nodes
    /// that were never heard are not placed. Takes about 30 rounds, each linear in the nodes and in the stops in
    /// range of a node. Apart from the log, it needs at most about 400 MB of memory, for a log of any size.
    ///
    /// # Errors
    /// [`MapError::Interrupted`] if `watch` ends the work.
    pub fn map(&self, log: &ReceptionLog, watch: &dyn Watch) -> Result<(TopologyMap, Option<Calibration>), MapError> {
        let mut map = TopologyMap {
            algorithm: Self::NAME,
            estimates: vec![None; log.node_count()],
            grid_step_m: self.settings.grid_step_m,
            vertices_evaluated: 0,
            heights: None,
            frame: CoordinateFrame::World,
        };
        let Some(start) = Start::of(log) else { return Ok((map, None)) };
        let reach_m = reach_m(log, &start.nodes);
        let step_of = |is_spatial| {
            self.settings.grid_step_m.unwrap_or(start.range_m / STEPS_PER_RANGE[usize::from(is_spatial)])
        };
        let sought = SoughtHeights::of_log(log.stops(), self.settings.z_range_m, reach_m, step_of(true));
        let Some(heights) = sought else { return Ok((map, None)) };
        map.heights = Some(heights);
        let is_spatial = heights.high_m > heights.low_m;
        let step_m = step_of(is_spatial);
        // If the stops have several heights, the robot may pass above or below an obstacle that blocks it elsewhere.
        let applies = start.is_rich && are_level(log.stops(), reach_m, step_m);
        let knowledge = if applies { self.settings.obstacles } else { ObstacleKnowledge::None };
        let directions =
            Directions::of(log, &SectorSettings::default(), start.range_m, heights.heights(), CoverageEdge::Exact)?;
        let counts = StopCounts::new(log, start.range_m, directions);
        let mut draft = CalibrationDraft::new(&counts, &start, &Limits::new(log, reach_m, heights), watch);
        watch.begin(self.work(log, start.nodes.len(), is_spatial));
        let settled = self.run(&mut draft, start.range_m, step_m, knowledge)?;
        draft.widen(step_m)?;
        let is_reach_known = is_reach_known(&start.nodes);
        let concern = |belief: &PlaceBelief| {
            let is_settled = !belief.is_cramped && (settled || belief.shift_m < SETTLED * step_m);
            FitState { is_reach_known, is_settled }.concern(belief.concern)
        };
        for belief in &draft.beliefs.nodes {
            map.estimates[belief.node.index()] = Some(Estimate {
                position: belief.mean,
                log_likelihood: Some(belief.highest),
                ties: 1,
                covariance: Some(belief.cell.spread(belief.covariance)),
                infeasible: false,
                concern: concern(belief),
            });
        }
        map.grid_step_m = Some(step_m);
        map.vertices_evaluated = draft.vertices;
        let at_bound: Vec<NodeId> =
            draft.beliefs.nodes.iter().filter(|belief| belief.concern.is_some()).map(|belief| belief.node).collect();
        let curve_at_bound = start.is_rich && draft.model.is_at_bound();
        let calibration = Calibration {
            curve: start.is_rich.then(|| draft.model.curve()),
            efficiency: draft.model.efficiencies().to_vec(),
            knowledge,
            rounds: draft.rounds,
            converged: settled && map.concerns().next().is_none() && !curve_at_bound,
            at_bound,
            curve_at_bound,
            dependence: None,
            obstacles: draft.into_obstacles()?,
        };
        Ok((map, Some(calibration)))
    }

    /// The work of all rounds, if all stops are in reach of each of `nodes` nodes.
    fn work(&self, log: &ReceptionLog, nodes: usize, is_spatial: bool) -> Work {
        #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
        let links = nodes as f64 * log.stops().len() as f64;
        Work {
            name: Self::NAME,
            unit: "round",
            steps: self.settings.max_rounds.into(),
            operations: links * VERTICES[usize::from(is_spatial)] * f64::from(self.settings.max_rounds),
        }
    }

    /// Runs the stages, from coarse steps without obstacles to steps of `step_m`. Returns whether the last stage
    /// converged.
    fn run(
        &self,
        draft: &mut CalibrationDraft<'_>,
        range_m: f64,
        step_m: f64,
        knowledge: ObstacleKnowledge,
    ) -> Result<bool, Interrupted> {
        let most_rounds = self.settings.max_rounds;
        let mut halvings = libm::log2(COARSEST * range_m / step_m).floor().clamp(0.0, 30.0);
        let coarsest_m = step_m * libm::exp2(halvings);
        let mut converged = draft.stage(coarsest_m, SETTLED * coarsest_m, most_rounds)?;
        if knowledge != ObstacleKnowledge::None {
            draft.seek_obstacles(knowledge, CELL * range_m, coarsest_m);
            // Obstacles change the places of the nodes, so there is another stage even without finer steps.
            halvings = halvings.max(1.0);
        }
        while halvings > 0.0 {
            halvings -= 1.0;
            let stage_step_m = (step_m * libm::exp2(halvings)).min(coarsest_m);
            converged = draft.stage(stage_step_m, SETTLED * stage_step_m, most_rounds)?;
        }
        Ok(converged)
    }
}

impl TryFrom<SelfCalibratedConfig> for SelfCalibrated {
    type Error = SettingError;

    fn try_from(config: SelfCalibratedConfig) -> Result<Self, SettingError> {
        Settings::try_from(config).map(|settings| Self { settings })
    }
}

impl Estimator for SelfCalibrated {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn axes(&self) -> Axes {
        Axes::Survey
    }

    fn uses(&self) -> &'static [KnowledgeKind] {
        match self.settings.obstacles {
            ObstacleKnowledge::None | ObstacleKnowledge::FromReceptions => &[KnowledgeKind::RobotReceptions],
            ObstacleKnowledge::FromLog => &[KnowledgeKind::RobotReceptions, KnowledgeKind::RobotPath],
        }
    }

    fn estimate(
        &self,
        knowledge: &Knowledge<'_>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<EstimatorFindings>), MapError> {
        let (map, mut calibration) = self.map(knowledge.log, watch)?;
        if let Some(calibration) = &mut calibration {
            calibration.dependence = calibration.dependence_in(knowledge.log, &map);
        }
        Ok((map, calibration.map(EstimatorFindings::new)))
    }
}

impl EstimatorSettings for SelfCalibratedConfig {
    const ANY_LOG: Option<AnyLog> = Some(AnyLog {
        name: "self-calibrated",
        rank: 4,
        description: "Joint estimate of positions, reception curve, stops and obstacles",
        settings: "{}",
    });

    fn mapper(self) -> Result<Mapper, SettingError> {
        SelfCalibrated::try_from(self).map(Mapper::new)
    }
}
