//! Places of nodes whose boxes are too large for a grid: a coarse scan of the box, then a grid that adapts itself.

use rayon::prelude::*;
use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::maths::with_widest_vectors;
use sextant_kernel::{NodeId, Watch, Work};

use super::Fit;
use crate::error::MapError;
use crate::log_facts::heights::Heights;
use crate::log_facts::reach::HeardNode;
use crate::log_facts::search_box::SearchBox;
use crate::numerics::normal::index;
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

/// Stops that are looked at together.
const LANES: usize = 8;

/// Some stops, and the packets of a node that each received and missed. Those that fill up a block have none.
#[derive(Clone, Copy, Default)]
struct StopBlock {
    coordinates_m: [[f64; LANES]; 3],
    received: [f64; LANES],
    missed: [f64; LANES],
    is_heard: bool,
}

/// Logarithms of the probabilities that a packet is received and missed, over distance.
struct LogCurve {
    per_m: f64,
    /// Each logarithm, and how much the next one is above it.
    values: Vec<[[f64; 2]; 2]>,
}

impl LogCurve {
    fn new(fit: &Fit) -> Self {
        let step_m = fit.curve.step_m();
        let end = whole(fit.curve.range_m() / step_m) + 2;
        let value = |i: usize| {
            let p = fit.curve.probability(step_m * i as f64).clamp(1e-9, 1.0 - 1e-9);
            [libm::log(p), libm::log1p(-p)]
        };
        let with_rise = |i: usize| {
            let ([near, far], at) = ([i, (i + 1).min(end)].map(value), [0, 1]);
            at.map(|of| [near[of], far[of] - near[of]])
        };
        Self { per_m: 1.0 / step_m, values: (0..=end).map(with_rise).collect() }
    }

    fn log_likelihood(&self, blocks: &[StopBlock], place: Position) -> f64 {
        with_widest_vectors(
            #[inline(always)]
            || self.sum(blocks, place.into()),
        )
    }

    #[inline(always)]
    fn sum(&self, blocks: &[StopBlock], place: [f64; 3]) -> f64 {
        let last = (self.values.len() - 1) as f64;
        let mut sums = [0.0; LANES];
        for block in blocks {
            let mut along = [0.0; LANES];
            let [xs, ys, zs] = &block.coordinates_m;
            for lane in 0..LANES {
                let [x, y, z] = [place[0] - xs[lane], place[1] - ys[lane], place[2] - zs[lane]];
                along[lane] = ((x * x + y * y + z * z).sqrt() * self.per_m).min(last);
            }
            for lane in 0..LANES {
                let below = index(along[lane]);
                let share = along[lane] - below as f64;
                let [received, missed] = self.values[below];
                sums[lane] += block.missed[lane] * (missed[0] + share * missed[1]);
                if block.is_heard {
                    sums[lane] += block.received[lane] * (received[0] + share * received[1]);
                }
            }
        }
        sums.iter().sum()
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

    /// The packets of a node at each stop that listened for it: first those that heard it.
    fn links(&self, heard: &HeardNode) -> Vec<StopBlock> {
        let mut entries = self.log.of(heard.node).iter().peekable();
        let links = (0_u32..).zip(self.log.stops()).map(|(index, stop)| {
            let entry = entries.next_if(|entry| entry.stop == index);
            let (received, sent) = entry.map_or((0, 1), |entry| (entry.received, entry.sent));
            (<[f64; 3]>::from(stop.position), received, sent - received)
        });
        let (hearing, silent): (Vec<_>, Vec<_>) = links.partition(|&(_, received, _)| received > 0);
        let block = |links: &[([f64; 3], u32, u32)]| {
            let mut block = StopBlock { is_heard: links[0].1 > 0, ..StopBlock::default() };
            for (lane, (place, received, missed)) in links.iter().enumerate() {
                (0..3).for_each(|axis| block.coordinates_m[axis][lane] = place[axis]);
                [block.received[lane], block.missed[lane]] = [received, missed].map(|count| f64::from(*count));
            }
            block
        };
        let silent: Vec<_> = silent.into_iter().filter(|&(.., missed)| missed > 0).collect();
        hearing.chunks(LANES).chain(silent.chunks(LANES)).map(block).collect()
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
