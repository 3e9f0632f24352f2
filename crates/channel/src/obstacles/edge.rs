//! Diffraction at the vertical edges of obstacles.

use std::f64::consts::FRAC_PI_2;

use crate::geometry::position::Position;
use crate::geometry::shape::{Edge, LEVEL_M};
use crate::propagation::path_loss::LIGHT_M_PER_S;

/// A way round an obstacle. Both places are the same if one edge is enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Detour {
    /// Where it bends first.
    pub(crate) first: Position,
    /// Where it bends last.
    pub(crate) last: Position,
    /// The diffraction parameter ν of a knife edge where the straight lines before and after the obstacle would meet
    /// (Bullington 1947; Recommendation ITU-R P.526-15, eq. 26 and section 4.5).
    pub(crate) nu: f64,
}

/// On which side of the straight line a way passes, seen from above.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Side {
    Left,
    Right,
}

/// The shortest way from `a` to `b` round what has these edges, on one side; `None` if nothing is in the way on that side, the
/// edges are too short, or an end is on one of them.
pub(crate) fn detour(edges: &[Edge], [a, b]: [Position; 2], side: Side, carrier_ghz: f64) -> Option<Detour> {
    let sign = if let Side::Left = side { 1.0 } else { -1.0 };
    let (first, out_rad) = tangent(edges, a, b, sign)?;
    let (last, in_rad) = tangent(edges, b, a, -sign)?;
    let level = |p: Position, q: Position| libm::hypot(q.x_m - p.x_m, q.y_m - p.y_m);
    let (before_m, after_m) = (level(a, first.bottom), level(last.bottom, b));
    let all_m = before_m + level(first.bottom, last.bottom) + after_m;
    if before_m <= 0.0 || after_m <= 0.0 {
        return None;
    }
    // Unfolded about the edges the way is straight.
    let on = |edge: Edge, way_m: f64| edge.at(a.z_m + (b.z_m - a.z_m) * way_m / all_m);
    let (first, last) = (on(first, before_m)?, on(last, all_m - after_m)?);
    let (rise_out, rise_in) = (libm::tan(out_rad), libm::tan(in_rad));
    let share = rise_in / (rise_out + rise_in);
    let aside_m = level(a, b) * share * rise_out;
    let distance_m = a.distance_m(b);
    let wavelength_m = LIGHT_M_PER_S / (carrier_ghz * 1e9);
    let spread = 1.0 / (share * distance_m) + 1.0 / ((1.0 - share) * distance_m);
    let nu = aside_m * (2.0 / wavelength_m * spread).sqrt();
    Some(Detour { first, last, nu })
}

/// The edge that is farthest to one side of the straight line from `a` to `b`, seen from `a` and from above, and its angle
/// with that line, if this is between 0 and a quarter of a turn.
fn tangent(edges: &[Edge], a: Position, b: Position, sign: f64) -> Option<(Edge, f64)> {
    let straight = b - a;
    let angle_rad = |edge: &Edge| {
        let to = edge.bottom - a;
        let across = straight.x_m * to.y_m - straight.y_m * to.x_m;
        sign * libm::atan2(across, straight.x_m * to.x_m + straight.y_m * to.y_m)
    };
    let all = edges.iter().map(|&edge| (edge, angle_rad(&edge)));
    let farthest = all.max_by(|one, other| one.1.total_cmp(&other.1))?;
    (farthest.1 > 0.0 && farthest.1 < FRAC_PI_2).then_some(farthest)
}

/// Where the straight line from `a` to `b` passes an edge, if it does.
pub(crate) fn passed(edge: &Edge, [a, b]: [Position; 2]) -> Option<Position> {
    let (way, to) = (b - a, edge.bottom - a);
    let square = way.x_m * way.x_m + way.y_m * way.y_m;
    let across_m = (way.x_m * to.y_m - way.y_m * to.x_m) / square.sqrt();
    let share = (way.x_m * to.x_m + way.y_m * to.y_m) / square;
    let is_passed = across_m.abs() <= LEVEL_M && share > 0.0 && share < 1.0;
    if is_passed { edge.at(a.z_m + way.z_m * share) } else { None }
}

/// Loss of a single knife edge beside free space (dB) in the shadow, for ν from 0 on (Recommendation ITU-R P.526-15,
/// eq. 31): `6.9 + 20 log10(sqrt((ν - 0.1)² + 1) + ν - 0.1)`.
pub(crate) fn knife_edge_loss_db(nu: f64) -> f64 {
    let x = nu - 0.1;
    6.9 + 20.0 * libm::log10((x * x + 1.0).sqrt() + x)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The exact loss: the integral of Fresnel from ν on, by Simpson's rule in the complex plane along a turned path, on
    /// which it decays.
    fn exact_db(nu: f64) -> f64 {
        // ∫ from ν of e^(-jπt²/2) dt with t = ν + s e^(-jπ/4): e^(-jπν²/2) ∫ e^(-πs²/2 - jπνs e^(-jπ/4)) ds e^(-jπ/4).
        let steps = 20_000;
        let h = 8.0 / f64::from(steps);
        let turn = std::f64::consts::FRAC_1_SQRT_2;
        let (mut re, mut im) = (0.0, 0.0);
        for i in 0..=steps {
            let s = f64::from(i) * h;
            let weight = if i == 0 || i == steps { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
            // -jπνs (1 - j)/√2 = -πνs/√2 - jπνs/√2.
            let size = (-std::f64::consts::PI * (s * s / 2.0 + nu * s * turn)).exp();
            let angle = -std::f64::consts::PI * nu * s * turn;
            re += weight * size * angle.cos();
            im += weight * size * angle.sin();
        }
        let field = (re * re + im * im).sqrt() * h / 3.0 / 2.0_f64.sqrt();
        -20.0 * field.log10()
    }

    #[test]
    fn the_loss_of_a_knife_edge_is_that_of_the_integral_of_fresnel() {
        assert!((exact_db(0.0) - 6.0206).abs() < 1e-3, "{}", exact_db(0.0));
        for nu in [0.0, 0.5, 1.0, 2.0, 5.0, 12.0] {
            let (found, exact) = (knife_edge_loss_db(nu), exact_db(nu));
            assert!((found - exact).abs() < 0.3, "{nu}: {found}, exact {exact}");
        }
    }

    fn edges(places: &[[f64; 2]]) -> Vec<Edge> {
        let edge = |&[x, y]: &[f64; 2]| Edge { bottom: Position::new(x, y, 0.0), top: Position::new(x, y, 3.0) };
        places.iter().map(edge).collect()
    }

    #[test]
    fn a_way_round_one_edge_is_the_shortest_one() {
        let edge = edges(&[[0.0, 1.0], [0.0, -4.0]]);
        let (a, b) = (Position::new(-4.0, 0.0, 1.0), Position::new(2.0, 0.0, 2.0));
        let Detour { first, last, nu } = detour(&edge, [a, b], Side::Left, 60.0).unwrap();
        let length_m = |z_m: f64| {
            let place = Position::new(0.0, 1.0, z_m);
            a.distance_m(place) + place.distance_m(b)
        };
        let best = (0..3000).map(|i| f64::from(i) * 1e-3).min_by(|x, y| length_m(*x).total_cmp(&length_m(*y)));
        assert!((first.z_m - best.unwrap()).abs() < 1e-3 && first == last, "{first}");
        // ν² is about four times the detour in wavelengths.
        let longer = (length_m(first.z_m) - a.distance_m(b)) / (LIGHT_M_PER_S / 60e9);
        assert!((nu * nu / (4.0 * longer) - 1.0).abs() < 0.1, "{nu} {longer}");
        let right = detour(&edge, [a, b], Side::Right, 60.0).unwrap();
        assert!(right.first.y_m < -3.0 && right.nu > nu);
        // The edge is too short, or not between the two.
        assert_eq!(detour(&edge, [a, Position::new(2.0, 0.0, 12.0)], Side::Left, 60.0), None);
        assert_eq!(detour(&edge, [Position::new(1.0, 0.0, 1.0), b], Side::Left, 60.0), None);
    }

    #[test]
    fn a_thick_obstacle_counts_as_a_knife_edge_where_its_tangents_meet() {
        let block = edges(&[[-1.0, 1.0], [1.0, 1.0], [1.0, -2.0], [-1.0, -2.0]]);
        let (a, b) = (Position::new(-5.0, 0.0, 1.0), Position::new(5.0, 0.0, 1.0));
        let Detour { first, last, nu } = detour(&block, [a, b], Side::Left, 28.0).unwrap();
        assert_eq!((first, last), (Position::new(-1.0, 1.0, 1.0), Position::new(1.0, 1.0, 1.0)));
        // Each tangent rises by a quarter: they meet at 1.25 m in the middle.
        let wavelength_m = LIGHT_M_PER_S / 28e9;
        assert!((nu - 1.25 * (2.0 / wavelength_m * 0.4).sqrt()).abs() < 1e-9, "{nu}");
    }
}
