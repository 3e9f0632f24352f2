//! The delays of packets, in a memory that does not grow with their number.

use std::collections::BTreeMap;
use std::time::Duration;

/// Delays that are kept one by one: so many of one station, ...
const KEPT: usize = 1024;

/// ... and so many of several stations together.
const KEPT_TOGETHER: usize = 1 << 16;

/// Buckets of each doubling of the delay, as a power of two. The middle of a bucket is within 1/512 of all its delays.
const BUCKET_BITS: u32 = 8;

/// Limits of the bins of the histogram (s).
const LIMITS_S: [f64; 26] = [
    0.0,
    1e-4,
    2e-4,
    5e-4,
    1e-3,
    2e-3,
    5e-3,
    0.01,
    0.02,
    0.05,
    0.1,
    0.2,
    0.5,
    1.0,
    2.0,
    5.0,
    10.0,
    20.0,
    50.0,
    1e2,
    2e2,
    5e2,
    1e3,
    1e4,
    1e5,
    f64::MAX,
];

/// The times from offer to first reception of the packets of a station, or of several.
///
/// Number, mean and histogram are exact. Percentiles are exact for up to 1024 packets of a station, and up to 65536 of
/// several stations none of which has more than 1024; beyond, they are within 0.2 % of a delay that occurred. Which delays
/// came first makes no difference.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Delays {
    /// In the order of receptions (ns), as long as there are few.
    kept: Vec<u64>,
    /// Number of delays by bucket, once there are many.
    buckets: BTreeMap<u64, u64>,
    count: u64,
    sum_ns: u128,
    /// The least and the greatest delay (ns).
    range_ns: Option<(u64, u64)>,
    /// Number of delays by bin of the histogram.
    bins: [u64; LIMITS_S.len() - 1],
}

/// Packets with a delay in a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DelayCount {
    /// Least delay (s).
    pub from_s: f64,
    /// The delay is less than this (s).
    pub to_s: f64,
    /// Number of packets.
    pub packets: u64,
}

impl Delays {
    /// Adds the delay of a packet.
    ///
    /// # Panics
    /// If it is longer than 584 years.
    pub fn add(&mut self, delay: Duration) {
        let delay_ns = u64::try_from(delay.as_nanos()).expect("below 584 years");
        let delay_s = delay.as_secs_f64();
        let bin = LIMITS_S.partition_point(|&limit_s| limit_s <= delay_s).saturating_sub(1);
        self.bins[bin.min(LIMITS_S.len() - 2)] += 1;
        self.count += 1;
        self.sum_ns += u128::from(delay_ns);
        let (least, greatest) = self.range_ns.unwrap_or((delay_ns, delay_ns));
        self.range_ns = Some((least.min(delay_ns), greatest.max(delay_ns)));
        if !self.is_exact() {
            *self.buckets.entry(bucket(delay_ns)).or_default() += 1;
        } else {
            self.kept.push(delay_ns);
            if self.kept.len() > KEPT {
                self.spill();
            }
        }
    }

    /// Adds the delays of another station.
    pub fn merge(&mut self, other: &Self) {
        let is_exact = self.is_exact() && other.is_exact() && self.kept.len() + other.kept.len() <= KEPT_TOGETHER;
        if !is_exact {
            self.spill();
        }
        self.count += other.count;
        self.sum_ns += other.sum_ns;
        self.range_ns = match (self.range_ns, other.range_ns) {
            (Some((a, b)), Some((c, d))) => Some((a.min(c), b.max(d))),
            (own, others) => own.or(others),
        };
        self.bins.iter_mut().zip(other.bins).for_each(|(bin, others)| *bin += others);
        if is_exact {
            self.kept.extend(&other.kept);
        } else {
            other.buckets.iter().for_each(|(&bucket, &count)| *self.buckets.entry(bucket).or_default() += count);
            other.kept.iter().for_each(|&delay_ns| *self.buckets.entry(bucket(delay_ns)).or_default() += 1);
        }
    }

    /// Number of packets.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Whether percentiles are exact.
    #[must_use]
    pub(crate) fn is_exact(&self) -> bool {
        self.buckets.is_empty()
    }

    /// Mean delay (s); `None` if there is no packet.
    #[must_use]
    pub fn mean_s(&self) -> Option<f64> {
        if self.count == 0 {
            return None;
        }
        if self.is_exact() {
            return Some(self.kept.iter().map(|&delay_ns| seconds(delay_ns)).sum::<f64>() / self.count as f64);
        }
        Some(self.sum_ns as f64 * 1e-9 / self.count as f64)
    }

    /// The least delays that these shares of the packets do not exceed (percent, s); `None` if there is no packet.
    #[must_use]
    pub fn percentiles_s<const N: usize>(&self, percent: [u64; N]) -> Option<[f64; N]> {
        let (least, greatest) = self.range_ns?;
        let mut sorted = self.kept.clone();
        sorted.sort_unstable();
        Some(percent.map(|percent| {
            let wanted = (percent * self.count).div_ceil(100).max(1);
            if self.is_exact() {
                let place = usize::try_from(wanted).expect("below the number of delays kept").min(sorted.len());
                return seconds(sorted[place - 1]);
            }
            let mut passed = 0;
            let reached = self.buckets.iter().find(|(_, count)| {
                passed += **count;
                passed >= wanted
            });
            seconds(reached.map_or(greatest, |(&bucket, _)| middle(bucket)).clamp(least, greatest))
        }))
    }

    /// The histogram: bins whose limits are 1, 2 and 5 times powers of ten, from the first to the last one that holds a
    /// packet.
    #[must_use]
    pub fn histogram(&self) -> Vec<DelayCount> {
        let Some(first) = self.bins.iter().position(|&packets| packets > 0) else { return Vec::new() };
        let last = self.bins.iter().rposition(|&packets| packets > 0).unwrap_or(first);
        (first..=last)
            .map(|bin| DelayCount { from_s: LIMITS_S[bin], to_s: LIMITS_S[bin + 1], packets: self.bins[bin] })
            .collect()
    }

    /// There are too many delays to keep each.
    fn spill(&mut self) {
        for delay_ns in std::mem::take(&mut self.kept) {
            *self.buckets.entry(bucket(delay_ns)).or_default() += 1;
        }
    }
}

fn seconds(nanos: u64) -> f64 {
    Duration::from_nanos(nanos).as_secs_f64()
}

/// Number of the bucket of a delay: its leading bits, and how many follow.
fn bucket(delay_ns: u64) -> u64 {
    let shift = (u64::BITS - delay_ns.leading_zeros()).saturating_sub(BUCKET_BITS + 1);
    (u64::from(shift) << BUCKET_BITS) + (delay_ns >> shift)
}

/// The delay in the middle of a bucket (ns).
fn middle(bucket: u64) -> u64 {
    let buckets = 1 << BUCKET_BITS;
    if bucket < 2 * buckets {
        return bucket;
    }
    let shift = bucket / buckets - 1;
    let first = (bucket - shift * buckets) << shift;
    first + (1 << shift) / 2
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_kernel::{Purpose, Seed};

    fn of(delays_s: impl IntoIterator<Item = f64>) -> Delays {
        let mut delays = Delays::default();
        delays_s.into_iter().for_each(|delay_s| delays.add(Duration::from_secs_f64(delay_s)));
        delays
    }

    #[test]
    fn percentiles_of_few_packets_are_delays_that_occurred() {
        let delays = of((1..=200).rev().map(f64::from));
        assert_eq!(delays.percentiles_s([50, 90, 99]), Some([100.0, 180.0, 198.0]));
        assert_eq!((delays.mean_s(), delays.count(), delays.is_exact()), (Some(100.5), 200, true));
        assert_eq!(of([0.25]).percentiles_s([50, 99]), Some([0.25, 0.25]));
        assert_eq!((of([]).percentiles_s([50]), of([]).mean_s()), (None, None));
    }

    #[test]
    fn percentiles_of_many_packets_are_within_a_fifth_of_a_percent_in_a_bounded_memory() {
        let draw = |i: u64| 1e-3 * libm::exp(4.0 * Seed(5).uniform(Purpose::new(8), [i, 0, 0]));
        let mut all: Vec<f64> = (0..200_000).map(draw).collect();
        let delays = of(all.iter().copied());
        assert!(!delays.is_exact() && delays.kept.is_empty());
        // Less than six doublings from 1 to 55 ms.
        assert!(delays.buckets.len() <= 6 << BUCKET_BITS, "{}", delays.buckets.len());
        all.sort_by(f64::total_cmp);
        let found = delays.percentiles_s([1, 50, 90, 99, 100]).expect("there are delays");
        for (percent, found) in [1, 50, 90, 99, 100].into_iter().zip(found) {
            let exact = all[percent * all.len() / 100 - 1];
            assert!((found / exact - 1.0).abs() <= 0.002, "{percent}: {found}, not {exact}");
        }
        let mean = all.iter().sum::<f64>() / 2e5;
        assert!((delays.mean_s().expect("there are delays") / mean - 1.0).abs() < 1e-6);
    }

    #[test]
    fn delays_of_several_stations_are_those_of_one() {
        let draw = |i: u64| Seed(7).uniform(Purpose::new(8), [i, 0, 0]);
        for count in [900, 3000] {
            let (mut parts, all) = (of((0..count / 3).map(draw)), of((0..count).map(draw)));
            parts.merge(&of((count / 3..count).map(draw)));
            assert_eq!(parts.is_exact(), count == 900);
            let (mut together, mut alone) = (parts.clone(), all.clone());
            together.spill();
            alone.spill();
            assert_eq!(together, alone);
        }
    }

    #[test]
    fn a_histogram_holds_each_packet_once() {
        let bins = of([0.002, 0.0049, 0.005, 0.03]).histogram();
        let counts: Vec<_> = bins.iter().map(|bin| (bin.from_s, bin.packets)).collect();
        assert_eq!(counts, [(0.002, 2), (0.005, 1), (0.01, 0), (0.02, 1)]);
        assert_eq!(of([]).histogram(), []);
    }

    #[test]
    fn a_bucket_holds_its_middle() {
        for delay_ns in [0, 1, 255, 256, 511, 512, 1000, 123_456_789, u64::MAX / 3] {
            assert_eq!(bucket(middle(bucket(delay_ns))), bucket(delay_ns), "{delay_ns}");
        }
    }
}
