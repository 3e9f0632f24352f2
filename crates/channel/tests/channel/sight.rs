//! What of a straight way is seen from a place.

use sextant_channel::{ObstacleConfig, ObstacleField, Position, ShapeConfig};

use crate::solids::{at, cylinder, obstacle, prism, random_place, solids, upright_box};

fn field(shapes: impl IntoIterator<Item = ShapeConfig>) -> ObstacleField {
    ObstacleField::new(shapes.into_iter().map(|shape| obstacle(shape, 1.0)).collect())
}

/// The ends of the parts that are seen, as x of a way along the x-axis direction from `from` to `to`.
fn seen_x(field: &ObstacleField, eye: Position, from: Position, to: Position) -> Vec<f64> {
    field.views(eye, from, to).into_iter().flatten().map(|share| from.x_m + (to.x_m - from.x_m) * share).collect()
}

fn assert_close(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len(), "{found:?}, not {expected:?}");
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-9, "{found}, not {expected}");
    }
}

#[test]
fn a_box_hides_what_lies_between_the_rays_through_its_corners() {
    // From the origin, the corners of the near face are at x = -1 and 2, y = 2; those of the far face at y = 4. The way is
    // along y = 6, so the near corners cast the shadow: x = -1 · 6 / 2 and 2 · 6 / 2.
    let cube = upright_box(at(0.5, 3.0, 0.0), [3.0, 2.0, 1.0], 0.0);
    let (from, to) = (at(-20.0, 6.0, 0.0), at(20.0, 6.0, 0.0));
    assert_close(&seen_x(&field([cube.clone()]), Position::ORIGIN, from, to), &[-20.0, -3.0, 6.0, 20.0]);
    // From (5, 0): the outer rays go through (2, 4) and (-1, 2).
    assert_close(
        &seen_x(&field([cube.clone()]), at(5.0, 0.0, 0.0), from, to),
        &[-20.0, 5.0 - 6.0 * 3.0, 5.0 - 3.0 * 6.0 / 4.0, 20.0],
    );
    // A way before the box is all seen, and so is one above it.
    assert_close(
        &seen_x(&field([cube.clone()]), Position::ORIGIN, at(-9.0, 1.0, 0.0), at(9.0, 1.0, 0.0)),
        &[-9.0, 9.0],
    );
    let above = [at(-9.0, 6.0, 3.0), at(9.0, 6.0, 3.0)];
    assert_close(&seen_x(&field([cube]), at(0.0, 0.0, 0.6), above[0], above[1]), &[-9.0, 9.0]);
}

#[test]
fn a_disc_hides_what_lies_between_its_tangents() {
    // The tangents from the origin to the circle of radius 3 round (0, 5) have the slope ± 4 / 3.
    let disc = cylinder(at(0.0, 5.0, -1.0), 3.0, 2.0);
    let (from, to) = (at(-20.0, 12.0, 0.0), at(20.0, 12.0, 0.0));
    assert_close(&seen_x(&field([disc.clone()]), Position::ORIGIN, from, to), &[-20.0, -9.0, 9.0, 20.0]);
    // From (7, 5 - √13) the angle to the centre is α and that of the tangents α ± asin(3 / d).
    let eye = at(7.0, 5.0 - 13_f64.sqrt(), 0.0);
    let (alpha, half) = (13_f64.sqrt().atan2(-7.0), (3.0 / 62_f64.sqrt()).asin());
    let x = |angle: f64| eye.x_m + (12.0 - eye.y_m) / angle.tan();
    let way = [at(-200.0, 12.0, 0.0), at(20.0, 12.0, 0.0)];
    assert_close(&seen_x(&field([disc]), eye, way[0], way[1]), &[-200.0, x(alpha + half), x(alpha - half), 20.0]);
}

#[test]
fn a_low_wall_hides_what_is_behind_its_upper_edge() {
    // The eye is 1 m high, 2 m before a wall of 2 m: behind it, the sight rises 1 m in 2 m. The way rises from the ground.
    let wall = upright_box(at(2.5, 0.0, 1.0), [1.0, 40.0, 2.0], 0.0);
    let (eye, from, to) = (at(0.0, 0.0, 1.0), at(6.0, 0.0, 0.0), at(6.0, 0.0, 10.0));
    let views = field([wall.clone()]).views(eye, from, to);
    assert_close(&views.concat(), &[0.4, 1.0]);
    // A disc of the same height: its upper rim is nearest at x = 2.
    let tower = cylinder(at(4.0, 0.0, 0.0), 2.0, 2.0);
    assert_close(&field([tower]).views(eye, at(9.0, 0.0, 0.0), at(9.0, 0.0, 10.0)).concat(), &[0.55, 1.0]);
}

#[test]
fn a_way_that_is_on_one_line_with_the_eye_is_seen_up_to_the_obstacle() {
    let cube = upright_box(at(0.0, 3.0, 0.0), [1.0, 1.0, 1.0], 0.0);
    let views = |from, to| field([cube.clone()]).views(Position::ORIGIN, from, to).concat();
    assert_close(&views(at(0.0, -4.0, 0.0), at(0.0, 2.0, 0.0)), &[0.0, 1.0]);
    assert_close(&views(at(0.0, 4.0, 0.0), at(0.0, 9.0, 0.0)), &[]);
    // Standing.
    assert_close(&views(at(0.0, 4.0, 0.0), at(0.0, 4.0, 0.0)), &[]);
    assert_close(&views(at(3.0, 4.0, 0.0), at(3.0, 4.0, 0.0)), &[0.0, 1.0]);
}

#[test]
fn shadows_that_touch_are_one() {
    // Two boxes with a common face, and a third one apart.
    let boxes = [-0.5, 0.5, 4.5].map(|x| upright_box(at(x, 3.0, 0.0), [1.0, 1.0, 1.0], 0.0));
    let seen = seen_x(&field(boxes), Position::ORIGIN, at(-20.0, 5.0, 0.0), at(20.0, 5.0, 0.0));
    assert_close(&seen, &[-20.0, -2.0, 2.0, 5.0 * 4.0 / 3.5, 10.0, 20.0]);
}

/// The rule says what is inside, without the library.
#[test]
fn no_shadow_is_missed_and_its_ends_are_right_for_any_solid() {
    let (mut ends, mut hidden) = (0, 0);
    for (name, shape, is_inside) in solids() {
        let field = field([shape]);
        for i in 0..300 {
            let [eye, from, to] = [0, 1, 2].map(|k| random_place(3 * i + k, 4.0));
            if [eye, from, to].into_iter().any(is_inside) {
                continue;
            }
            let views = field.views(eye, from, to);
            let way = |share: f64| from + (to - from) * share;
            for step in 0..=60 {
                let share = f64::from(step) / 60.0;
                let crosses = (1..400).any(|k| is_inside(eye + (way(share) - eye) * (f64::from(k) / 400.0)));
                let is_seen = views.iter().any(|view| (view[0]..=view[1]).contains(&share));
                hidden += u32::from(!is_seen);
                assert!(!(crosses && is_seen), "{name} {i}: hidden at {share}, though {views:?}");
                assert_eq!(is_seen, field.blocking(eye, way(share)).is_none(), "{name} {i} at {share}: {views:?}");
            }
            for end in views.iter().flatten().filter(|end| (1e-6..1.0 - 1e-6).contains(*end)) {
                let sides = [-1e-7, 1e-7].map(|off| field.blocking(eye, way(end + off)).is_some());
                assert_ne!(sides[0], sides[1], "{name} {i} at {end}: {views:?}");
                ends += 1;
            }
        }
    }
    assert!(ends > 500 && hidden > 10_000, "{ends} ends, {hidden} hidden places");
}

#[test]
fn only_solid_obstacles_hide() {
    let views = |solid: bool| {
        let config = ObstacleConfig {
            solid,
            ..ObstacleConfig::absorbing(prism(&[[-3.0, 2.0], [3.0, 2.0], [0.0, 3.0]], -1.0, 2.0), 0.1)
        };
        let field = ObstacleField::new(vec![config.try_into().expect("a good obstacle")]);
        field.views(Position::ORIGIN, at(-1.0, 4.0, 0.0), at(1.0, 4.0, 0.0)).concat()
    };
    assert_close(&views(true), &[]);
    assert_close(&views(false), &[0.0, 1.0]);
}
