//! What lies in the boundary of a solid: floors belong to it, side faces and roofs do not.

use std::fmt::Write as _;
use std::path::Path;

use proptest::prelude::*;
use sextant_channel::{Obstacle, ObstacleConfig, ObstacleField, Position, Shape, ShapeConfig};
use sextant_kernel::Files;

use crate::reflections::{channel, rays};
use crate::solids::{at, convex, cubes, cylinder, mesh, obstacle, prism, shape, upright_box};

/// Upright solids of each kind, about 2 m wide, that stand at a height.
fn standing(middle: Position, height_m: f64, yaw_deg: f64) -> Vec<(&'static str, ShapeConfig)> {
    let corner = |turn: f64, reach: f64| {
        let (sin, cos) = (yaw_deg.to_radians() + turn).sin_cos();
        [middle.x_m + reach * cos, middle.y_m + reach * sin]
    };
    let ring = [corner(0.0, 1.3), corner(1.1, 1.0), corner(2.7, 1.2), corner(4.4, 1.1), corner(5.3, 1.3)];
    let levels = [middle.z_m, middle.z_m + height_m];
    let points: Vec<_> = levels.iter().flat_map(|&z| ring.map(|[x, y]| [x, y, z])).collect();
    let half = at(0.0, 0.0, 0.5 * height_m);
    vec![
        ("box", upright_box(middle + half, [2.0, 1.4, height_m], yaw_deg)),
        ("cylinder", cylinder(middle, 1.1, height_m)),
        ("prism", prism(&ring, middle.z_m, height_m)),
        ("convex", convex(&points)),
        ("mesh", as_mesh([prism(&ring, middle.z_m, height_m)])),
        ("mesh of two storeys", as_mesh(storeys(middle, height_m, &ring))),
    ]
}

/// A prism in two parts, one on the other.
fn storeys(middle: Position, height_m: f64, ring: &[[f64; 2]]) -> [ShapeConfig; 2] {
    let half_m = 0.5 * height_m;
    [prism(ring, middle.z_m, half_m), prism(ring, middle.z_m + half_m, half_m)]
}

/// The surfaces of solids as one mesh.
fn as_mesh(parts: impl IntoIterator<Item = ShapeConfig>) -> ShapeConfig {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for part in parts {
        let (corners, faces) = shape(part).mesh();
        let first = u32::try_from(vertices.len()).expect("few vertices");
        vertices.extend(corners.iter().map(|&p| <[f64; 3]>::from(p)));
        triangles.extend(faces.iter().map(|face| face.map(|corner| first + corner)));
    }
    mesh(&vertices, &triangles)
}

/// A level line that passes a place at a distance.
fn level_line(middle: Position, away_m: f64, heading_rad: f64, ends_m: [f64; 2]) -> [Position; 2] {
    let (sin, cos) = heading_rad.sin_cos();
    ends_m.map(|along| middle + at(along * cos - away_m * sin, along * sin + away_m * cos, 0.0))
}

proptest! {
    #[test]
    fn a_line_in_a_floor_has_the_length_of_one_a_centimetre_higher(
        middle in prop::array::uniform3(-40.0..40.0_f64), height_m in 0.02..9.0_f64, yaw_deg in -180.0..180.0_f64,
        away_m in -1.5..1.5_f64, heading_rad in 0.0..7.0_f64, ends_m in (-3.0..0.5_f64, 0.0..3.0_f64),
    ) {
        let middle = Position::from(middle);
        let [from, to] = level_line(middle, away_m, heading_rad, [ends_m.0, ends_m.1]);
        for (name, solid) in standing(middle, height_m, yaw_deg) {
            let solid = shape(solid);
            let on_m = solid.length_inside_m(from, to);
            let higher = at(0.0, 0.0, 0.01);
            let above_m = solid.length_inside_m(from + higher, to + higher);
            prop_assert!((on_m - above_m).abs() < 1e-9, "{}: {} {}", name, on_m, above_m);
            prop_assert!((solid.length_inside_m(to, from) - on_m).abs() < 1e-12, "{}", name);
            // On the roof, above it, and below the floor it is free.
            for rise_m in [height_m, height_m + 0.002, -0.002] {
                let rise = at(0.0, 0.0, rise_m);
                let length_m = solid.length_inside_m(from + rise, to + rise);
                prop_assert!(length_m <= 0.0, "{} {}: {}", name, rise_m, length_m);
            }
            for place in [from, to] {
                prop_assert_eq!(solid.contains(place), solid.contains(place + higher), "{}", name);
                prop_assert!(!solid.contains(place + at(0.0, 0.0, height_m)), "{}", name);
            }
        }
        // Closed forms: the chord of a circle, and a line through the middle of a rectangle along its length.
        let round = shape(cylinder(middle, 1.1, height_m));
        let [from, to] = level_line(middle, away_m, heading_rad, [-9.0, 9.0]);
        let chord_m = 2.0 * (1.21 - away_m * away_m).max(0.0).sqrt();
        prop_assert!((round.length_inside_m(from, to) - chord_m).abs() < 1e-6);
        let [from, to] = level_line(middle, 0.0, yaw_deg.to_radians(), [-9.0, 9.0]);
        let wall = shape(upright_box(middle + at(0.0, 0.0, 0.5 * height_m), [2.0, 1.4, height_m], yaw_deg));
        prop_assert!((wall.length_inside_m(from, to) - 2.0).abs() < 1e-9);
    }

    #[test]
    fn two_stacked_solids_are_one(
        middle in prop::array::uniform3(-40.0..40.0_f64), low_m in 0.1..5.0_f64, high_m in 0.1..5.0_f64,
        yaw_deg in -180.0..180.0_f64, away_m in -1.5..1.5_f64, heading_rad in 0.0..7.0_f64, gap_m in -3e-4..3e-4_f64,
    ) {
        let middle = Position::from(middle);
        let next = middle + at(0.0, 0.0, low_m);
        let parts = standing(middle, low_m, yaw_deg).into_iter().zip(standing(next, high_m, yaw_deg));
        for (((name, lower), (_, upper)), (_, whole)) in parts.zip(standing(middle, low_m + high_m, yaw_deg)) {
            let (lower, upper, whole) = (shape(lower), shape(upper), shape(whole));
            // In the common plane, and as near to it as surveyors measure.
            for rise_m in [0.0, low_m, low_m + gap_m, low_m + high_m] {
                let line = level_line(middle + at(0.0, 0.0, rise_m), away_m, heading_rad, [-3.0, 3.0]);
                let length_m = |shape: &Shape| shape.length_inside_m(line[0], line[1]);
                let (parts_m, whole_m) = (length_m(&lower) + length_m(&upper), length_m(&whole));
                prop_assert!((parts_m - whole_m).abs() < 1e-9, "{}: {} {}", name, parts_m, whole_m);
                prop_assert!(length_m(&lower) <= 0.0 || length_m(&upper) <= 0.0, "{}: twice", name);
            }
        }
    }

    #[test]
    fn a_world_that_is_moved_and_turned_keeps_its_floors(
        x in -5e6..5e6_f64, y in -5e6..5e6_f64, z in -400.0..4000.0_f64, turn_deg in -180.0..180.0_f64,
        away_m in -1.0..1.0_f64, heading_rad in 0.0..7.0_f64,
    ) {
        let here = standing(Position::ORIGIN, 2.0, 0.0);
        let there = standing(at(x, y, z), 2.0, turn_deg);
        for ((name, here), (_, there)) in here.into_iter().zip(there) {
            let (here, there) = (shape(here), shape(there));
            let heading_there_rad = heading_rad + turn_deg.to_radians();
            for rise_m in [0.0, 1.0, 2.0] {
                let line = level_line(at(0.0, 0.0, rise_m), away_m, heading_rad, [-3.0, 3.0]);
                let moved = level_line(at(x, y, z + rise_m), away_m, heading_there_rad, [-3.0, 3.0]);
                let [here_m, there_m] = [(&here, line), (&there, moved)].map(|(shape, [a, b])| shape.length_inside_m(a, b));
                prop_assert!((here_m - there_m).abs() < 1e-5, "{} {}: {} {}", name, rise_m, here_m, there_m);
            }
        }
    }
}

#[test]
fn floors_of_decimal_numbers_are_floors() {
    for (tenths, sizes) in (-30..30).flat_map(|tenths| (1..40).map(move |sizes| (tenths, sizes))) {
        let (floor_m, height_m) = (0.1 * f64::from(tenths), 0.1 * f64::from(sizes));
        // As somebody types them, and rounded as a file of a modelling tool has them.
        let middle_m = (1e6 * (floor_m + height_m / 2.0)).round() / 1e6;
        #[expect(clippy::cast_possible_truncation, reason = "files of meshes have single precision")]
        let single = |x: f64| f64::from(x as f32);
        for solid in [
            upright_box(at(0.0, 0.0, middle_m), [2.0, 3.0, height_m], 30.0),
            convex(
                &[0.0, height_m]
                    .map(|z| [[-1.0, -1.0], [1.0, -1.0], [0.0, 2.0]].map(|[x, y]| [x, y, single(floor_m + z)]))
                    .concat(),
            ),
        ] {
            let solid = shape(solid);
            for (rise_m, is_inside) in [(0.0, true), (height_m, false)] {
                let line = [-4.0, 4.0].map(|x| at(x, 0.1, floor_m + rise_m));
                assert_eq!(solid.length_inside_m(line[0], line[1]) > 1.0, is_inside, "{floor_m} {height_m} {rise_m}");
            }
        }
    }
}

#[test]
fn stations_on_a_side_face_see_each_other() {
    for (name, cube) in cubes() {
        let cube = shape(cube);
        for z in [0.0, 0.5, 1.0] {
            for [from, to] in [[at(-1.0, 1.0, z), at(2.0, 1.0, z)], [at(0.0, 0.2, z), at(0.0, 0.9, z)]] {
                assert!(cube.length_inside_m(from, to) <= 0.0, "{name} at {z}");
                assert!(!cube.contains((from + to) * 0.5), "{name} at {z}");
            }
        }
    }
    // Round walls, and a line that ends at the wall.
    let round = shape(cylinder(at(0.0, 0.0, 0.0), 2.0, 3.0));
    assert!(round.length_inside_m(at(2.0, -3.0, 0.0), at(2.0, 3.0, 0.0)) <= 0.0);
    assert!(round.length_inside_m(at(5.0, 0.0, 0.0), at(2.0, 0.0, 0.0)) <= 0.0);
}

#[test]
fn a_line_that_leaves_a_floor_has_the_length_above_it() {
    for (name, cube) in cubes() {
        let cube = shape(cube);
        for (from, to, expected_m) in [
            // From the floor through the side, from below, and from the floor downwards.
            (at(0.5, 0.5, 0.0), at(2.5, 0.5, 0.2), 0.5 * 1.01_f64.sqrt()),
            (at(0.4, 0.3, -1.0), at(0.4, 0.3, 1.0), 1.0),
            (at(0.4, 0.3, 0.0), at(0.4, 0.3, 0.5), 0.5),
            (at(0.4, 0.3, 0.0), at(0.4, 0.3, -0.5), 0.0),
            (at(0.2, 0.5, 0.0), at(0.8, 0.5, -0.1), 0.0),
            (at(-1.0, 0.5, 1.0), at(2.0, 0.5, 1.1), 0.0),
        ] {
            let length_m = cube.length_inside_m(from, to);
            assert!((length_m - expected_m).abs() < 1e-9, "{name} from {from} to {to}: {length_m}");
        }
    }
}

#[test]
fn the_ceiling_of_a_hall_and_the_floors_of_its_storeys_are_faces_that_look_down() {
    // Walls and a roof of 0.2 m around a room 3 m high that is open below.
    let outer = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
    let hall = shape(as_mesh([
        prism(&[[0.0, 0.0], [0.2, 0.0], [0.2, 10.0], [0.0, 10.0]], 0.0, 3.0),
        prism(&[[9.8, 0.0], [10.0, 0.0], [10.0, 10.0], [9.8, 10.0]], 0.0, 3.0),
        prism(&outer, 3.0, 0.2),
    ]));
    let across_m = |z: f64| hall.length_inside_m(at(-1.0, 5.0, z), at(11.0, 5.0, z));
    for (z, expected_m) in [(-0.01, 0.0), (0.0, 0.4), (1.0, 0.4), (2.99, 0.4), (3.0, 10.0), (3.1, 10.0), (3.2, 0.0)] {
        assert!((across_m(z) - expected_m).abs() < 1e-9, "{z}: {}", across_m(z));
    }
    assert!(
        hall.contains(at(5.0, 5.0, 3.0)) && !hall.contains(at(5.0, 5.0, 2.99)) && !hall.contains(at(5.0, 5.0, 3.2))
    );
}

/// The walls of a yard and its gate, each with a material of its own, as an .obj file with the rounding of such files.
fn yard() -> String {
    let mut text = String::new();
    let walls =
        [("concrete", [0.0, 10.0], [0.0, 0.3]), ("brick", [0.0, 10.0], [6.0, 6.3]), ("wood", [4.0, 6.0], [2.0, 2.1])];
    for (i, (material, x, y)) in walls.into_iter().enumerate() {
        writeln!(text, "usemtl {material}").expect("a text grows");
        for z in ["0.000001", "2.400000"] {
            for (x, y) in [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])] {
                writeln!(
                    text,
                    "v {x:.6} {y:.6} {}{z}",
                    if i == 1 && x > 5.0 && z.starts_with("0.0") { "-" } else { "" }
                )
                .expect("a text grows");
            }
        }
        for corners in [[1, 4, 3, 2], [5, 6, 7, 8], [1, 2, 6, 5], [2, 3, 7, 6], [3, 4, 8, 7], [4, 1, 5, 8]] {
            let [a, b, c, d] = corners.map(|corner| corner + 8 * i);
            writeln!(text, "f {a} {b} {c} {d}").expect("a text grows");
        }
    }
    text
}

#[test]
fn walls_of_a_mesh_file_that_stand_on_the_ground_block_what_is_on_the_ground() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("floors");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("yard.obj"), yard()).unwrap();
    let read = |more: &str| {
        let config: ObstacleConfig = toml::from_str(&format!("{more}\nshape.mesh.file = \"yard.obj\"")).unwrap();
        ObstacleField::new(Obstacle::read_all(config, &Files::of_folder(&folder)).unwrap())
    };
    let mut crossings = Vec::new();
    for (field, count) in [(read(""), 3), (read("material = \"brick\""), 1)] {
        assert_eq!(field.len(), count);
        for z in [0.0, 1.0] {
            field.crossings(at(5.0, -1.0, z), at(5.5, 9.0, z), &mut crossings);
            let sum_m: f64 = crossings.iter().map(|crossing| crossing.length_m).sum();
            let slant = 10_f64.hypot(0.5) / 10.0;
            assert_eq!(crossings.len(), count, "{z}");
            assert!((sum_m - 0.7 * slant).abs() < 1e-5, "{z}: {sum_m}");
        }
        field.crossings(at(5.0, -1.0, 2.4), at(5.5, 9.0, 2.4), &mut crossings);
        assert!(crossings.is_empty());
    }
}

#[test]
fn a_field_knows_what_stands_on_its_floors() {
    let wall = |z: f64| obstacle(upright_box(at(5.0, 0.0, z + 1.0), [1.0, 8.0, 2.0], 0.0), 2.0);
    for z in [0.0, -3.2, 17.4] {
        // The floor is as far off as a plan that is rounded to tenths of a millimetre.
        for off_m in [0.0, 1e-4, -1e-4] {
            let field = ObstacleField::new(vec![wall(z + off_m)]);
            let (from, to) = (at(0.0, 0.5, z), at(10.0, 0.5, z));
            assert_eq!(field.blocking(from, to), Some(0));
            assert!((field.loss(from, to).0 - 8.685_889_638).abs() < 1e-6);
            assert_eq!(field.containing(at(5.0, 0.0, z)), Some(0));
            assert!(field.fault(at(5.0, 0.0, z)).is_some() && field.fault(at(5.0, 0.0, z + 2.01)).is_none());
            // A robot stops before it; one that is smaller than the gap below it too. Along the wall it drives.
            for radius_m in [0.3, 1e-6] {
                assert!((field.clearance_m(from, at(1.0, 0.0, 0.0), 20.0, radius_m) - 4.5 + radius_m).abs() < 1e-6);
            }
            assert!(field.clearance_m(at(5.0, 0.0, z), at(0.0, 1.0, 0.0), 20.0, 0.3) <= 0.0);
            assert!(field.clearance_m(at(4.2, -9.0, z), at(0.0, 1.0, 0.0), 20.0, 0.3) >= 20.0);
            // What is behind it is not seen: from x = 0 the corners at (4.5, ±4) hide y = ±8 at x = 9.
            let seen = field.views(at(0.0, 0.0, z), at(9.0, -20.0, z), at(9.0, 20.0, z)).concat();
            let expected = [0.0, 0.3, 0.7, 1.0];
            assert!(seen.len() == 4 && seen.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{seen:?}");
            // On its roof all is seen and nothing is lost.
            let roof = z + off_m + 2.0;
            assert_eq!(field.views(at(0.0, 0.0, roof), at(9.0, -20.0, roof), at(9.0, 20.0, roof)), [[0.0, 1.0]]);
            assert_eq!(field.blocking(at(4.8, -3.0, roof), at(5.2, 3.0, roof)), None);
            assert_eq!(field.containing(at(5.0, 0.0, roof)), None);
            // From a place on its side to another one, and from below.
            assert_eq!(field.blocking(at(4.5, -3.0, z), at(4.5, 3.0, z)), None);
            assert_eq!(field.blocking(at(0.0, 0.0, z - 0.01), at(9.0, 0.0, z - 0.01)), None);
        }
    }
}

const FREE: &str = "path_loss.close_in = { carrier_ghz = 60, exponent = 2, min_distance_m = 0.01 }";

#[test]
fn a_wall_reflects_and_bends_at_its_lower_edge_as_above_it_and_not_at_its_upper_edge() {
    let law = format!("{FREE}\nreflections = {{ loss_db = 6, order = 2, edges = true, most = 255 }}");
    let (from, to) = (at(-3.0, 0.2, 0.0), at(3.0, -0.1, 0.0));
    let losses = |floor_m: f64, mesh: bool, z: f64| {
        let text = |center: [f64; 2], size: [f64; 3]| {
            let [x, y] = center;
            let solid = upright_box(at(x, y, floor_m + 0.5 * size[2]), size, 0.0);
            if !mesh {
                return format!(
                    "loss_db = 30\nshape.box = {{ center_m = [{x}, {y}, {}], size_m = {size:?} }}",
                    floor_m + 0.5 * size[2]
                );
            }
            let (corners, triangles) = shape(solid).mesh();
            let corners: Vec<_> = corners.iter().map(|&corner| <[f64; 3]>::from(corner)).collect();
            format!("loss_db = 30\nshape.mesh = {{ vertices_m = {corners:?}, triangles = {triangles:?} }}")
        };
        // A wall on each side and a pillar between the two stations.
        let walls = [
            text([0.0, 4.0], [20.0, 0.3, 2.7]),
            text([0.0, -3.0], [20.0, 0.3, 2.7]),
            text([0.2, 0.0], [0.9, 0.7, 2.7]),
        ];
        let rise = at(0.0, 0.0, floor_m + z);
        rays(&channel(&law, &walls), from + rise, to + rise).iter().map(|ray| ray.loss.0).collect::<Vec<_>>()
    };
    for floor_m in [0.0, 0.3, -1.7] {
        for mesh in [false, true] {
            let above = losses(floor_m, mesh, 1.0);
            // Past the pillar on both sides, off both walls, off both in turn.
            assert!(above.len() >= 6 && above[0] > 110.0, "{above:?}");
            let lower = losses(floor_m, mesh, 0.0);
            assert_eq!(lower.len(), above.len(), "{floor_m} {mesh}: {lower:?} {above:?}");
            assert!(
                lower.iter().zip(&above).all(|(a, b)| (a - b).abs() < 1e-9),
                "{floor_m} {mesh}: {lower:?} {above:?}"
            );
            assert_eq!(losses(floor_m, mesh, 2.7).len(), 1, "{floor_m} {mesh}");
        }
    }
}
