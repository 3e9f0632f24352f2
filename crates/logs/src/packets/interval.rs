//! How often a node sends, from the times of the packets that were heard.

use std::collections::BTreeMap;
use std::time::Duration;

use sextant_kernel::SimTime;

/// The gaps between the packets of a node that were heard one after the other, in whatever order they come. Memory does not grow
/// with packets: the times of [`AT_ONCE`] packets at once are put in order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Gaps {
    latest: Option<SimTime>,
    /// Times whose gaps are not counted yet (ns).
    times: Vec<u64>,
    bins: BTreeMap<u16, Bin>,
    /// Packets, and those of them that have the time of another one.
    packets: u64,
    repeated: u64,
    /// Whether a time tells less than a hundredth of a second.
    is_fine: bool,
}

/// Gaps of about one length.
#[derive(Clone, Copy, Debug, Default)]
struct Bin {
    count: u64,
    sum_ns: u128,
}

impl Bin {
    fn mean_ns(&self) -> f64 {
        self.sum_ns as f64 / self.count as f64
    }
}

/// Shorter gaps are between copies of one packet.
const SHORTEST_NS: u64 = 1_000_000;

/// Times in steps of this are coarse: a node may send several packets meanwhile.
const COARSE_NS: u64 = 10_000_000;

/// So many packets are put in order at once.
const AT_ONCE: usize = 1024;

/// The interval of a node with fewer gaps is not estimated from them.
const FEWEST_GAPS: u64 = 5;

impl Gaps {
    /// Notes that a packet was heard at a time. Returns how much earlier that is than the latest one.
    pub(crate) fn heard(&mut self, time: SimTime) -> Duration {
        let latest = self.latest.unwrap_or(time);
        self.latest = Some(latest.max(time));
        self.times.push(time.as_nanos());
        self.packets += 1;
        self.is_fine |= !time.as_nanos().is_multiple_of(COARSE_NS);
        if self.times.len() == AT_ONCE {
            self.count();
        }
        latest.saturating_since(time)
    }

    /// Counts the gaps between the times that are kept. The last of them stays for the gap to the next.
    fn count(&mut self) {
        self.times.sort_unstable();
        for pair in self.times.windows(2) {
            let gap_ns = pair[1] - pair[0];
            self.repeated += u64::from(gap_ns == 0);
            if gap_ns >= SHORTEST_NS {
                let bin = self.bins.entry(bin_of(gap_ns)).or_default();
                bin.count += 1;
                bin.sum_ns += u128::from(gap_ns);
            }
        }
        self.times.drain(..self.times.len().saturating_sub(1));
    }

    /// Packets, and those that have the time of another one, which are copies of it: none if times are coarse.
    pub(crate) fn repeated(&mut self) -> [u64; 2] {
        self.count();
        [self.packets, if self.is_fine { self.repeated } else { 0 }]
    }

    /// Adds the gaps that another robot heard.
    pub(crate) fn add(&mut self, mut other: Self) {
        other.count();
        for (width, bin) in other.bins {
            let own = self.bins.entry(width).or_default();
            own.count += bin.count;
            own.sum_ns += bin.sum_ns;
        }
    }

    /// The time between two packets of the node, lost ones included, if it sends at regular times and was heard often
    /// enough.
    ///
    /// Of a node that sends at regular times, each gap is a multiple of the interval, and the interval itself is the most
    /// frequent gap, whatever share of the packets is lost independently. So the most frequent gap (to ± 20 %) is the
    /// interval under three conditions. Three quarters of the gaps up to 4.5 intervals are multiples of it to ± 15 %
    /// of the interval. Three tenths of them are the interval itself. At most three tenths of all gaps are longer
    /// than 4.5 intervals, as they would be if packets came in bursts.
    pub(crate) fn interval(&self) -> Option<Duration> {
        let bins: Vec<(f64, u64)> = self.bins.values().map(|bin| (bin.mean_ns(), bin.count)).collect();
        let count = |from_ns: f64, to_ns: f64| -> u64 {
            let from = bins.partition_point(|&(gap_ns, _)| gap_ns < from_ns);
            let to = bins.partition_point(|&(gap_ns, _)| gap_ns <= to_ns);
            bins[from..to.max(from)].iter().map(|&(_, count)| count).sum()
        };
        let near = |gap_ns: f64| count(0.8 * gap_ns, 1.2 * gap_ns);
        let (peak_ns, _) =
            bins.iter().copied().reduce(|best, bin| if near(bin.0) > near(best.0) { bin } else { best })?;
        let mut interval_ns = peak_ns;
        for _ in 0..2 {
            let around: Vec<&Bin> =
                self.bins.values().filter(|bin| (bin.mean_ns() / interval_ns - 1.0).abs() <= 0.15).collect();
            let total: u64 = around.iter().map(|bin| bin.count).sum();
            let sum_ns: u128 = around.iter().map(|bin| bin.sum_ns).sum();
            interval_ns = if total == 0 { return None } else { sum_ns as f64 / total as f64 };
        }
        let all = count(0.0, f64::INFINITY);
        let short = count(0.0, 4.5 * interval_ns);
        let multiple = |m: u32| count((f64::from(m) - 0.15) * interval_ns, (f64::from(m) + 0.15) * interval_ns);
        let multiples: u64 = (1..=4).map(multiple).sum();
        let long = count(4.5 * interval_ns, f64::INFINITY);
        let is_regular = short >= FEWEST_GAPS
            && 4 * multiples >= 3 * short
            && 10 * multiple(1) >= 3 * short
            && 10 * long <= 3 * all;
        is_regular.then(|| Duration::from_secs_f64(interval_ns * 1e-9))
    }
}

/// The number of the bin of a gap: its highest bit and the six bits below it, so bins are at most 1.6 % wide.
fn bin_of(gap_ns: u64) -> u16 {
    let highest = gap_ns.ilog2();
    let fraction = (gap_ns << gap_ns.leading_zeros() << 1) >> 58;
    u16::try_from(u64::from(highest) * 64 + fraction).expect("64 highest bits, 64 fractions")
}

/// The intervals of nodes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Intervals {
    /// Of each node, if it is known.
    pub(crate) of: Vec<Option<Duration>>,
    /// The shortest, the median and the longest of the nodes whose own gaps tell it, and how many these are.
    pub(crate) told: Option<CommonInterval>,
}

/// What the gaps of nodes tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CommonInterval {
    pub(crate) nodes: usize,
    pub(crate) shortest: Duration,
    pub(crate) median: Duration,
    pub(crate) longest: Duration,
}

/// The interval of each node from its gaps. A node whose gaps do not tell it has the median of the others, if those
/// agree to ± 10 %.
pub(crate) fn intervals(gaps: &[Gaps]) -> Intervals {
    let of: Vec<Option<Duration>> = gaps.iter().map(Gaps::interval).collect();
    let mut known: Vec<Duration> = of.iter().copied().flatten().collect();
    known.sort_unstable();
    let (Some(&shortest), Some(&longest)) = (known.first(), known.last()) else {
        return Intervals { of, told: None };
    };
    let median = known[(known.len() - 1) / 2];
    let agree = shortest >= median.mul_f64(0.9) && longest <= median.mul_f64(1.1);
    let common = agree.then_some(median);
    let told = CommonInterval { nodes: known.len(), shortest, median, longest };
    Intervals { of: of.into_iter().map(|own| own.or(common)).collect(), told: Some(told) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packets_at_one_time_are_copies_unless_times_are_coarse() {
        let of = |step_ns: u64, copies: usize| {
            let mut gaps = Gaps::default();
            let times = (0..copies).flat_map(|_| (0..100).map(|number| SimTime::from_nanos(number * step_ns)));
            times.for_each(|time| _ = gaps.heard(time));
            gaps.repeated()
        };
        assert_eq!(of(123_456_789, 1), [100, 0]);
        assert_eq!(of(123_456_789, 3), [300, 200]);
        assert_eq!(of(1_000_000_000, 3), [300, 0]);
    }

    /// The interval of a node that was heard at these times (s), in this order.
    fn told(times_s: impl Iterator<Item = u64>) -> Option<Duration> {
        let (mut heard, mut all) = (Gaps::default(), Gaps::default());
        times_s.for_each(|time_s| {
            heard.heard(SimTime::from_nanos(time_s * 1_000_000_000));
        });
        all.add(heard);
        all.interval()
    }

    #[test]
    fn the_interval_does_not_depend_on_the_order_of_rows() {
        let six = Some(Duration::from_secs(6));
        assert_eq!(told((0..102).map(|packet| 6 * packet)), six);
        assert_eq!(told((0..102).rev().map(|packet| 6 * packet)), six, "the newest first");
        assert_eq!(told((0..102).map(|packet| 6 * (packet * 37 % 102))), six, "mixed");
        assert_eq!(told((0..10_000).rev().map(|packet| 6 * packet)), six, "more than are put in order at once");
    }
}
