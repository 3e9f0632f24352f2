//! Plots of bars: a group for each whole number on the horizontal axis, with a bar for each series.

use super::axes::{Axes, Axis, Shown};
use super::curves::Curves;
use super::sheet::{Entry, Sheet, Symbol};
use crate::paint::file::Figure;
use crate::paint::palette::{CURVES, INK};
use crate::paint::picture::{Area, Picture, Stroke};

/// Size of the plot (px).
const SIZE: (f64, f64) = (560.0, 360.0);
/// Share of the distance between two groups that bars fill.
const FILLED: f64 = 0.84;

/// The same content as [`Curves`], drawn as bars. The horizontal values of all series are whole numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Bars(pub Curves);

impl Bars {
    /// The figure; `name` is the name of its file.
    #[must_use]
    pub fn figure(self, name: &str) -> Figure {
        Figure { name: name.to_owned(), picture: self.draw() }
    }

    fn draw(self) -> Picture {
        let Self(Curves { title, note, across, up, series }) = self;
        let color = |i: usize| CURVES[i % CURVES.len()];
        let points = || series.iter().flat_map(|series| &series.points);
        let low = points().map(|point| point.0).fold(f64::INFINITY, f64::min);
        let high = points().map(|point| point.0).fold(f64::NEG_INFINITY, f64::max);
        let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
        let top = points().map(|point| point.1).fold(0.0, f64::max);
        let legend = series.iter().enumerate().map(|(i, series)| {
            let symbol = Symbol::Square { side: 12.0, fill: color(i) };
            Entry { symbol, text: series.name.clone() }
        });
        let (mut picture, areas) = Sheet { title, note, bar: None, legend: legend.collect() }.lay_out(&[SIZE]);
        let axes = Axes {
            across: Axis { low: low - 0.5, high: high + 0.5, name: across, shown: Shown::All },
            up: Axis { low: 0.0, high: 1.05 * top.max(1e-9), name: up, shown: Shown::All },
            area: areas[0],
        };
        axes.draw_grid(&mut picture);
        let width = FILLED / series.len().max(1) as f64;
        for (i, series) in series.iter().enumerate() {
            let shift = width * i as f64 - FILLED / 2.0;
            for ((x, y), [low, high]) in series.spans() {
                let (corner, foot) = (axes.at(x + shift, y), axes.at(x + shift + width, 0.0));
                let area =
                    Area { left: corner.x, top: corner.y, width: foot.x - corner.x, height: foot.y - corner.y };
                picture.rectangle(area, color(i));
                if low < high {
                    let middle = x + shift + width / 2.0;
                    let (low, high) = (axes.at(middle, low.max(0.0)), axes.at(middle, high));
                    picture.path_within(axes.area, &[low, high], Stroke::new(INK, 1.0));
                }
            }
        }
        axes.draw(&mut picture);
        picture
    }
}

#[cfg(test)]
mod tests {
    use super::super::curves::Series;
    use super::*;
    use crate::paint::picture::Mark;

    #[test]
    fn each_value_is_a_bar_of_its_height_and_bars_do_not_overlap() {
        let series =
            |y: [f64; 2]| Series { name: "a".into(), points: vec![(0.0, y[0]), (1.0, y[1])], intervals: vec![] };
        let curves = Curves {
            title: "t".into(),
            note: String::new(),
            across: "x".into(),
            up: "y".into(),
            series: vec![series([1.0, 2.0]), series([4.0, 3.0])],
        };
        let picture = Bars(curves).draw();
        let bars = |color| -> Vec<Area> {
            let area = |mark: &Mark| match *mark {
                Mark::Rectangle { area, fill } if fill == color && area.height > 13.0 => Some(area),
                _ => None,
            };
            picture.marks.iter().filter_map(area).collect()
        };
        let (first, second) = (bars(CURVES[0]), bars(CURVES[1]));
        assert_eq!((first.len(), second.len()), (2, 2));
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a}, not {b}");
        near(first[1].height, 2.0 * first[0].height);
        near(second[0].height, 4.0 * first[0].height);
        near(first[0].bottom(), second[1].bottom());
        near(first[0].right(), second[0].left);
        assert!(second[0].right() < first[1].left);
    }
}
