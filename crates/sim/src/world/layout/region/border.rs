//! Where a straight way leaves a region.

use sextant_channel::Position;

use super::{Region, Shape};

/// Places of the border that are nearer to each other are the same (m).
const SAME_M: f64 = 1e-6;
/// Halvings of a way that find its crossing of the border to the last bit.
const HALVINGS: u32 = 60;

/// Where a straight way leaves a region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Border {
    /// How far it is (m); infinite if the way does not leave.
    pub(crate) distance_m: f64,
    /// A vector of length one at a right angle to the border there, outwards or inwards.
    pub(crate) normal: Position,
}

impl Border {
    /// The nearer one of two.
    fn or(self, other: Self) -> Self {
        if other.distance_m < self.distance_m { other } else { self }
    }
}

impl Region {
    /// Where a straight way from `from`, inside, in `direction` (of length one) leaves the region. A way that is
    /// outside by rounding leaves at once, backwards.
    pub(crate) fn way_out(&self, from: Position, direction: Position) -> Border {
        let whole = self.way_out_of_bounds(from, direction);
        match &self.shape {
            Shape::Bounds => whole,
            Shape::Round { center, radius_m } => {
                let level = |p: Position| Position::new(p.x_m, p.y_m, 0.0);
                whole.or(way_out_of_ball(level(from - *center), level(direction), *radius_m))
            }
            Shape::Ball { center, radius_m } => way_out_of_ball(from - *center, direction, *radius_m),
            Shape::Polygon(polygon) => polygon
                .sides()
                .filter_map(|side| way_through_side(from, direction, side))
                .reduce(Border::or)
                .unwrap_or(Border { distance_m: 0.0, normal: direction }),
        }
    }

    /// Whether the straight way from `inside` to `outside` crosses the border once.
    pub(crate) fn is_left_once(&self, inside: Position, outside: Position) -> bool {
        let way = outside - inside;
        let length_m = way.length_m();
        let Shape::Polygon(_) = self.shape else { return true };
        if length_m <= 0.0 {
            return false;
        }
        let ahead = way * (1.0 / length_m);
        let first_m = self.way_out(inside, ahead).distance_m;
        // Seen from outside, the nearest side is the last one.
        let last_m = || self.way_out(outside, ahead * -1.0).distance_m;
        first_m >= length_m - SAME_M || (first_m + last_m() - length_m).abs() < SAME_M
    }

    /// Whether `p` is so near to a side of a polygon that a way that leads inwards may seem to leave there.
    pub(crate) fn is_on_side(&self, p: Position) -> bool {
        let Shape::Polygon(polygon) = &self.shape else { return false };
        polygon.nearest_on_side([p.x_m, p.y_m]).1 < SAME_M
    }

    /// How far from `outside` the border is on the straight way to `inside`, which crosses it once (m). The place there
    /// may be outside by rounding.
    pub(crate) fn way_in_m(&self, outside: Position, inside: Position) -> f64 {
        let (mut before, mut after) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (before + after);
            let is_inside = self.contains(outside + (inside - outside) * middle);
            if is_inside { after = middle } else { before = middle }
        }
        after * outside.distance_m(inside)
    }

    fn way_out_of_bounds(&self, from: Position, direction: Position) -> Border {
        let (low, high) = (<[f64; 3]>::from(self.bounds.min), <[f64; 3]>::from(self.bounds.max));
        let (from, ahead) = (<[f64; 3]>::from(from), <[f64; 3]>::from(direction));
        let mut nearest = Border { distance_m: f64::INFINITY, normal: direction };
        for axis in 0..3 {
            let mut normal = [0.0; 3];
            normal[axis] = 1.0;
            let end = if ahead[axis] > 0.0 { high[axis] } else { low[axis] };
            if ahead[axis].abs() > 0.0 {
                let distance_m = ((end - from[axis]) / ahead[axis]).max(0.0);
                nearest = nearest.or(Border { distance_m, normal: normal.into() });
            }
        }
        nearest
    }
}

/// Where a way from `from`, seen from the centre of a ball, leaves it. In the plane, `direction` may be shorter than
/// one.
fn way_out_of_ball(from: Position, direction: Position, radius_m: f64) -> Border {
    let a = direction.dot(direction);
    let b = from.dot(direction);
    let c = from.dot(from) - radius_m * radius_m;
    let root = b * b - a * c;
    if a <= 0.0 {
        return Border { distance_m: f64::INFINITY, normal: direction };
    }
    if root < 0.0 {
        return Border { distance_m: 0.0, normal: direction };
    }
    let distance_m = ((root.sqrt() - b) / a).max(0.0);
    let out = from + direction * distance_m;
    Border { distance_m, normal: out * (1.0 / out.length_m()) }
}

/// Where a way in the plane passes the side of a polygon; `None` if it does not.
fn way_through_side(
    from: Position,
    direction: Position,
    ([ax, ay], [bx, by]): ([f64; 2], [f64; 2]),
) -> Option<Border> {
    let (sx, sy) = (bx - ax, by - ay);
    // from + u direction = a + t side, solved by cross products with the other direction.
    let across = direction.x_m * sy - direction.y_m * sx;
    if across.abs() <= 0.0 {
        return None;
    }
    let (ox, oy) = (ax - from.x_m, ay - from.y_m);
    let distance_m = (ox * sy - oy * sx) / across;
    let t = (ox * direction.y_m - oy * direction.x_m) / across;
    let length_m = libm::hypot(sx, sy);
    let normal = Position::new(sy / length_m, -sx / length_m, 0.0);
    (distance_m >= 0.0 && (0.0..=1.0).contains(&t)).then_some(Border { distance_m, normal })
}
