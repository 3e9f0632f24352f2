//! The place, power and path-loss exponent of each node that fit its strengths best.

use std::cell::RefCell;
use std::convert::Infallible;

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;
use sextant_channel::Position;
use sextant_kernel::maths::ln_each;
use sextant_kernel::{SettingError, Watch, Work};

use super::rssi_centroid::{DEFAULT_G, centroid};
use crate::comparators::Comparator;
use crate::error::MapError;
use crate::estimator::{AnyLog, EstimatorSettings, Mapper};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::log_facts::SoughtHeights;
use crate::log_facts::heights::check_z_range;
use crate::log_facts::reach::{heard_nodes, reach_m};
use crate::log_facts::search_box::{Limits, SearchBox};
use crate::log_facts::strengths::{Strength, all_strengths};
use crate::numerics::least_squares::{Damping, LeastSquares, minimum};
use crate::numerics::sums::{dot, sum};
use crate::posterior::Concern;
use crate::survey_frame::Axes;
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// The least-squares fit as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LogDistanceConfig {
    /// Lowest and highest path-loss exponent of a node: above 0, at most 10.
    pub exponents: [f64; 2],
    /// Lowest and highest height of a node (m). If absent, nodes are at the height of the stops if these are nearly level.
    #[cfg_attr(feature = "config", serde(skip_serializing_if = "Option::is_none"))]
    pub z_range_m: Option<[f64; 2]>,
}

impl Default for LogDistanceConfig {
    fn default() -> Self {
        Self { exponents: [1.0, 10.0], z_range_m: None }
    }
}

/// Non-linear least squares: the minimum of `Σ (P_i − P₀ + 10 n log₁₀ d_i)²` over the place of a node, its power P₀ at one
/// metre and its exponent n, P_i being the strengths at distances d_i (Li 2006, with an exponent for each node).
///
/// Power and exponent follow from the place by linear regression, so only the place is searched for: on a grid over the box
/// in which the node may be, then from the best vertices of the grid by Levenberg and Marquardt's method (variable
/// projection: Golub and Pereyra 1973, Kaufman 1975). A node with fewer strengths than there are unknowns is at its RSSI
/// centroid, with a concern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogDistance {
    exponents: [f64; 2],
    z_range_m: Option<[f64; 2]>,
}

/// Below this distance strength is constant (m).
const LEAST_M: f64 = 0.1;
/// Vertices of the grid along each axis, in the plane and in space.
const VERTICES: [u32; 2] = [24, 12];
/// Vertices from which the search goes on.
const STARTS: usize = 4;
/// Steps of a search.
const STEPS: u32 = 60;
/// Steps shorter than this are the last (m).
const SMALL_M: f64 = 1e-6;
/// Grid steps over the reach, for the judgement whether stops are level.
const STEPS_PER_REACH: f64 = 60.0;
const DAMPING: Damping = Damping { first: 1e-3, ease: 0.2, least: 1e-12, tighten: 5.0, most: 1e10 };

impl TryFrom<LogDistanceConfig> for LogDistance {
    type Error = SettingError;

    fn try_from(LogDistanceConfig { exponents, z_range_m }: LogDistanceConfig) -> Result<Self, SettingError> {
        let [low, high] = exponents;
        if !(low > 0.0 && low <= high && high <= 10.0) {
            let allowed = "two numbers above 0, at most 10, the lower one first";
            return Err(SettingError::new("exponents", format!("[{low}, {high}]"), allowed));
        }
        check_z_range(z_range_m)?;
        Ok(Self { exponents, z_range_m })
    }
}

impl Comparator for LogDistance {
    const NAME: &'static str = "least-squares";

    fn uses(&self) -> &'static [KnowledgeKind] {
        &[KnowledgeKind::RobotRssi]
    }

    fn axes(&self) -> Axes {
        Axes::Survey
    }

    /// The map. Nodes that were never heard with a strength are not placed. The result is bit-identical for any number of
    /// threads.
    ///
    /// # Errors
    /// [`MapError::Missing`] if the log has no strengths; [`MapError::Interrupted`].
    fn map(&self, knowledge: &Knowledge<'_>, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
        let log = knowledge.log;
        let nodes = all_strengths(Self::NAME, log)?;
        let mut map = TopologyMap::of_places(Self::NAME, vec![None; nodes.len()], CoordinateFrame::World);
        let heard = heard_nodes(log);
        let reach_m = reach_m(log, &heard);
        let step_m = reach_m / STEPS_PER_REACH;
        let Some(heights) = SoughtHeights::of_log(log.stops(), self.z_range_m, reach_m, step_m) else {
            return Ok(map);
        };
        map.heights = Some(heights);
        let limits = Limits::new(log, reach_m, heights);
        let operations = heard.len() as f64 * log.stops().len() as f64 * 1e5;
        watch.begin(Work { name: Self::NAME, unit: "node", steps: heard.len() as u64, operations });
        let places: Result<Vec<_>, MapError> = heard
            .par_iter()
            .map(|heard| {
                watch.check()?;
                watch.advance(1);
                let within = limits.of(heard);
                Ok(self.place(&nodes[heard.node.index()], &within))
            })
            .collect();
        watch.check()?;
        let places = places?;
        let found = heard.iter().zip(&places).filter_map(|(heard, place)| Some((heard.node, (*place)?)));
        let mut by_node = vec![None; nodes.len()];
        found.for_each(|(node, place)| by_node[node.index()] = Some(place));
        let positions = by_node.iter().map(|found| found.map(|(place, _)| place)).collect();
        map.estimates = TopologyMap::of_places(Self::NAME, positions, CoordinateFrame::World).estimates;
        for (estimate, found) in map.estimates.iter_mut().zip(by_node) {
            if let (Some(estimate), Some((_, concern))) = (estimate, found) {
                estimate.concern = concern;
            }
        }
        Ok(map)
    }
}

impl LogDistance {
    /// The place of a node in its box, and why it is not reliable; `None` without strengths.
    fn place(&self, strengths: &[Strength], within: &SearchBox) -> Option<(Position, Option<Concern>)> {
        let middle = centroid(strengths, DEFAULT_G)?;
        let unknowns = if within.is_level() { 4 } else { 5 };
        if strengths.len() < unknowns {
            return Some((middle, Some(Concern::NoEvidence)));
        }
        let fit = LogDistanceFit::new(strengths, self.exponents, within);
        let mut starts: Vec<(f64, Position)> =
            fit.grid().into_iter().chain([within.nearest(middle)]).map(|place| (fit.cost(&place), place)).collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let found = starts.iter().take(STARTS).map(|&(_, start)| {
            let Ok(place) = minimum(&fit, start, DAMPING, STEPS);
            (fit.cost(&place), place)
        });
        let (_, place) = found.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let concern = within.is_at_edge(place, SMALL_M).then_some(Concern::AtEdge);
        Some((place, concern))
    }
}

/// The fit of one node.
struct LogDistanceFit<'a> {
    /// Coordinates of the stops (m).
    x_m: Vec<f64>,
    y_m: Vec<f64>,
    z_m: Vec<f64>,
    /// Strengths, less their mean (dB), and the sum of their squares.
    over_mean_db: Vec<f64>,
    squares_db2: f64,
    exponents: [f64; 2],
    within: &'a SearchBox,
    /// Logarithms of the distances from the place that is looked at.
    logarithms: RefCell<Vec<f64>>,
}

/// The regression of strengths on the logarithms of the distances from a place.
struct Regression {
    /// The fall of strength (dB) for each e-fold of distance.
    fall_db: f64,
    /// Sums of the squared logarithms and of their products with the strengths, both less their means.
    squares: f64,
    products_db: f64,
    /// Whether the exponent is within its bounds.
    is_free: bool,
}

/// The fall of strength for each e-fold of distance, of an exponent of 1 (dB).
const FALL_DB: f64 = 10.0 * std::f64::consts::LOG10_E;

impl<'a> LogDistanceFit<'a> {
    fn new(strengths: &[Strength], exponents: [f64; 2], within: &'a SearchBox) -> Self {
        let along = |of: fn(&Position) -> f64| strengths.iter().map(|strength| of(&strength.place)).collect();
        let strengths_dbm: Vec<f64> = strengths.iter().map(|strength| strength.rssi_dbm).collect();
        let mean_dbm = sum(&strengths_dbm) / strengths.len() as f64;
        let over_mean_db: Vec<f64> = strengths_dbm.iter().map(|dbm| dbm - mean_dbm).collect();
        Self {
            x_m: along(|place| place.x_m),
            y_m: along(|place| place.y_m),
            z_m: along(|place| place.z_m),
            squares_db2: dot(&over_mean_db, &over_mean_db),
            over_mean_db,
            exponents,
            within,
            logarithms: RefCell::new(vec![0.0; strengths.len()]),
        }
    }

    fn count(&self) -> usize {
        self.x_m.len()
    }

    /// The way from a stop to a place (m).
    fn way(&self, stop: usize, place: Position) -> Vector3<f64> {
        Vector3::new(place.x_m - self.x_m[stop], place.y_m - self.y_m[stop], place.z_m - self.z_m[stop])
    }

    /// Writes the logarithms of the distances (m) from `place`, less their mean.
    fn take_logarithms(&self, place: Position, logarithms: &mut [f64]) {
        let stops = self.x_m.iter().zip(&self.y_m).zip(&self.z_m);
        for (own, ((x_m, y_m), z_m)) in logarithms.iter_mut().zip(stops) {
            let (x, y, z) = (place.x_m - x_m, place.y_m - y_m, place.z_m - z_m);
            *own = (x * x + y * y + z * z).max(LEAST_M * LEAST_M);
        }
        ln_each(logarithms);
        let mean = sum(logarithms) / logarithms.len() as f64;
        logarithms.iter_mut().for_each(|own| *own = 0.5 * (*own - mean));
    }

    fn regression(&self, logarithms: &[f64]) -> Regression {
        let squares = dot(logarithms, logarithms);
        let products_db = dot(logarithms, &self.over_mean_db);
        let [low_db, high_db] = self.exponents.map(|exponent| FALL_DB * exponent);
        let best_db = if squares > 0.0 { -products_db / squares } else { low_db };
        let is_free = squares > 0.0 && best_db > low_db && best_db < high_db;
        Regression { fall_db: best_db.clamp(low_db, high_db), squares, products_db, is_free }
    }

    /// The middles of the cells of a grid over the box.
    fn grid(&self) -> Vec<Position> {
        let count = VERTICES[usize::from(!self.within.is_level())];
        let counts = [count, count, if self.within.is_level() { 1 } else { count }];
        let SearchBox { low, high, .. } = *self.within;
        let along = |axis: usize, i: u32| {
            low[axis] + (f64::from(i) + 0.5) / f64::from(counts[axis]) * (high[axis] - low[axis])
        };
        let mut places = Vec::new();
        for k in 0..counts[2] {
            for j in 0..counts[1] {
                places.extend((0..counts[0]).map(|i| Position::new(along(0, i), along(1, j), along(2, k))));
            }
        }
        places
    }
}

impl LeastSquares for LogDistanceFit<'_> {
    type Point = Position;
    type Step = Vector3<f64>;
    type Error = Infallible;

    fn cost(&self, at: &Position) -> f64 {
        let mut logarithms = self.logarithms.borrow_mut();
        self.take_logarithms(*at, &mut logarithms);
        let Regression { fall_db, squares, products_db, .. } = self.regression(&logarithms);
        self.squares_db2 + fall_db * (2.0 * products_db + fall_db * squares)
    }

    fn step(&self, at: &Position, damping: f64) -> Result<Option<Vector3<f64>>, Infallible> {
        let mut logarithms = self.logarithms.borrow_mut();
        self.take_logarithms(*at, &mut logarithms);
        let law = self.regression(&logarithms);
        let is_level = self.within.is_level();
        let slope = |stop: usize| {
            let mut way = self.way(stop, *at);
            let square = way.norm_squared();
            if square < LEAST_M * LEAST_M {
                return Vector3::zeros();
            }
            if is_level {
                way.z = 0.0;
            }
            way * (law.fall_db / square)
        };
        // The parts of the slopes that power and exponent can follow do not count (Kaufman).
        let (mut total, mut along) = (Vector3::zeros(), Vector3::zeros());
        for (stop, logarithm) in logarithms.iter().enumerate() {
            let slope = slope(stop);
            total += slope;
            along += slope * *logarithm;
        }
        let mean = total / self.count() as f64;
        let along = if law.is_free { along / law.squares } else { Vector3::zeros() };
        let mut normal = Matrix3::zeros();
        let mut gradient = Vector3::zeros();
        for (stop, (logarithm, over_mean_db)) in logarithms.iter().zip(&self.over_mean_db).enumerate() {
            let residual = over_mean_db + law.fall_db * logarithm;
            let row = slope(stop) - mean - along * *logarithm;
            normal += row * row.transpose();
            gradient += row * residual;
        }
        let scale = normal.trace().max(f64::MIN_POSITIVE);
        let damped = normal + Matrix3::identity() * (damping * scale);
        Ok(damped.cholesky().map(|cholesky| cholesky.solve(&gradient)))
    }

    fn moved(&self, at: &Position, step: &Vector3<f64>) -> Position {
        self.within.nearest(*at - Position::new(step.x, step.y, step.z))
    }

    fn is_last(&self, at: &Position, step: &Vector3<f64>, _: bool) -> bool {
        self.moved(at, step).distance_m(*at) <= SMALL_M
    }
}

impl EstimatorSettings for LogDistanceConfig {
    const ANY_LOG: Option<AnyLog> = Some(AnyLog {
        name: "least-squares",
        rank: 8,
        description: "Place, power and path-loss exponent of each node that fit its strengths best",
        settings: "{}",
    });

    fn mapper(self) -> Result<Mapper, SettingError> {
        LogDistance::try_from(self).map(Mapper::new)
    }
}

#[cfg(test)]
mod tests {
    use sextant_kernel::{Purpose, Seed};

    use super::super::tests::{log_of, map, square};
    use super::*;
    use crate::algorithm::AlgorithmConfig;

    #[test]
    fn exact_strengths_of_any_power_and_exponent_give_the_exact_place() {
        for (draw, (power_dbm, exponent)) in (0..).zip([(-40.0, 2.0), (-55.0, 3.7), (3.0, 1.6), (-20.0, 5.5)]) {
            for (inside, height_m) in [(12.0, 0.0), (14.0, 0.0), (12.0, 3.0)] {
                let axis = |axis| inside * Seed(5).uniform(Purpose::new(1), [draw, axis, 0]);
                let node = Position::new(axis(0), axis(1), height_m);
                // Stops at two heights if the node is not on the ground.
                let lift = |(i, place): (usize, &Position)| {
                    if height_m > 0.0 && i % 2 == 1 { *place + Position::new(0.0, 0.0, 6.0) } else { *place }
                };
                let places: Vec<Position> = square().iter().enumerate().map(lift).collect();
                let law =
                    |stop: Position| Some(power_dbm - 10.0 * exponent * libm::log10(stop.distance_m(node).max(0.1)));
                let config = LogDistanceConfig { exponents: [1.5, 6.0], ..LogDistanceConfig::default() };
                let map = map(AlgorithmConfig::LeastSquares(config), &log_of(&places, &[&law]));
                let found = map.estimates[0].as_ref().unwrap();
                assert!(found.position.distance_m(node) < 1e-3, "{} is not {node}", found.position);
                assert_eq!(found.concern, None);
            }
        }
    }

    #[test]
    fn an_exponent_beyond_its_bounds_is_kept_there_and_bounds_are_checked() {
        // Strengths that do not fall with distance: any place far away fits an exponent of zero.
        let log = log_of(&square(), &[&|stop: Position| Some(-60.0 - 0.01 * stop.x_m)]);
        let found = map(AlgorithmConfig::LeastSquares(LogDistanceConfig::default()), &log);
        assert_eq!(found.estimates[0].as_ref().unwrap().concern, Some(Concern::AtEdge));
        for exponents in [[0.0, 2.0], [3.0, 2.0], [2.0, 11.0], [f64::NAN, 2.0]] {
            let refused = LogDistance::try_from(LogDistanceConfig { exponents, z_range_m: None }).unwrap_err();
            assert_eq!(refused.key, "exponents");
        }
    }
}
