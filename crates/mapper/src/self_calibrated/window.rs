//! The vertices round the last place of a node, on which its posterior is computed.

use sextant_channel::Position;

use super::belief::PlaceBelief;
use crate::log_facts::search_box::SearchBox;
use crate::posterior::Cell;

/// Least number of steps from the middle of a window to its edge.
const REACH: usize = 4;
/// Maximum number of steps from the middle to the edge, in the plane and in space, fine and coarse.
const MOST: [[usize; 2]; 2] = [[24, 9], [24, 4]];
/// Half the width of a window in standard deviations of the last posterior.
const SPREADS: f64 = 4.0;
/// Steps along an axis are doubled while they are below this share of the standard deviation, fine and coarse in space.
const COARSENESS: [f64; 2] = [0.8, 1.6];
/// A log that lists more pairs of a node and a stop than this is long.
const MOST_PAIRS: usize = 50_000;
/// Where vertices lie relative to round coordinates, in steps (powers of the golden ratio): a lattice that matches
/// the places of the nodes would make estimates look better than they are.
const PHASE: [f64; 3] = [0.381_966, 0.236_068, 0.145_898];

/// How much work a round may take: less for a long log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RoundDetail {
    Fine,
    Coarse,
}

impl RoundDetail {
    /// The detail for a log that lists so many pairs of a node and a stop.
    pub(super) fn of_pairs(pairs: usize) -> Self {
        if pairs > MOST_PAIRS { Self::Coarse } else { Self::Fine }
    }
}

/// A box of vertices. They are counted with x running fastest.
#[derive(Debug, Default)]
pub(super) struct VertexWindow {
    axes: [Axis; 3],
}

/// The coordinates of the vertices along an axis (m).
#[derive(Debug, Default)]
struct Axis {
    /// Never empty once it is laid.
    coordinates: Vec<f64>,
    /// Whether guessed bounds of the node cut the window off, at the low and at the high end.
    is_cut: [bool; 2],
    /// Whether no bounds cut the window off, at the low and at the high end.
    is_open: [bool; 2],
}

impl VertexWindow {
    /// Lays the vertices round the last belief and within the bounds, in steps of `step_m` or longer ones.
    pub(super) fn lay(&mut self, bounds: &SearchBox, before: &PlaceBelief, step_m: f64, detail: RoundDetail) {
        for (number, axis) in self.axes.iter_mut().enumerate() {
            axis.lay(number, bounds, before, step_m, detail);
        }
    }

    /// Number of vertices.
    pub(super) fn len(&self) -> usize {
        self.axes.iter().map(|axis| axis.coordinates.len()).product()
    }

    /// What each vertex stands for.
    pub(super) fn cell(&self) -> Cell {
        Cell::new([0, 1, 2].map(|axis| self.axes[axis].step_m()))
    }

    /// Number of vertices with which a box would be filled, at least that of the window: one that does not reach an end of
    /// the box leaves out only places that are not likely.
    pub(super) fn vertices_in(&self, bounds: &SearchBox) -> f64 {
        let along = |(number, axis): (usize, &Axis)| {
            let (count, [first, last]) = (axis.coordinates.len() as f64, axis.ends());
            let step_m = (last - first) / (count - 1.0);
            if step_m > 0.0 { count.max((bounds.high[number] - bounds.low[number]) / step_m) } else { count }
        };
        self.axes.iter().enumerate().map(along).product()
    }

    /// Coordinates of the first and the last vertices along an axis (m).
    pub(super) fn ends(&self, axis: usize) -> [f64; 2] {
        self.axes[axis].ends()
    }

    /// The distance from `place` to the farthest vertex, at most (m).
    pub(super) fn radius_m(&self, place: Position) -> f64 {
        let place: [f64; 3] = place.into();
        let mut square = 0.0;
        for (axis, middle) in self.axes.iter().zip(place) {
            let reach_m = axis.ends().map(|end| (end - middle).abs()).into_iter().fold(0.0, f64::max);
            square += reach_m * reach_m;
        }
        square.sqrt()
    }

    /// Calls `visit` with the number and the place of each vertex, in order.
    #[inline]
    pub(super) fn each(&self, mut visit: impl FnMut(usize, Position)) {
        let [xs, ys, zs] = &self.axes;
        let mut vertex = 0;
        for &z_m in &zs.coordinates {
            for &y_m in &ys.coordinates {
                for &x_m in &xs.coordinates {
                    visit(vertex, Position::new(x_m, y_m, z_m));
                    vertex += 1;
                }
            }
        }
    }

    /// Whether guessed bounds cut the window off anywhere.
    pub(super) fn is_cut(&self) -> bool {
        self.axes.iter().any(|axis| axis.is_cut != [false; 2])
    }

    /// Whether a vertex is at an end of the window that no bounds cut off, and that may therefore be too near.
    pub(super) fn is_at_open_end(&self, vertex: usize) -> bool {
        let [columns, rows, _] = [0, 1, 2].map(|axis| self.axes[axis].coordinates.len());
        let indices = [vertex % columns, vertex / columns % rows, vertex / (columns * rows)];
        self.axes.iter().zip(indices).any(|(axis, index)| axis.is_open_at(index))
    }

    /// Whether guessed bounds cut the window off right at a vertex.
    pub(super) fn is_at_cut(&self, vertex: usize) -> bool {
        let [columns, rows, _] = [0, 1, 2].map(|axis| self.axes[axis].coordinates.len());
        let indices = [vertex % columns, vertex / columns % rows, vertex / (columns * rows)];
        self.axes.iter().zip(indices).any(|(axis, index)| axis.is_cut_at(index))
    }
}

impl Axis {
    fn lay(
        &mut self,
        number: usize,
        bounds: &SearchBox,
        before: &PlaceBelief,
        least_step_m: f64,
        detail: RoundDetail,
    ) {
        let (low, high) = (bounds.low[number], bounds.high[number]);
        let mean_m = <[f64; 3]>::from(before.mean)[number];
        self.coordinates.clear();
        self.is_cut = [false; 2];
        self.is_open = [false; 2];
        if low < high {
            let spread_m = before.spread_m(number);
            let is_coarse = detail == RoundDetail::Coarse && !bounds.is_level();
            let step_m = step_m(spread_m, least_step_m, COARSENESS[usize::from(is_coarse)]);
            let half = half_width(spread_m, step_m, MOST[detail as usize][usize::from(!bounds.is_level())]);
            let middle = (mean_m / step_m - PHASE[number]).round() + PHASE[number];
            self.is_open = [true; 2];
            for along in (0..=2 * half).map(|i| (middle + f64::from(i) - f64::from(half)) * step_m) {
                if along < low {
                    self.is_cut[0] = bounds.is_guessed[number];
                    self.is_open[0] = false;
                } else if along > high {
                    self.is_cut[1] = bounds.is_guessed[number];
                    self.is_open[1] = false;
                } else {
                    self.coordinates.push(along);
                }
            }
        }
        if self.coordinates.is_empty() {
            self.coordinates.push(mean_m.clamp(low, high));
        }
    }

    /// Distance of neighbouring vertices; 0 if there is one (m).
    fn step_m(&self) -> f64 {
        match self.coordinates[..] {
            [first, second, ..] => second - first,
            _ => 0.0,
        }
    }

    fn ends(&self) -> [f64; 2] {
        [self.coordinates[0], self.coordinates[self.coordinates.len() - 1]]
    }

    fn is_open_at(&self, index: usize) -> bool {
        self.is_open[0] && index == 0 || self.is_open[1] && index + 1 == self.coordinates.len()
    }

    fn is_cut_at(&self, index: usize) -> bool {
        self.is_cut[0] && index == 0 || self.is_cut[1] && index + 1 == self.coordinates.len()
    }
}

/// Step along an axis along which the last posterior spreads by `spread_m` (m).
fn step_m(spread_m: f64, least_step_m: f64, coarseness: f64) -> f64 {
    let doublings = libm::log2(coarseness * spread_m / least_step_m).floor().clamp(0.0, 20.0);
    least_step_m * libm::exp2(doublings)
}

/// Steps from the middle of a window to its edge.
fn half_width(spread_m: f64, step_m: f64, most: usize) -> u32 {
    let half = crate::numerics::whole((SPREADS * spread_m / step_m).ceil()).clamp(REACH, most);
    u32::try_from(half).unwrap_or(u32::MAX)
}
