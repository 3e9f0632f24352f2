//! Lengths of lines inside obstacles.

use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query::{Ray, RayCast};
use parry3d_f64::shape::{ConvexPolyhedron, Cuboid, Cylinder, TriMesh};
use proptest::prelude::*;
use sextant_channel::{Bounds, Crossing, Db, ObstacleField, Position, Shape};

use crate::solids::{at, cubes, cylinder, mesh, obstacle, random_place, shape, solids, upright_box};

fn assert_length(shape: &Shape, name: &str, from: Position, to: Position, expected_m: f64) {
    for (a, b) in [(from, to), (to, from)] {
        let length_m = shape.length_inside_m(a, b);
        assert!((length_m - expected_m).abs() < 1e-9, "{name} from {a} to {b}: {length_m}, not {expected_m}");
    }
}

#[test]
fn lengths_are_the_same_for_every_way_of_writing_a_cube() {
    let root = 2_f64.sqrt();
    for (name, cube) in cubes() {
        let cube = shape(cube);
        for (from, to, expected_m) in [
            // Straight through, with ends outside, inside, on the surface.
            (at(-2.0, 0.4, 0.3), at(3.0, 0.4, 0.3), 1.0),
            (at(0.4, -2.0, 0.3), at(0.4, 0.75, 0.3), 0.75),
            (at(0.4, 0.3, 0.2), at(0.4, 0.3, 0.9), 0.7),
            (at(0.0, 0.4, 0.3), at(1.0, 0.4, 0.3), 1.0),
            // Through the diagonals of the faces of the mesh, edges and corners.
            (at(-1.0, 0.5, 0.5), at(2.0, 0.5, 0.5), 1.0),
            (at(0.5, 0.5, -1.0), at(0.5, 0.5, 2.0), 1.0),
            (at(-1.0, -1.0, 0.5), at(2.0, 2.0, 0.5), root),
            (at(-1.0, -1.0, -1.0), at(2.0, 2.0, 2.0), 3_f64.sqrt()),
            (at(0.5, 0.5, 0.5), at(2.0, 2.0, 2.0), 3_f64.sqrt() / 2.0),
            // In the floor; on the roof, along a side face, along an edge, touching an edge, touching a corner, ending on a face.
            (at(-1.0, 0.5, 0.0), at(2.0, 0.5, 0.0), 1.0),
            (at(-1.0, 0.5, 1.0), at(2.0, 0.5, 1.0), 0.0),
            (at(-1.0, 1.0, 0.3), at(2.0, 1.0, 0.3), 0.0),
            (at(-1.0, 0.0, 0.0), at(2.0, 0.0, 0.0), 0.0),
            (at(-1.0, 1.0, 0.5), at(1.0, -1.0, 0.5), 0.0),
            (at(2.0, 0.0, 0.4), at(0.0, 2.0, 0.4), 0.0),
            (at(1.0, 1.0, -1.0), at(1.0, 1.0, 2.0), 0.0),
            (at(-1.0, 0.4, 0.3), at(0.0, 0.4, 0.3), 0.0),
            // Beside the cube, before it, and a line without length.
            (at(-1.0, 1.2, 0.5), at(2.0, 1.2, 0.5), 0.0),
            (at(-1.0, 0.4, 0.3), at(-0.1, 0.4, 0.3), 0.0),
            (at(0.5, 0.5, 0.5), at(0.5, 0.5, 0.5), 0.0),
            (at(3.0, 0.5, 0.5), at(3.0, 0.5, 0.5), 0.0),
        ] {
            assert_length(&cube, name, from, to, expected_m);
        }
    }
}

#[test]
fn random_lines_have_the_same_length_for_every_way_of_writing_a_cube() {
    let cubes: Vec<_> = cubes().into_iter().map(|(name, cube)| (name, shape(cube))).collect();
    let mut crossed = 0;
    for i in 0..4000 {
        let half = at(0.5, 0.5, 0.5);
        let (from, to) = (random_place(2 * i, 1.5) + half, random_place(2 * i + 1, 1.5) + half);
        let expected_m = cubes[0].1.length_inside_m(from, to);
        crossed += u32::from(expected_m > 0.0);
        for (name, cube) in &cubes[1..] {
            assert_length(cube, name, from, to, expected_m);
        }
    }
    assert!(crossed > 1000, "only {crossed} lines cross");
}

#[test]
fn lines_through_a_cylinder_have_the_lengths_of_chords() {
    let round = shape(cylinder(at(3.0, -2.0, 1.0), 0.5, 2.0));
    let chord_m = 2.0 * (0.25_f64 - 0.09).sqrt();
    for (from, to, expected_m) in [
        (at(0.0, -2.0, 2.0), at(9.0, -2.0, 2.0), 1.0),
        (at(0.0, -1.7, 2.0), at(9.0, -1.7, 2.0), chord_m),
        (at(3.0, -2.0, 2.0), at(9.0, -2.0, 2.0), 0.5),
        (at(3.1, -2.0, 0.0), at(3.1, -2.0, 9.0), 2.0),
        (at(3.1, -2.0, 1.5), at(3.1, -2.0, 1.75), 0.25),
        // Enters through the bottom face at half of the line, leaves through the mantle at three quarters.
        (at(2.0, -2.0, -1.0), at(4.0, -2.0, 3.0), 0.25 * 20_f64.sqrt()),
        // On the mantle, tangent to it, on the top face, above it.
        (at(3.5, -2.0, 0.0), at(3.5, -2.0, 9.0), 0.0),
        (at(0.0, -1.5, 2.0), at(9.0, -1.5, 2.0), 0.0),
        (at(0.0, -2.0, 3.0), at(9.0, -2.0, 3.0), 0.0),
        (at(0.0, -2.0, 3.1), at(9.0, -2.0, 3.1), 0.0),
        (at(3.0, -2.0, 2.0), at(3.0, -2.0, 2.0), 0.0),
    ] {
        assert_length(&round, "cylinder", from, to, expected_m);
    }
}

#[test]
fn lengths_agree_with_a_hundred_thousand_steps_along_the_line() {
    const STEPS: u32 = 100_000;
    for (name, solid, inside) in solids() {
        let solid = shape(solid);
        let mut longest_m = 0.0_f64;
        for i in 0..12 {
            let (from, to) = (random_place(2 * i, 3.0), random_place(2 * i + 1, 1.0) * -1.0);
            let step = (to - from) * (1.0 / f64::from(STEPS));
            let hits = (0..STEPS).filter(|&k| inside(from + step * (f64::from(k) + 0.5))).count();
            let expected_m = f64::from(u32::try_from(hits).unwrap()) * step.length_m();
            let length_m = solid.length_inside_m(from, to);
            // A line passes at most four faces, each with an error of at most half a step.
            assert!(
                (length_m - expected_m).abs() <= 2.01 * step.length_m(),
                "{name}: {length_m}, counted {expected_m}"
            );
            longest_m = longest_m.max(length_m);
        }
        assert!(longest_m > 0.5, "{name}: no line inside");
    }
}

#[test]
fn lines_through_edges_corners_and_faces_of_a_mesh_are_counted_once() {
    const STEPS: u32 = 400;
    // Places on a lattice that the faces, edges and corners of the mesh lie on.
    for (index, spacing_m) in [(4, 0.5), (5, 0.7)] {
        let (name, solid, inside) = solids().swap_remove(index);
        let solid = shape(solid);
        let mut crossed = 0;
        for i in 0..4000 {
            let lattice = |p: Position| {
                let snap = |x_m: f64| (x_m / spacing_m).round() * spacing_m;
                at(snap(p.x_m), snap(p.y_m), snap(p.z_m))
            };
            let (from, to) = (lattice(random_place(2 * i, 2.5)), lattice(random_place(2 * i + 1, 2.5)));
            let step = (to - from) * (1.0 / f64::from(STEPS));
            // What lies in a face belongs to the solid if what is just above does.
            let above = from + at(0.0, 0.0, 1e-9);
            let hits = (0..STEPS).filter(|&k| inside(above + step * (f64::from(k) + 0.5))).count();
            let expected_m = f64::from(u32::try_from(hits).unwrap()) * step.length_m();
            let length_m = solid.length_inside_m(from, to);
            // By the rule, too, a line along a side face is outside: lattice and faces are exact numbers.
            assert!(
                (length_m - expected_m).abs() <= 2.01 * step.length_m(),
                "{name} from {from} to {to}: {length_m}, counted {expected_m}"
            );
            crossed += u32::from(length_m > 0.0);
        }
        assert!(crossed > 500, "{name}: {crossed}");
    }
}

#[test]
fn a_place_is_inside_if_its_rule_says_so_and_only_then_its_distance_is_zero() {
    for (name, solid, inside) in solids() {
        let solid = shape(solid);
        let mut count = 0;
        for i in 0..3000 {
            let p = random_place(i, 2.0);
            if inside(p) != inside(p + at(0.0, 0.0, Shape::LEVEL_M)) {
                // It counts as on a floor or a roof.
                continue;
            }
            assert_eq!(solid.contains(p), inside(p), "{name} at {p}");
            assert_eq!(solid.distance_m(p) <= 0.0, inside(p), "{name} at {p}");
            count += u32::from(inside(p));
        }
        assert!(count > 100, "{name}: {count} inside");
    }
}

/// The library's casts from both ends, which iterate for round and convex shapes.
fn cast_length_m(body: &dyn RayCast, pose: &Pose, from: Position, to: Position) -> Option<f64> {
    let vector = |p: Position| Vector::new(p.x_m, p.y_m, p.z_m);
    let length_m = from.distance_m(to);
    let u = (to - from) * (1.0 / length_m);
    let enter_m = body.cast_ray(pose, &Ray::new(vector(from), vector(u)), length_m, true)?;
    let leave_m = body.cast_ray(pose, &Ray::new(vector(to), vector(u * -1.0)), length_m, true)?;
    Some(length_m - enter_m - leave_m)
}

#[test]
fn lengths_agree_with_the_casts_of_the_geometry_library() {
    const LINES: u64 = 3000;
    let (_, octahedron, _) = solids().swap_remove(3);
    let (vertices, triangles) = shape(octahedron).mesh();
    let vertices: Vec<_> = vertices.iter().map(|p| Vector::new(p.x_m, p.y_m, p.z_m)).collect();
    let upright = Pose::new(Vector::new(0.4, 0.2, 0.1), Vector::new(std::f64::consts::FRAC_PI_2, 0.0, 0.0));
    let turned = Pose::new(Vector::new(1.0, -0.5, 0.3), Vector::new(0.0, 0.0, 0.5));
    let bodies: [(&str, Box<dyn RayCast>, Pose, usize); 4] = [
        ("turned box", Box::new(Cuboid::new(Vector::new(1.5, 0.6, 1.0))), turned, 0),
        ("cylinder", Box::new(Cylinder::new(1.1, 1.2)), upright, 1),
        (
            "convex",
            Box::new(ConvexPolyhedron::from_convex_mesh(vertices.clone(), &triangles).unwrap()),
            Pose::IDENTITY,
            3,
        ),
        ("mesh", Box::new(TriMesh::new(vertices, triangles).unwrap()), Pose::IDENTITY, 3),
    ];
    for (name, body, pose, index) in bodies {
        let (_, solid, inside) = solids().swap_remove(index);
        let solid = shape(solid);
        let (mut crossed, mut missed) = (0, 0);
        for i in 0..LINES {
            let (from, to) = (random_place(2 * i, 3.0), random_place(2 * i + 1, 3.0));
            if inside(from) || inside(to) {
                continue;
            }
            let length_m = solid.length_inside_m(from, to);
            crossed += u32::from(length_m > 0.0);
            let cast_m = cast_length_m(&*body, &pose, from, to).unwrap_or(0.0);
            missed += u32::from((length_m - cast_m).abs() > 1e-5);
        }
        // Its iterative casts miss about one line in 20 000; ours are right there, as the counted steps show.
        assert!(missed <= 1, "{name}: {missed} of {crossed} lines differ");
        assert!(crossed > 200, "{name}: {crossed}");
    }
}

/// 300 boxes and cylinders in a block of 40 by 40 by 6 m, some overlapping.
fn town() -> ObstacleField {
    let place = |i: u64| {
        let p = random_place(i, 20.0);
        at(p.x_m, p.y_m, p.z_m * 0.1)
    };
    ObstacleField::new(
        (0..300)
            .map(|i| {
                let s = random_place(1000 + i, 1.0);
                let size = [s.x_m.abs() + 0.2, s.y_m.abs() + 0.2, s.z_m.abs() + 0.2];
                if i % 2 == 0 {
                    obstacle(upright_box(place(i), size, 180.0 * s.x_m), 1.0 + s.y_m)
                } else {
                    obstacle(cylinder(place(i), size[0], size[1]), 1.0 + s.y_m)
                }
            })
            .collect(),
    )
}

#[test]
fn a_field_finds_the_same_crossings_as_a_query_of_each_obstacle() {
    let field = town();
    let mut crossings = vec![Crossing { obstacle: 7, length_m: 1.0, passages: 1 }];
    let mut total = 0;
    for i in 0..3000 {
        let (from, to) = (random_place(5000 + 2 * i, 22.0), random_place(5001 + 2 * i, 22.0));
        let (from, to) = (at(from.x_m, from.y_m, 0.1 * from.z_m), at(to.x_m, to.y_m, 0.1 * to.z_m));
        field.crossings(from, to, &mut crossings);
        let mut expected = Vec::new();
        let mut nepers = 0.0;
        for (obstacle, found) in field.obstacles().iter().enumerate() {
            let length_m = found.shape().length_inside_m(from, to);
            if length_m > 0.0 {
                expected.push((obstacle, length_m));
                nepers += found.absorption_per_m() * length_m;
            }
        }
        assert_eq!(
            crossings.iter().map(|c| c.obstacle).collect::<Vec<_>>(),
            expected.iter().map(|e| e.0).collect::<Vec<_>>()
        );
        for (crossing, (_, length_m)) in crossings.iter().zip(&expected) {
            assert!((crossing.length_m - length_m).abs() < 1e-9);
        }
        assert!((field.loss(from, to).0 - nepers * 4.342_944_819_032_518).abs() < 1e-9);
        assert_eq!(field.loss(from, to).0.to_bits(), field.loss(to, from).0.to_bits());
        total += crossings.len();
        let first = field.obstacles().iter().position(|o| o.shape().contains(from));
        assert_eq!(field.containing(from), first);
        let nearest_m = field.obstacles().iter().map(|o| o.shape().distance_m(from)).fold(f64::INFINITY, f64::min);
        assert!((field.distance_m(from) - nearest_m).abs() < 1e-12);
    }
    assert!(total > 2000, "only {total} crossings");
}

#[test]
fn an_empty_field_stops_nothing() {
    let field = ObstacleField::default();
    let mut crossings = Vec::new();
    field.crossings(at(0.0, 0.0, 0.0), at(9.0, 0.0, 0.0), &mut crossings);
    assert!(crossings.is_empty() && field.is_empty());
    assert_eq!(field.loss(at(0.0, 0.0, 0.0), at(9.0, 0.0, 0.0)), Db(0.0));
    assert_eq!((field.containing(at(0.0, 0.0, 0.0)), field.bounds()), (None, None));
    assert!(field.distance_m(at(0.0, 0.0, 0.0)).is_infinite());
}

#[test]
fn many_equal_obstacles_all_count() {
    let field = ObstacleField::new(vec![obstacle(upright_box(at(0.0, 0.0, 0.0), [1.0; 3], 0.0), 2.0); 100]);
    let loss = field.loss(at(-5.0, 0.1, 0.1), at(5.0, 0.1, 0.1));
    assert!((loss.0 - 200.0 * 4.342_944_819_032_518).abs() < 1e-9);
    assert_eq!(field.bounds(), Some(Bounds { min: at(-0.5, -0.5, -0.5), max: at(0.5, 0.5, 0.5) }));
}

#[test]
fn surfaces_for_drawing_turn_outwards_and_enclose_the_solid() {
    let volumes = [
        3.0 * 1.2 * 2.0,
        0.0,
        0.5 * 3.5 * 3.5 * 1.6,
        4.0 / 3.0 * 1.7_f64.powi(3),
        5.0 * 2.0,
        2.8_f64.powi(3) - 1.6_f64.powi(3),
    ];
    for ((name, solid, _), mut expected_m3) in solids().into_iter().zip(volumes) {
        if name == "cylinder" {
            // A prism of 48 sides in the circle.
            expected_m3 = 48.0 / 2.0 * 1.44 * (std::f64::consts::TAU / 48.0).sin() * 2.2;
        }
        let solid = shape(solid);
        let (vertices, triangles) = solid.mesh();
        let volume_m3: f64 =
            triangles.iter().map(|t| t.map(|i| vertices[i as usize])).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
        assert!((volume_m3 - expected_m3).abs() < 1e-9, "{name}: {volume_m3}, not {expected_m3}");
        let bounds = Bounds::of(vertices.iter().copied()).unwrap();
        assert!(bounds.min.distance_m(solid.bounds().min) < 1e-9 && bounds.max.distance_m(solid.bounds().max) < 1e-9);
    }
}

proptest! {
    #[test]
    fn a_line_cut_in_two_has_the_lengths_of_its_parts(
        which in 0_usize..6, i in 0_u64..1000, share in 0.0..1.0_f64
    ) {
        let (_, solid, _) = solids().swap_remove(which);
        let solid = shape(solid);
        let (from, to) = (random_place(2 * i, 3.0), random_place(2 * i + 1, 3.0));
        let middle = from + (to - from) * share;
        let (whole_m, first_m) = (solid.length_inside_m(from, to), solid.length_inside_m(from, middle));
        prop_assert!((whole_m - first_m - solid.length_inside_m(middle, to)).abs() < 1e-8);
        prop_assert!(first_m <= whole_m + 1e-8 && whole_m <= from.distance_m(to) + 1e-12);
    }

    #[test]
    fn a_moved_world_has_the_same_lengths(i in 0_u64..1000, dx in -500.0..500.0_f64, yaw in -360.0..360.0_f64) {
        let shift = at(dx, -dx, 0.1 * dx);
        let (from, to) = (random_place(2 * i, 3.0), random_place(2 * i + 1, 3.0));
        let here = shape(upright_box(at(0.0, 0.0, 0.0), [2.0, 1.0, 3.0], yaw));
        let there = shape(upright_box(shift, [2.0, 1.0, 3.0], yaw));
        prop_assert!((here.length_inside_m(from, to) - there.length_inside_m(from + shift, to + shift)).abs() < 1e-9);
    }
}

/// Two boxes in one mesh, the second of which begins inside the first; and one that lies in the other.
#[test]
fn parts_of_a_mesh_that_overlap_count_once() {
    let boxes = [(at(0.0, 0.0, 0.0), 2.0), (at(1.5, 0.1, 0.1), 2.0), (at(0.05, 0.0, 0.0), 0.5)];
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for (center, size_m) in boxes {
        let (corners, faces) = shape(upright_box(center, [size_m; 3], 0.0)).mesh();
        let first = u32::try_from(vertices.len()).unwrap();
        vertices.extend(corners.iter().map(|p| [p.x_m, p.y_m, p.z_m]));
        triangles.extend(faces.iter().map(|face| face.map(|corner| first + corner)));
    }
    let joined = shape(mesh(&vertices, &triangles));
    for (from, to, expected_m) in [
        (at(-5.0, 0.21, 0.12), at(5.0, 0.21, 0.12), 3.5),
        (at(-5.0, 0.0, 0.0), at(5.0, 0.0, 0.0), 3.5),
        (at(0.75, 0.21, 0.12), at(0.25, 0.21, 0.12), 0.5),
        (at(0.2, -5.0, 0.12), at(0.2, 5.0, 0.12), 2.0),
        (at(-5.0, 1.05, 0.12), at(5.0, 1.05, 0.12), 2.0),
    ] {
        assert_length(&joined, "boxes that overlap", from, to, expected_m);
    }
}
