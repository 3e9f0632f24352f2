//! The curve of highest likelihood, given how often packets arrived over which distance.

use sextant_channel::ReceptionLog;
use sextant_kernel::NodeId;

use super::belief::FittedBelief;
use super::receivers;
use crate::grid_ml::directions::{Directions, covers};
use crate::numerics::normal::index;
use crate::numerics::{never_rising, whole};
use crate::profile::TableProfile;

/// Number of bins up to the distance that 95 % of the first receptions do not exceed.
const BINS_IN_REACH: f64 = 80.0;
/// How much further bins go.
const REACHES: f64 = 2.5;
/// Share of the highest probability below which a distance is beyond the range.
const NEGLIGIBLE: f64 = 0.01;

/// Expected packets over each distance.
#[derive(Clone, Debug)]
pub(super) struct CurveCounts {
    /// Sent, then received, in each bin; the last one is for everything further.
    pub(super) bins: Vec<[f64; 2]>,
}

impl CurveCounts {
    pub(super) fn new(bins: usize) -> Self {
        Self { bins: vec![[0.0; 2]; bins] }
    }

    pub(super) fn add(&mut self, other: &Self) {
        for (sum, term) in self.bins.iter_mut().zip(&other.bins) {
            sum[0] += term[0];
            sum[1] += term[1];
        }
    }
}

/// A curve that never rises, at the middles 0, w, 2w, .. of bins of width w.
#[derive(Clone, Debug)]
pub(super) struct FittedCurve {
    /// w (m).
    bin_m: f64,
    /// Probabilities, the last one for everything further.
    values: Vec<f64>,
    /// Bins in range.
    in_range: usize,
    floor: f64,
    ceiling: f64,
    /// The logarithms of the probabilities in each bin.
    logarithms: Vec<LogProbabilities>,
}

/// The logarithms of the probabilities that a packet over some distance is received and missed, and what they differ by in the next
/// bin.
#[derive(Clone, Copy, Debug)]
pub(super) struct LogProbabilities {
    pub(super) received: f64,
    pub(super) missed: f64,
    received_on: f64,
    missed_on: f64,
}

impl LogProbabilities {
    /// Those of each bin with these probabilities.
    fn of(values: impl Iterator<Item = f64>) -> Vec<Self> {
        let logs = values.map(|s| (libm::log(s), libm::log1p(-s)));
        let mut each: Vec<Self> =
            logs.map(|(received, missed)| Self { received, missed, received_on: 0.0, missed_on: 0.0 }).collect();
        for bin in 1..each.len() {
            let next = each[bin];
            let own = &mut each[bin - 1];
            (own.received_on, own.missed_on) = (next.received - own.received, next.missed - own.missed);
        }
        each
    }

    /// The logarithm of the probability that packets are `received` and `missed` at this share of the way to the next bin.
    #[inline]
    pub(super) fn at(&self, share: f64, received: f64, missed: f64) -> f64 {
        received * (self.received + share * self.received_on) + missed * (self.missed + share * self.missed_on)
    }
}

impl FittedCurve {
    /// The curve for the first beliefs; `None` if there are none.
    pub(super) fn first(
        log: &ReceptionLog,
        nodes: &[NodeId],
        beliefs: &[FittedBelief],
        directions: Option<&Directions>,
    ) -> Option<Self> {
        let mut distances: Vec<f64> = Vec::new();
        for (&node, belief) in nodes.iter().zip(beliefs) {
            distances.extend(receivers(log, node).map(|(place, _)| place.distance_m(belief.mean)));
        }
        distances.sort_unstable_by(f64::total_cmp);
        let &farthest = distances.last()?;
        let reach_m = distances[distances.len() * 95 / 100];
        // All stops that heard a node may be in one place.
        let extent_m = if reach_m > 0.0 {
            reach_m
        } else if farthest > 0.0 {
            farthest
        } else {
            1.0
        };
        let bin_m = extent_m / BINS_IN_REACH;
        let bins = whole(BINS_IN_REACH * REACHES) + 1;
        let (values, logarithms) = (vec![0.0; bins], Vec::new());
        let empty = Self { bin_m, values, in_range: bins - 1, floor: 0.0, ceiling: 1.0, logarithms };
        let mut counts = CurveCounts::new(bins);
        for (&node, belief) in nodes.iter().zip(beliefs) {
            let mut entries = log.of(node).iter().peekable();
            for (index, stop) in (0_u32..).zip(log.stops()) {
                let entry = entries.next_if(|entry| entry.stop == index);
                let (received, sent) = entry.map_or((0, 1), |entry| (entry.received, entry.sent));
                if received == 0 && !covers(directions, belief.mean - stop.position) {
                    continue;
                }
                let bin = empty.bin(stop.position.distance_m(belief.mean));
                counts.bins[bin][0] += f64::from(sent);
                counts.bins[bin][1] += f64::from(received);
            }
        }
        Some(empty.updated(&counts))
    }

    pub(super) fn bins(&self) -> usize {
        self.values.len()
    }

    pub(super) fn bin(&self, distance_m: f64) -> usize {
        index(distance_m / self.bin_m + 0.5).min(self.values.len() - 1)
    }

    pub(super) fn bin_m(&self) -> f64 {
        self.bin_m
    }

    /// Receptions beyond this distance are outliers (m).
    pub(super) fn range_m(&self) -> f64 {
        self.bin_m * self.in_range as f64
    }

    /// Distance from which on everything is in the last bin (m).
    pub(super) fn reach_m(&self) -> f64 {
        self.bin_m * (self.values.len() as f64 - 1.5)
    }

    /// Probability in a bin.
    pub(super) fn value(&self, bin: usize) -> f64 {
        self.values[bin].clamp(self.floor, self.ceiling)
    }

    /// The logarithms of the probabilities in each bin.
    pub(super) fn logarithms(&self) -> &[LogProbabilities] {
        &self.logarithms
    }

    /// The curve of highest likelihood for `counts`.
    pub(super) fn updated(&self, counts: &CurveCounts) -> Self {
        let share = |&[sent, received]: &[f64; 2]| if sent > 0.0 { received / sent } else { 0.0 };
        let means: Vec<f64> = counts.bins.iter().map(share).collect();
        let weights: Vec<f64> = counts.bins.iter().map(|&[sent, _]| sent).collect();
        let values = never_rising(&means, &weights);
        let sum = |bins: &[[f64; 2]]| bins.iter().fold([0.0; 2], |sum: [f64; 2], b| [sum[0] + b[0], sum[1] + b[1]]);
        // The probability far away. Half a reception is added, so that it is never 0.
        let quarter = values.len() * 3 / 4;
        let [sent, received] = sum(&counts.bins[quarter..]);
        let floor = ((received + 0.5) / (sent + 1.0)).clamp(1e-6, 0.02);
        let least = (NEGLIGIBLE * values[0]).max(3.0 * floor);
        let in_range = values.iter().rposition(|&value| value > least).map_or(1, |last| last + 1);
        let [sent, _] = sum(&counts.bins[..in_range]);
        let ceiling = 1.0 - (1.0 / (sent + 2.0)).clamp(1e-4, 0.3);
        let logarithms = LogProbabilities::of(values.iter().map(|value| value.clamp(floor, ceiling)));
        Self { values, in_range, floor, ceiling, logarithms, bin_m: self.bin_m }
    }

    /// The root mean square difference of two curves over the packets in range of either, and the standard error of a
    /// share of one half for this number of packets.
    pub(super) fn distance(&self, other: &Self, counts: &CurveCounts) -> (f64, f64) {
        let (mut sum, mut weight) = (0.0, 0.0);
        for bin in 0..self.in_range.max(other.in_range) {
            let sent = counts.bins[bin][0];
            sum += sent * (self.value(bin) - other.value(bin)).powi(2);
            weight += sent;
        }
        if weight > 0.0 { ((sum / weight).sqrt(), 0.5 / weight.sqrt()) } else { (0.0, 0.0) }
    }

    /// The curve as a profile that ends at its range.
    pub(super) fn table(&self) -> TableProfile {
        let mut values: Vec<f64> =
            (0..=self.in_range).map(|bin| self.value(bin.min(self.values.len() - 1))).collect();
        // A node that was heard at one stop only, and many stops in silence: still, one was heard.
        values[0] = values[0].max(2.0 * self.floor);
        TableProfile::new(self.bin_m, values, self.floor, self.ceiling.max(4.0 * self.floor))
            .expect("a clamped curve is a profile")
    }
}
