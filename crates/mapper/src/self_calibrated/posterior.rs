//! Where one node may be: its posterior on a window of vertices, and what it adds to the counts.

use sextant_channel::Position;
use sextant_kernel::{NodeId, Watch};

use super::absorption::AbsorptionMap;
use super::bounds::Bounds;
use super::counts::{Counts, Link, Record};
use super::model::Model;
use super::shadows::Shadows;
use crate::local_posterior::covariance;

/// Steps from the middle of a window to its edge, at least.
const REACH: usize = 4;
/// Steps from the middle to the edge, at most, in the plane and in space.
const MOST: [usize; 2] = [24, 9];
/// Half the width of a window in standard deviations of the posterior before.
const SPREADS: f64 = 4.0;
/// Steps along an axis are doubled while they are below this share of the standard deviation.
const COARSENESS: f64 = 0.8;
/// Probability of a vertex that counts.
const NEGLIGIBLE: f64 = 1e-4;
/// Packets whose probabilities are multiplied before a logarithm is taken: 10⁻⁶ to this power is a normal number.
const CHUNK: u32 = 40;
/// A place whose log-likelihood is this much below the highest is in the 95 % region: half the quantile of the chi-squared
/// law with two degrees of freedom.
const LIKELY: f64 = 3.0;
/// Where vertices lie relative to round coordinates, in steps (powers of the golden ratio): an estimation lattice that
/// matches the places of the nodes would flatter the estimate.
const PHASE: [f64; 3] = [0.381_966, 0.236_068, 0.145_898];

/// What is believed of the place of one node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Belief {
    pub(super) node: NodeId,
    /// Posterior mean (m).
    pub(super) mean: Position,
    /// Log-likelihood of the likeliest vertex.
    pub(super) highest: f64,
    /// Posterior covariance (m²).
    pub(super) covariance: [[f64; 3]; 3],
    /// Whether places at the bounds of the node are about as likely as the likeliest.
    pub(super) at_bound: bool,
}

impl Belief {
    /// Standard deviation along an axis (m).
    pub(super) fn spread_m(&self, axis: usize) -> f64 {
        self.covariance[axis][axis].max(0.0).sqrt()
    }
}

/// What one node adds to the counts.
#[derive(Clone, Debug)]
pub(super) struct Tally {
    pub(super) received: Vec<f64>,
    pub(super) sent: Vec<f64>,
    /// Stop, packets received, packets expected at full efficiency.
    pub(super) stops: Vec<(u32, [f64; 2])>,
    pub(super) vertices: u64,
}

impl Tally {
    pub(super) fn new(bins: usize) -> Self {
        Self { received: vec![0.0; bins], sent: vec![0.0; bins], stops: Vec::new(), vertices: 0 }
    }

    fn clear(&mut self) {
        self.received.fill(0.0);
        self.sent.fill(0.0);
        self.stops.clear();
    }
}

/// What is known besides the node's own place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surroundings<'a> {
    pub(super) counts: &'a Counts<'a>,
    pub(super) model: &'a Model,
    pub(super) obstacles: Option<Obstacles<'a>>,
    pub(super) step_m: f64,
    pub(super) watch: &'a dyn Watch,
}

/// What stands in the way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Obstacles<'a> {
    pub(super) map: &'a AbsorptionMap,
    pub(super) shadows: &'a Shadows,
}

impl Obstacles<'_> {
    /// Whether something may absorb between a stop and a window.
    fn may_shade(&self, axes: &[Vec<f64>; 3], link: &Link) -> bool {
        let ends = [(0, link.place.x_m), (1, link.place.y_m)].map(|(axis, at): (usize, f64)| {
            let axis = &axes[axis];
            (axis[0].min(at), axis[axis.len() - 1].max(at))
        });
        self.shadows.has(link.stop) && !self.map.is_clear_within(ends.map(|end| end.0), ends.map(|end| end.1))
    }
}

/// Memory that a thread uses again for each node.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    record: Record,
    links: Vec<Link>,
    axes: [Vec<f64>; 3],
    /// Whether the bounds of the node cut the window off, at the low and the high end of each axis.
    is_cut: [[bool; 2]; 3],
    log_likelihood: Vec<f64>,
    product: Vec<f64>,
    likely: Vec<(Position, f64)>,
}

impl Surroundings<'_> {
    /// The posterior of a node round the last belief and within its bounds, and its counts; anything if the work was ended
    /// meanwhile.
    pub(super) fn refine(
        &self,
        scratch: &mut Scratch,
        bounds: &Bounds,
        before: &Belief,
        tally: &mut Tally,
    ) -> Belief {
        tally.clear();
        let radius_m = self.lay_window(scratch, bounds, before);
        let near_m = self.model.range_m() + radius_m;
        let far_m = self.model.last_bin_m().max(near_m);
        let Scratch { record, links, .. } = scratch;
        self.counts.read(before.node, record);
        links.clear();
        let mut seen = 0.0;
        self.counts.within(record, before.mean, far_m, |link| {
            seen += 1.0;
            let apart = link.place - before.mean;
            if link.received > 0 || apart.dot(apart) <= near_m * near_m {
                links.push(link);
            } else {
                let bin = self.model.bin(apart.length_m());
                tally.sent[bin] += f64::from(link.missed) * self.model.efficiency(link.stop as usize);
            }
        });
        // Each of the other stops missed one packet, unless it has an entry.
        let mut unseen = self.counts.log.stops().len() as f64 - seen;
        self.counts.recorded_beyond(record, before.mean, far_m, |link| {
            unseen -= 1.0;
            if link.received > 0 {
                links.push(link);
            } else {
                unseen += f64::from(link.missed);
            }
        });
        if let Some(last) = tally.sent.last_mut() {
            *last += unseen;
        }
        self.weigh(scratch);
        tally.vertices += scratch.log_likelihood.len() as u64;
        let belief = scratch.moments(before.node);
        self.tally(scratch, &belief, tally);
        belief
    }

    /// Sets the axes of the window; returns the distance from the last mean to its farthest vertex, at most (m).
    fn lay_window(&self, scratch: &mut Scratch, bounds: &Bounds, before: &Belief) -> f64 {
        let mean: [f64; 3] = before.mean.into();
        let most = MOST[usize::from(!bounds.is_level())];
        let mut square = 0.0;
        for axis in 0..3 {
            let coordinates = &mut scratch.axes[axis];
            coordinates.clear();
            let (low, high) = (bounds.low[axis], bounds.high[axis]);
            let mut is_cut = [false; 2];
            if low < high {
                let spread_m = before.spread_m(axis);
                let coarser = libm::log2(COARSENESS * spread_m / self.step_m).floor().clamp(0.0, 20.0);
                let step = self.step_m * libm::exp2(coarser);
                let half = crate::lattice::whole((SPREADS * spread_m / step).ceil()).clamp(REACH, most);
                let half = u32::try_from(half).unwrap_or(u32::MAX);
                let middle = (mean[axis] / step - PHASE[axis]).round() + PHASE[axis];
                for along in (0..=2 * half).map(|i| (middle + f64::from(i) - f64::from(half)) * step) {
                    if along < low {
                        is_cut[0] = bounds.is_guessed[axis];
                    } else if along > high {
                        is_cut[1] = bounds.is_guessed[axis];
                    } else {
                        coordinates.push(along);
                    }
                }
            }
            if coordinates.is_empty() {
                coordinates.push(mean[axis].clamp(low, high));
            }
            scratch.is_cut[axis] = is_cut;
            let ends = coordinates.first().into_iter().chain(coordinates.last());
            let reach_m = ends.map(|end| (end - mean[axis]).abs()).fold(0.0, f64::max);
            square += reach_m * reach_m;
        }
        square.sqrt()
    }

    /// Computes the log-likelihood of each vertex.
    fn weigh(&self, scratch: &mut Scratch) {
        let Scratch { links, axes, log_likelihood, product, .. } = scratch;
        let vertices: usize = axes.iter().map(Vec::len).product();
        log_likelihood.clear();
        log_likelihood.resize(vertices, 0.0);
        product.clear();
        product.resize(vertices, 1.0);
        let mut packets = 0;
        for link in links.iter() {
            let sent = link.received.saturating_add(link.missed);
            if sent == 0 {
                continue;
            }
            if self.watch.is_stopped() {
                return;
            }
            if packets + sent > CHUNK {
                take_logarithms(log_likelihood, product);
                packets = 0;
            }
            packets += sent.min(CHUNK);
            let obstacles = self.obstacles.filter(|obstacles| obstacles.may_shade(axes, link));
            let efficiency = self.model.efficiency(link.stop as usize);
            let mut vertex = 0;
            for &z_m in &axes[2] {
                for &y_m in &axes[1] {
                    let (dy, dz) = (y_m - link.place.y_m, z_m - link.place.z_m);
                    for &x_m in &axes[0] {
                        let dx = x_m - link.place.x_m;
                        let level = dx * dx + dy * dy;
                        let distance_m = (level + dz * dz).sqrt();
                        let p = match obstacles {
                            Some(obstacles) => {
                                let level_m = level.sqrt();
                                let mut absorbed = obstacles.shadows.absorbed_level(link.stop, [dx, dy], level_m);
                                if level_m < distance_m && level_m > 0.0 {
                                    absorbed *= distance_m / level_m;
                                }
                                self.model.shaded(efficiency, distance_m, absorbed)
                            }
                            None => self.model.clear(efficiency, distance_m),
                        };
                        match (link.received, link.missed) {
                            (0, 1) => product[vertex] *= 1.0 - p,
                            (1, 0) => product[vertex] *= p,
                            (received, missed) if sent <= CHUNK => {
                                product[vertex] *= power(p, received) * power(1.0 - p, missed);
                            }
                            (received, missed) => {
                                log_likelihood[vertex] +=
                                    f64::from(received) * libm::log(p) + f64::from(missed) * libm::log1p(-p);
                            }
                        }
                        vertex += 1;
                    }
                }
            }
        }
        take_logarithms(log_likelihood, product);
    }

    /// Adds the packets of each link to the bins of its likely lengths. What obstacles stop is not sent, as far as the
    /// curve is concerned: to leave out shaded links instead would leave those that were lucky.
    fn tally(&self, scratch: &Scratch, belief: &Belief, tally: &mut Tally) {
        for link in &scratch.links {
            let efficiency = self.model.efficiency(link.stop as usize);
            let (received, sent) = (f64::from(link.received), f64::from(link.received.saturating_add(link.missed)));
            let absorbed = self.obstacles.map_or(0.0, |obstacles| obstacles.map.absorbed(link.place, belief.mean));
            let mut expected = 0.0;
            for &(place, weight) in &scratch.likely {
                let bin = self.model.bin(link.place.distance_m(place));
                let passed = self.model.passed(bin, absorbed);
                tally.received[bin] += weight * received;
                tally.sent[bin] += weight * sent * efficiency * passed;
                expected += weight * passed * self.model.in_bin(bin);
            }
            tally.stops.push((link.stop, [received, expected * sent]));
        }
    }
}

impl Scratch {
    /// Turns log-likelihoods into the posterior and its moments.
    fn moments(&mut self, node: NodeId) -> Belief {
        let Self { axes, log_likelihood, likely, .. } = self;
        let mut best = (0, f64::NEG_INFINITY);
        for (vertex, &value) in log_likelihood.iter().enumerate() {
            if value > best.1 {
                best = (vertex, value);
            }
        }
        let sum: f64 = log_likelihood.iter().map(|value| libm::exp(value - best.1)).sum();
        likely.clear();
        let mut mode = Position::ORIGIN;
        let mut vertex = 0;
        for &z_m in &axes[2] {
            for &y_m in &axes[1] {
                for &x_m in &axes[0] {
                    let weight = libm::exp(log_likelihood[vertex] - best.1) / sum;
                    let place = Position::new(x_m, y_m, z_m);
                    if vertex == best.0 {
                        mode = place;
                    }
                    if weight > NEGLIGIBLE {
                        likely.push((place, weight));
                    }
                    vertex += 1;
                }
            }
        }
        let total: f64 = likely.iter().map(|&(_, weight)| weight).sum();
        let mut offset = Position::ORIGIN;
        for &(place, weight) in likely.iter() {
            offset = offset + (place - mode) * (weight / total);
        }
        let mean = mode + offset;
        let covariance = covariance(likely.iter().map(|&(place, weight)| (place - mean, weight / total)));
        Belief { node, mean, highest: best.1, covariance, at_bound: self.is_likely_at_cut(best.1) }
    }

    /// Whether a place where the window is cut off is about as likely as the likeliest, whose log-likelihood is `highest`.
    fn is_likely_at_cut(&self, highest: f64) -> bool {
        let Self { axes, is_cut, log_likelihood, .. } = self;
        if is_cut.iter().all(|ends| *ends == [false; 2]) {
            return false;
        }
        let is_at_cut =
            |axis: usize, i: usize| is_cut[axis][0] && i == 0 || is_cut[axis][1] && i + 1 == axes[axis].len();
        let [columns, rows, _] = [0, 1, 2].map(|axis| axes[axis].len());
        log_likelihood.iter().enumerate().filter(|&(_, &value)| value >= highest - LIKELY).any(|(vertex, _)| {
            let indices = [vertex % columns, vertex / columns % rows, vertex / (columns * rows)];
            (0..3).any(|axis| is_at_cut(axis, indices[axis]))
        })
    }
}

/// `p` to the power `times`, at most [`CHUNK`].
fn power(p: f64, times: u32) -> f64 {
    p.powi(times.cast_signed())
}

/// Moves the products to the logarithms.
fn take_logarithms(log_likelihood: &mut [f64], product: &mut [f64]) {
    for (sum, product) in log_likelihood.iter_mut().zip(product) {
        *sum += libm::log(*product);
        *product = 1.0;
    }
}
