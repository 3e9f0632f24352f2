use super::*;
use crate::geometry::position::Position;
use crate::obstacles::field::ObstacleField;

fn wall(points_m: &[Vector], openings: Vec<OpeningConfig>) -> WallConfig {
    WallConfig {
        name: Some("wall".into()),
        points_m: points_m.to_vec(),
        thickness_m: 0.2,
        bottom_m: 0.0,
        storey: None,
        height_m: Some(3.0),
        material: None,
        absorption_per_m: Some(1.0),
        loss_db: None,
        reflection_loss_db: None,
        openings,
    }
}

fn door(at_m: f64, width_m: f64) -> OpeningConfig {
    OpeningConfig {
        at_m,
        width_m,
        bottom_m: 0.0,
        top_m: Some(2.0),
        material: None,
        absorption_per_m: None,
        loss_db: None,
    }
}

fn field(wall: &WallConfig) -> ObstacleField {
    ObstacleField::new(wall.obstacles(0).unwrap())
}

/// Length inside the wall (m) of a link between two places.
fn inside_m(field: &ObstacleField, from: [f64; 3], to: [f64; 3]) -> f64 {
    field.loss(Position::from(from), Position::from(to)).0 / (10.0 * std::f64::consts::LOG10_E)
}

#[test]
fn a_closed_wall_has_the_area_of_its_ring_and_no_piece_twice() {
    let corners = [[0.0, 0.0], [6.0, 0.0], [6.0, 4.0], [0.0, 4.0], [0.0, 0.0]];
    for corners in [corners, [corners[4], corners[3], corners[2], corners[1], corners[0]]] {
        let field = field(&wall(&corners, Vec::new()));
        assert_eq!(field.len(), 4);
        // A link through two sides, one along a side, and one through a corner: each is in the wall once.
        assert!((inside_m(&field, [-1.0, 2.0, 1.0], [7.0, 2.0, 1.0]) - 0.4).abs() < 1e-9);
        assert!((inside_m(&field, [-1.0, 0.05, 1.0], [7.0, 0.05, 1.0]) - 6.2).abs() < 1e-9);
        let diagonal = inside_m(&field, [-1.0, -1.0, 1.0], [3.0, 3.0, 1.0]);
        assert!((diagonal - 0.2 * 2.0_f64.sqrt()).abs() < 1e-9, "{diagonal}");
        // At ground level too, and not above.
        assert!((inside_m(&field, [-1.0, 2.0, 0.0], [1.0, 2.0, 0.0]) - 0.2).abs() < 1e-9);
        assert!(inside_m(&field, [-1.0, 2.0, 3.1], [7.0, 2.0, 3.1]) < 1e-9);
    }
}

#[test]
fn links_go_through_open_doors_and_below_lintels() {
    let window = OpeningConfig { bottom_m: 1.0, absorption_per_m: Some(0.5), ..door(4.0, 1.0) };
    let field = field(&wall(&[[0.0, 0.0], [6.0, 0.0]], vec![window, door(1.0, 0.9)]));
    // Before, between and after; the lintel; below, in and above the window.
    assert_eq!(field.len(), 3 + 1 + 3);
    let across = |x_m: f64, z_m: f64| inside_m(&field, [x_m, -1.0, z_m], [x_m, 1.0, z_m]);
    for (x_m, z_m, expected_m) in [
        (0.5, 1.0, 0.2),
        (1.5, 1.0, 0.0),
        (1.5, 2.5, 0.2),
        (1.95, 1.0, 0.2),
        (4.5, 0.5, 0.2),
        (4.5, 1.5, 0.1),
        (4.5, 2.5, 0.2),
        (6.1, 1.0, 0.0),
    ] {
        assert!((across(x_m, z_m) - expected_m).abs() < 1e-9, "{x_m}, {z_m}: {}", across(x_m, z_m));
    }
}

/// By sampling: no place is in two pieces, and all near the line are in one, also where the wall turns by odd angles.
#[test]
fn pieces_meet_at_each_turn() {
    let corners = [[0.0, 0.0], [3.0, 0.4], [4.0, 3.0], [7.0, 2.5], [6.0, 6.0], [1.0, 5.0]];
    let field = field(&wall(&corners, vec![door(1.0, 1.0)]));
    let mut covered = 0;
    for x in 0..240 {
        for y in 0..200 {
            let (x_m, y_m) = (-0.5 + 0.0347 * f64::from(x), -0.5 + 0.0353 * f64::from(y));
            let inside = inside_m(&field, [x_m, y_m, 2.2], [x_m, y_m, 2.3]);
            assert!(inside < 0.1 + 1e-9, "{x_m}, {y_m}: {inside}");
            covered += usize::from(inside > 0.05);
        }
    }
    let length_m: f64 =
        corners.windows(2).map(|pair| f64::hypot(pair[1][0] - pair[0][0], pair[1][1] - pair[0][1])).sum();
    let area_m2 = covered as f64 * 0.0347 * 0.0353;
    assert!((area_m2 / (0.2 * length_m) - 1.0).abs() < 0.03, "{area_m2}");
}

#[test]
fn impossible_walls_are_refused_where_they_are_written() {
    let line = [[0.0, 0.0], [6.0, 0.0], [6.0, 4.0]];
    let refused = |wall: WallConfig| wall.obstacles(0).unwrap_err().to_string();
    for (wall, part) in [
        (wall(&line[..1], Vec::new()), "`points_m` is a list of 1"),
        (wall(&[[0.0, 0.0], [0.0, 0.0]], Vec::new()), "corners 0 and 1 at one place"),
        (wall(&[[0.0, 0.0], [0.0, 3.0], [0.05, 3.0], [0.05, 0.0]], Vec::new()), "a part 1 of 0.05 m"),
        (WallConfig { thickness_m: 0.0, ..wall(&line, Vec::new()) }, "`thickness_m` is 0"),
        (WallConfig { absorption_per_m: None, ..wall(&line, Vec::new()) }, "material"),
        (wall(&line, vec![door(5.5, 1.0)]), "`openings[0].at_m` is 5.5 with width_m = 1"),
        (wall(&line, vec![door(1.0, 1.0), door(1.5, 1.0)]), "a place beside openings[0]"),
        (wall(&line, vec![OpeningConfig { top_m: Some(4.0), ..door(1.0, 1.0) }]), "`openings[0].top_m` is 4"),
        (wall(&line, vec![OpeningConfig { bottom_m: 3.0, ..door(1.0, 1.0) }]), "`openings[0].bottom_m` is 3"),
    ] {
        let found = refused(wall);
        assert!(found.contains(part), "{found}");
    }
}

#[test]
fn openings_at_the_ends_of_a_wall_leave_no_sliver() {
    // At both ends, side by side, at the corners, from the foot and to the top, each by less than a millimetre.
    let opening = |at_m, width_m| OpeningConfig { bottom_m: 0.0004, top_m: Some(3.0003), ..door(at_m, width_m) };
    let straight = [[0.0, 0.0], [6.0, 0.0]];
    for (openings, pieces) in [
        (vec![opening(0.0, 1.0)], 1),
        (vec![opening(0.0004, 1.0), opening(5.0, 0.9996)], 1),
        (vec![opening(5.0, 1.0 + 1e-9)], 1),
        (vec![opening(0.0, 6.0)], 0),
        (vec![opening(1.0, 1.0), opening(2.0005, 1.0), opening(2.9998, 1.0)], 2),
        (vec![door(0.0, 1.0)], 2),
    ] {
        let made = wall(&straight, openings.clone()).obstacles(0).unwrap();
        assert_eq!(made.len(), pieces, "{openings:?}");
        assert!(made.iter().all(|piece| piece.shape().bounds().max.x_m - piece.shape().bounds().min.x_m > 0.9));
    }
    // From corner to corner: the sides of a door are the walls beside it.
    let square = [[0.0, 0.0], [6.0, 0.0], [6.0, 4.0], [0.0, 4.0], [0.0, 0.0]];
    for from_m in [0.1, 0.1003, 0.0998] {
        let field = field(&wall(&square, vec![opening(from_m, 5.8)]));
        assert!(inside_m(&field, [0.1 + 1e-6, -1.0, 1.0], [0.1 + 1e-6, 2.0, 1.0]) <= 0.0, "{from_m}");
        assert!((inside_m(&field, [-1.0, 0.0, 1.0], [7.0, 0.0, 1.0]) - 0.4).abs() < 1e-9);
    }
}
