//! A Gaussian process over the strengths of each node, which is where the process is greatest.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;
use sextant_channel::Position;
use sextant_kernel::maths::{cholesky, exp_each};
use sextant_kernel::{SettingError, Watch, Work};

use crate::comparators::Comparator;
use crate::error::MapError;
use crate::estimator::{AnyLog, EstimatorSettings, Mapper};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::log_facts::SoughtHeights;
use crate::log_facts::reach::{heard_nodes, reach_m};
use crate::log_facts::strengths::{Strength, all_strengths};
use crate::numerics::sums::dot;
use crate::survey_frame::Axes;
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// The Gaussian process as written in a scenario. It has no settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GaussianProcessConfig {}

/// A Gaussian process with a constant mean and a squared-exponential kernel over the strengths of a node (Ferris, Hähnel and
/// Fox 2006; Rasmussen and Williams 2006, sections 2.2 and 5.4). The node is where the posterior mean is greatest within
/// the box of the stops that received it. Length scale and noise are those of a small grid with the greatest marginal
/// likelihood; mean and variance are then the likeliest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GaussianProcess;

/// Length scales that are tried, in shares of the diagonal of the box.
const LENGTHS: [f64; 6] = [0.05, 0.1, 0.2, 0.35, 0.6, 1.0];
/// Standard deviations of the noise that are tried, relative to that of the process.
const NOISES: [f64; 4] = [0.1, 0.3, 0.7, 1.5];
/// Only so many of the strongest stops count, because the work grows with their third power.
const MOST_STOPS: usize = 200;
/// Cells of a grid along each axis, in the plane and in space.
const CELLS: [u32; 2] = [40, 14];
/// Grids, each over the neighbours of the best vertex of the one before.
const GRIDS: u32 = 3;
/// Grid steps over the reach, for the judgement whether stops are level.
const STEPS_PER_REACH: f64 = 60.0;

impl Comparator for GaussianProcess {
    const NAME: &'static str = "gaussian-process";

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
        let reach_m = reach_m(log, &heard_nodes(log));
        let heights = SoughtHeights::of_log(log.stops(), None, reach_m, reach_m / STEPS_PER_REACH);
        let level_m = heights.filter(|heights| heights.high_m <= heights.low_m).map(|heights| heights.low_m);
        let stops = (log.stops().len().min(MOST_STOPS)) as f64;
        let operations = nodes.len() as f64 * stops.powi(3) * (LENGTHS.len() * NOISES.len()) as f64 / 3.0;
        watch.begin(Work { name: Self::NAME, unit: "node", steps: nodes.len() as u64, operations });
        let places: Result<Vec<Option<Position>>, MapError> = nodes
            .par_iter()
            .map(|strengths| {
                watch.check()?;
                watch.advance(1);
                Ok(peak(strengths, level_m))
            })
            .collect();
        watch.check()?;
        Ok(TopologyMap::of_places(Self::NAME, places?, CoordinateFrame::World))
    }
}

/// Where the process of these strengths is greatest, at the height `level_m` if there is one; `None` without strengths.
fn peak(strengths: &[Strength], level_m: Option<f64>) -> Option<Position> {
    let mut strongest = strongest_first(strengths);
    if let Some(level_m) = level_m {
        strongest.iter_mut().for_each(|strength| strength.place.z_m = level_m);
    }
    let [low, high] = corners(&strongest)?;
    // Strengths at one place, or alike everywhere, have no process.
    let Some(process) = Process::likeliest(&strongest) else { return Some(strongest[0].place) };
    Some(process.greatest(low, high))
}

/// The strengths that count, the greatest first.
pub(crate) fn strongest_first(strengths: &[Strength]) -> Vec<Strength> {
    let mut strongest = strengths.to_vec();
    strongest.sort_by(|a, b| b.rssi_dbm.total_cmp(&a.rssi_dbm));
    strongest.truncate(MOST_STOPS);
    strongest
}

/// The corners of the box of the places; `None` without any.
fn corners(strengths: &[Strength]) -> Option<[[f64; 3]; 2]> {
    let mut low: [f64; 3] = strengths.first()?.place.into();
    let mut high = low;
    for strength in strengths {
        for (axis, along) in <[f64; 3]>::from(strength.place).into_iter().enumerate() {
            low[axis] = low[axis].min(along);
            high[axis] = high[axis].max(along);
        }
    }
    Some([low, high])
}

/// A process that is conditioned on strengths.
pub(crate) struct Process<'a> {
    strengths: &'a [Strength],
    length_m: f64,
    /// Standard deviation of the noise, relative to that of the process.
    noise: f64,
    /// Mean (dBm) and variance of the process (dB²).
    mean: f64,
    variance: f64,
    /// Of the correlations `K` of the strengths.
    factor: Cholesky<f64, Dyn>,
    /// `K⁻¹ (y − mean)`.
    weights: DVector<f64>,
    log_likelihood: f64,
}

impl<'a> Process<'a> {
    /// The process of the greatest marginal likelihood. `None` if the strengths are alike, at one place, or none.
    pub(crate) fn likeliest(strengths: &'a [Strength]) -> Option<Self> {
        let [low, high] = corners(strengths)?;
        let diagonal_m = Position::from(low).distance_m(high.into());
        let processes = LENGTHS.iter().filter_map(|share| StrengthCorrelations::of(strengths, share * diagonal_m));
        let processes = processes.flat_map(|correlations| {
            NOISES.into_iter().filter_map(move |noise| Self::new(strengths, &correlations, noise))
        });
        processes.max_by(|a, b| a.log_likelihood.total_cmp(&b.log_likelihood))
    }

    /// Mean (dBm) and variance (dB²) of a strength that is measured at `place`.
    pub(crate) fn predicted(&self, place: Position) -> (f64, f64) {
        let mut with =
            DVector::from_fn(self.strengths.len(), |i, _| exponent(place, self.strengths[i].place, self.length_m));
        exp_each(with.as_mut_slice());
        // The square of half of the solution.
        let half = self.factor.l_dirty().solve_lower_triangular_unchecked(&with);
        let known = half.norm_squared();
        let variance = self.variance * (1.0 - known + self.noise * self.noise).max(0.0);
        (self.mean + with.dot(&self.weights), variance)
    }

    /// The process with these correlations of the strengths and this standard deviation of the noise, relative to its own.
    /// `None` if the strengths are alike.
    fn new(strengths: &'a [Strength], correlations: &StrengthCorrelations, noise: f64) -> Option<Self> {
        let StrengthCorrelations { length_m, below } = correlations;
        let (length_m, count) = (*length_m, strengths.len());
        let mut whole = below.clone();
        for i in 0..count {
            whole[(i, i)] += noise * noise;
        }
        if !cholesky(whole.as_mut_slice(), count) {
            return None;
        }
        let factor: Cholesky<f64, Dyn> = Cholesky::pack_dirty(whole);
        let values = DVector::from_fn(count, |i, _| strengths[i].rssi_dbm);
        let ones = DVector::from_element(count, 1.0);
        let of_ones = factor.solve(&ones);
        let mean = of_ones.dot(&values) / of_ones.sum();
        let centred = values.map(|value| value - mean);
        let weights = factor.solve(&centred);
        let variance = centred.dot(&weights) / count as f64;
        if variance.is_nan() || variance <= 1e-12 {
            return None;
        }
        let ln_root: f64 = factor.l_dirty().diagonal().iter().map(|&entry| libm::log(entry)).sum();
        let log_likelihood = -0.5 * count as f64 * libm::log(variance) - ln_root;
        Some(Self { strengths, length_m, noise, mean, variance, factor, weights, log_likelihood })
    }

    /// The kernel along one axis, from a coordinate (m) to each strength.
    fn along_axis(&self, axis: usize, at_m: f64) -> Vec<f64> {
        let exponent = |strength: &Strength| {
            let way = (at_m - <[f64; 3]>::from(strength.place)[axis]) / self.length_m;
            -0.5 * (way * way)
        };
        let mut kernels: Vec<f64> = self.strengths.iter().map(exponent).collect();
        exp_each(&mut kernels);
        kernels
    }

    /// Where it is greatest in the box with these corners. The kernel is a product of one along each axis.
    fn greatest(&self, first: [f64; 3], last: [f64; 3]) -> Position {
        let count = CELLS[usize::from(last[2] > first[2])];
        let mut best = (f64::NEG_INFINITY, Position::from(first));
        let (mut low, mut high) = (first, last);
        for _ in 0..GRIDS {
            let counts = [0, 1, 2].map(|axis| if high[axis] > low[axis] { count } else { 0 });
            let steps = [0, 1, 2].map(|axis| (high[axis] - low[axis]) / f64::from(counts[axis].max(1)));
            let along = |axis: usize, i: u32| low[axis] + f64::from(i) * steps[axis];
            let kernels = [0, 1, 2].map(|axis| {
                let each = (0..=counts[axis]).map(|i| self.along_axis(axis, along(axis, i)));
                each.collect::<Vec<Vec<f64>>>()
            });
            let mut of_row = vec![0.0; self.strengths.len()];
            for (k, third) in (0..).zip(&kernels[2]) {
                for (j, second) in (0..).zip(&kernels[1]) {
                    let others = second.iter().zip(third).zip(self.weights.iter());
                    of_row.iter_mut().zip(others).for_each(|(own, ((b, c), weight))| *own = b * c * weight);
                    for (i, first) in (0..).zip(&kernels[0]) {
                        let value = dot(first, &of_row);
                        if value > best.0 {
                            best = (value, Position::new(along(0, i), along(1, j), along(2, k)));
                        }
                    }
                }
            }
            let middle: [f64; 3] = best.1.into();
            for axis in 0..3 {
                low[axis] = (middle[axis] - steps[axis]).max(first[axis]);
                high[axis] = (middle[axis] + steps[axis]).min(last[axis]);
            }
        }
        best.1
    }
}

/// The correlations of strengths with a length scale.
struct StrengthCorrelations {
    length_m: f64,
    /// Below the diagonal and on it.
    below: DMatrix<f64>,
}

impl StrengthCorrelations {
    /// `None` if the length is 0: the strengths are at one place.
    fn of(strengths: &[Strength], length_m: f64) -> Option<Self> {
        let count = strengths.len();
        if length_m <= 0.0 {
            return None;
        }
        let mut below = DMatrix::zeros(count, count);
        let mut kernels = Vec::with_capacity(count);
        for (column, own) in strengths.iter().enumerate() {
            kernels.clear();
            kernels.extend(strengths[column..].iter().map(|other| exponent(own.place, other.place, length_m)));
            exp_each(&mut kernels);
            below.view_mut((column, column), (count - column, 1)).copy_from_slice(&kernels);
        }
        Some(Self { length_m, below })
    }
}

/// The exponent of the squared-exponential kernel.
fn exponent(a: Position, b: Position, length_m: f64) -> f64 {
    let apart = a - b;
    -0.5 * apart.dot(apart) / (length_m * length_m)
}

impl EstimatorSettings for GaussianProcessConfig {
    const ANY_LOG: Option<AnyLog> = Some(AnyLog {
        name: "gaussian-process",
        rank: 9,
        description: "Where a Gaussian process over the strengths of a node is greatest",
        settings: "{}",
    });

    fn mapper(self) -> Result<Mapper, SettingError> {
        Ok(Mapper::new(GaussianProcess))
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{log_of, map, square};
    use super::*;
    use crate::algorithm::AlgorithmConfig;

    #[test]
    fn a_smooth_field_of_strengths_gives_its_peak_between_the_stops() {
        let node = Position::new(4.9, 7.2, 0.0);
        let law = |stop: Position| Some(-40.0 - 0.3 * (stop - node).length_m().powi(2));
        let map = map(AlgorithmConfig::GaussianProcess(GaussianProcessConfig {}), &log_of(&square(), &[&law]));
        let found = map.estimates[0].as_ref().unwrap().position;
        assert!(found.distance_m(node) < 0.2, "{found} is not {node}");
    }

    #[test]
    fn a_process_without_noise_passes_through_its_strengths() {
        let strengths: Vec<Strength> =
            square().into_iter().map(|place| Strength { place, rssi_dbm: -50.0 - place.x_m.sin() }).collect();
        let process = Process::new(&strengths, &StrengthCorrelations::of(&strengths, 2.0).unwrap(), 1e-4).unwrap();
        assert!(strengths.iter().all(|strength| {
            let (mean, variance) = process.predicted(strength.place);
            (mean - strength.rssi_dbm).abs() < 1e-4 && variance < 1e-4
        }));
    }

    #[test]
    fn the_greatest_place_of_a_grid_is_that_of_the_literal_sum() {
        let strength =
            |place: Position| -60.0 - (0.7 * place.x_m).sin() * 3.0 - (0.4 * place.y_m).cos() * 5.0 + place.z_m;
        let place = |i: u32| Position::new(f64::from(i % 6), f64::from(i / 6), 0.4 * f64::from(i % 3));
        let strengths: Vec<Strength> =
            (0..36).map(|i| Strength { place: place(i), rssi_dbm: strength(place(i)) }).collect();
        let process = Process::likeliest(&strengths).unwrap();
        let [low, high] = corners(&strengths).unwrap();
        let found = process.greatest(low, high);
        let at = |place| process.predicted(place).0;
        for i in 0..1000 {
            let share = |of: u32| f64::from(of) / 9.0;
            let other = Position::new(5.0 * share(i % 10), 5.0 * share(i / 10 % 10), 0.8 * share(i / 100));
            assert!(at(other) <= at(found) + 1e-9, "{other} is greater than {found}");
        }
    }
}
