//! The posterior of one node on a window of vertices, and its contribution to the counts.

use sextant_channel::Position;
use sextant_kernel::maths::exp_each;
use sextant_kernel::{NodeId, Watch};

use super::belief::PlaceBelief;
use super::counts::{CountedLink, Record, StopCounts};
use super::likelihood::WindowLikelihood;
use super::model::{FLOOR, Logarithms, Model};
use super::shadows::Shadows;
use super::window::{RoundDetail, VertexWindow};
use crate::absorption::AbsorptionMap;
use crate::grid_ml::directions::Directions;
use crate::log_facts::search_box::SearchBox;
use crate::posterior::{Concern, Verdict, covariance};

/// Probability above which a vertex counts.
const NEGLIGIBLE: f64 = 1e-4;
/// A window does not hold the posterior if more than this probability is at its ends.
const CRAMPED: f64 = 0.02;

/// The contribution of one node to the counts.
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

/// Everything that is known, apart from the place of the node.
#[derive(Clone, Copy, Debug)]
pub(super) struct KnownBesidesPlace<'a> {
    pub(super) counts: &'a StopCounts<'a>,
    pub(super) model: &'a Model,
    pub(super) obstacles: Option<Obstacles<'a>>,
    pub(super) step_m: f64,
    pub(super) detail: RoundDetail,
    /// Tables of the logarithms of the model, for a long log.
    pub(super) logarithms: Option<&'a Logarithms>,
    pub(super) watch: &'a dyn Watch,
}

/// The obstacles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Obstacles<'a> {
    pub(super) map: &'a AbsorptionMap,
    pub(super) shadows: &'a Shadows,
}

impl Obstacles<'_> {
    /// Whether something may absorb between a stop and a window.
    fn may_shade(&self, window: &VertexWindow, link: &CountedLink) -> bool {
        let ends = [(0, link.place.x_m), (1, link.place.y_m)].map(|(axis, at): (usize, f64)| {
            let [low, high] = window.ends(axis);
            (low.min(at), high.max(at))
        });
        self.shadows.has(link.stop) && !self.map.is_clear_within(ends.map(|end| end.0), ends.map(|end| end.1))
    }

    /// What the line from a stop to the place `apart` from it absorbs: what its projection does, times its slant.
    #[inline]
    fn absorbed(&self, stop: u32, apart: Position) -> f64 {
        let Position { x_m: dx, y_m: dy, .. } = apart;
        let (level_m, distance_m) = ((dx * dx + dy * dy).sqrt(), apart.length_m());
        let absorbed = self.shadows.absorbed_level(stop, [dx, dy], level_m);
        if level_m < distance_m && level_m > 0.0 { absorbed * (distance_m / level_m) } else { absorbed }
    }
}

/// Memory that a thread reuses for each node.
#[derive(Debug, Default)]
pub(super) struct PosteriorScratch {
    record: Record,
    links: Vec<CountedLink>,
    window: VertexWindow,
    likelihood: WindowLikelihood,
    /// The likelihood of each vertex over the highest.
    shares: Vec<f64>,
    likely: Vec<(Position, f64)>,
}

impl KnownBesidesPlace<'_> {
    /// Computes the posterior of a node round the last belief and within its bounds, and its counts. If `watch` ends the
    /// work meanwhile, the result means nothing.
    pub(super) fn refine(
        &self,
        scratch: &mut PosteriorScratch,
        bounds: &SearchBox,
        before: &PlaceBelief,
        tally: &mut Tally,
    ) -> PlaceBelief {
        tally.clear();
        scratch.window.lay(bounds, before, self.step_m, self.detail);
        self.gather(scratch, before, tally);
        self.weigh(scratch);
        tally.vertices += scratch.window.len() as u64;
        let belief = scratch.moments(before.node, bounds);
        self.tally(scratch, &belief, tally);
        belief
    }

    /// Lists the links that tell where the node is: those with a reception, and those to stops in range. Packets that were
    /// missed farther away go to the counts at once.
    fn gather(&self, scratch: &mut PosteriorScratch, before: &PlaceBelief, tally: &mut Tally) {
        let PosteriorScratch { record, links, window, .. } = scratch;
        let near_m = self.model.range_m() + window.radius_m(before.mean);
        let far_m = self.model.last_bin_m().max(near_m);
        self.counts.read(before.node, record);
        links.clear();
        let mut seen = 0.0;
        self.counts.within(record, before.mean, far_m, |link| {
            seen += 1.0;
            let apart = link.place - before.mean;
            if link.received > 0 || apart.dot(apart) <= near_m * near_m {
                links.push(link);
            } else if self.counts.tells(&link, before.mean) {
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
    }

    /// Computes the log-likelihood of each vertex.
    fn weigh(&self, scratch: &mut PosteriorScratch) {
        let PosteriorScratch { links, window, likelihood, .. } = scratch;
        likelihood.clear(window.len());
        for link in links.iter().filter(|link| link.sent() > 0) {
            if self.watch.is_stopped() {
                return;
            }
            let efficiency = self.model.efficiency(link.stop as usize);
            if let Some(directions) = &self.counts.directions {
                self.weigh_direction(directions, window, link, likelihood);
                continue;
            }
            match self.obstacles.filter(|obstacles| obstacles.may_shade(window, link)) {
                Some(obstacles) => likelihood.add(window, link, |place| {
                    let apart = place - link.place;
                    self.model.shaded(efficiency, apart.length_m(), obstacles.absorbed(link.stop, apart))
                }),
                None => match self.logarithms {
                    Some(logarithms) => likelihood.add_logarithms(window, link, self.model, logarithms),
                    None => likelihood
                        .add(window, link, |place| self.model.clear(efficiency, place.distance_m(link.place))),
                },
            }
        }
        likelihood.take_logarithms();
    }

    /// Multiplies by the likelihood of a link to a stop with an antenna of several sectors.
    fn weigh_direction(
        &self,
        directions: &Directions,
        window: &VertexWindow,
        link: &CountedLink,
        likelihood: &mut WindowLikelihood,
    ) {
        let efficiency = self.model.efficiency(link.stop as usize);
        let obstacles = self.obstacles.filter(|obstacles| obstacles.may_shade(window, link));
        likelihood.add(window, link, |place| {
            let apart = place - link.place;
            if link.received == 0 && !directions.covers(apart) {
                return FLOOR;
            }
            match obstacles {
                Some(obstacles) => {
                    self.model.shaded(efficiency, apart.length_m(), obstacles.absorbed(link.stop, apart))
                }
                None => self.model.clear(efficiency, apart.length_m()),
            }
        });
        if link.sector.is_some() {
            likelihood.multiply(window, |place| directions.factor(link.sector, place - link.place));
        }
    }

    /// Adds the packets of each link to the bins of its likely lengths. For the curve, packets that obstacles stop
    /// count as not sent. Shaded links are not simply left out, because that would keep the lucky ones and bias the
    /// curve.
    fn tally(&self, scratch: &PosteriorScratch, belief: &PlaceBelief, tally: &mut Tally) {
        for link in &scratch.links {
            let efficiency = self.model.efficiency(link.stop as usize);
            let (received, sent) = (f64::from(link.received), f64::from(link.sent()));
            let absorbed = self.obstacles.map_or(0.0, |obstacles| obstacles.map.absorbed(link.place, belief.mean));
            let mut expected = 0.0;
            for &(place, weight) in &scratch.likely {
                if !self.counts.tells(link, place) {
                    continue;
                }
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

impl PosteriorScratch {
    /// Turns log-likelihoods into the posterior and its moments.
    fn moments(&mut self, node: NodeId, bounds: &SearchBox) -> PlaceBelief {
        let Self { window, likelihood, shares, likely, .. } = self;
        let (best, highest) = likelihood.highest();
        shares.clear();
        shares.extend(likelihood.logarithms().iter().map(|value| value - highest));
        exp_each(shares);
        let sum: f64 = shares.iter().sum();
        likely.clear();
        let mut mode = Position::ORIGIN;
        window.each(|vertex, place| {
            if vertex == best {
                mode = place;
            }
            let weight = shares[vertex] / sum;
            if weight > NEGLIGIBLE {
                likely.push((place, weight));
            }
        });
        let total: f64 = likely.iter().map(|&(_, weight)| weight).sum();
        let mut offset = Position::ORIGIN;
        for &(place, weight) in likely.iter() {
            offset = offset + (place - mode) * (weight / total);
        }
        let mean = mode + offset;
        let covariance = covariance(likely.iter().map(|&(place, weight)| (place - mean, weight / total)));
        let at_open_end = (0..self.window.len()).filter(|&vertex| self.window.is_at_open_end(vertex));
        let weight = |vertex: usize| self.shares[vertex] / sum;
        let is_cramped = at_open_end.map(weight).sum::<f64>() > CRAMPED;
        let concern = self.concern(bounds);
        let cell = self.window.cell();
        PlaceBelief { node, mean, highest, covariance, cell, concern, is_cramped, shift_m: 0.0 }
    }

    /// What the window says of the posterior in the bounds of the node.
    fn concern(&self, bounds: &SearchBox) -> Option<Concern> {
        let mut verdict = Verdict::default();
        let mut highest_at_cut = f64::NEG_INFINITY;
        for (vertex, &value) in self.likelihood.logarithms().iter().enumerate() {
            verdict.take(value);
            if value > highest_at_cut && self.window.is_cut() && self.window.is_at_cut(vertex) {
                highest_at_cut = value;
            }
        }
        verdict.among(self.window.vertices_in(bounds)).concern(verdict.highest() - highest_at_cut)
    }
}
