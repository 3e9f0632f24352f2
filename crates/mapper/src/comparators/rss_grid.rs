//! A Bayesian grid on the signal strengths that the robot measured (Sichitiu and Ramadurai 2004).

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_channel::{Position, Reception, Stop};
use sextant_kernel::{NodeId, SettingError};

use super::ranging::{Ranging, RangingConfig};
use crate::lattice::whole;
use crate::local_posterior::covariance;
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
    /// Least power that is received (dBm); in a scenario, that of its radio if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensitivity_dbm: Option<f64>,
    /// Hard communication radius (m); in a scenario, that of its channel if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_range_m: Option<f64>,
    /// Which place is taken from the likelihood.
    #[serde(default = "posterior_mean")]
    pub estimate: EstimateKind,
    /// Lowest and highest height of a node (m); as of `ml_tm` if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub z_range_m: Option<[f64; 2]>,
}

fn posterior_mean() -> EstimateKind {
    EstimateKind::PosteriorMean
}

/// The Bayesian grid: what the robot's receptions tell with their strengths, so what maximum likelihood on receptions
/// alone does without.
///
/// The log-likelihood of a node at a vertex at distance d from a stop is `−(P − m(d))²/2σ²` for a reception of strength
/// P, `m(d)` being the mean strength, and `log Φ((P_min − m(d))/σ)` for a stop without one, zero beyond the hard
/// radius. Each stop counts as one packet. Vertices beyond the hard radius of a stop that heard the node are ruled out, as
/// far as any are left.
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
        if let Some([low, high]) = z_range_m
            && !(low.is_finite() && high.is_finite() && low <= high)
        {
            let allowed = "two finite heights, the lower one first";
            return Err(SettingError::new("z_range_m", format!("[{low}, {high}]"), allowed));
        }
        let grid_step_m = SettingError::positive("grid_step_m", grid_step_m)?;
        Ok(Self { grid_step_m, ranging, sensitivity_dbm, max_range_m, estimate, z_range_m })
    }
}

/// Memory that the shared surface may need (octets).
const ALLOWED_BYTES: u64 = 512_000_000;
/// Distance below which the strength rises no further (m).
const LEAST_M: f64 = 0.1;
/// Standard deviations above the mean that a reception without a hard radius is credited with.
const REACH_SIGMAS: f64 = 3.0;
/// Cells of the tables over distance.
const CELLS: usize = 8192;

/// What a stop tells at a distance, tabulated: mean strength (dBm) and log-probability of silence.
struct Curves {
    per_m: f64,
    mean_dbm: Vec<f64>,
    log_silence: Vec<f64>,
}

impl Curves {
    fn at(table: &[f64], place: f64) -> f64 {
        let cell = whole(place).min(CELLS - 1);
        let within = place - cell as f64;
        table[cell] + within.min(1.0) * (table[cell + 1] - table[cell])
    }
}

impl RssGrid {
    /// The algorithm's name in tables and topics.
    pub const NAME: &'static str = "rss-grid";

    /// What it uses.
    pub const USES: &'static [KnowledgeKind] = &[KnowledgeKind::RobotRssi, KnowledgeKind::PathLoss];

    /// Distance within which nodes are heard (m).
    fn range_m(&self) -> f64 {
        self.max_range_m
            .unwrap_or_else(|| self.ranging.distance_m(self.sensitivity_dbm - REACH_SIGMAS * self.ranging.sigma_db()))
    }

    fn curves(&self, longest_m: f64) -> Curves {
        let distance_m = |cell: usize| longest_m * cell as f64 / CELLS as f64;
        let mean_dbm: Vec<f64> =
            (0..=CELLS).map(|cell| self.ranging.power_dbm(distance_m(cell).max(LEAST_M))).collect();
        let log_silence = mean_dbm.iter().map(|mean_dbm| {
            let margin = (mean_dbm - self.sensitivity_dbm) / self.ranging.sigma_db();
            log_normal_tail(margin)
        });
        let per_m = CELLS as f64 / longest_m;
        Curves { per_m, log_silence: log_silence.collect(), mean_dbm }
    }

    /// The map, computed on the current rayon pool; the same bits for any number of threads. Nodes that were never heard
    /// with a strength are not placed.
    ///
    /// # Errors
    /// [`MapError::GridTooLarge`].
    pub fn map(&self, knowledge: &Knowledge<'_>) -> Result<TopologyMap, MapError> {
        let log = knowledge.log;
        let mut map = TopologyMap::of_places(Self::NAME, vec![None; log.node_count()], CoordinateFrame::World);
        map.grid_step_m = Some(self.grid_step_m);
        if log.stops().is_empty() {
            return Ok(map);
        }
        let range_m = self.range_m();
        map.heights = SoughtHeights::of(log.stops(), self.z_range_m, range_m);
        let lattice = Lattice::covering(log.stops(), range_m, self.grid_step_m, self.z_range_m, ALLOWED_BYTES)?;
        let bytes = lattice.len().saturating_mul(8);
        if bytes > ALLOWED_BYTES {
            let (vertices, excess) = (lattice.len() as f64, bytes as f64 / ALLOWED_BYTES as f64);
            return Err(MapError::GridTooLarge {
                vertices,
                bytes,
                allowed_bytes: ALLOWED_BYTES,
                step_m: self.grid_step_m,
                suggested_step_m: self.grid_step_m * excess.sqrt().ceil(),
            });
        }
        let grid = Grid {
            curves: self.curves(range_m + 2.0 * lattice.half_diagonal_m()),
            lattice: &lattice,
            stops: log.stops(),
            range_m,
            variance: self.ranging.sigma_db().powi(2),
        };
        let silence = grid.silence();
        let solved: Vec<(Option<Estimate>, u64)> = (0..log.node_count())
            .into_par_iter()
            .map(|node| {
                let heard: Vec<Reception> = log
                    .of(NodeId::from_index(node))
                    .iter()
                    .filter(|r| r.received > 0 && r.rssi_dbm.is_some())
                    .collect();
                grid.estimate(&heard, &silence, self.estimate)
            })
            .collect();
        for (slot, (estimate, evaluated)) in map.estimates.iter_mut().zip(solved) {
            *slot = estimate;
            map.vertices_evaluated += evaluated;
        }
        Ok(map)
    }
}

/// `log Φ(−x)`, also where Φ underflows.
fn log_normal_tail(x: f64) -> f64 {
    if x < 30.0 {
        libm::log(0.5 * libm::erfc(x / std::f64::consts::SQRT_2))
    } else {
        // Φ(−x) ≈ φ(x)/x with a relative error below 1/x².
        -0.5 * x * x - libm::log(x * (2.0 * std::f64::consts::PI).sqrt())
    }
}

/// A survey on a lattice.
struct Grid<'a> {
    curves: Curves,
    lattice: &'a Lattice,
    stops: &'a [Stop],
    range_m: f64,
    variance: f64,
}

impl Grid<'_> {
    /// Log-likelihood at each vertex of a node that no stop heard.
    fn silence(&self) -> Vec<f64> {
        let [columns, rows, layers] = self.lattice.counts();
        let mut silence = vec![0.0; columns * rows * layers];
        silence.par_chunks_mut(columns).enumerate().for_each(|(row, values)| {
            let (j, k) = (row % rows, row / rows);
            for stop in self.stops {
                let first = self.lattice.position([0, j, k]);
                let across_m = (first.y_m - stop.position.y_m).hypot(first.z_m - stop.position.z_m);
                if across_m > self.range_m {
                    continue;
                }
                let half_m = (self.range_m * self.range_m - across_m * across_m).sqrt();
                let (span, _) = self.lattice.span(0, stop.position.x_m - half_m, stop.position.x_m + half_m);
                for i in span {
                    let along_m = self.lattice.coordinate(0, i) - stop.position.x_m;
                    values[i] += Curves::at(&self.curves.log_silence, along_m.hypot(across_m) * self.curves.per_m);
                }
            }
        });
        silence
    }

    fn estimate(&self, heard: &[Reception], silence: &[f64], kind: EstimateKind) -> (Option<Estimate>, u64) {
        let slack_m = self.range_m + self.lattice.half_diagonal_m();
        let stops: Vec<(Position, f64)> = heard
            .iter()
            .filter_map(|reception| Some((self.stops[reception.stop as usize].position, reception.rssi_dbm?)))
            .collect();
        let Some(&(strongest, _)) = stops.iter().max_by(|a, b| a.1.total_cmp(&b.1)) else { return (None, 0) };
        let whole_box = |within: &[(Position, f64)]| {
            [0, 1, 2].map(|axis| {
                let along = |place: Position| <[f64; 3]>::from(place)[axis];
                let low = within.iter().map(|stop| along(stop.0) - slack_m).fold(f64::NEG_INFINITY, f64::max);
                let high = within.iter().map(|stop| along(stop.0) + slack_m).fold(f64::INFINITY, f64::min);
                self.lattice.span(axis, low, high).0
            })
        };
        let (found, evaluated) = self.search(whole_box(&stops), &stops, silence, true);
        if let Some(surface) = found {
            return (Some(surface.estimate(kind, false)), evaluated);
        }
        // No vertex is in reach of all: round the strongest, ruling nothing out.
        let (found, further) = self.search(whole_box(&[(strongest, 0.0)]), &stops, silence, false);
        (found.map(|surface| surface.estimate(kind, true)), evaluated + further)
    }

    /// The log-likelihoods in a box of vertices; `None` if all are ruled out.
    fn search(
        &self,
        [xs, ys, zs]: [std::ops::Range<usize>; 3],
        stops: &[(Position, f64)],
        silence: &[f64],
        rules_out: bool,
    ) -> (Option<SearchedSurface>, u64) {
        let [columns, rows, _] = self.lattice.counts();
        let slack_m = self.range_m + self.lattice.half_diagonal_m();
        let mut surface = SearchedSurface { vertices: Vec::new() };
        for k in zs {
            for j in ys.clone() {
                for i in xs.clone() {
                    let place = self.lattice.position([i, j, k]);
                    let mut value = silence[(k * rows + j) * columns + i];
                    let mut is_ruled_out = false;
                    for &(stop, rssi_dbm) in stops {
                        let distance_m = place.distance_m(stop);
                        is_ruled_out |= distance_m > slack_m;
                        let at = distance_m * self.curves.per_m;
                        let misfit = rssi_dbm - Curves::at(&self.curves.mean_dbm, at);
                        value -= 0.5 * misfit * misfit / self.variance;
                        if distance_m <= self.range_m {
                            value -= Curves::at(&self.curves.log_silence, at);
                        }
                    }
                    if !(rules_out && is_ruled_out) {
                        surface.vertices.push((place, value));
                    }
                }
            }
        }
        let evaluated = surface.vertices.len() as u64;
        ((evaluated > 0).then_some(surface), evaluated)
    }
}

/// Vertices with their log-likelihoods, at least one.
struct SearchedSurface {
    vertices: Vec<(Position, f64)>,
}

impl SearchedSurface {
    fn estimate(&self, kind: EstimateKind, infeasible: bool) -> Estimate {
        let mut best = self.vertices[0];
        for &vertex in &self.vertices {
            if vertex.1 > best.1 {
                best = vertex;
            }
        }
        let (position, covariance) = match kind {
            EstimateKind::Argmax => (best.0, None),
            EstimateKind::PosteriorMean => {
                let weights =
                    || self.vertices.iter().map(|&(place, value)| (place - best.0, libm::exp(value - best.1)));
                let total: f64 = weights().map(|(_, weight)| weight).sum();
                let mean = weights().fold(Position::ORIGIN, |sum, (offset, weight)| sum + offset * (weight / total));
                let apart = weights().map(|(offset, weight)| (offset - mean, weight / total));
                (best.0 + mean, Some(covariance(apart)))
            }
        };
        Estimate { position, log_likelihood: Some(best.1), ties: 1, covariance, infeasible }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tail_of_the_normal_law_is_smooth_where_it_underflows() {
        // Values of scipy.stats.norm.logcdf (SciPy 1.17).
        for (x, expected) in [(5.0, -15.064_998_393_988_727), (-2.0, -0.023_012_909_328_963_487)] {
            assert!((log_normal_tail(x) - expected).abs() < 1e-12, "{x}");
        }
        let step = log_normal_tail(30.0 - 1e-9) - log_normal_tail(30.0);
        assert!(step.abs() < 2e-3, "{step}");
        assert!((log_normal_tail(40.0) / -804.608_442_014_199_9 - 1.0).abs() < 1e-5);
    }
}
