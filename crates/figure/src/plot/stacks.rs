//! Stacked shares.

use plotters::style::RGBColor;

use super::axes::{Axes, Axis, Shown};
use super::sheet::{Entry, Sheet, Symbol};
use crate::paint::palette::{CURVES, OBSTACLE, OBSTACLE_RIM};
use crate::paint::picture::{Area, Picture};

/// Size of the plot (px).
const SIZE: (f64, f64) = (640.0, 300.0);

/// Colours of the layers: green for the first one, which is the good one.
const COLOURS: [RGBColor; 9] =
    [CURVES[2], CURVES[1], CURVES[3], CURVES[0], CURVES[4], CURVES[5], CURVES[6], OBSTACLE_RIM, OBSTACLE];

/// Counts that are drawn as shares of their sum.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stack {
    /// Its left end on the horizontal axis.
    pub(crate) from: f64,
    /// Its right end.
    pub(crate) to: f64,
    /// Counts, one a layer.
    pub(crate) counts: Vec<u64>,
}

/// Stacks side by side.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stacks {
    pub(crate) title: String,
    pub(crate) note: String,
    pub(crate) across: String,
    /// Names of the layers, from below; at most nine.
    pub(crate) layers: Vec<&'static str>,
    pub(crate) stacks: Vec<Stack>,
}

impl Stacks {
    /// The figure; `None` if there is no stack. Layers without a count are not in the legend, which has the totals.
    pub(crate) fn draw(self) -> Option<Picture> {
        let Self { title, note, across, layers, stacks } = self;
        let low = stacks.iter().map(|stack| stack.from).reduce(f64::min)?;
        let high = stacks.iter().map(|stack| stack.to).reduce(f64::max)?;
        let total = |layer: usize| stacks.iter().filter_map(|stack| stack.counts.get(layer)).sum::<u64>();
        let legend = layers.iter().enumerate().filter(|(layer, _)| total(*layer) > 0).map(|(layer, name)| Entry {
            symbol: Symbol::Square { side: 12.0, fill: COLOURS[layer % COLOURS.len()] },
            text: format!("{name}: {}", total(layer)),
        });
        let (mut picture, areas) = Sheet { title, note, bar: None, legend: legend.collect() }.lay_out(&[SIZE]);
        let margin = 0.01 * (high - low);
        let axes = Axes {
            across: Axis { low: low - margin, high: high + margin, name: across, shown: Shown::All },
            up: Axis { low: 0.0, high: 1.0, name: "share".to_owned(), shown: Shown::All },
            area: areas[0],
        };
        axes.draw_grid(&mut picture);
        for Stack { from, to, counts } in &stacks {
            let sum = counts.iter().sum::<u64>();
            let mut below = 0;
            for (layer, &count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
                let share = |count: u64| count as f64 / sum as f64;
                let (foot, head) = (axes.at(*from, share(below)), axes.at(*to, share(below + count)));
                let area = Area { left: foot.x, top: head.y, width: head.x - foot.x, height: foot.y - head.y };
                picture.rectangle(area, COLOURS[layer % COLOURS.len()]);
                below += count;
            }
        }
        axes.draw(&mut picture);
        Some(picture)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::picture::Mark;

    #[test]
    fn layers_of_a_stack_fill_the_height_in_proportion() {
        let stack = |from: f64, counts: [u64; 2]| Stack { from, to: from + 1.0, counts: counts.to_vec() };
        let stacks = Stacks {
            title: String::new(),
            note: String::new(),
            across: String::new(),
            layers: vec!["a", "b"],
            stacks: vec![stack(0.0, [3, 1]), stack(1.0, [0, 2])],
        };
        let picture = stacks.draw().unwrap();
        let heights = |color: RGBColor| -> Vec<f64> {
            let height = |mark: &Mark| match *mark {
                Mark::Rectangle { area, fill } if fill == color && area.height > 13.0 => Some(area.height),
                _ => None,
            };
            picture.marks.iter().filter_map(height).map(f64::round).collect()
        };
        assert_eq!((heights(COLOURS[0]), heights(COLOURS[1])), (vec![225.0], vec![75.0, 300.0]));
    }
}
