//! ML-TM under a known channel among known obstacles.

use rayon::prelude::*;
use sextant_channel::{Db, ObstacleField, Position, ReceptionLog, Stop};
use sextant_kernel::{NodeId, SettingError, Watch, Work};

use crate::each_node::EachNode;
use crate::error::MapError;
use crate::estimator::Estimator;
use crate::grid_ml::ml_tm::{MlTm, MlTmConfig};
use crate::grid_ml::ml_tm_parts::fixed;
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::learned::EstimatorFindings;
use crate::log_facts::SoughtHeights;
use crate::log_facts::heights::Heights;
use crate::parts::{FixedLaw, LogParts, PartEstimator, PartsError};
use crate::posterior::{Estimate, EstimateKind, NodeEvidence, local_posterior};
use crate::profile::{ChannelProfileConfig, KnownLink};
use crate::topology_map::TopologyMap;

/// ML-TM under a known channel with known obstacles. The likelihood of a place includes, for each stop, what the
/// obstacles on the straight line to the stop absorb.
///
/// The likelihood is then not a function of distances alone, so nodes do not share a grid. Each node starts at the
/// best place of a coarse scan round its posterior mean without obstacles, within a third of the reach (a fifth in
/// space). A grid round this place is moved, widened and refined until it holds the posterior. With `argmax` the
/// place is the best vertex of this grid.
#[derive(Clone, Debug)]
pub struct ObstacleMlTm {
    start: MlTm,
    /// The settings of the channel, from which [`link`](Self::link) was made.
    channel: ChannelProfileConfig,
    link: KnownLink,
    estimate: EstimateKind,
    z_range_m: Option<[f64; 2]>,
}

/// The data that all nodes share.
#[derive(Clone, Copy)]
struct SharedByNodes<'a> {
    log: &'a ReceptionLog,
    obstacles: &'a ObstacleField,
    heights: Heights,
    watch: &'a dyn Watch,
}

/// First guess of how far a posterior spreads (m).
const SPREAD_M: f64 = 0.3;
/// Step of the coarse scan, as a share of the reach, and steps to each side of the start in the plane and in space.
const SCAN_STEP: f64 = 0.05;
const SCAN: [i32; 2] = [6, 4];
/// Least step of a node's grid (m).
const LEAST_STEP_M: f64 = 0.01;

impl ObstacleMlTm {
    /// The algorithm with the settings of `config` under the channel of `channel`.
    ///
    /// # Errors
    /// If a value is invalid, or a value of the channel is absent.
    pub fn new(config: MlTmConfig, channel: &ChannelProfileConfig) -> Result<Self, SettingError> {
        let link = channel.link().map_err(|error| error.within("profile.channel"))?;
        let (estimate, z_range_m) = (config.estimate, config.z_range_m);
        let start = MlTm::try_from(MlTmConfig { estimate: EstimateKind::PosteriorMean, ..config })?;
        Ok(Self { start, channel: channel.clone(), link, estimate, z_range_m })
    }

    /// The map of the nodes in `log`, which were heard among `obstacles`.
    ///
    /// # Errors
    /// [`MapError::GridTooLarge`]; [`MapError::Interrupted`].
    pub fn map(
        &self,
        log: &ReceptionLog,
        obstacles: &ObstacleField,
        watch: &dyn Watch,
    ) -> Result<TopologyMap, MapError> {
        let log = &*self.start.counted(log);
        let start = self.start.map(log, watch)?;
        let Some(heights) = start.heights.map(SoughtHeights::heights) else { return Ok(start) };
        let obstacles = &obstacles.at_carrier(self.link.carrier_ghz());
        watch.begin(self.work(log, &start, heights));
        let estimates: Result<Vec<Option<Estimate>>, MapError> = (start.estimates.par_iter().enumerate())
            .map(|(node, start)| {
                watch.check()?;
                let Some(start) = start else { return Ok(None) };
                let among = SharedByNodes { log, obstacles, heights, watch };
                let found = self.place(&among, NodeId::from_index(node), start.position);
                watch.check()?;
                watch.advance(1);
                Ok(Some(found.unwrap_or_else(|| Estimate { infeasible: true, ..start.clone() })))
            })
            .collect();
        Ok(TopologyMap { estimates: estimates?, ..start })
    }

    /// The work of the search round each place of the map `start`, if all stops are in reach.
    fn work(&self, log: &ReceptionLog, start: &TopologyMap, heights: Heights) -> Work {
        let places = match heights {
            Heights::Level(_) => (2 * SCAN[0] + 1).pow(2),
            Heights::Between(..) => (2 * SCAN[1] + 1).pow(3),
        };
        #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
        let operations = start.mapped() as f64 * f64::from(2 * places) * log.stops().len() as f64;
        Work { name: "ml-tm among obstacles", unit: "node", steps: start.mapped() as u64, operations }
    }

    /// The estimate of a node. If the work was ended meanwhile, the result means nothing.
    fn place(&self, among: &SharedByNodes<'_>, node: NodeId, near: Position) -> Option<Estimate> {
        let SharedByNodes { log, obstacles, heights, watch } = *among;
        let evidence = NodeEvidence::near(log, node, near, self.link.reach_m())?;
        let stops = log.stops();
        let (floor, ceiling) = (self.channel.floor, self.channel.ceiling);
        let log_likelihood = |place: Position| {
            if watch.is_stopped() {
                return f64::NEG_INFINITY;
            }
            evidence.log_likelihood(|stop| {
                let stop = stops[stop as usize].position;
                let loss = if obstacles.is_empty() { Db(0.0) } else { obstacles.loss(place, stop) };
                self.link.probability(place.distance_m(stop), loss).clamp(floor, ceiling)
            })
        };
        let summit = self.scan(near, heights, &log_likelihood);
        let found = local_posterior(heights, summit, [SPREAD_M; 3], LEAST_STEP_M, &log_likelihood)?;
        let best = found.likeliest();
        Some(found.estimate(self.estimate, (best, log_likelihood(best))))
    }

    /// The likeliest place on a coarse grid round `near`, including `near` itself.
    fn scan(&self, near: Position, heights: Heights, log_likelihood: &impl Fn(Position) -> f64) -> Position {
        let step_m = SCAN_STEP * self.link.reach_m();
        let (steps, layers) = match heights {
            Heights::Level(_) => (SCAN[0], 0),
            Heights::Between(..) => (SCAN[1], SCAN[1]),
        };
        let mut best = (near, log_likelihood(near));
        for k in -layers..=layers {
            let z_m = heights.clamp(near.z_m + step_m * f64::from(k));
            for j in -steps..=steps {
                for i in -steps..=steps {
                    let place =
                        Position::new(near.x_m + step_m * f64::from(i), near.y_m + step_m * f64::from(j), z_m);
                    let value = log_likelihood(place);
                    if value > best.1 {
                        best = (place, value);
                    }
                }
            }
        }
        best.0
    }
}

impl PartialEq for ObstacleMlTm {
    fn eq(&self, other: &Self) -> bool {
        let settings = |this: &Self| (this.estimate, this.z_range_m);
        settings(self) == settings(other) && self.start == other.start && self.channel == other.channel
    }
}

impl Estimator for ObstacleMlTm {
    fn name(&self) -> &'static str {
        MlTm::NAME
    }

    fn uses(&self) -> &'static [KnowledgeKind] {
        &[KnowledgeKind::RobotReceptions, KnowledgeKind::PathLoss, KnowledgeKind::Obstacles]
    }

    fn by_parts(&self) -> Option<&dyn PartEstimator> {
        Some(self)
    }

    fn check_grid(&self, stops: &[Stop]) -> Result<(), MapError> {
        self.start.check_grid(stops)
    }

    fn estimate(
        &self,
        knowledge: &Knowledge<'_>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<EstimatorFindings>), MapError> {
        self.map(knowledge.log, knowledge.obstacles(MlTm::NAME)?, watch).map(|map| (map, None))
    }
}

impl PartEstimator for ObstacleMlTm {
    fn fix<'a>(
        &'a self,
        parts: &dyn LogParts,
        knowledge: &'a Knowledge<'a>,
        watch: &dyn Watch,
    ) -> Result<Box<dyn FixedLaw + 'a>, PartsError> {
        let estimator = Self { start: fixed(&self.start, parts, watch)?, ..self.clone() };
        Ok(Box::new(EachNode { estimator, knowledge }))
    }
}

#[cfg(test)]
mod tests {
    use sextant_channel::{BoxConfig, Obstacle, ObstacleConfig, Reception, ShapeConfig, Stop};
    use sextant_kernel::{RobotId, SimTime, Unwatched};

    use super::*;
    use crate::profile::{ObstacleUse, ProfileConfig};

    fn channel() -> ChannelProfileConfig {
        ChannelProfileConfig {
            exponent: Some(2.7),
            sigma_db: Some(6.0),
            tx_power_dbm: Some(-50.0),
            sensitivity_dbm: Some(-80.0),
            max_range_m: Some(10.0),
            obstacles: ObstacleUse::Known,
            ..ChannelProfileConfig::default()
        }
    }

    fn algorithm() -> ObstacleMlTm {
        let config = MlTmConfig {
            estimate: EstimateKind::PosteriorMean,
            ..MlTmConfig::new(0.25, ProfileConfig::Channel(channel()))
        };
        ObstacleMlTm::new(config, &channel()).expect("good settings")
    }

    /// A wall 1 m thick that almost no packet passes.
    fn wall() -> ObstacleField {
        let shape = BoxConfig { center_m: Position::new(3.0, 0.0, 0.0), size_m: [1.0, 12.0, 4.0], yaw_deg: 0.0 };
        let config = ObstacleConfig {
            name: None,
            shape: ShapeConfig::Box(shape),
            material: None,
            absorption_per_m: Some(10.0),
            loss_db: None,
            solid: true,
            reflection_loss_db: None,
        };
        ObstacleField::new(vec![Obstacle::try_from(config).expect("a good obstacle")])
    }

    /// Stops on both sides of the wall; each hears the node, at `place`, if that is likelier than not.
    fn log(place: Position, obstacles: &ObstacleField) -> ReceptionLog {
        let at = |i: i32, j: i32| Position::new(f64::from(i), f64::from(j), 0.0);
        let stops: Vec<Stop> = (-10..=14)
            .flat_map(|i| (-8..=8).map(move |j| (i, j)))
            .filter(|&(i, _)| i != 3)
            .map(|(i, j)| Stop { robot: RobotId(0), time: SimTime::ZERO, position: at(i, j), heading_rad: None })
            .collect();
        let link = channel().link().expect("a good channel");
        let hears = |stop: &Stop| {
            link.probability(stop.position.distance_m(place), obstacles.loss(stop.position, place)) > 0.5
        };
        let receptions = (0_u32..).zip(&stops).filter(|(_, stop)| hears(stop)).map(|(stop, _)| Reception {
            node: NodeId(0),
            stop,
            received: 1,
            sent: 1,
            sector: None,
            rssi_dbm: None,
            snr_db: None,
        });
        let receptions = receptions.collect();
        ReceptionLog::new(vec!["n".into()], stops, receptions, Vec::new()).expect("a good log")
    }

    #[test]
    fn a_node_behind_a_wall_is_placed_where_the_wall_explains_the_silence() {
        let (place, wall) = (Position::new(1.3, 0.4, 0.0), wall());
        let log = log(place, &wall);
        let error_m = |obstacles: &ObstacleField| {
            let map = algorithm().map(&log, obstacles, &Unwatched).expect("a map");
            map.estimates[0].as_ref().expect("the node was heard").position.distance_m(place)
        };
        let (told, untold) = (error_m(&wall), error_m(&ObstacleField::default()));
        assert!(told < 0.5, "{told} m");
        assert!(untold > 2.0 * told, "{untold} m without the wall, {told} m with it");
    }

    #[test]
    fn without_obstacles_the_place_is_that_of_the_shared_grid() {
        let log = log(Position::new(-2.0, 1.0, 0.0), &ObstacleField::default());
        let algorithm = algorithm();
        let place = |map: TopologyMap| map.estimates[0].as_ref().expect("the node was heard").position;
        let (own, shared) = (
            place(algorithm.map(&log, &ObstacleField::default(), &Unwatched).expect("a map")),
            place(algorithm.start.map(&log, &Unwatched).expect("a map")),
        );
        // The tolerance is half the diagonal of a cell of the shared grid, which averages over its cells.
        assert!(own.distance_m(shared) < 0.18, "{own:?} {shared:?}");
    }
}
