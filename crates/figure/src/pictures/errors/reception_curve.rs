//! The reception curve of a map against the data: the share of packets received by distance.

use sextant_mapper::TopologyMap;

use crate::paint::palette::{ACCENT, CURVES};
use crate::paint::picture::{Picture, Point, Stroke};
use crate::pictures::maps::estimated::{Pair, ReceptionCurve, one_node_in, pairs};
use crate::plot::axes::{Axes, Axis, Shown};
use crate::plot::sheet::{Entry, Sheet, Symbol};

/// Size of the plot (px).
const SIZE: (f64, f64) = (560.0, 360.0);
/// Number of bins of the distance.
const BINS: u16 = 24;
/// Points of the curve.
const STEPS: u16 = 400;
/// The normal quantile of a two-sided interval of 95 %.
const Z_95: f64 = 1.959_963_984_540_054;
/// Radius of a point (px).
const POINT: f64 = 3.2;
const DATA: Stroke = Stroke::new(CURVES[0], 1.2);
const CURVE: Stroke = Stroke::new(ACCENT, 2.0);

/// The figure of one network of the map `name`; `None` if no mapped node has a stop that listened to it.
pub(crate) fn draw(title: &str, name: &str, map: &TopologyMap, of: &ReceptionCurve<'_>) -> Option<Picture> {
    let pairs = pairs(map, of.log);
    let high = shown_m(&pairs, of.model.as_ref().and_then(|model| model.range_m))?;
    let shares = shares(&pairs, high);
    let symbol = Symbol::Disc { radius: POINT, fill: DATA.color };
    let mut legend = vec![Entry { symbol, text: "share of packets received, with its 95 % interval".to_owned() }];
    if let Some(model) = &of.model {
        legend.push(Entry { symbol: Symbol::Line { stroke: CURVE, pattern: &[] }, text: model.name.clone() });
    }
    let network = of.network.map(|network| format!(", {network}")).unwrap_or_default();
    let sheet = Sheet {
        title: format!("{name}{network}: receptions by distance"),
        note: format!(
            "{title}; {} pairs of a mapped node and a stop{}, each counted as one observation",
            pairs.len(),
            Some(one_node_in(of.log))
                .filter(|&nodes| nodes > 1)
                .map_or(String::new(), |nodes| format!(", one of {nodes} nodes"))
        ),
        bar: None,
        legend,
    };
    let (mut picture, areas) = sheet.lay_out(&[SIZE]);
    let across = "distance from the stop to the mapped node [m]".to_owned();
    let axes = Axes {
        across: Axis { low: 0.0, high, name: across, shown: Shown::All },
        up: Axis { low: 0.0, high: 1.04, name: "share of packets received".to_owned(), shown: Shown::All },
        area: areas[0],
    };
    axes.draw_grid(&mut picture);
    for share in &shares {
        let [low, high] = share.interval();
        picture.line(axes.at(share.middle_m, low), axes.at(share.middle_m, high), DATA);
    }
    for share in &shares {
        picture.disc(axes.at(share.middle_m, share.share()), POINT, DATA.color);
    }
    if let Some(model) = &of.model {
        let at = |i: u16| {
            let distance_m = high * f64::from(i) / f64::from(STEPS);
            axes.at(distance_m, (model.probability)(distance_m).clamp(0.0, 1.0))
        };
        picture.path((0..=STEPS).map(at).collect::<Vec<Point>>(), CURVE);
    }
    axes.draw(&mut picture);
    Some(picture)
}

/// How far the distances are shown (m): a quarter beyond the range of the curve and beyond nearly all receptions, but not
/// beyond the data. `None` without data.
fn shown_m(pairs: &[Pair], range_m: Option<f64>) -> Option<f64> {
    let farthest = pairs.iter().map(|pair| pair.distance_m).fold(f64::NAN, f64::max);
    let mut heard: Vec<f64> = pairs.iter().filter(|pair| pair.received > 0.0).map(|pair| pair.distance_m).collect();
    heard.sort_unstable_by(f64::total_cmp);
    let usual = heard.get(heard.len() * 99 / 100).copied().unwrap_or(0.0);
    let wanted = 1.25 * range_m.filter(|range_m| range_m.is_finite()).unwrap_or(0.0).max(usual);
    let shown = if wanted > 0.0 { wanted.min(1.02 * farthest) } else { farthest };
    (!pairs.is_empty()).then_some(shown.max(1e-3))
}

/// The share of packets received in a bin of the distance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Share {
    middle_m: f64,
    received: f64,
    sent: f64,
    /// Number of pairs.
    pairs: f64,
}

impl Share {
    fn share(&self) -> f64 {
        self.received / self.sent
    }

    /// The interval of Wilson (1927). The packets of a pair share its shadowing, so each pair is one observation.
    fn interval(&self) -> [f64; 2] {
        let (share, count, squared) = (self.share(), self.pairs, Z_95 * Z_95);
        let middle = (share + squared / (2.0 * count)) / (1.0 + squared / count);
        let half =
            Z_95 / (1.0 + squared / count) * (share * (1.0 - share) / count + squared / (4.0 * count * count)).sqrt();
        [(middle - half).max(0.0), (middle + half).min(1.0)]
    }
}

/// The shares in the bins up to `high` that have pairs.
fn shares(pairs: &[Pair], high: f64) -> Vec<Share> {
    let width = high / f64::from(BINS);
    let of_bin = |bin: u16| {
        let (from, to) = (width * f64::from(bin), width * f64::from(bin + 1));
        let mut sum = Share { middle_m: 0.5 * (from + to), ..Share::default() };
        for pair in pairs.iter().filter(|pair| pair.distance_m >= from && pair.distance_m < to) {
            sum.received += pair.received;
            sum.sent += pair.sent;
            sum.pairs += 1.0;
        }
        sum
    };
    (0..BINS).map(of_bin).filter(|share| share.pairs > 0.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_is_that_of_wilson() {
        // Brown, Cai and DasGupta (2001) give the formula; for 0 of 10 and 5 of 10 by hand.
        let share = |received| Share { middle_m: 0.0, received, sent: 10.0, pairs: 10.0 };
        let [low, high] = share(0.0).interval();
        assert!(low.abs() < 1e-12 && (high - 0.277_5).abs() < 1e-4, "{low} {high}");
        let [low, high] = share(5.0).interval();
        assert!((low - 0.236_6).abs() < 1e-4 && (high - 0.763_4).abs() < 1e-4, "{low} {high}");
    }

    #[test]
    fn packets_are_summed_by_distance() {
        let pair = |distance_m, received| Pair { stop: 0, distance_m, received, sent: 4.0 };
        let shares = shares(&[pair(0.1, 4.0), pair(0.2, 2.0), pair(23.5, 1.0), pair(99.0, 4.0)], 24.0);
        assert_eq!(shares.len(), 2);
        assert!((shares[0].share() - 0.75).abs() < 1e-12 && (shares[1].share() - 0.25).abs() < 1e-12);
        assert!((shares[1].middle_m - 23.5).abs() < 1e-12);
    }

    #[test]
    fn distances_are_shown_as_far_as_something_is_received() {
        let pair = |distance_m, received| Pair { stop: 0, distance_m, received, sent: 4.0 };
        let pairs = [pair(2.0, 4.0), pair(8.0, 1.0), pair(100.0, 0.0)];
        assert!((shown_m(&pairs, None).unwrap() - 10.0).abs() < 1e-12);
        assert!((shown_m(&pairs, Some(20.0)).unwrap() - 25.0).abs() < 1e-12);
        assert!((shown_m(&pairs[..2], Some(20.0)).unwrap() - 8.16).abs() < 1e-12);
        assert_eq!(shown_m(&[], Some(20.0)), None);
    }
}
