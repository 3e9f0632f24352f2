//! The lines of a drawing on the floor: blocks where they are inserted, and arcs as short straight parts.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

use super::drawing::{Drawing, Entity, Insert, Kind};

/// A straight part is at most so far from the arc that it stands for (m), and turns by at most so much.
const OFF_M: f64 = 0.01;
const MOST_TURN: f64 = PI / 8.0;
/// Blocks in blocks, at most.
const DEPTH: usize = 16;
/// Corners of all lines, at most.
const MOST_CORNERS: usize = 1_000_000;

/// A line on the floor (m), and its layer.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FloorLine {
    pub(super) layer: String,
    /// The frozen layer on which its block was inserted, if it was on one.
    pub(super) frozen: Option<String>,
    pub(super) points: Vec<[f64; 2]>,
}

/// The lines of `drawing`, whose unit has so many metres. Blocks that it lacks are counted in `missing`.
pub(super) fn lines(
    drawing: &Drawing,
    unit_m: f64,
    missing: &mut BTreeMap<String, usize>,
) -> Result<Vec<FloorLine>, String> {
    let mut drawn = Drawn { drawing, lines: Vec::new(), frozen: None, corners: 0, missing };
    drawn.draw(&drawing.entities, &Place::scaled(unit_m), None, 0)?;
    Ok(drawn.lines)
}

/// Where something is drawn: x and y as `turn · p + shift`.
#[derive(Clone, Copy, Debug)]
struct Place {
    turn: [[f64; 2]; 2],
    shift: [f64; 2],
}

impl Place {
    fn scaled(scale: f64) -> Self {
        Self { turn: [[scale, 0.0], [0.0, scale]], shift: [0.0; 2] }
    }

    fn apply(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|row| self.turn[row][0] * x + self.turn[row][1] * y + self.shift[row])
    }

    /// The place of what is at `inner` in this one.
    fn of(&self, inner: &Self) -> Self {
        let turned = |row: usize, column: usize| {
            self.turn[row][0] * inner.turn[0][column] + self.turn[row][1] * inner.turn[1][column]
        };
        Self { turn: [0, 1].map(|row| [0, 1].map(|column| turned(row, column))), shift: self.apply(inner.shift) }
    }

    /// The largest factor on lengths.
    fn scale(&self) -> f64 {
        let column = |at: usize| libm::hypot(self.turn[0][at], self.turn[1][at]);
        column(0).max(column(1))
    }
}

struct Drawn<'a> {
    drawing: &'a Drawing,
    lines: Vec<FloorLine>,
    /// The frozen layer on which what is drawn now is inserted.
    frozen: Option<String>,
    corners: usize,
    missing: &'a mut BTreeMap<String, usize>,
}

impl Drawn<'_> {
    /// Draws entities at `place`. Those on layer `0` of a block are on the layer `outer` of what inserts it.
    fn draw(&mut self, entities: &[Entity], place: &Place, outer: Option<&str>, depth: usize) -> Result<(), String> {
        for Entity { layer, kind } in entities {
            let layer = outer.filter(|_| layer == "0").unwrap_or(layer);
            match kind {
                Kind::Line { corners, is_closed } => {
                    self.add(layer, place, polyline(corners, *is_closed, place.scale())?)?
                }
                Kind::Arc { center, radius, from_deg, to_deg, is_mirrored } => {
                    let turn = (to_deg - from_deg).to_radians();
                    // An arc of a whole turn is a circle, and one that ends before it begins goes on.
                    let turn = if turn > 0.0 { turn.min(TAU) } else { turn.rem_euclid(TAU) };
                    let from = from_deg.to_radians();
                    let mut points = vec![on_circle(*center, *radius, from)];
                    arc_to(&mut points, *center, *radius, [from, turn], place.scale())?;
                    let flip = if *is_mirrored { -1.0 } else { 1.0 };
                    self.add(layer, place, points.into_iter().map(|[x, y]| [flip * x, y]).collect())?;
                }
                Kind::Insert(insert) => self.insert(insert, place, layer, depth)?,
            }
        }
        Ok(())
    }

    fn insert(&mut self, insert: &Insert, place: &Place, layer: &str, depth: usize) -> Result<(), String> {
        let drawing = self.drawing;
        let Some(block) = drawing.blocks.get(&insert.block) else {
            *self.missing.entry(insert.block.clone()).or_default() += 1;
            return Ok(());
        };
        if depth >= DEPTH {
            return Err(format!(
                "the block `{}` is in blocks in blocks, or in itself; allowed: {DEPTH} levels",
                insert.block
            ));
        }
        let before = self.frozen.clone();
        if before.is_none() && drawing.is_frozen(layer) {
            self.frozen = Some(layer.to_owned());
        }
        let (sin, cos) = libm::sincos(insert.turn_deg.to_radians());
        let flip = if insert.is_mirrored { -1.0 } else { 1.0 };
        let turn = |[x, y]: [f64; 2]| [flip * (cos * x - sin * y), sin * x + cos * y];
        let (along_x, along_y) = (turn([insert.scale[0], 0.0]), turn([0.0, insert.scale[1]]));
        for column in 0..insert.count[0] {
            for row in 0..insert.count[1] {
                let apart = turn([column as f64 * insert.spacing[0], row as f64 * insert.spacing[1]]);
                let at = [flip * insert.at[0] + apart[0], insert.at[1] + apart[1]];
                let turn = [[along_x[0], along_y[0]], [along_x[1], along_y[1]]];
                let inner = Place { turn, shift: at };
                let back = Place { shift: block.base.map(|base| -base), ..Place::scaled(1.0) };
                self.count(1)?;
                self.draw(&block.entities, &place.of(&inner.of(&back)), Some(layer), depth + 1)?;
            }
        }
        self.frozen = before;
        Ok(())
    }

    fn add(&mut self, layer: &str, place: &Place, points: Vec<[f64; 2]>) -> Result<(), String> {
        self.count(points.len())?;
        let mut points: Vec<[f64; 2]> = points.into_iter().map(|point| place.apply(point)).collect();
        points.dedup_by(|a, b| libm::hypot(a[0] - b[0], a[1] - b[1]) < 1e-3);
        if points.len() > 1 {
            self.lines.push(FloorLine { layer: layer.to_owned(), frozen: self.frozen.clone(), points });
        }
        Ok(())
    }

    fn count(&mut self, corners: usize) -> Result<(), String> {
        self.corners += corners;
        if self.corners > MOST_CORNERS {
            return Err(format!(
                "it has more than {MOST_CORNERS} corners and blocks; choose the layers of the walls"
            ));
        }
        Ok(())
    }
}

fn on_circle([x, y]: [f64; 2], radius: f64, angle: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(angle);
    [x + radius * cos, y + radius * sin]
}

/// Adds the points of an arc that begins at the angle `from` and turns by `turn` (rad), without its first one. Lengths are multiplied
/// by `scale` afterwards.
fn arc_to(
    points: &mut Vec<[f64; 2]>,
    center: [f64; 2],
    radius: f64,
    [from, turn]: [f64; 2],
    scale: f64,
) -> Result<(), String> {
    // A chord over the angle a is r (1 − cos(a / 2)) off.
    let off = (OFF_M / (radius.abs() * scale).max(OFF_M)).min(1.0);
    let most = (2.0 * libm::acos(1.0 - off)).min(MOST_TURN);
    let parts = (turn.abs() / most).ceil().max(1.0);
    if !radius.is_finite() || points.len() as f64 + parts > MOST_CORNERS as f64 {
        let radius_m = radius.abs() * scale;
        return Err(format!("an arc has a radius of {radius_m:.3e} m: more than {MOST_CORNERS} corners"));
    }
    let mut part = 1.0;
    while part <= parts {
        points.push(on_circle(center, radius, from + turn * part / parts));
        part += 1.0;
    }
    Ok(())
}

/// The points of a line with bulges.
fn polyline(corners: &[([f64; 2], f64)], is_closed: bool, scale: f64) -> Result<Vec<[f64; 2]>, String> {
    let Some(&(first, _)) = corners.first() else { return Ok(Vec::new()) };
    let mut points = vec![first];
    let ends = corners.iter().skip(1).map(|(end, _)| *end).chain(is_closed.then_some(first));
    for (&(from, bulge), to) in corners.iter().zip(ends) {
        let way = [to[0] - from[0], to[1] - from[1]];
        let chord = libm::hypot(way[0], way[1]);
        if bulge.abs() > 1e-9 && chord > 0.0 {
            // The angle of the arc is 4 atan(bulge), and its centre is left of the chord by (1 − bulge²) / (4 bulge) chords.
            let left = 0.25 * (1.0 - bulge * bulge) / bulge;
            let center = [0.5 * (from[0] + to[0]) - left * way[1], 0.5 * (from[1] + to[1]) + left * way[0]];
            let angle = libm::atan2(from[1] - center[1], from[0] - center[0]);
            let radius = libm::hypot(from[0] - center[0], from[1] - center[1]);
            arc_to(&mut points, center, radius, [angle, 4.0 * libm::atan(bulge)], scale)?;
            points.pop();
        }
        points.push(to);
    }
    Ok(points)
}
