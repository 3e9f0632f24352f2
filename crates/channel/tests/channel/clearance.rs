//! How far a ball travels: the range sensor of a robot.

use sextant_channel::{ObstacleField, Position};

use crate::solids::{at, cubes, cylinder, obstacle, random_place, shape, solids, upright_box};

fn field() -> ObstacleField {
    ObstacleField::new(vec![
        obstacle(upright_box(at(5.0, 0.0, 0.0), [2.0, 4.0, 3.0], 0.0), 1.0),
        obstacle(cylinder(at(0.0, 10.0, -1.0), 2.0, 3.0), 1.0),
    ])
}

fn assert_clearance(from: Position, direction: Position, range_m: f64, radius_m: f64, expected_m: f64) {
    let clearance_m = field().clearance_m(from, direction, range_m, radius_m);
    let close = (clearance_m - expected_m).abs() < 1e-8;
    assert!(close, "from {from} towards {direction}: {clearance_m}, not {expected_m}");
}

#[test]
fn a_ball_stops_where_it_touches() {
    let origin = at(0.0, 0.0, 0.0);
    let x = at(1.0, 0.0, 0.0);
    assert_clearance(origin, x, 10.0, 0.2, 3.8);
    assert_clearance(origin, x * 7.0, 10.0, 0.2, 3.8);
    assert_clearance(origin, x, 3.0, 0.2, 3.0);
    assert_clearance(origin, x * -1.0, 10.0, 0.2, 10.0);
    // Obliquely onto the face x = 4.
    assert_clearance(origin, at(1.0, 0.25, 0.0), 10.0, 0.2, 3.8 * (1.0 + 0.0625_f64).sqrt());
    // Past the edge (4, 2): the path of the centre misses the box by 0.1 m, the ball does not.
    assert_clearance(at(0.0, 2.1, 0.0), x, 10.0, 0.2, 4.0 - (0.04_f64 - 0.01).sqrt());
    assert_clearance(at(0.0, 2.21, 0.0), x, 10.0, 0.2, 10.0);
    // Beside the axis of the cylinder by 1 m: centres 2.2 m apart at the touch.
    assert_clearance(at(1.0, 0.0, 0.0), at(0.0, 1.0, 0.0), 20.0, 0.2, 10.0 - (2.2_f64 * 2.2 - 1.0).sqrt());
    // Down onto the lid of the cylinder at z = 2.
    assert_clearance(at(0.5, 10.0, 5.0), at(0.0, 0.0, -1.0), 20.0, 0.2, 2.8);
    // A point counts as a ball of 1 µm.
    assert_clearance(origin, x, 10.0, 0.0, 4.0 - 1e-6);
}

#[test]
fn a_ball_at_an_obstacle_may_slide_or_leave_but_not_go_in() {
    for gap_m in [0.0, -1e-12, 1e-12, -0.01] {
        let from = at(3.8 - gap_m, 0.0, 0.0);
        assert_clearance(from, at(0.0, 1.0, 0.0), 1.5, 0.2, 1.5);
        assert_clearance(from, at(0.0, -1.0, 0.0), 1.5, 0.2, 1.5);
        assert_clearance(from, at(-1.0, 0.3, 0.0), 2.0, 0.2, 2.0);
        let inwards = field().clearance_m(from, at(1.0, 0.3, 0.0), 2.0, 0.2);
        assert!(inwards <= 1e-10, "{inwards}");
    }
    // Inside an obstacle nothing moves.
    assert_clearance(at(5.0, 0.0, 0.0), at(1.0, 0.0, 0.0), 2.0, 0.2, 0.0);
}

#[test]
fn after_a_drive_up_to_the_clearance_a_robot_can_turn_but_not_go_on() {
    for i in 0..400 {
        let from = random_place(i, 12.0);
        let from = at(from.x_m, from.y_m, 0.0);
        let direction = random_place(9000 + i, 1.0);
        let direction = at(direction.x_m, direction.y_m, 0.0);
        if field().distance_m(from) < 0.2 {
            continue;
        }
        let first_m = field().clearance_m(from, direction, 30.0, 0.2);
        if first_m < 30.0 {
            let there = from + direction * (first_m / direction.length_m());
            assert!(field().clearance_m(there, direction, 30.0, 0.2) < 1e-8);
            assert!(field().clearance_m(there, direction * -1.0, 0.9 * first_m, 0.2) >= 0.9 * first_m);
        }
    }
}

#[test]
fn invalid_directions_and_ranges_have_zero_clearance() {
    let origin = at(0.0, 0.0, 0.0);
    for field in [field(), ObstacleField::default()] {
        let x = at(1.0, 0.0, 0.0);
        for (direction, range_m) in [(origin, 5.0), (at(f64::NAN, 0.0, 0.0), 5.0), (x, 0.0), (x, -1.0), (x, f64::NAN)]
        {
            assert!(field.clearance_m(origin, direction, range_m, 0.2).abs() < 1e-300);
        }
        assert!(field.clearance_m(origin, x * -1.0, f64::INFINITY, 0.2).is_infinite());
    }
    assert!((field().clearance_m(origin, at(1.0, 0.0, 0.0), f64::INFINITY, 0.2) - 3.8).abs() < 1e-9);
}

/// Marches in small steps until the ball overlaps: an upper bound within a step.
fn marched_m(distance_m: impl Fn(Position) -> f64, from: Position, u: Position, range_m: f64, radius_m: f64) -> f64 {
    const STEP_M: f64 = 0.002;
    let mut travel_m = 0.0;
    while travel_m < range_m {
        let gap_m = distance_m(from + u * travel_m) - radius_m;
        if gap_m < 0.0 {
            return travel_m;
        }
        travel_m += STEP_M.max(gap_m * 0.999);
    }
    range_m
}

#[test]
fn clearances_agree_with_marching_for_every_shape() {
    const RADIUS_M: f64 = 0.15;
    for (name, solid, inside) in solids() {
        let field = ObstacleField::new(vec![obstacle(solid.clone(), 1.0)]);
        let solid = shape(solid);
        let mut touched = 0;
        for i in 0..300 {
            let from = random_place(2 * i, 3.0);
            if inside(from) || solid.distance_m(from) < RADIUS_M {
                continue;
            }
            let to = random_place(2 * i + 1, 2.0);
            let u = (to - from) * (1.0 / from.distance_m(to));
            let clearance_m = field.clearance_m(from, u, 5.0, RADIUS_M);
            let expected_m = marched_m(|p| solid.distance_m(p), from, u, 5.0, RADIUS_M);
            assert!(clearance_m <= expected_m + 1e-9, "{name}: {clearance_m} beyond {expected_m}");
            // Only the exact search finds grazing contacts shorter than a step: the gap there is below the sagitta of
            // a step.
            let gap_m = solid.distance_m(from + u * clearance_m) - RADIUS_M;
            assert!(gap_m >= -1e-9, "{name}: {gap_m}");
            if clearance_m < 5.0 {
                assert!(gap_m < 1e-9, "{name}: stopped with a gap of {gap_m}");
                touched += 1;
            }
            if clearance_m + 0.0021 < expected_m {
                let beyond = solid.distance_m(from + u * (clearance_m + 1e-3)) - RADIUS_M;
                assert!(beyond < 1e-3, "{name}: {clearance_m}, marched {expected_m}");
            }
        }
        assert!(touched > 30, "{name}: {touched}");
    }
}

#[test]
fn a_ball_stops_at_the_same_distance_for_every_way_of_writing_a_cube() {
    let reference = ObstacleField::new(vec![obstacle(upright_box(at(0.5, 0.5, 0.5), [1.0; 3], 0.0), 1.0)]);
    for (name, cube) in cubes() {
        let field = ObstacleField::new(vec![obstacle(cube, 1.0)]);
        for i in 0..200 {
            let from = at(-1.5, 0.0, 0.0) + random_place(i, 1.2) * 0.5;
            let u = at(1.0, 0.0, 0.0) + random_place(7000 + i, 0.5);
            assert!(field.distance_m(from) > 0.1);
            let (a, b) = (field.clearance_m(from, u, 4.0, 0.1), reference.clearance_m(from, u, 4.0, 0.1));
            assert!((a - b).abs() < 1e-6, "{name} from {from} along {u}: {a}, not {b}");
        }
    }
}
