//! The distribution of the delays of the packets.

use std::collections::BTreeMap;

use sextant_kernel::text::counted;

use super::{PacketSource, Span, seconds};
use crate::paint::picture::Picture;
use crate::plot::curves::{Curves, Series};

/// Points of a curve, at most: with more packets, only each so many is a point.
const MOST_POINTS: usize = 1000;

/// The figure: a curve for each network; `None` if no packet was delivered.
pub(super) fn draw(source: &PacketSource<'_>, span: Span) -> Option<Picture> {
    let mut networks: BTreeMap<&str, (u64, Vec<f64>)> = BTreeMap::new();
    for packet in source.packets.iter().map(|packet| &packet.packet).filter(|packet| packet.counted) {
        let (ended, delays) = networks.entry(&packet.network).or_default();
        *ended += u64::from(packet.fate != "pending");
        delays.extend(packet.delivered_ns.map(|delivered| seconds(delivered.saturating_sub(packet.offered_ns))));
    }
    let series: Vec<_> = networks
        .into_iter()
        .filter(|(_, (_, delays))| !delays.is_empty())
        .map(|(network, (ended, mut delays))| {
            delays.sort_by(f64::total_cmp);
            curve(network, &format!(" of {ended}"), &delays)
        })
        .collect();
    let curves = Curves {
        title: format!("{}: delay of {}", source.title, span.of_packets()),
        note: span.delivered(" from offer to reception"),
        across: "delay (s)".to_owned(),
        up: "share of the delivered packets".to_owned(),
        series,
    };
    (!curves.series.is_empty()).then(|| curves.draw())
}

/// The curve of delays in ascending order (s), of so many packets in words.
pub(super) fn curve(network: &str, of: &str, delays: &[f64]) -> Series {
    let count = delays.len();
    let share = |i: usize| i as f64 / count as f64;
    let at = |percent: usize| delays[(percent * count).div_ceil(100).max(1) - 1];
    let name = if network.is_empty() { String::new() } else { format!("{network}: ") };
    let name = format!(
        "{name}{}{of} delivered, median {:.1} ms, 99 % within {:.1} ms",
        counted(count, "packet"),
        1e3 * at(50),
        1e3 * at(99)
    );
    let step = count.div_ceil(MOST_POINTS);
    let mut points = vec![(0.0, 0.0), (delays[0], 0.0)];
    for i in (0..count).filter(|i| i % step == 0 || i + 1 == count) {
        let last = points[points.len() - 1].1;
        points.push((delays[i], last));
        points.push((delays[i], share(i + 1)));
    }
    Series { name, points, intervals: Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_rises_to_one_in_equal_steps() {
        let curve = curve("", " of 5", &[0.1, 0.2, 0.2, 0.4]);
        let expected = [
            (0.0, 0.0),
            (0.1, 0.0),
            (0.1, 0.0),
            (0.1, 0.25),
            (0.2, 0.25),
            (0.2, 0.5),
            (0.2, 0.5),
            (0.2, 0.75),
            (0.4, 0.75),
            (0.4, 1.0),
        ];
        assert_eq!(curve.points, expected);
        assert_eq!(curve.name, "4 packets of 5 delivered, median 200.0 ms, 99 % within 400.0 ms");
    }
}
