//! Obstacles that touch or overlap: joints, corners, passages and edges.

use proptest::prelude::*;
use sextant_channel::{
    Channel, ChannelConfig, Dbm, Obstacle, ObstacleConfig, ObstacleField, Position, Ray, WallConfig,
};
use sextant_kernel::Seed;

use crate::reflections::rays;

fn at(x: f64, y: f64) -> Position {
    Position::new(x, y, 1.0)
}

fn body(text: &str) -> Obstacle {
    let config: ObstacleConfig = toml::from_str(text).unwrap_or_else(|error| panic!("{error}"));
    config.try_into().unwrap_or_else(|error| panic!("{error}"))
}

/// A box on the ground between these corners.
fn block(more: &str, [x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) -> Obstacle {
    let center = [f64::midpoint(x0, x1), f64::midpoint(y0, y1), 1.5];
    body(&format!("{more}\nshape.box = {{ center_m = {center:?}, size_m = [{:?}, {:?}, 3.0] }}", x1 - x0, y1 - y0))
}

fn walls(texts: &[&str]) -> Vec<Obstacle> {
    let wall = |(i, text): (usize, &&str)| {
        let config: WallConfig = toml::from_str(text).unwrap_or_else(|error| panic!("{error}"));
        config.obstacles(i).unwrap_or_else(|error| panic!("{error}"))
    };
    texts.iter().enumerate().flat_map(wall).collect()
}

fn loss_db(field: &ObstacleField, from: Position, to: Position) -> f64 {
    let loss = field.loss(from, to);
    let sum: f64 = field.losses(from, to).iter().map(|one| one.loss().0).sum();
    assert!(sum.to_bits() == loss.0.to_bits() || (sum - loss.0).abs() < 1e-9, "{sum} is not {loss:?}");
    assert_eq!(loss.0.to_bits(), field.loss(to, from).0.to_bits());
    loss.0
}

const METRE: &str = "absorption_per_m = 0.2302585092994046\nloss_db = 10"; // 1 dB per metre, and 10 dB.

#[test]
fn a_line_through_a_joint_is_in_the_way_of_both() {
    // The third one is half a millimetre away, and the fourth stands apart.
    let field = ObstacleField::new(vec![
        block(METRE, [0.0, 0.0], [1.0, 0.5]),
        block(METRE, [1.0, 0.0], [2.0, 0.5]),
        block(METRE, [2.0005, 0.0], [3.0, 0.5]),
        block(METRE, [3.01, 0.0], [4.0, 0.5]),
    ]);
    for z in [0.0, 1.0] {
        let across = |x: f64| (Position::new(x, -3.0, z), Position::new(x, 4.0, z));
        for x in [0.5, 1.0, 1.0 + 1e-12, 1.0 - 5e-10, 2.0, 2.000_25, 2.0005] {
            let (from, to) = across(x);
            assert!((loss_db(&field, from, to) - 10.5).abs() < 1e-6, "{x}: {}", loss_db(&field, from, to));
            assert!(field.blocking(from, to).is_some(), "{x}");
        }
        // Along their common face it is free, and so is the gap of a centimetre; an end on the joint is on a face.
        let (from, to) = across(3.005);
        assert_eq!((loss_db(&field, from, to), field.blocking(from, to)), (0.0, None));
        let (from, to) = (Position::new(-3.0, 0.5, z), Position::new(9.0, 0.5, z));
        assert_eq!((loss_db(&field, from, to), field.blocking(from, to)), (0.0, None));
        assert_eq!(field.blocking(Position::new(1.0, 4.0, z), Position::new(1.0, 0.5, z)), None);
    }
    // On the common roof it is free.
    assert!(loss_db(&field, Position::new(1.0, -3.0, 3.0), Position::new(1.0, 4.0, 3.0)) <= 0.0);
}

#[test]
fn a_line_through_the_edge_of_two_blocks_pays_and_a_place_in_a_corner_does_not() {
    let field = ObstacleField::new(vec![block(METRE, [0.0, 0.0], [1.0, 1.0]), block(METRE, [1.0, 1.0], [2.0, 2.0])]);
    assert!((loss_db(&field, at(0.0, 2.0), at(2.0, 0.0)) - 10.0).abs() < 0.01);
    // Two walls that meet have a corner: who stands in it hears along both and across.
    let field = ObstacleField::new(vec![block(METRE, [0.0, 0.0], [5.0, 0.2]), block(METRE, [0.0, 0.2], [0.2, 5.0])]);
    for to in [at(3.0, 3.0), at(4.0, 0.2), at(0.2, 4.0), at(4.0, 1.0), at(0.5, 4.0)] {
        assert_eq!((loss_db(&field, at(0.2, 0.2), to), field.blocking(at(0.2, 0.2), to)), (0.0, None));
    }
}

#[test]
fn two_parts_of_a_mesh_that_touch_have_no_slit() {
    let mut text = String::from("shape.mesh = { vertices_m = [");
    for x0 in [0.0, 1.0] {
        for (x, y, z) in [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)] {
            text += &format!("[{}, {y}, {z}], ", x0 + f64::from(x));
        }
    }
    text += "], triangles = [";
    for before in [0, 8] {
        for [a, b, c, d] in [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]] {
            let [a, b, c, d] = [a, b, c, d].map(|corner| corner + before);
            text += &format!("[{a}, {b}, {c}], [{a}, {c}, {d}], ");
        }
    }
    let field = ObstacleField::new(vec![body(&format!("{METRE}\n{text}] }}"))]);
    let z = |p: Position| Position { z_m: 0.4, ..p };
    for x in [0.3, 1.0, 1.7] {
        assert!((loss_db(&field, z(at(x, -2.0)), z(at(x, 3.0))) - 11.0).abs() < 1e-6, "{x}");
    }
    // Through both parts is one passage; along the outside is free.
    assert!((loss_db(&field, z(at(-1.0, 0.4)), z(at(3.0, 0.4))) - 12.0).abs() < 1e-6);
    assert!(loss_db(&field, z(at(-1.0, 1.0)), z(at(3.0, 1.0))) <= 0.0);
}

#[test]
fn a_fixed_loss_is_paid_once_a_passage_by_all_shapes() {
    let wall = "points_m = [[0, 0], [4, 0], [4, 3], [0, 3], [0, 0]]\nthickness_m = 0.2\nloss_db = 10\n\
                openings = [{ at_m = 1, width_m = 1, bottom_m = 0.5, top_m = 2, loss_db = 2 }]";
    let room = ObstacleField::new(walls(&[wall]));
    for (from, to, expected_db) in [
        (at(3.0, -1.0), at(3.0, 1.0), 10.0),
        (at(3.0, -1.0), at(3.0, 5.0), 20.0),
        // Through a corner, along a side, and in the window; below, at and beside it.
        (at(3.0, -1.0), at(5.0, 1.0), 10.0),
        (at(-1.0, 0.05), at(6.0, 0.05), 10.0),
        (at(1.5, -1.0), at(1.5, 1.0), 2.0),
        (Position::new(1.5, -1.0, 0.2), Position::new(1.5, 1.0, 0.2), 10.0),
        (Position::new(1.5, -1.0, 0.3), Position::new(1.5, 1.0, 0.7), 10.0),
        (at(0.9, -0.5), at(1.1, 0.5), 10.0),
        // From inside the wall, and within it.
        (at(3.0, 0.0), at(3.0, 1.0), 10.0),
        (at(2.5, 0.0), at(3.0, 0.0), 10.0),
    ] {
        let found = loss_db(&room, from, to);
        assert!((found - expected_db).abs() < 1e-9, "{from} {to}: {found}, not {expected_db}");
    }
    // A frame as a mesh is passed twice: its border is a prism with a hole, from 0 to 1 m, and from 2 to 3 m.
    let (mut vertices, mut triangles) = (String::new(), String::new());
    for z in [0, 2] {
        for (low, high) in [(0, 3), (1, 2)] {
            for (x, y) in [(low, low), (high, low), (high, high), (low, high)] {
                vertices += &format!("[{x}, {y}, {z}], ");
            }
        }
    }
    for i in 0..4 {
        let next = (i + 1) % 4;
        for [a, b, c, d] in [
            [i, next, next + 8, i + 8],
            [next + 4, i + 4, i + 12, next + 12],
            [next, i, i + 4, next + 4],
            [i + 8, next + 8, next + 12, i + 12],
        ] {
            triangles += &format!("[{a}, {b}, {c}], [{a}, {c}, {d}], ");
        }
    }
    let frame = format!("{METRE}\nshape.mesh = {{ vertices_m = [{vertices}], triangles = [{triangles}] }}");
    let frame = ObstacleField::new(vec![body(&frame)]);
    assert!((loss_db(&frame, at(-1.0, 1.4), at(4.0, 1.4)) - 22.0).abs() < 1e-9);
    assert!((loss_db(&frame, at(-1.0, 1.4), at(1.5, 1.6)) - 11.0).abs() < 0.1);
    assert!((loss_db(&frame, at(-1.0, 0.4), at(4.0, 0.4)) - 13.0).abs() < 1e-9);
}

#[test]
fn walls_that_overlap_at_a_corner_are_paid_once() {
    let of = |loss: &str| {
        let first = format!("points_m = [[0, 0], [5, 0]]\nthickness_m = 0.2\n{loss}");
        let second = format!("points_m = [[5, 0], [5, 4]]\nthickness_m = 0.2\n{loss}");
        ObstacleField::new(walls(&[&first, &second]))
    };
    // Along the first wall through the second one, whose half is in it.
    let absorbing = of("absorption_per_m = 0.2302585092994046");
    assert!((loss_db(&absorbing, at(-1.0, 0.05), at(7.0, 0.05)) - 5.1).abs() < 1e-9);
    let fixed = of("loss_db = 10");
    for (from, to, expected_db) in [
        (at(-1.0, 0.05), at(7.0, 0.05), 10.0),
        (at(4.95, -1.0), at(4.95, 0.09), 10.0),
        (at(4.5, -0.45), at(5.5, 0.55), 10.0),
        (at(2.0, -1.0), at(6.0, 3.0), 20.0),
    ] {
        let found = loss_db(&fixed, from, to);
        assert!((found - expected_db).abs() < 1e-9, "{from} {to}: {found}");
    }
    // Two walls at one place, as areas of a plan that share a border have them.
    let text = "points_m = [[0, 0], [5, 0]]\nabsorption_per_m = 1\nloss_db = 3";
    let (one, two) = (ObstacleField::new(walls(&[text])), ObstacleField::new(walls(&[text, text])));
    let (from, to) = (at(2.0, -1.0), at(3.0, 1.0));
    assert!((loss_db(&one, from, to) - loss_db(&two, from, to)).abs() < 1e-9);
}

/// A channel of free space with edges among obstacles.
fn bending(obstacles: Vec<Obstacle>) -> Channel {
    let law = "path_loss.close_in = { carrier_ghz = 28, exponent = 2 }\nreflections = { order = 0, edges = true }";
    let config: ChannelConfig = toml::from_str(law).expect("a channel");
    Channel::new(config.try_into().expect("a good channel"), ObstacleField::new(obstacles), Seed(1))
}

const METAL: &str = "material = \"metal\"";

#[test]
fn edges_are_those_of_whole_walls() {
    let whole = bending(vec![block(METAL, [0.0, -2.0], [0.2, 2.0])]);
    let parts = bending(vec![
        block(METAL, [0.0, -2.0], [0.2, 0.1]),
        block(METAL, [0.0, 0.1], [0.2, 1.0]),
        block(METAL, [0.0, 1.0], [0.2, 2.0]),
    ]);
    let line = bending(walls(&["points_m = [[0.1, -2], [0.1, 2]]\nthickness_m = 0.2\nmaterial = \"metal\"\n\
         openings = [{ at_m = 1.5, width_m = 1, bottom_m = 0.5, top_m = 1.5, material = \"metal\" }]"]));
    for y in [-1.3, 0.0, 0.1, 0.4, 1.0] {
        let (from, to) = (at(-4.0, y), at(3.0, y));
        let expected = rays(&whole, from, to);
        assert_eq!(expected.iter().filter(|ray| ray.is_diffracted).count(), 2);
        for other in [&parts, &line] {
            let found = rays(other, from, to);
            assert_eq!(found.len(), expected.len(), "{y}: {found:#?}");
            for (one, other) in found[1..].iter().zip(&expected[1..]) {
                assert!((one.loss.0 - other.loss.0).abs() < 1e-6, "{y}: {one:?} {other:?}");
            }
        }
    }
    // A wall that goes on in a corner has its edge there, and an open door has one.
    let corner = walls(&["points_m = [[0, 0], [0, 4], [4, 4]]\nthickness_m = 0.2\nmaterial = \"metal\"\n\
         openings = [{ at_m = 1, width_m = 1 }]"]);
    let found = rays(&bending(corner), at(-3.0, 0.5), at(3.0, 0.6));
    assert_eq!(found.iter().filter(|ray| ray.is_diffracted).count(), 2, "{found:?}");
}

proptest! {
    #[test]
    fn edges_never_give_more_power_than_the_open_way(
        loss_db in 0.0..40.0_f64, half in 0.05..2.0_f64, y in -2.0..2.0_f64, thick in 0.01..0.5_f64,
    ) {
        let screen = block(&format!("loss_db = {loss_db}"), [0.0, -half], [thick, half]);
        let channel = bending(vec![screen]);
        let (from, to) = (at(-4.0, y), at(3.0, 0.2));
        let power = channel.mean_power(Dbm(0.0), from, to).expect("no hard radius").0;
        let open = -channel.law().path_loss().loss(from.distance_m(to)).0;
        prop_assert!(power <= open + 1e-9 && power >= open - loss_db - 1e-9, "{} {}", power, open);
        let bent = rays(&channel, from, to).into_iter().filter(|ray: &Ray| ray.is_diffracted);
        prop_assert!(bent.count() <= 2);
    }
}
