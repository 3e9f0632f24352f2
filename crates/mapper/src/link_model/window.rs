//! Where a node can be, before anything is heard of its direction: within reach of the places that heard it.

use sextant_channel::Position;

use super::links::{NodeLinks, PlaceLinks};
use crate::log_facts::reach::median;
use crate::log_facts::{HeightReason, SoughtHeights};
use crate::numerics::convex_hull::{hull, turn};
use crate::posterior::PlacePrior;

/// Length over which the density of nodes falls outside the box of the places, as a share of its diagonal.
const BEYOND: f64 = 0.05;
/// The same, as a share of the reach beyond half the width of the box: where robots drove along a line, nodes are beside
/// it.
const BEYOND_REACH: f64 = 0.35;
/// The same in height, as a share of the heights of the places.
const BEYOND_HEIGHT: f64 = 0.25;
/// A node whose stops are higher or lower than all by more than this is on another floor (m).
const ANOTHER_FLOOR_M: f64 = 1.5;
/// Where nothing but the reach is known, a node is within so many times the reach.
const REACHES: f64 = 2.0;
/// The window ends after so many of these lengths.
const LENGTHS: f64 = 4.0;
/// A place is at the border of the survey if it is within this share of the width of the box from one of its sides. If no more
/// than this share of the nodes is strongest there, they are not beyond it.
const BORDER: f64 = 0.1;
const STRONGEST_AT_BORDER: f64 = 1.0 / 3.0;
/// Nodes are far beyond all stops only if this share of them is placed outside.
const MOST_OUTSIDE: f64 = 0.75;

/// The window of all nodes, and the density in it.
#[derive(Clone, Debug)]
pub(super) struct LinkWindow<'a> {
    /// The box of the places (m).
    low: [f64; 3],
    high: [f64; 3],
    /// Length of the fall of the density beyond the box along each axis (m).
    length_m: [f64; 3],
    /// How far the window goes beyond the box (m).
    margin_m: [f64; 3],
    /// Bounds of the heights (m).
    heights: [f64; 2],
    is_bounded_in_height: bool,
    /// Whether nodes are in the plane of the stops, which are not quite level.
    is_plane_of_stops: bool,
    reach_m: f64,
    /// How far from the places that heard it a node can be (m).
    farthest_m: f64,
    places: Vec<Position>,
    prior: Option<&'a PlacePrior>,
}

/// A box (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
}

impl<'a> LinkWindow<'a> {
    pub(super) fn new(
        links: &PlaceLinks,
        sought: SoughtHeights,
        z_is_given: bool,
        prior: Option<&'a PlacePrior>,
    ) -> Self {
        let places = links.places.clone();
        let corner = |from: f64, pick: fn(f64, f64) -> f64| {
            let along = |axis: usize| places.iter().map(|&place| <[f64; 3]>::from(place)[axis]).fold(from, pick);
            [along(0), along(1), along(2)]
        };
        let (low, high) = (corner(f64::INFINITY, f64::min), corner(f64::NEG_INFINITY, f64::max));
        let diagonal_m = libm::hypot(high[0] - low[0], high[1] - low[1]);
        let reach_m = links.reach_m;
        let length_m = [0, 1, 2].map(|axis| {
            let width_m = high[axis] - low[axis];
            if axis == 2 {
                return (BEYOND_HEIGHT * width_m).min(reach_m).max(1e-6);
            }
            let beyond_m = BEYOND_REACH * (reach_m - 0.5 * width_m);
            (BEYOND * diagonal_m).max(beyond_m).max(0.01 * reach_m)
        });
        let margin_m = length_m.map(|length_m| (LENGTHS * length_m).min(reach_m));
        let is_bounded_in_height = z_is_given || sought.high_m <= sought.low_m;
        let heights = if is_bounded_in_height {
            [sought.low_m, sought.high_m]
        } else {
            [(low[2] - margin_m[2]).max(sought.low_m), (high[2] + margin_m[2]).min(sought.high_m)]
        };
        let is_plane_of_stops = matches!(sought.reason, HeightReason::UnevenStops(_));
        Self {
            low,
            high,
            length_m,
            margin_m,
            heights,
            is_bounded_in_height,
            is_plane_of_stops,
            reach_m,
            farthest_m: reach_m,
            places,
            prior,
        }
    }

    /// The window of nodes that may be far beyond all places: their density there falls over the reach. `None` if something is
    /// known of where they are, or too few of the `nodes` are strongest at a border of the survey.
    pub(super) fn of_far(&self, nodes: &[NodeLinks]) -> Option<Self> {
        let strongest = nodes.iter().filter_map(NodeLinks::strongest);
        let at_border = strongest.filter(|&place| self.is_at_border(self.places[place])).count();
        if self.prior.is_some() || at_border as f64 <= STRONGEST_AT_BORDER * nodes.len() as f64 {
            return None;
        }
        let farthest_m = REACHES * self.reach_m;
        let [_, _, up_m] = self.length_m;
        let [_, _, above_m] = self.margin_m;
        let length_m = [self.reach_m, self.reach_m, up_m];
        Some(Self { length_m, margin_m: [farthest_m, farthest_m, above_m], farthest_m, ..self.clone() })
    }

    /// Whether most of the nodes at these places are outside the convex hull of the places where robots listened.
    pub(super) fn holds_most_outside(&self, nodes: &[Position]) -> bool {
        let border = hull(self.places.iter().map(|place| [place.x_m, place.y_m]).collect());
        let is_outside = |node: &&Position| {
            let sides = border.iter().zip(border.iter().cycle().skip(1));
            sides.map(|(&from, &to)| turn(from, to, [node.x_m, node.y_m])).any(|turn| turn < 0.0)
        };
        nodes.iter().filter(is_outside).count() as f64 >= MOST_OUTSIDE * nodes.len() as f64
    }

    fn is_at_border(&self, place: Position) -> bool {
        let at: [f64; 3] = place.into();
        let is_near = |axis: usize| {
            let near_m = BORDER * (self.high[axis] - self.low[axis]);
            at[axis] - self.low[axis] <= near_m || self.high[axis] - at[axis] <= near_m
        };
        is_near(0) || is_near(1)
    }

    /// The plane of `node`: that of all stops, or the median of the places that heard it if that is another floor (m).
    fn plane_of(&self, node: &NodeLinks) -> f64 {
        let heard = node.links.iter().filter(|link| link.received > 0);
        let mut own_m: Vec<f64> = heard.map(|link| self.places[link.place].z_m).collect();
        let all_m = self.heights[0];
        if own_m.is_empty() {
            return all_m;
        }
        let own_m = median(&mut own_m);
        if (own_m - all_m).abs() > ANOTHER_FLOOR_M { own_m } else { all_m }
    }

    /// Bounds of the heights (m).
    pub(super) fn heights(&self) -> [f64; 2] {
        self.heights
    }

    /// Whether the ends of the window along each axis are guessed, and neither given nor those of a plane.
    pub(super) fn is_guessed(&self) -> [bool; 3] {
        let has_area = self.prior.is_some_and(|prior| prior.area.is_some());
        [!has_area, !has_area, !self.is_bounded_in_height]
    }

    /// Where `node` can be: within reach of the places that heard it, and in the window.
    pub(super) fn of(&self, node: &NodeLinks) -> Bounds {
        let [corner_low, corner_high] = node.heard.corners;
        let axis_bounds = |axis: usize| {
            if axis == 2 {
                return if self.is_plane_of_stops { [self.plane_of(node); 2] } else { self.heights };
            }
            let mut low = (self.low[axis] - self.margin_m[axis]).max(corner_low[axis] - self.farthest_m);
            let mut high = (self.high[axis] + self.margin_m[axis]).min(corner_high[axis] + self.farthest_m);
            if let Some(area) = self.prior.and_then(|prior| prior.area.as_ref()) {
                let [area_low, area_high] = area.bounds();
                // What the user knows wins over what is usual.
                low = area_low[axis].max(corner_low[axis] - self.reach_m);
                high = area_high[axis].min(corner_high[axis] + self.reach_m);
                if low >= high {
                    (low, high) = (area_low[axis], area_high[axis]);
                }
            }
            [low, high]
        };
        let bounds = [0, 1, 2].map(axis_bounds);
        Bounds { low: bounds.map(|[low, _]| low), high: bounds.map(|[_, high]| high) }
    }

    /// Where `node` can be if only its reach is known: within twice the reach of the places that heard it.
    pub(super) fn within_reach(&self, node: &NodeLinks) -> Bounds {
        let [corner_low, corner_high] = node.heard.corners;
        let far_m = REACHES * self.reach_m.max(node.heard.farthest_m);
        let mut bounds = self.of(node);
        for axis in 0..2 {
            bounds.low[axis] = corner_low[axis] - far_m;
            bounds.high[axis] = corner_high[axis] + far_m;
        }
        bounds
    }

    /// How far `place` is beyond the box of the places, as a multiple of the length over which the density of nodes falls there; 0
    /// inside it, and where an area is known.
    pub(super) fn beyond(&self, place: Position) -> f64 {
        let at: [f64; 3] = place.into();
        let guessed = (0..2).filter(|&axis| self.is_guessed()[axis]);
        let beyond_m = |axis: usize| (self.low[axis] - at[axis]).max(at[axis] - self.high[axis]);
        guessed.map(|axis| beyond_m(axis) / self.length_m[axis]).fold(0.0, f64::max)
    }

    /// The distance of `place` from the border of the area in which nodes are known to be, if there is one (m).
    pub(super) fn to_border_m(&self, place: Position) -> Option<f64> {
        Some(self.prior?.area.as_ref()?.to_border_m(place))
    }

    /// Logarithm of the density of nodes at `place`, up to a constant.
    pub(super) fn log_density(&self, place: Position) -> f64 {
        let at: [f64; 3] = place.into();
        let is_guessed = self.is_guessed();
        let mut log = 0.0;
        for (axis, along_m) in at.into_iter().enumerate().filter(|(axis, _)| is_guessed[*axis]) {
            let beyond_m = (self.low[axis] - along_m).max(along_m - self.high[axis]).max(0.0);
            log -= beyond_m / self.length_m[axis];
        }
        if let Some(prior) = self.prior {
            let nearest_m = match prior.near_stops_m {
                Some(_) => self.places.iter().map(|stop| stop.distance_m(place)).fold(f64::INFINITY, f64::min),
                None => 0.0,
            };
            log += prior.log_density(place, nearest_m);
        }
        log
    }
}

impl Bounds {
    /// Widths (m).
    fn widths(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| (self.high[axis] - self.low[axis]).max(0.0))
    }

    /// Number of cells along each axis of a grid of about `count` cells, and its step (m).
    fn cells(&self, count: f64) -> ([usize; 3], f64) {
        let widths = self.widths();
        let step_m = step_m(widths, count);
        (widths.map(|width| crate::numerics::whole((width / step_m).round()).max(1)), step_m)
    }

    /// The vertices of a grid in the box, about `count` in number, each in the middle of its cell, and the step (m).
    pub(super) fn vertices(&self, count: f64) -> (Vec<Position>, f64) {
        let (cells, step_m) = self.cells(count);
        let widths = self.widths();
        let along =
            |axis: usize, cell: usize| self.low[axis] + widths[axis] * (cell as f64 + 0.5) / cells[axis] as f64;
        let mut vertices = Vec::with_capacity(cells.iter().product());
        for z in 0..cells[2] {
            for y in 0..cells[1] {
                for x in 0..cells[0] {
                    vertices.push(Position::new(along(0, x), along(1, y), along(2, z)));
                }
            }
        }
        (vertices, step_m)
    }

    /// Whole cells of a grid of about `count` cells in the box that hold the part round `middle`, `half` wide on each side
    /// along each axis (m).
    pub(super) fn cells_round(&self, count: f64, middle: Position, half: [f64; 3]) -> Self {
        let (cells, widths) = (self.cells(count).0, self.widths());
        let part = self.round(middle, half);
        let edge = |axis: usize, at_m: f64, round: fn(f64) -> f64| {
            let width_m = widths[axis] / cells[axis] as f64;
            if width_m > 0.0 { self.low[axis] + width_m * round((at_m - self.low[axis]) / width_m) } else { at_m }
        };
        let low = [0, 1, 2].map(|axis| edge(axis, part.low[axis], f64::floor).max(self.low[axis]));
        let high = [0, 1, 2].map(|axis| edge(axis, part.high[axis], f64::ceil).min(self.high[axis]));
        Self { low, high }
    }

    /// Whether `place` is in the box.
    pub(super) fn contains(&self, place: Position) -> bool {
        let at: [f64; 3] = place.into();
        (0..3).all(|axis| at[axis] >= self.low[axis] && at[axis] <= self.high[axis])
    }

    /// The part of the box round `middle`, `half` wide on each side along each axis (m).
    pub(super) fn round(&self, middle: Position, half: [f64; 3]) -> Self {
        let middle: [f64; 3] = middle.into();
        let low = [0, 1, 2].map(|axis| (middle[axis] - half[axis]).clamp(self.low[axis], self.high[axis]));
        let high = [0, 1, 2].map(|axis| (middle[axis] + half[axis]).clamp(self.low[axis], self.high[axis]));
        Self { low, high }
    }
}

/// The step with which a box of these widths has about `count` cells (m).
fn step_m(widths: [f64; 3], count: f64) -> f64 {
    let cells = |step_m: f64| widths.iter().map(|width| (width / step_m).round().max(1.0)).product::<f64>();
    let widest = widths.into_iter().fold(0.0, f64::max);
    if widest <= 0.0 {
        return 1.0;
    }
    let (mut fine, mut coarse) = (widest / count, widest);
    for _ in 0..40 {
        let middle = (fine * coarse).sqrt();
        if cells(middle) > count { fine = middle } else { coarse = middle }
    }
    coarse
}
