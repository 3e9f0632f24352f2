//! Triangles: distance, solid angle, and intersection with a line.

use super::clip::GRAZE_M;
use crate::geometry::position::Position;

/// Corners of a triangle (m), counterclockwise seen from the side that its normal points to.
pub(crate) type Triangle = [Position; 3];

/// Normal of the triangle; its length is twice the area (m²).
pub(crate) fn normal([a, b, c]: Triangle) -> Position {
    (b - a).cross(c - a)
}

/// Distance from `p` to the triangle (m) (Ericson 2005, Real-Time Collision Detection, 5.1.5).
pub(crate) fn distance_m([a, b, c]: Triangle, p: Position) -> f64 {
    let edges = || segment_distance_m(a, b, p).min(segment_distance_m(b, c, p)).min(segment_distance_m(c, a, p));
    let n = normal([a, b, c]);
    let area = n.length_m();
    if area <= 0.0 {
        return edges();
    }
    // Inside the prism over the triangle, the plane is nearest; elsewhere an edge is.
    let over = |from: Position, to: Position| n.dot((to - from).cross(p - from)) >= 0.0;
    if over(a, b) && over(b, c) && over(c, a) { (n.dot(p - a) / area).abs() } else { edges() }
}

fn segment_distance_m(a: Position, b: Position, p: Position) -> f64 {
    let d = b - a;
    let square = d.dot(d);
    let t = if square > 0.0 { ((p - a).dot(d) / square).clamp(0.0, 1.0) } else { 0.0 };
    p.distance_m(a + d * t)
}

/// Signed solid angle of the triangle seen from `p` (sr), positive from the side its normal points away from
/// (van Oosterom and Strackee 1983).
pub(crate) fn solid_angle([a, b, c]: Triangle, p: Position) -> f64 {
    let (a, b, c) = (a - p, b - p, c - p);
    let (la, lb, lc) = (a.length_m(), b.length_m(), c.length_m());
    let numerator = a.dot(b.cross(c));
    let denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * libm::atan2(numerator, denominator)
}

/// How a line intersects a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Meeting {
    /// Not at all.
    Miss,
    /// Through the middle, at this signed distance along the line (m), out of the solid if `leaves`.
    Through { at_m: f64, leaves: bool },
    /// Within a nanometre of an edge, at this distance along the line, if the line is not in the plane.
    Edge { at_m: Option<f64> },
}

/// How the infinite line through `from` along the unit vector `u` intersects the triangle.
pub(crate) fn meet([a, b, c]: Triangle, from: Position, u: Position) -> Meeting {
    let (pa, pb, pc) = (a - from, b - from, c - from);
    // Twice the areas of the three part triangles in projection along u, over the length of their outer edge:
    // signed distances from the edges in projection, or less.
    let side = |p: Position, q: Position| u.dot(p.cross(q));
    let sides = [side(pa, pb), side(pb, pc), side(pc, pa)];
    let edges = [pa.distance_m(pb), pb.distance_m(pc), pc.distance_m(pa)];
    let area = sides[0] + sides[1] + sides[2];
    let n = normal([a, b, c]);
    let at_m = (area.abs() > 1e-12 * n.length_m()).then(|| n.dot(pa) / n.dot(u));
    let sign = if area < 0.0 { -1.0 } else { 1.0 };
    let mut depth_m = f64::INFINITY;
    for (side, edge_m) in sides.into_iter().zip(edges) {
        depth_m = depth_m.min(sign * side / edge_m);
    }
    match at_m {
        _ if depth_m < -GRAZE_M => Meeting::Miss,
        Some(at_m) if depth_m > GRAZE_M => Meeting::Through { at_m, leaves: area > 0.0 },
        at_m => Meeting::Edge { at_m },
    }
}
