//! Places of nodes whose boxes are too large for a grid: a coarse scan of the box, then a grid that adapts itself.

use rayon::prelude::*;
use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::{NodeId, Watch, Work};

use super::Fit;
use crate::error::MapError;
use crate::log_facts::heights::Heights;
use crate::log_facts::reach::HeardNode;
use crate::log_facts::search_box::SearchBox;
use crate::numerics::whole;
use crate::posterior::{Estimate, EstimateKind, Verdict, local_posterior};

/// Places of the scan along each axis, in the plane and in space.
const SCAN: [u32; 2] = [15, 9];
/// A grid is too large if it takes more operations than this for a node on average, and for all nodes.
const MOST_OPERATIONS: [f64; 2] = [1e7, 4e8];
/// Or if the log lists more pairs of a node and a stop than this, and it takes more operations for a node on average.
const LONG_LOG: (usize, f64) = (50_000, 1e6);
/// Operations of the adaptive grid for each link of a node, about.
const OPERATIONS: f64 = 3000.0;
/// The search for the nodes of a log in boxes that are too large for a grid.
#[derive(Debug)]
pub(crate) struct WideSearch<'a> {
    pub(crate) log: &'a ReceptionLog,
    pub(crate) fit: &'a Fit,
    pub(crate) step_m: f64,
    pub(crate) kind: EstimateKind,
}

/// The packets of a stop.
struct StopPackets {
    place: Position,
    received: f64,
    missed: f64,
}

/// Logarithms of the probabilities that a packet is received and missed, over distance.
struct LogCurve {
    per_m: f64,
    values: Vec<[f64; 2]>,
}

impl LogCurve {
    fn new(fit: &Fit) -> Self {
        let step_m = fit.curve.step_m();
        let end = whole(fit.curve.range_m() / step_m) + 2;
        let value = |i: usize| {
            let p = fit.curve.probability(step_m * i as f64).clamp(1e-9, 1.0 - 1e-9);
            [libm::log(p), libm::log1p(-p)]
        };
        Self { per_m: 1.0 / step_m, values: (0..=end).map(value).collect() }
    }

    #[inline]
    fn log_likelihood(&self, links: &[StopPackets], place: Position) -> f64 {
        let last = self.values.len() - 1;
        links.iter().fold(0.0, |sum, link| {
            let along = place.distance_m(link.place) * self.per_m;
            let below = whole(along).min(last);
            let [near, far] = [self.values[below], self.values[(below + 1).min(last)]];
            let share = (along - below as f64).min(1.0);
            let mix = |i: usize| near[i] + share * (far[i] - near[i]);
            sum + link.received * mix(0) + link.missed * mix(1)
        })
    }
}

/// How much a grid would take for the nodes of a log.
#[derive(Debug, Default)]
pub(crate) struct GridSize {
    /// Vertices of each node.
    vertices: Vec<(NodeId, f64)>,
    /// Pairs of a node and a stop that the log lists.
    pairs: usize,
}

impl GridSize {
    /// Adds the nodes in these boxes, of which the log lists so many pairs. The curve of `fit` is on a grid of `step_m`.
    pub(crate) fn add(&mut self, boxes: &[(HeardNode, SearchBox)], pairs: usize, fit: &Fit, step_m: f64) {
        let reach_m = 2.0 * fit.curve.range_m();
        let vertices = |within: &SearchBox| -> f64 {
            let along = |axis: usize| (within.high[axis] - within.low[axis]).min(reach_m) / step_m + 1.0;
            (0..3).map(along).product()
        };
        self.vertices.extend(boxes.iter().map(|(heard, within)| (heard.node, vertices(within))));
        self.pairs += pairs;
    }

    /// Whether a grid would take too long, with so many stops.
    pub(crate) fn takes_too_long(mut self, stops: usize) -> bool {
        // Nodes may come in parts of a log, and sums depend on the order.
        self.vertices.sort_unstable_by_key(|&(node, _)| node);
        let vertices: f64 = self.vertices.iter().map(|&(_, vertices)| vertices).sum();
        let operations = vertices * stops as f64;
        let of_node = operations / self.vertices.len().max(1) as f64;
        let (pairs, most) = LONG_LOG;
        operations > MOST_OPERATIONS[1] && of_node > MOST_OPERATIONS[0] || self.pairs > pairs && of_node > most
    }
}

impl WideSearch<'_> {
    /// The estimates of the nodes in `boxes`, in the order of the nodes of the log.
    ///
    /// # Errors
    /// [`MapError::Interrupted`].
    pub(crate) fn estimates(
        &self,
        boxes: &[(HeardNode, SearchBox)],
        watch: &dyn Watch,
    ) -> Result<Vec<Option<Estimate>>, MapError> {
        let links = boxes.len() as f64 * self.log.stops().len() as f64;
        let steps = boxes.len() as u64;
        watch.begin(Work { name: "ml-tm", unit: "node", steps, operations: links * OPERATIONS });
        let curve = LogCurve::new(self.fit);
        let found: Result<Vec<Option<Estimate>>, MapError> = boxes
            .par_iter()
            .map(|(heard, within)| {
                let estimate = self.estimate(&curve, heard, within, watch);
                watch.check()?;
                watch.advance(1);
                Ok(estimate)
            })
            .collect();
        let mut estimates = vec![None; self.log.node_count()];
        for ((heard, _), estimate) in boxes.iter().zip(found?) {
            estimates[heard.node.index()] = estimate;
        }
        Ok(estimates)
    }

    fn estimate(
        &self,
        curve: &LogCurve,
        heard: &HeardNode,
        within: &SearchBox,
        watch: &dyn Watch,
    ) -> Option<Estimate> {
        let links = self.links(heard);
        let log_likelihood = |place: Position| {
            if !within.contains(place) || watch.is_stopped() {
                return f64::NEG_INFINITY;
            }
            curve.log_likelihood(&links, place)
        };
        let Scan { start, gaps_m, verdict } = scan(within, within.nearest(heard.middle), &log_likelihood);
        let heights = if within.is_level() {
            Heights::Level(within.low[2])
        } else {
            Heights::Between(within.low[2], within.high[2])
        };
        let least_step_m = 0.5 * self.step_m;
        let found =
            local_posterior(heights, start, gaps_m.map(|gap| gap.max(self.step_m)), least_step_m, &log_likelihood);
        let found = found?;
        let best = found.likeliest();
        let most = curve.log_likelihood(&links, best);
        let at_edge = found.places.iter().filter(|(place, _)| within.is_at_edge(*place, self.step_m));
        let highest_at_edge = at_edge.map(|&(place, _)| log_likelihood(place)).fold(f64::NEG_INFINITY, f64::max);
        // The scan holds places of the whole box, and the grid the likeliest.
        let concern = verdict.concern(most - highest_at_edge);
        Some(Estimate { concern, ..found.estimate(self.kind, (best, most)) })
    }

    /// The packets of a node at each stop that listened for it.
    fn links(&self, heard: &HeardNode) -> Vec<StopPackets> {
        let mut entries = self.log.of(heard.node).iter().peekable();
        let links = (0_u32..).zip(self.log.stops()).map(|(index, stop)| {
            let entry = entries.next_if(|entry| entry.stop == index);
            let (received, sent) = entry.map_or((0, 1), |entry| (entry.received, entry.sent));
            StopPackets { place: stop.position, received: f64::from(received), missed: f64::from(sent - received) }
        });
        links.filter(|link| link.received + link.missed > 0.0).collect()
    }
}

/// What a coarse grid over a box tells.
struct Scan {
    /// The likeliest of its places.
    start: Position,
    /// The gaps between them along each axis (m).
    gaps_m: [f64; 3],
    verdict: Verdict,
}

/// The scan of the box, and of `first`, which may be likelier than the places of the grid.
fn scan(within: &SearchBox, first: Position, log_likelihood: &impl Fn(Position) -> f64) -> Scan {
    let count = SCAN[usize::from(!within.is_level())];
    let counts = [0, 1, 2].map(|axis| if within.high[axis] > within.low[axis] { count } else { 1 });
    let gaps_m = [0, 1, 2].map(|axis| (within.high[axis] - within.low[axis]) / f64::from(counts[axis]));
    let along = |axis: usize, i: u32| within.low[axis] + (f64::from(i) + 0.5) * gaps_m[axis];
    let mut best = (first, log_likelihood(first));
    let mut verdict = Verdict::default();
    for k in 0..counts[2] {
        for j in 0..counts[1] {
            for i in 0..counts[0] {
                let place = Position::new(along(0, i), along(1, j), along(2, k));
                let value = log_likelihood(place);
                verdict.take(value);
                if value > best.1 {
                    best = (place, value);
                }
            }
        }
    }
    Scan { start: best.0, gaps_m, verdict }
}
