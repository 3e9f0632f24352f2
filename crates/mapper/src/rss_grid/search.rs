//! The search for one node. Tiles that cannot hold a relevant vertex are skipped.

use std::ops::Range;

use sextant_channel::{Position, Stop};
use sextant_kernel::Watch;

use super::curves::Curves;
use super::tiles::{Silence, TileBox, Tiles};
use crate::grid_ml::solver::Peak;
use crate::lattice::Lattice;
use crate::log_facts::strengths::Strength;
use crate::posterior::{Cell, Estimate, EstimateKind, covariance};

/// A vertex this far below the highest log-likelihood is left out of the mean: even 10⁹ such vertices have a weight
/// of 10⁻²¹.
const NEGLIGIBLE: f64 = 70.0;
/// Margin of a bound for rounding errors, relative to the sum of its terms.
const ROUNDING: f64 = 1e-9;

/// Whether vertices beyond the radius of a stop that heard the node are ruled out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Radius {
    Hard,
    Ignored,
}

/// A survey that is prepared for the search of its nodes.
pub(super) struct StrengthSearch<'a> {
    pub(super) curves: Curves,
    pub(super) lattice: &'a Lattice,
    pub(super) stops: &'a [Stop],
    pub(super) range_m: f64,
    pub(super) variance: f64,
    pub(super) watch: &'a dyn Watch,
}

impl Silence for StrengthSearch<'_> {
    fn lattice(&self) -> &Lattice {
        self.lattice
    }

    fn watch(&self) -> &dyn Watch {
        self.watch
    }

    fn silence(&self, part: &TileBox) -> Box<[f64]> {
        let [columns, rows, layers] = [0, 1, 2].map(|axis| part.span(axis));
        let mut silence = vec![0.0; columns.len() * rows.len() * layers.len()];
        let mut values = silence.chunks_mut(columns.len());
        for k in layers {
            for j in rows.clone() {
                let Some(values) = values.next() else { break };
                for stop in self.stops {
                    self.add_silence(stop.position, [j, k], &columns, values);
                }
            }
        }
        silence.into()
    }

    fn silence_bound(&self, part: &TileBox) -> f64 {
        let mut sum = 0.0;
        for stop in self.stops {
            let [_, far_m] = part.distances_m(stop.position);
            // Near the range, rounding decides whether a vertex is in range.
            if far_m < self.range_m * (1.0 - 1e-6) {
                sum += self.curves.log_silence(far_m);
            }
        }
        sum * (1.0 - ROUNDING)
    }
}

impl StrengthSearch<'_> {
    /// Adds the log-likelihood of the silence of a stop to the vertices `columns` of a row.
    fn add_silence(&self, stop: Position, [j, k]: [usize; 2], columns: &Range<usize>, values: &mut [f64]) {
        let first = self.lattice.position([0, j, k]);
        let across_m = libm::hypot(first.y_m - stop.y_m, first.z_m - stop.z_m);
        if across_m > self.range_m {
            return;
        }
        let half_m = (self.range_m * self.range_m - across_m * across_m).sqrt();
        let (span, _) = self.lattice.span(0, stop.x_m - half_m, stop.x_m + half_m);
        for i in span.start.max(columns.start)..span.end.min(columns.end) {
            let along_m = self.lattice.coordinate(0, i) - stop.x_m;
            let distance_m = (along_m * along_m + across_m * across_m).sqrt();
            // The span may have a vertex too many at its ends. `log_likelihood` takes back only what is within the range.
            if distance_m <= self.range_m {
                values[i - columns.start] += self.curves.log_silence(distance_m);
            }
        }
    }

    /// An upper bound of the log-likelihood of a node at any vertex of a part whose silence bound is `silence`.
    fn bound(&self, part: &TileBox, silence: f64, heard: &[Strength], radius: Radius) -> f64 {
        let slack_m = self.slack_m();
        let (mut gain, mut loss) = (0.0, 0.0);
        for stop in heard {
            let [near_m, far_m] = part.distances_m(stop.place);
            if radius == Radius::Hard && near_m > slack_m * (1.0 + ROUNDING) {
                return f64::NEG_INFINITY;
            }
            let (strongest, weakest) = (self.curves.mean_dbm(near_m), self.curves.mean_dbm(far_m));
            let misfit = (stop.rssi_dbm - strongest).max(weakest - stop.rssi_dbm).max(0.0);
            loss += 0.5 * misfit * misfit / self.variance;
            if near_m <= self.range_m * (1.0 + ROUNDING) {
                gain -= self.curves.log_silence(near_m);
            }
        }
        silence + gain - loss + ROUNDING * (1.0 - silence + gain + loss)
    }

    /// How far a vertex may be from a stop that heard the node (m).
    fn slack_m(&self) -> f64 {
        self.range_m + self.lattice.half_diagonal_m()
    }

    /// The estimate of a node that was heard at these stops, and how many vertices were looked at. If the work was
    /// ended meanwhile, the result means nothing.
    pub(super) fn estimate(&self, tiles: &Tiles, heard: &[Strength], kind: EstimateKind) -> (Option<Estimate>, u64) {
        let Some(strongest) = heard.iter().max_by(|a, b| a.rssi_dbm.total_cmp(&b.rssi_dbm)) else { return (None, 0) };
        let mut found = RelevantVertices::new(kind);
        self.look(tiles, &self.spans(heard), heard, Radius::Hard, &mut found);
        let is_infeasible = found.vertices.is_empty();
        if is_infeasible {
            // No vertex is in reach of all: search round the strongest, and rule nothing out.
            self.look(tiles, &self.spans(&[*strongest]), heard, Radius::Ignored, &mut found);
        }
        let evaluated = found.evaluated;
        (found.estimate(self.lattice, is_infeasible), evaluated)
    }

    /// The box of the vertices that may be in reach of all stops.
    fn spans(&self, heard: &[Strength]) -> [Range<usize>; 3] {
        let slack_m = self.slack_m();
        [0, 1, 2].map(|axis| {
            let along = |stop: &Strength| <[f64; 3]>::from(stop.place)[axis];
            let low = heard.iter().map(|stop| along(stop) - slack_m).fold(f64::NEG_INFINITY, f64::max);
            let high = heard.iter().map(|stop| along(stop) + slack_m).fold(f64::INFINITY, f64::min);
            self.lattice.span(axis, low, high).0
        })
    }

    /// Gives `found` all relevant vertices of a box, block by block, the most promising first.
    fn look(
        &self,
        tiles: &Tiles,
        spans: &[Range<usize>; 3],
        heard: &[Strength],
        radius: Radius,
        found: &mut RelevantVertices,
    ) {
        let mut blocks: Vec<_> = tiles
            .blocks(self.lattice, spans)
            .map(|(block, part, silence)| (self.bound(&part, silence, heard, radius), block))
            .collect();
        blocks.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (bound, block) in blocks {
            if !found.is_within_reach(bound) || self.watch.is_stopped() {
                return;
            }
            let mut of_block: Vec<_> = tiles
                .of_block(self, block, spans)
                .map(|(number, part, silence)| (self.bound(&part, silence, heard, radius), number, part))
                .collect();
            of_block.sort_by(|a, b| b.0.total_cmp(&a.0));
            for (bound, number, part) in of_block {
                if !found.is_within_reach(bound) || self.watch.is_stopped() {
                    break;
                }
                self.weigh(&part, tiles.silence(self, number, &part), spans, heard, radius, found);
            }
        }
    }

    /// Gives `found` the vertices of a tile that are in a box.
    fn weigh(
        &self,
        part: &TileBox,
        silence: &[f64],
        spans: &[Range<usize>; 3],
        heard: &[Strength],
        radius: Radius,
        found: &mut RelevantVertices,
    ) {
        let mut silence = silence.iter();
        for k in part.span(2) {
            for j in part.span(1) {
                for i in part.span(0) {
                    let Some(&silence) = silence.next() else { return };
                    let vertex = [i, j, k];
                    if !(0..3).all(|axis| spans[axis].contains(&vertex[axis])) {
                        continue;
                    }
                    let place = self.lattice.position(vertex);
                    if let Some(value) = self.log_likelihood(place, silence, heard, radius) {
                        found.take(self.lattice.index(vertex), value);
                    }
                }
            }
        }
    }

    /// The log-likelihood of a node at a vertex where that of the silence of all stops is `silence`; `None` if the vertex is
    /// ruled out.
    #[inline]
    fn log_likelihood(&self, place: Position, silence: f64, heard: &[Strength], radius: Radius) -> Option<f64> {
        let slack_m = self.slack_m();
        let mut value = silence;
        for stop in heard {
            let distance_m = place.distance_m(stop.place);
            if radius == Radius::Hard && distance_m > slack_m {
                return None;
            }
            let misfit = stop.rssi_dbm - self.curves.mean_dbm(distance_m);
            value -= 0.5 * misfit * misfit / self.variance;
            if distance_m <= self.range_m {
                value -= self.curves.log_silence(distance_m);
            }
        }
        Some(value)
    }
}

/// The vertices that are relevant, or were relevant when they were found.
struct RelevantVertices {
    kind: EstimateKind,
    margin: f64,
    highest: f64,
    vertices: Vec<(u64, f64)>,
    evaluated: u64,
}

impl RelevantVertices {
    fn new(kind: EstimateKind) -> Self {
        let margin = match kind {
            EstimateKind::Argmax => Peak::TOLERANCE,
            EstimateKind::PosteriorMean => NEGLIGIBLE,
        };
        Self { kind, margin, highest: f64::NEG_INFINITY, vertices: Vec::new(), evaluated: 0 }
    }

    /// Whether a vertex with this log-likelihood would be relevant.
    fn is_within_reach(&self, value: f64) -> bool {
        value > f64::NEG_INFINITY && value >= self.highest - self.margin
    }

    fn take(&mut self, index: u64, value: f64) {
        self.evaluated += 1;
        if self.is_within_reach(value) {
            self.highest = self.highest.max(value);
            self.vertices.push((index, value));
        }
    }

    /// The estimate; `None` if nothing was found.
    fn estimate(mut self, lattice: &Lattice, infeasible: bool) -> Option<Estimate> {
        let least = self.highest - self.margin;
        self.vertices.retain(|&(_, value)| value >= least);
        // In the order of the lattice, so that sums do not depend on the order of the search.
        self.vertices.sort_unstable_by_key(|&(index, _)| index);
        let place = |index| lattice.position(lattice.vertex(index));
        let &(best, highest) = self.vertices.iter().find(|&&(_, value)| value >= self.highest)?;
        let best = place(best);
        let (position, covariance) = match self.kind {
            EstimateKind::Argmax => (best, None),
            EstimateKind::PosteriorMean => {
                let weights =
                    || self.vertices.iter().map(|&(index, value)| (place(index) - best, libm::exp(value - highest)));
                let total: f64 = weights().map(|(_, weight)| weight).sum();
                let mean = weights().fold(Position::ORIGIN, |sum, (offset, weight)| sum + offset * (weight / total));
                let apart = weights().map(|(offset, weight)| (offset - mean, weight / total));
                (best + mean, Some(Cell::of(lattice).spread(covariance(apart))))
            }
        };
        let ties = self.vertices.iter().filter(|&&(_, value)| value >= highest - Peak::TOLERANCE).count();
        let ties = u32::try_from(ties).unwrap_or(u32::MAX);
        Some(Estimate { position, log_likelihood: Some(highest), ties, covariance, infeasible, concern: None })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use sextant_kernel::{Purpose, Seed, Unwatched};

    use super::*;
    use crate::ranging::{Ranging, RangingConfig};

    /// What a scan of all vertices finds: the likeliest vertices that are not ruled out (several if they are equally
    /// likely), their log-likelihood, and the mean.
    fn scan(
        search: &StrengthSearch<'_>,
        heard: &[Strength],
        radius: Radius,
    ) -> Option<(Vec<Position>, f64, Position)> {
        let slack_m = search.slack_m();
        let strongest = heard.iter().max_by(|a, b| a.rssi_dbm.total_cmp(&b.rssi_dbm)).expect("it was heard");
        let mut found: Vec<(Position, f64)> = Vec::new();
        for index in 0..search.lattice.len() {
            let place = search.lattice.position(search.lattice.vertex(index));
            let is_in = |stop: &Strength| place.distance_m(stop.place) <= slack_m;
            let apart: [f64; 3] = (place - strongest.place).into();
            if !match radius {
                Radius::Hard => heard.iter().all(is_in),
                Radius::Ignored => apart.iter().all(|apart| apart.abs() <= slack_m),
            } {
                continue;
            }
            let log_silence = |stop: Position| {
                let distance_m = place.distance_m(stop);
                if distance_m <= search.range_m { search.curves.log_silence(distance_m) } else { 0.0 }
            };
            let mut value: f64 = search.stops.iter().map(|stop| log_silence(stop.position)).sum();
            for stop in heard {
                let misfit = stop.rssi_dbm - search.curves.mean_dbm(place.distance_m(stop.place));
                value -= 0.5 * misfit * misfit / search.variance + log_silence(stop.place);
            }
            found.push((place, value));
        }
        let highest = found.iter().map(|&(_, value)| value).reduce(f64::max)?;
        let is_best = |value: f64| value >= highest - Peak::TOLERANCE;
        let best = found.iter().filter(|&&(_, value)| is_best(value)).map(|&(place, _)| place).collect();
        let weights = || found.iter().map(|&(place, value)| (place, (value - highest).exp()));
        let total: f64 = weights().map(|(_, weight)| weight).sum();
        let mean = weights().fold(Position::ORIGIN, |sum, (place, weight)| sum + place * (weight / total));
        Some((best, highest, mean))
    }

    /// What differs between the estimate and a scan, for stops and strengths that are drawn with a seed.
    fn agrees_with_a_scan(
        (seed, count, heard): (u64, u64, usize),
        (sigma_db, range_m): (f64, Option<f64>),
        is_spatial: bool,
    ) -> Result<(), TestCaseError> {
        let draw = |i, axis| Seed(seed).uniform(Purpose::new(8), [i, axis, 0]);
        let height_m = if is_spatial { 6.0 } else { 0.0 };
        let stops: Vec<Stop> = (0..count)
            .map(|i| Position::new(20.0 * draw(i, 0), 14.0 * draw(i, 1), height_m * draw(i, 2)))
            .map(Stop::at)
            .collect();
        let config = RangingConfig {
            exponent: Some(2.7),
            tx_power_dbm: Some(-50.0),
            sigma_db: Some(sigma_db),
            ..RangingConfig::default()
        };
        let ranging = Ranging::try_from(config).expect("a law");
        let sensitivity_dbm = -75.0;
        let range_m = range_m.unwrap_or_else(|| ranging.distance_m(sensitivity_dbm - 2.0 * sigma_db)).min(40.0);
        let step_m = if is_spatial { 1.9 } else { 0.6 };
        let lattice = Lattice::covering(&stops, range_m, step_m, None, 1 << 30).expect("a small lattice");
        // The lattice begins exactly at the range of the outermost stop. Whether such a vertex is within it would be a
        // matter of rounding.
        let range_m = range_m * (1.0 + 1e-7);
        let search = StrengthSearch {
            curves: Curves::new(&ranging, sensitivity_dbm, range_m + 2.0 * lattice.half_diagonal_m()),
            lattice: &lattice,
            stops: &stops,
            range_m,
            variance: sigma_db * sigma_db,
            watch: &Unwatched,
        };
        let tiles = Tiles::new(&search).expect("nobody interrupts");
        let heard: Vec<Strength> = (0..)
            .zip(stops.iter().take(heard))
            .map(|(i, stop)| Strength { place: stop.position, rssi_dbm: -75.0 + 30.0 * draw(i, 3) })
            .collect();
        let radius = if scan(&search, &heard, Radius::Hard).is_some() { Radius::Hard } else { Radius::Ignored };
        let (best, highest, mean) = scan(&search, &heard, radius).expect("a vertex near the strongest stop");
        for kind in [EstimateKind::Argmax, EstimateKind::PosteriorMean] {
            let (estimate, evaluated) = search.estimate(&tiles, &heard, kind);
            let estimate = estimate.expect("a vertex near the strongest stop");
            prop_assert!(evaluated <= 2 * lattice.len());
            prop_assert_eq!(estimate.infeasible, radius == Radius::Ignored);
            prop_assert_eq!(estimate.ties as usize, best.len());
            prop_assert!((estimate.log_likelihood.unwrap() - highest).abs() < 1e-9 * (1.0 + highest.abs()));
            let expected = if kind == EstimateKind::Argmax { best.as_slice() } else { &[mean] };
            // Weights follow from log-likelihoods, whose rounding errors the lattice of 40 m multiplies.
            prop_assert!(
                expected.iter().any(|place| estimate.position.distance_m(*place) < 1e-6),
                "{} is not in {expected:?}",
                estimate.position
            );
        }
        Ok(())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]
        #[test]
        fn the_estimate_is_that_of_a_scan_of_all_vertices(
            seed in 0..10_000_u64,
            count in 1..30_u64,
            heard in 1..8_usize,
            sigma_db in 0.5..10.0_f64,
            range_m in prop_oneof![Just(None), (4.0..12.0_f64).prop_map(Some)],
            is_spatial in any::<bool>(),
        ) {
            agrees_with_a_scan((seed, count, heard), (sigma_db, range_m), is_spatial)?;
        }
    }

    #[test]
    fn silence_of_a_stop_does_not_count_a_micrometre_beyond_its_range() {
        agrees_with_a_scan((6058, 22, 1), (8.378_906_630_118_95, None), true).expect("the same estimate");
    }
}
