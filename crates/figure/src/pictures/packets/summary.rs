//! Figures of the traffic as the summary counts it, for recordings without a packet trace.

use sextant_kernel::text::counted;
use sextant_recording::{RecordedOutcomes, RecordedTraffic};

use super::Span;
use super::outcomes::FATES;
use crate::paint::picture::Picture;
use crate::plot::curves::{Curves, Series};
use crate::plot::stacks::{Stack, Stacks};

/// The distribution of the delays, by the bins of the histogram; `None` if nothing was delivered.
pub(super) fn delays(title: &str, span: Span, traffic: &[RecordedTraffic]) -> Option<Picture> {
    let series: Vec<_> = traffic.iter().filter_map(curve).collect();
    let curves = Curves {
        title: format!("{title}: delay of {}", span.of_packets()),
        note: span.delivered(", from the histogram of the summary"),
        across: "delay (s)".to_owned(),
        up: "share of the delivered packets".to_owned(),
        series,
    };
    (!curves.series.is_empty()).then(|| curves.draw())
}

/// The curve of a network: exact at the limits of the bins.
fn curve(traffic: &RecordedTraffic) -> Option<Series> {
    let bins = &traffic.delay_histogram;
    let total = bins.iter().map(|bin| bin.packets).sum::<u64>();
    let first = bins.first().filter(|_| total > 0)?;
    let mut below = 0;
    let mut points = vec![(first.from_s, 0.0)];
    // The last bin of all has no end.
    for bin in bins.iter().filter(|bin| bin.to_s < f64::MAX) {
        below += bin.packets;
        points.push((bin.to_s, below as f64 / total as f64));
    }
    let delivered = counted(usize::try_from(total).unwrap_or(usize::MAX), "packet");
    let name = traffic.network.as_ref().map_or_else(String::new, |network| format!("{network}: "));
    Some(Series { name: format!("{name}{delivered} delivered"), points, intervals: Vec::new() })
}

/// Shares of the outcomes by node, of each network; `None` if nothing was offered.
pub(super) fn by_node(title: &str, span: Span, traffic: &[RecordedTraffic]) -> Option<Picture> {
    let stack = |(index, node): (u32, &RecordedOutcomes)| {
        let middle = f64::from(index);
        Stack { from: middle - 0.42, to: middle + 0.42, counts: counts(node) }
    };
    let stacks = (0..).zip(traffic.iter().flat_map(|network| &network.nodes)).map(stack);
    let stacks = Stacks {
        title: format!("{title}: outcomes of {} by node", span.of_packets()),
        note: span.offered().to_owned(),
        across: "number of the node in the summary".to_owned(),
        layers: FATES.map(|(_, words)| words).to_vec(),
        stacks: stacks.filter(|stack| stack.counts.iter().any(|&count| count > 0)).collect(),
    };
    stacks.draw()
}

/// The counts in the order of the layers.
fn counts(node: &RecordedOutcomes) -> Vec<u64> {
    let &RecordedOutcomes {
        delivered,
        lost_collision,
        lost_signal,
        not_listened,
        out_of_range,
        lost_channel_access,
        lost_queue,
        died,
        pending,
        ..
    } = node;
    let lost = [lost_collision, lost_signal, not_listened, out_of_range, lost_channel_access, lost_queue];
    [&[delivered][..], &lost, &[died, pending]].concat()
}

#[cfg(test)]
mod tests {
    use sextant_recording::RecordedDelays;

    use super::*;

    #[test]
    fn a_curve_of_a_histogram_is_exact_at_its_limits() {
        let bin = |from_s, to_s, packets| RecordedDelays { from_s, to_s, packets };
        let traffic = RecordedTraffic {
            network: Some("a".to_owned()),
            delay_histogram: vec![bin(0.001, 0.002, 1), bin(0.002, 0.005, 3)],
            nodes: Vec::new(),
        };
        let curve = curve(&traffic).unwrap();
        assert_eq!(curve.points, [(0.001, 0.0), (0.002, 0.25), (0.005, 1.0)]);
        assert_eq!(curve.name, "a: 4 packets delivered");
    }
}
