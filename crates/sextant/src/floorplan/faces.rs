//! The lines of walls moved to the middle between their faces.
//!
//! Thinning leaves a line of cells, which cannot be in the middle of a wall of an even number of cells, and takes more from one end than
//! from the other.

use super::graph::WallLine;
use super::lines::{Cell, distance};
use super::occupancy::Mask;

/// A wall that is thicker or thinner than this times its mean thickness is measured where something else stands.
const THINNEST: f64 = 0.5;
const THICKEST: f64 = 1.5;
/// A corner of two legs whose directions have a smaller cross product is no corner (sine of 30°).
const STRAIGHT: f64 = 0.5;
/// An end at the face of another wall is at most so far from it (cells).
const SNAP: f64 = 1.5;

/// A straight part of a wall.
#[derive(Clone, Copy, Debug)]
struct Leg {
    from: Cell,
    way: Cell,
    length: f64,
}

impl Leg {
    fn new(from: Cell, to: Cell) -> Self {
        let length = distance(from, to);
        let way = [0, 1].map(|axis| (to[axis] - from[axis]) / length.max(1e-9));
        Self { from, way, length }
    }

    /// The direction to the left of the way.
    fn left(&self) -> Cell {
        [-self.way[1], self.way[0]]
    }

    fn at(&self, along: f64) -> Cell {
        moved(self.from, self.way, along)
    }
}

fn moved(from: Cell, way: Cell, by: f64) -> Cell {
    [0, 1].map(|axis| from[axis] + by * way[axis])
}

fn dot(a: Cell, b: Cell) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// The middle one of some numbers, or the mean of the middle two.
fn median(mut numbers: Vec<f64>) -> Option<f64> {
    numbers.sort_by(f64::total_cmp);
    let last = numbers.len().checked_sub(1)?;
    Some(0.5 * (numbers[last / 2] + numbers[last.div_ceil(2)]))
}

/// The wall with each leg in the middle between its faces in `mask`, as thick as they are apart, up to the faces of its free ends.
pub(super) fn between_faces(wall: &WallLine, mask: &Mask) -> WallLine {
    let legs: Vec<Leg> = wall.line.windows(2).map(|leg| Leg::new(leg[0], leg[1])).collect();
    let mut widths = Vec::new();
    let offsets: Vec<f64> = legs.iter().map(|leg| offset(leg, wall.thickness, mask, &mut widths)).collect();
    let thickness = median(widths).unwrap_or(wall.thickness);
    let count = legs.len();
    let is_closed = count > 2 && distance(wall.line[0], wall.line[count]) <= 0.0;
    let corner = |(at, &place): (usize, &Cell)| {
        let before = if at > 0 { Some(at - 1) } else { is_closed.then(|| count - 1) };
        let after = if at < count { Some(at) } else { is_closed.then_some(0) };
        let shift = match (before, after) {
            (Some(a), Some(b)) => of_corner([legs[a].left(), legs[b].left()], [offsets[a], offsets[b]]),
            (Some(only), None) | (None, Some(only)) => moved([0.0; 2], legs[only].left(), offsets[only]),
            (None, None) => [0.0; 2],
        };
        [0, 1].map(|axis| place[axis] + shift[axis])
    };
    let mut line: Vec<Cell> = wall.line.iter().enumerate().map(corner).collect();
    for (end, &is_free) in wall.is_free.iter().enumerate() {
        if is_free && !is_closed && count > 0 {
            let (last, before) = if end == 0 { (0, 1) } else { (count, count - 1) };
            line[last] = face_of_end(&Leg::new(line[before], line[last]), thickness, mask);
        }
    }
    WallLine { line, thickness, is_free: wall.is_free }
}

/// By how much the middle between the faces is to the left of a leg; adds how far apart they are to `widths`.
fn offset(leg: &Leg, thickness: f64, mask: &Mask, widths: &mut Vec<f64>) -> f64 {
    // Away from corners and from walls that meet it there.
    let margin = thickness.min(0.5 * leg.length);
    let inner = leg.length - 2.0 * margin;
    let count = inner.ceil().max(1.0);
    let mut offsets = Vec::new();
    let mut step = 0.5;
    while step < count {
        let place = leg.at(margin + inner * step / count);
        let [left, right] = [1.0, -1.0].map(|side| reach(mask, place, leg.left().map(|part| side * part)));
        let width = left + right;
        if width >= THINNEST * thickness && width <= THICKEST * thickness + 1.0 {
            offsets.push(0.5 * (left - right));
            widths.push(width);
        }
        step += 1.0;
    }
    median(offsets).unwrap_or(0.0)
}

/// How a corner moves if its two legs move to their left by these lengths.
fn of_corner([a, b]: [Cell; 2], [of_a, of_b]: [f64; 2]) -> Cell {
    let cross = a[0] * b[1] - a[1] * b[0];
    if cross.abs() < STRAIGHT {
        return [0, 1].map(|axis| 0.5 * (of_a * a[axis] + of_b * b[axis]));
    }
    [(of_a * b[1] - of_b * a[1]) / cross, (of_b * a[0] - of_a * b[0]) / cross]
}

/// Where a wall ends that goes along `leg` and ends freely.
fn face_of_end(leg: &Leg, thickness: f64, mask: &Mask) -> Cell {
    let inside = thickness.min(0.5 * leg.length);
    let base = leg.at(leg.length - inside);
    let ways = [-0.3, -0.15, 0.0, 0.15, 0.3].map(|aside| {
        let from = moved(base, leg.left(), aside * thickness);
        reach(mask, from, leg.way)
    });
    match median(ways.into_iter().filter(|&way| way > 0.0).collect()) {
        Some(way) if way <= inside + 2.0 * thickness + 1.0 => moved(base, leg.way, way),
        _ => leg.at(leg.length),
    }
}

/// How far it is from a place in this direction to what is not in `mask`: 0 if the place itself is not.
fn reach(mask: &Mask, from: Cell, way: Cell) -> f64 {
    // J. Amanatides, A. Woo: A fast voxel traversal algorithm for ray tracing. Eurographics, 1987. Cell i reaches from i − 1/2 to i + 1/2.
    let place = from.map(|part| part + 0.5);
    let mut cell = place.map(f64::floor);
    let mut next = [0, 1].map(|axis| match way[axis] {
        step if step > 0.0 => (cell[axis] + 1.0 - place[axis]) / step,
        step if step < 0.0 => (cell[axis] - place[axis]) / step,
        _ => f64::INFINITY,
    });
    let mut reached = 0.0;
    while mask.has_at(cell) {
        let axis = usize::from(next[1] < next[0]);
        reached = next[axis];
        cell[axis] += way[axis].signum();
        next[axis] += 1.0 / way[axis].abs();
    }
    reached
}

/// Brings the ends of walls that meet another one exactly to its face.
pub(super) fn meet_faces(walls: &mut [WallLine]) {
    let of = |wall: &WallLine| -> Vec<(Leg, f64)> {
        wall.line.windows(2).map(|leg| (Leg::new(leg[0], leg[1]), 0.5 * wall.thickness)).collect()
    };
    let legs: Vec<Vec<(Leg, f64)>> = walls.iter().map(of).collect();
    for (number, wall) in walls.iter_mut().enumerate() {
        let last = wall.line.len() - 1;
        for (is_free, [end, before]) in wall.is_free.into_iter().zip([[0, 1], [last, last.saturating_sub(1)]]) {
            if is_free || last == 0 || distance(wall.line[0], wall.line[last]) <= 0.0 {
                continue;
            }
            let leg = Leg::new(wall.line[before], wall.line[end]);
            let others = legs.iter().enumerate().filter(|&(other, _)| other != number).flat_map(|(_, legs)| legs);
            let nearest = others.filter_map(|(other, half)| to_face(&leg, other, *half));
            if let Some(by) = nearest.min_by(|a, b| a.abs().total_cmp(&b.abs())) {
                wall.line[end] = leg.at(leg.length + by);
            }
        }
    }
}

/// How far it is from the end of `leg` on to the nearer face of `other`, if it is near.
fn to_face(leg: &Leg, other: &Leg, half: f64) -> Option<f64> {
    let across = dot(leg.way, other.left());
    if across.abs() < STRAIGHT {
        return None;
    }
    let end = leg.at(leg.length);
    let off = dot([end[0] - other.from[0], end[1] - other.from[1]], other.left());
    let ways = [half, -half].map(|face| (face - off) / across);
    ways.into_iter().filter(|by| by.abs() <= SNAP).min_by(|a, b| a.abs().total_cmp(&b.abs())).filter(|&by| {
        let hit = leg.at(leg.length + by);
        let along = dot([hit[0] - other.from[0], hit[1] - other.from[1]], other.way);
        (-half - 1.0..=other.length + half + 1.0).contains(&along)
    })
}
