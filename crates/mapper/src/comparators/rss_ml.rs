//! Cooperative maximum likelihood on signal strengths (Patwari et al. 2003): all places at once.

use nalgebra::{Matrix3, Vector3};
use sextant_channel::{Link, Position};
use sextant_kernel::{Interrupted, SettingError, Watch, Work};

use super::centroid::weighted_mean;
use crate::comparators::Comparator;
use crate::error::MapError;
use crate::estimator::{EstimatorSettings, Mapper};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::numerics::least_squares::{Damping, LeastSquares, minimum};
use crate::ranging::{Ranging, RangingConfig};
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// Cooperative maximum likelihood as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RssMlConfig {
    /// How power falls with distance.
    pub ranging: RangingConfig,
    /// Maximum number of steps, 1 or more.
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub steps: u32,
}

impl Default for RssMlConfig {
    fn default() -> Self {
        Self { ranging: RangingConfig::default(), steps: 200 }
    }
}

/// Cooperative maximum likelihood: the minimum of `Σ k (P − P_tx + 10 n log₁₀ |x_i − x_j|/d₀)²` over the places of
/// all nodes that are no anchors, the sum being over all links, between nodes and with anchors, of k packets of mean
/// strength P. Packets that were not received are ignored, so far links look too strong.
///
/// The method is that of Levenberg and Marquardt. The normal equations are solved by conjugate gradients, without
/// forming their matrix. The start of a node is the centroid of the anchors that it heard, weighted by the inverse
/// squared distance, or that of neighbours placed before it. The result is a local minimum near this start. Nodes
/// without a chain of links to an anchor are not placed. Anchors keep their known places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RssMl {
    ranging: Ranging,
    steps: u32,
}

impl TryFrom<RssMlConfig> for RssMl {
    type Error = SettingError;

    fn try_from(config: RssMlConfig) -> Result<Self, SettingError> {
        if config.steps == 0 {
            return Err(SettingError::new("steps", 0, "1 or more"));
        }
        let ranging = Ranging::try_from(config.ranging).map_err(|error| error.within("ranging"))?;
        Ok(Self { ranging, steps: config.steps })
    }
}

/// Two nodes count as at least this far apart (m).
const LEAST_M: f64 = 1e-3;
/// A step shorter than this is the last (m).
const SMALL_M: f64 = 1e-9;

const DAMPING: Damping = Damping { first: 1e-2, ease: 0.3, least: 1e-12, tighten: 6.0, most: 1e12 };

/// A measured link; ends are nodes.
#[derive(Clone, Copy, Debug)]
struct Measured {
    a: usize,
    b: usize,
    rssi_dbm: f64,
    /// Square root of the number of packets.
    weight: f64,
}

impl Comparator for RssMl {
    const NAME: &'static str = "rss-ml";

    fn uses(&self) -> &'static [KnowledgeKind] {
        &[KnowledgeKind::NeighbourRssi, KnowledgeKind::AnchorRssi, KnowledgeKind::Anchors, KnowledgeKind::PathLoss]
    }

    fn least_anchors(&self, dimensions: usize) -> usize {
        dimensions + 1
    }

    /// The map.
    ///
    /// # Errors
    /// [`MapError::Missing`] without what was heard of neighbours and anchors; [`MapError::TooFewAnchors`] below three, in
    /// space four; [`MapError::Interrupted`].
    fn map(&self, knowledge: &Knowledge<'_>, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
        let dimensions = knowledge.dimensions();
        knowledge.anchors(Self::NAME, dimensions + 1)?;
        let known = knowledge.known_places();
        let logs = [knowledge.neighbours(Self::NAME)?, knowledge.beacons(Self::NAME)?];
        let measured = |link: &Link| {
            Some(Measured {
                a: link.listener.index(),
                b: link.sender.index(),
                rssi_dbm: link.rssi_dbm?,
                weight: f64::from(link.received).sqrt(),
            })
        };
        let links: Vec<Measured> = logs.iter().flat_map(|log| log.links()).filter_map(measured).collect();
        let start = self.start(&known, &links, watch)?;
        // Links between two anchors give no information. Nodes without a start are left out.
        let links: Vec<Measured> = links
            .into_iter()
            .filter(|link| start[link.a].is_some() && start[link.b].is_some())
            .filter(|link| known[link.a].is_none() || known[link.b].is_none())
            .collect();
        let fit = PlacesFit { ranging: self.ranging, links: &links, known: &known, dimensions, watch };
        // A step takes some rounds of conjugate gradients, at most four per node.
        #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
        let operations = 4.0 * known.len() as f64 * links.len() as f64 * f64::from(self.steps);
        watch.begin(Work { name: Self::NAME, unit: "step", steps: self.steps.into(), operations });
        let first = start.iter().map(|place| place.unwrap_or_default()).collect();
        let places = minimum(&fit, first, DAMPING, self.steps)?;
        let places = start.iter().zip(places).map(|(start, place)| start.map(|_| place)).collect();
        Ok(TopologyMap::of_places(Self::NAME, places, CoordinateFrame::World))
    }
}

impl RssMl {
    /// A first place for each node with a chain of links to an anchor.
    fn start(
        &self,
        known: &[Option<Position>],
        links: &[Measured],
        watch: &dyn Watch,
    ) -> Result<Vec<Option<Position>>, Interrupted> {
        let mut of: Vec<Vec<(usize, f64)>> = vec![Vec::new(); known.len()];
        for link in links {
            let weight = link.weight.powi(2) * self.ranging.distance_m(link.rssi_dbm).powi(-2);
            of[link.a].push((link.b, weight));
            of[link.b].push((link.a, weight));
        }
        let mut places = known.to_vec();
        loop {
            watch.check()?;
            // Each round places the nodes next to those placed before.
            let next: Vec<Option<Position>> = (0..known.len())
                .map(|node| {
                    places[node].or_else(|| {
                        let near = of[node].iter().filter_map(|&(other, weight)| Some((places[other]?, weight)));
                        weighted_mean(&near.collect::<Vec<_>>())
                    })
                })
                .collect();
            if next.iter().flatten().count() == places.iter().flatten().count() {
                return Ok(places);
            }
            places = next;
        }
    }
}

/// A least-squares fit of places to links.
struct PlacesFit<'a> {
    ranging: Ranging,
    links: &'a [Measured],
    known: &'a [Option<Position>],
    dimensions: usize,
    watch: &'a dyn Watch,
}

impl PlacesFit<'_> {
    fn vector(&self, place: Position) -> Vector3<f64> {
        Vector3::new(place.x_m, place.y_m, if self.dimensions == 3 { place.z_m } else { 0.0 })
    }

    /// Residual of a link, and its derivative with respect to the place of the first end. The derivative with respect
    /// to the other end is the negative.
    fn residual(&self, places: &[Position], link: &Measured) -> (f64, Vector3<f64>) {
        let mut apart = self.vector(places[link.a] - places[link.b]);
        let mut distance_m = apart.norm();
        if distance_m < LEAST_M {
            apart = if distance_m > 0.0 { apart * (LEAST_M / distance_m) } else { Vector3::new(LEAST_M, 0.0, 0.0) };
            distance_m = LEAST_M;
        }
        let slope = link.weight * self.ranging.db_per_decade() / std::f64::consts::LN_10;
        let residual = link.weight * (link.rssi_dbm - self.ranging.power_dbm(distance_m));
        (residual, apart * (slope / (distance_m * distance_m)))
    }

    /// Solves `(JᵀJ + μ D) δ = Jᵀ r`, D being the diagonal blocks of `JᵀJ`, by conjugate gradients with these blocks as
    /// the preconditioner.
    fn solved(&self, slopes: &[(f64, Vector3<f64>)], damping: f64) -> Result<Vec<Vector3<f64>>, Interrupted> {
        let nodes = self.known.len();
        let mut blocks = vec![Matrix3::zeros(); nodes];
        let mut rest = vec![Vector3::zeros(); nodes];
        for (link, &(residual, slope)) in self.links.iter().zip(slopes) {
            let square = slope * slope.transpose();
            for (end, sign) in [(link.a, 1.0), (link.b, -1.0)] {
                if self.known[end].is_none() {
                    blocks[end] += square;
                    rest[end] += slope * (sign * residual);
                }
            }
        }
        let inverses: Vec<Matrix3<f64>> = blocks.iter().map(|block| self.inverse(block, damping)).collect();
        let precondition = |rest: &[Vector3<f64>]| -> Vec<Vector3<f64>> {
            rest.iter().zip(&inverses).map(|(rest, inverse)| inverse * rest).collect()
        };
        let mut solution = vec![Vector3::zeros(); nodes];
        let mut preconditioned = precondition(&rest);
        let mut direction = preconditioned.clone();
        let mut product = dot(&rest, &preconditioned);
        let target = product * 1e-20;
        for _ in 0..4 * nodes {
            if product <= target || product <= 0.0 {
                break;
            }
            self.watch.check()?;
            let image = self.normal_product(&direction, slopes, &blocks, damping);
            let length = product / dot(&direction, &image);
            for i in 0..nodes {
                solution[i] += direction[i] * length;
                rest[i] -= image[i] * length;
            }
            preconditioned = precondition(&rest);
            let next = dot(&rest, &preconditioned);
            for (direction, preconditioned) in direction.iter_mut().zip(&preconditioned) {
                *direction = preconditioned + *direction * (next / product);
            }
            product = next;
        }
        Ok(solution)
    }

    /// `(JᵀJ + μ D) x`.
    fn normal_product(
        &self,
        x: &[Vector3<f64>],
        slopes: &[(f64, Vector3<f64>)],
        blocks: &[Matrix3<f64>],
        damping: f64,
    ) -> Vec<Vector3<f64>> {
        let mut image: Vec<Vector3<f64>> = x.iter().zip(blocks).map(|(x, block)| block * x * damping).collect();
        for (link, (_, slope)) in self.links.iter().zip(slopes) {
            let along = slope.dot(&(x[link.a] - x[link.b]));
            if self.known[link.a].is_none() {
                image[link.a] += slope * along;
            }
            if self.known[link.b].is_none() {
                image[link.b] -= slope * along;
            }
        }
        image
    }

    /// The inverse of a damped diagonal block; there is no step along an axis without a slope.
    fn inverse(&self, block: &Matrix3<f64>, damping: f64) -> Matrix3<f64> {
        let mut damped = block * (1.0 + damping);
        let scale = damped.trace();
        if scale <= 0.0 {
            return Matrix3::zeros();
        }
        for axis in 0..3 {
            damped[(axis, axis)] += 1e-12 * scale;
        }
        if self.dimensions == 2 {
            damped[(2, 2)] = scale;
        }
        damped.try_inverse().unwrap_or_else(Matrix3::zeros)
    }
}

impl LeastSquares for PlacesFit<'_> {
    type Point = Vec<Position>;
    type Step = Vec<Vector3<f64>>;
    type Error = Interrupted;

    fn cost(&self, at: &Vec<Position>) -> f64 {
        self.links.iter().map(|link| self.residual(at, link).0.powi(2)).sum()
    }

    fn step(&self, at: &Vec<Position>, damping: f64) -> Result<Option<Vec<Vector3<f64>>>, Interrupted> {
        self.watch.advance(1);
        let slopes: Vec<(f64, Vector3<f64>)> = self.links.iter().map(|link| self.residual(at, link)).collect();
        self.solved(&slopes, damping).map(Some)
    }

    fn moved(&self, at: &Vec<Position>, step: &Vec<Vector3<f64>>) -> Vec<Position> {
        at.iter().zip(step).map(|(&place, step)| place - Position::new(step.x, step.y, step.z)).collect()
    }

    fn is_last(&self, _: &Vec<Position>, step: &Vec<Vector3<f64>>, _: bool) -> bool {
        step.iter().map(Vector3::norm).fold(0.0, f64::max) <= SMALL_M
    }
}

fn dot(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

impl EstimatorSettings for RssMlConfig {
    fn mapper(self) -> Result<Mapper, SettingError> {
        RssMl::try_from(self).map(Mapper::new)
    }

    fn ranging_mut(&mut self) -> Option<&mut RangingConfig> {
        Some(&mut self.ranging)
    }
}
