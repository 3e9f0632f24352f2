//! The probability that a packet is received: a curve over distance, and an efficiency of each stop.

use crate::numerics::never_rising;
use crate::numerics::normal::{Normal, index, quantile};

/// Number of bins over the range seen in the log.
const BINS_PER_RANGE: f64 = 100.0;
/// Number of bins. The last one holds everything beyond two and a half ranges.
const BINS: u32 = 250;
/// Lowest probability of a reception.
pub(super) const FLOOR: f64 = 1e-6;
/// Highest probability of a reception.
pub(super) const CEILING: f64 = 1.0 - 1e-4;
/// Probability of a clear link next to the node at full efficiency. It is fixed because curve and efficiency are
/// determined only up to a common factor.
const TOP: f64 = 0.998;
/// Weight of the mean efficiency of all stops in the estimate for one stop, in expected packets.
const SHRINKAGE: f64 = 20.0;
/// Least number of packets over a distance for which the log tells how often they arrive.
const SOME: f64 = 1.0;
/// The curve ends where it falls below this.
const NOTHING: f64 = 1e-4;
/// The reported range ends where the curve falls below this.
const RARE: f64 = 0.01;

/// The counts from which a model is estimated: packets by distance and by stop, expected under the posteriors of the
/// nodes.
#[derive(Clone, Debug)]
pub(super) struct ModelSums {
    /// Packets received, by bin.
    pub(super) received: Vec<f64>,
    /// Packets sent, times the efficiency of the stop and the share that passes the obstacles, by bin.
    pub(super) sent: Vec<f64>,
    /// Packets received, and expected at full efficiency, by stop.
    pub(super) stops: Vec<[f64; 2]>,
}

/// The logarithms of the probabilities that a packet is received and missed over a clear link, by stop and bin.
#[derive(Clone, Debug)]
pub(super) struct Logarithms {
    values: Vec<[f64; 2]>,
    bins: usize,
}

impl Logarithms {
    /// Those of a stop, by bin.
    pub(super) fn of_stop(&self, stop: usize) -> &[[f64; 2]] {
        &self.values[stop * self.bins..(stop + 1) * self.bins]
    }
}

/// The probability of a reception.
#[derive(Clone, Debug)]
pub(super) struct Model {
    bin_m: f64,
    per_m: f64,
    /// Probability over clear links at full efficiency, by bin.
    clear: Vec<f64>,
    /// The same as a normal quantile: z.
    score: Vec<f64>,
    efficiency: Vec<f64>,
    floor: f64,
    range_m: f64,
    normal: Normal,
}

impl Model {
    /// A first model: the trapezoid with a plateau of a fifth of `range_m`.
    pub(super) fn new(range_m: f64, stops: usize) -> Self {
        let bin_m = range_m / BINS_PER_RANGE;
        let trapezoid = |bin: u32| {
            let share = (f64::from(bin) + 0.5) / BINS_PER_RANGE;
            0.95 * ((1.2 - share) / 1.0).clamp(0.0, 1.0)
        };
        let mut model = Self {
            bin_m,
            per_m: 1.0 / bin_m,
            clear: (0..BINS).map(trapezoid).collect(),
            score: Vec::new(),
            efficiency: vec![1.0; stops],
            floor: FLOOR,
            range_m,
            normal: Normal::new(),
        };
        model.finish();
        model
    }

    /// Number of bins.
    pub(super) fn bins(&self) -> usize {
        self.clear.len()
    }

    /// Probability over clear links at full efficiency, in a bin.
    pub(super) fn in_bin(&self, bin: usize) -> f64 {
        self.clear[bin]
    }

    /// Sums of zero.
    pub(super) fn sums(&self) -> ModelSums {
        let bins = vec![0.0; self.clear.len()];
        ModelSums { received: bins.clone(), sent: bins, stops: vec![[0.0; 2]; self.efficiency.len()] }
    }

    /// The bin that holds `distance_m`.
    #[inline]
    pub(super) fn bin(&self, distance_m: f64) -> usize {
        index(distance_m * self.per_m).min(self.clear.len() - 1)
    }

    /// The distance beyond which the curve stays below `probability` (m).
    pub(super) fn reach_m(&self, probability: f64) -> f64 {
        let bin = self.clear.iter().rposition(|&clear| clear > probability).unwrap_or(0);
        let bin = bin as f64;
        bin * self.bin_m
    }

    /// The distance at which the last bin begins (m).
    pub(super) fn last_bin_m(&self) -> f64 {
        let bins = (self.clear.len() - 1) as f64;
        bins * self.bin_m
    }

    /// Receptions at this distance or beyond are outliers (m).
    pub(super) fn range_m(&self) -> f64 {
        self.range_m
    }

    /// Efficiency of a stop.
    pub(super) fn efficiency(&self, stop: usize) -> f64 {
        self.efficiency[stop]
    }

    /// z over `distance_m`.
    pub(super) fn score(&self, distance_m: f64) -> f64 {
        self.score[self.bin(distance_m)]
    }

    pub(super) fn normal(&self) -> &Normal {
        &self.normal
    }

    /// Probability of a reception over a clear link.
    #[inline]
    pub(super) fn clear(&self, efficiency: f64, distance_m: f64) -> f64 {
        (self.clear[self.bin(distance_m)] * efficiency).clamp(self.floor, CEILING)
    }

    /// Tables of its logarithms.
    pub(super) fn logarithms(&self) -> Logarithms {
        let value = |efficiency: f64, clear: f64| {
            let p = (clear * efficiency).clamp(self.floor, CEILING);
            [libm::log(p), libm::log1p(-p)]
        };
        let of_stop = |&efficiency: &f64| self.clear.iter().map(move |&clear| value(efficiency, clear));
        Logarithms { values: self.efficiency.iter().flat_map(of_stop).collect(), bins: self.clear.len() }
    }

    /// Probability of a reception over a link that obstacles weaken by `absorbed` standard deviations.
    #[inline]
    pub(super) fn shaded(&self, efficiency: f64, distance_m: f64, absorbed: f64) -> f64 {
        if absorbed <= 0.0 {
            return self.clear(efficiency, distance_m);
        }
        let passed = self.normal.below(self.score[self.bin(distance_m)] - absorbed);
        (passed * efficiency).clamp(self.floor, CEILING)
    }

    /// Of the packets over a length in `bin` that would arrive over a clear link, the share that still arrives if
    /// obstacles weaken them by `absorbed` standard deviations.
    pub(super) fn passed(&self, bin: usize, absorbed: f64) -> f64 {
        if absorbed <= 0.0 { 1.0 } else { self.normal.below(self.score[bin] - absorbed) / self.clear[bin] }
    }

    /// Fits curve and efficiencies to `sums`.
    pub(super) fn fit(&mut self, sums: &ModelSums) {
        self.fit_efficiency(&sums.stops);
        // One half of 2·10⁻⁴ packets keeps probabilities above 0 where nothing was sent.
        let sent: Vec<f64> = sums.sent.iter().map(|sent| sent + 2e-4).collect();
        let received = sums.received.iter().map(|received| received + 1e-4);
        let means: Vec<f64> = received.zip(&sent).map(|(received, sent)| received / sent).collect();
        self.clear = never_rising(&means, &sent);
        let factor = TOP / self.top(sums);
        for clear in &mut self.clear {
            *clear *= factor;
        }
        for efficiency in &mut self.efficiency {
            *efficiency /= factor;
        }
        self.finish();
    }

    /// Fits the efficiencies, but not their common level. If the level followed from the old curve, and the curve
    /// from the old efficiencies, both would oscillate for ever.
    fn fit_efficiency(&mut self, stops: &[[f64; 2]]) {
        let (mut received, mut expected, mut at_full) = (0.0, 0.0, 0.0);
        for (efficiency, stop) in self.efficiency.iter().zip(stops) {
            received += stop[0];
            expected += efficiency * stop[1];
            at_full += stop[1];
        }
        if received <= 0.0 || expected <= 0.0 {
            return;
        }
        let level = expected / at_full;
        for (efficiency, stop) in self.efficiency.iter_mut().zip(stops) {
            *efficiency = (stop[0] * expected / received + SHRINKAGE * level) / (stop[1] + SHRINKAGE);
        }
    }

    /// Probability of a reception over the nearest hundredth of the links in range, at full efficiency. If these have
    /// fewer than fifty packets, more links are used, up to a tenth.
    fn top(&self, sums: &ModelSums) -> f64 {
        let within = self.bin(self.range_m);
        let all: f64 = sums.sent[..=within].iter().sum();
        let enough = (0.01 * all).max(50.0).min(0.1 * all);
        let (mut received, mut sent) = (0.5, 0.5);
        for (bin, &packets) in sums.sent[..=within].iter().enumerate() {
            received += sums.received[bin];
            sent += packets;
            if sent > enough {
                break;
            }
        }
        (received / sent).max(0.01)
    }

    fn finish(&mut self) {
        for clear in &mut self.clear {
            *clear = clear.clamp(FLOOR, 0.999);
        }
        self.score = self.clear.iter().map(|&clear| quantile(clear)).collect();
        self.floor = self.clear.last().copied().unwrap_or(FLOOR);
        let end = self.clear.iter().rposition(|&clear| clear > 3.0 * self.floor + NOTHING).map_or(1, |bin| bin + 1);
        let range_m = end as f64 * self.bin_m;
        self.range_m = range_m;
    }

    /// Lets the curve go on as it ends: beyond the longest distance with packets it has the value that it has there.
    pub(super) fn extrapolate(&mut self, sums: &ModelSums) {
        let Some(last) = sums.sent.iter().rposition(|&sent| sent >= SOME) else { return };
        let value = self.clear[last];
        self.clear[last..].fill(value);
        self.finish();
    }

    /// Whether the curve is still clearly above 0 in the last bin.
    pub(super) fn is_at_bound(&self) -> bool {
        self.clear.last().is_some_and(|&clear| clear > RARE)
    }

    /// The curve for users.
    pub(super) fn curve(&self) -> CalibratedCurve {
        let mean = self.efficiency.iter().sum::<f64>() / self.efficiency.len().max(1) as f64;
        let probabilities = self.clear.iter().map(|&clear| (clear * mean).clamp(self.floor, CEILING)).collect();
        CalibratedCurve { bin_m: self.bin_m, probabilities, range_m: self.reach_m(RARE) + self.bin_m }
    }

    /// Efficiency of each stop.
    pub(super) fn efficiencies(&self) -> &[f64] {
        &self.efficiency
    }
}

/// The reception curve of a self-calibrated map: the probability that a packet is received over a clear link of some
/// distance at a stop of average efficiency. It never rises with distance.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibratedCurve {
    bin_m: f64,
    probabilities: Vec<f64>,
    range_m: f64,
}

impl CalibratedCurve {
    /// Probability that a packet is received over `distance_m`.
    #[must_use]
    pub fn probability(&self, distance_m: f64) -> f64 {
        self.probabilities[self.bin(distance_m)]
    }

    /// The bin of a distance.
    pub(crate) fn bin(&self, distance_m: f64) -> usize {
        crate::numerics::whole(distance_m / self.bin_m).min(self.probabilities.len() - 1)
    }

    /// The distance beyond which less than one packet in a hundred arrives (m).
    #[must_use]
    pub fn range_m(&self) -> f64 {
        self.range_m
    }

    /// Width of the bins within which the curve is constant (m). The last bin has no end.
    #[must_use]
    pub fn bin_m(&self) -> f64 {
        self.bin_m
    }

    /// The probability in each bin.
    #[must_use]
    pub fn probabilities(&self) -> &[f64] {
        &self.probabilities
    }
}
