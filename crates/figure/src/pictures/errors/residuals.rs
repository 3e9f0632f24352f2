//! Where the log and the reception curve of a map disagree: packets received minus packets expected at each stop.

use plotters::style::RGBColor;
use sextant_mapper::TopologyMap;

use crate::paint::palette::{ACCENT, CURVES, INK, PAPER, THREAD};
use crate::paint::picture::{Picture, Stroke};
use crate::pictures::maps::estimated::{Model, Pair, ReceptionCurve, one_node_in, pairs};
use crate::pictures::source::Source;
use crate::plot::sheet::{Entry, Sheet, Symbol};
use crate::plot::silhouette::draw_solids;
use crate::plot::ticks::number;

/// More packets than expected.
const MORE: RGBColor = CURVES[0];
/// Fewer packets than expected.
const FEWER: RGBColor = ACCENT;
/// Radius of the largest residual, if it is at least a packet (px).
const LARGEST: f64 = 13.0;
/// Round a residual, so that two that overlap can be distinguished.
const RIM: Stroke = Stroke::new(PAPER, 1.0);
const NODE: Stroke = Stroke::new(THREAD, 1.0);
/// Side of the square of a stop (px).
const STOP: f64 = 2.6;

/// The figure of one network of the map `name`; `None` if it has no curve, or no mapped node has a stop that listened to it,
/// or the log is too large for all pairs of a node and a stop to be looked at.
pub(crate) fn draw(source: &Source<'_>, name: &str, map: &TopologyMap, of: &ReceptionCurve<'_>) -> Option<Picture> {
    let model = of.model.as_ref().filter(|_| one_node_in(of.log) == 1)?;
    let pairs = pairs(map, of.log);
    let stops = of.log.stops();
    let residuals = residuals(&pairs, stops.len(), model);
    let largest = residuals.iter().flatten().map(|residual| residual.abs()).fold(f64::NAN, f64::max);
    if largest.is_nan() {
        return None;
    }
    let largest = largest.max(1.0);
    let radius = |residual: f64| LARGEST * (residual.abs() / largest).sqrt();
    let received: f64 = pairs.iter().map(|pair| pair.received).sum();
    let sum: f64 = residuals.iter().flatten().sum();
    let network = of.network.map(|network| format!(", {network}")).unwrap_or_default();
    let views = source.views(source.survey().chain(map.positions().into_iter().flatten()));
    let seen = if views.sizes().len() > 1 { "; seen from above and from the side" } else { "" };
    let sheet = Sheet {
        title: format!("{name}{network}: packets received minus expected at each stop"),
        note: format!(
            "{}; {received:.0} packets received, {} expected under the {}{seen}",
            source.title,
            number(received - sum, 0),
            model.name
        ),
        bar: None,
        legend: legend(largest, &radius, !source.solids().is_empty(), source),
    };
    let (mut picture, areas) = sheet.lay_out(&views.sizes());
    let mut order: Vec<(usize, f64)> =
        residuals.iter().enumerate().filter_map(|(stop, residual)| Some((stop, (*residual)?))).collect();
    // The smallest are drawn last, on top.
    order.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    for panel in views.panels(&areas) {
        draw_solids(&mut picture, &panel, source.solids());
        for place in map.positions().into_iter().flatten() {
            picture.cross(panel.at(place), 2.0, NODE);
        }
        for &(stop, residual) in &order {
            let (at, radius) = (panel.at(stops[stop].position), radius(residual));
            picture.disc(at, radius, if residual < 0.0 { FEWER } else { MORE });
            picture.ring(at, radius, RIM);
        }
        for stop in stops {
            picture.square(panel.at(stop.position), STOP, INK);
        }
        panel.axes.draw(&mut picture);
    }
    Some(picture)
}

fn legend(largest: f64, radius: &dyn Fn(f64) -> f64, has_solids: bool, source: &Source<'_>) -> Vec<Entry> {
    let disc = |fill, text: &str| Entry { symbol: Symbol::Disc { radius: 6.0, fill }, text: text.to_owned() };
    let mut legend = vec![disc(MORE, "more than expected (+)"), disc(FEWER, "fewer than expected (\u{2212})")];
    let size = round(largest);
    legend.push(Entry {
        symbol: Symbol::Circle { radius: radius(size), stroke: Stroke::new(INK, 1.0) },
        text: format!("size of {} packet{}", number(size, 0), if size > 1.0 { "s" } else { "" }),
    });
    legend.push(Entry { symbol: Symbol::Square { side: STOP, fill: INK }, text: "stop".to_owned() });
    legend.push(Entry { symbol: Symbol::Cross { stroke: NODE }, text: "mapped node".to_owned() });
    if has_solids {
        legend.extend(source.obstacle_entry());
    }
    legend
}

/// The largest of 1, 2 and 5 times a power of ten that does not exceed `value`, which is at least 1.
fn round(value: f64) -> f64 {
    let power = libm::pow(10.0, libm::log10(value * (1.0 + 1e-9)).floor());
    [5.0, 2.0].into_iter().map(|factor| factor * power).find(|round| *round <= value).unwrap_or(power)
}

/// Packets received minus packets expected at each stop; `None` where the stop listened to no mapped node.
fn residuals(pairs: &[Pair], stops: usize, model: &Model<'_>) -> Vec<Option<f64>> {
    let mut residuals = vec![None; stops];
    for &Pair { stop, distance_m, received, sent } in pairs {
        *residuals[stop].get_or_insert(0.0) += received - sent * model.at_stop(stop, distance_m);
    }
    residuals
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_residual_is_received_minus_expected() {
        let model = Model {
            name: String::new(),
            probability: Box::new(|distance_m| 1.0 - distance_m / 10.0),
            of_stops: vec![1.0, 0.5, 1.0],
            range_m: None,
        };
        let pair = |stop, distance_m, received| Pair { stop, distance_m, received, sent: 10.0 };
        let found = residuals(&[pair(0, 2.0, 10.0), pair(0, 5.0, 4.0), pair(1, 2.0, 3.0)], 3, &model);
        // 14 received, 8 + 5 expected; 3 received, 4 expected; nothing listened to.
        assert!((found[0].unwrap() - 1.0).abs() < 1e-12 && (found[1].unwrap() + 1.0).abs() < 1e-12);
        assert_eq!(found[2], None);
    }

    #[test]
    fn the_size_in_the_legend_is_round() {
        for (value, expected) in [(1.0, 1.0), (7.3, 5.0), (49.9, 20.0), (10.0, 10.0), (999.0, 500.0)] {
            assert!((round(value) - expected).abs() < 1e-12, "{value}: {}", round(value));
        }
    }
}
