//! Places from angles.

use sextant_channel::Position;

use super::LaterationError;

/// Least sine of the angle between two anchors that can be used.
const LEAST_SINE: f64 = 1e-9;

/// The place in the plane from which three anchors are seen in the directions `bearings_rad`, counter-clockwise from
/// any common direction (rad); only their differences count. The height is that of the first anchor.
///
/// All places that see two anchors P and Q under the directed angle θ lie on a circle through both, whose centre is
/// `(P + Q)/2 + ½ cot θ · (Q − P) turned by 90°` (the inscribed angle; Gunathillake 2018, appendix A, gives its radius).
/// Two such circles share one anchor; the place is the other point that they share: the mirror image of the anchor
/// in the line of the centres.
///
/// # Errors
/// If the place lies on the circle through all three anchors or on one line with all of them, or if a number is not
/// finite.
pub fn triangulate(anchors: [Position; 3], bearings_rad: [f64; 3]) -> Result<Position, LaterationError> {
    if !(anchors.iter().all(|anchor| anchor.is_finite()) && bearings_rad.iter().all(|bearing| bearing.is_finite())) {
        return Err(LaterationError::NotFinite);
    }
    let sine = |pair: usize| libm::sin(bearings_rad[(pair + 1) % 3] - bearings_rad[pair]).abs();
    // The pair under the angle nearest to 0° or 180° has the farthest centre: the other two are used.
    let worst = (0..3).min_by(|&a, &b| sine(a).total_cmp(&sine(b))).unwrap_or(0);
    let (before, after) = ((worst + 1) % 3, (worst + 2) % 3);
    if sine(before).min(sine(after)) < LEAST_SINE {
        return Err(LaterationError::OnCircle);
    }
    let centre = |pair: usize| {
        let (p, q) = (anchors[pair], anchors[(pair + 1) % 3]);
        let angle = bearings_rad[(pair + 1) % 3] - bearings_rad[pair];
        let half_cotangent = 0.5 * libm::cos(angle) / libm::sin(angle);
        let chord = q - p;
        (p + q) * 0.5 + Position::new(-chord.y_m, chord.x_m, 0.0) * half_cotangent
    };
    let (first, second) = (centre(before), centre(after));
    // Pairs `before` and `after` follow each other: the anchor between them is on both circles.
    let shared = anchors[after];
    let line = Position::new(second.x_m - first.x_m, second.y_m - first.y_m, 0.0);
    let apart = Position::new(shared.x_m - first.x_m, shared.y_m - first.y_m, 0.0);
    if line.length_m() <= 1e-9 * apart.length_m().max(f64::MIN_POSITIVE) {
        return Err(LaterationError::OnCircle);
    }
    let foot = first + line * (line.dot(apart) / line.dot(line));
    Ok(Position::new(2.0 * foot.x_m - shared.x_m, 2.0 * foot.y_m - shared.y_m, anchors[0].z_m))
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_kernel::{Purpose, Seed};

    fn bearings(node: Position, anchors: [Position; 3], heading_rad: f64) -> [f64; 3] {
        anchors.map(|anchor| (anchor.y_m - node.y_m).atan2(anchor.x_m - node.x_m) - heading_rad)
    }

    #[test]
    fn exact_angles_give_the_exact_place_inside_the_triangle_and_outside() {
        let mut worst_m: f64 = 0.0;
        for seed in 0..200 {
            let draw = |i, axis| 20.0 * Seed(seed).uniform(Purpose::new(8), [i, axis, 1]) - 10.0;
            let place = |i| Position::new(draw(i, 0), draw(i, 1), 0.0);
            let (node, anchors) = (place(0), [place(1), place(2), place(3)]);
            let found = triangulate(anchors, bearings(node, anchors, draw(4, 0))).unwrap();
            worst_m = worst_m.max(found.distance_m(node));
        }
        // Some places lie near the circle through their anchors, where rounding is magnified.
        assert!(worst_m < 1e-6, "{worst_m}");
    }

    #[test]
    fn a_place_in_line_with_two_anchors_is_found() {
        let anchors = [Position::ORIGIN, Position::new(4.0, 0.0, 0.0), Position::new(1.0, 5.0, 0.0)];
        for node in [Position::new(2.0, 0.0, 0.0), Position::new(-3.0, 0.0, 0.0), Position::new(7.0, 0.0, 0.0)] {
            let found = triangulate(anchors, bearings(node, anchors, 0.3)).unwrap();
            assert!(found.distance_m(node) < 1e-9, "{found} not {node}");
        }
    }

    #[test]
    fn a_place_on_the_circle_through_the_anchors_is_rejected() {
        let on_circle = |angle: f64| Position::new(3.0 * angle.cos(), 3.0 * angle.sin(), 0.0);
        let anchors = [on_circle(0.1), on_circle(1.7), on_circle(3.9)];
        let refused = triangulate(anchors, bearings(on_circle(5.0), anchors, 0.0));
        assert_eq!(refused, Err(LaterationError::OnCircle));
        assert_eq!(triangulate(anchors, [0.0, f64::NAN, 1.0]), Err(LaterationError::NotFinite));
    }
}
