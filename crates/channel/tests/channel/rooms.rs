//! Rooms from mesh files with several materials, and reflections off their faces.

use std::fmt::Write as _;
use std::path::Path;

use sextant_channel::{Channel, ChannelConfig, Material, Obstacle, ObstacleConfig, ObstacleField, Position};
use sextant_kernel::{Files, Seed};

use crate::reflections::rays;

/// An upright box as vertices and faces of an .obj file, after `before` vertices.
fn solid(before: usize, center: [f64; 3], size: [f64; 3]) -> String {
    let mut text = String::new();
    for (x, y, z) in
        [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)]
    {
        let at = |axis: usize, sign: i32| center[axis] + 0.5 * f64::from(sign) * size[axis];
        writeln!(text, "v {} {} {}", at(0, x), at(1, y), at(2, z)).expect("a string takes all");
    }
    for corners in [[1, 4, 3, 2], [5, 6, 7, 8], [1, 2, 6, 5], [2, 3, 7, 6], [3, 4, 8, 7], [4, 1, 5, 8]] {
        let [a, b, c, d] = corners.map(|corner| corner + before);
        writeln!(text, "f {a} {b} {c} {d}").expect("a string takes all");
    }
    text
}

/// A floor and a wall of concrete, a pane of glass, and a rack of metal, with names as tools for modelling write them.
fn room() -> String {
    let floor = solid(0, [0.0, 0.0, -0.1], [20.0, 20.0, 0.2]);
    let pane = solid(8, [0.0, 5.0, 2.0], [8.0, 0.006, 4.0]);
    let rack = solid(16, [-6.0, -3.0, 1.0], [0.4, 4.0, 2.0]);
    let wall = solid(24, [8.0, 0.0, 2.0], [0.3, 20.0, 4.0]);
    format!(
        "o floor\nusemtl itu_concrete\n{floor}o pane\nusemtl Glass.001\n{pane}usemtl mat-itu_metal\n{rack}usemtl itu_concrete\n{wall}"
    )
}

fn read(folder: &Path, name: &str, text: &str, more: &str) -> Result<Vec<Obstacle>, String> {
    std::fs::write(folder.join(name), text).expect("a folder for tests");
    let config: ObstacleConfig =
        toml::from_str(&format!("{more}\nshape.mesh.file = \"{name}\"")).expect("an obstacle");
    Obstacle::read_all(config, &Files::of_folder(folder)).map_err(|error| error.to_string())
}

fn channel(obstacles: Vec<Obstacle>, law: &str) -> Channel {
    let config: ChannelConfig = toml::from_str(law).unwrap_or_else(|error| panic!("{error}"));
    Channel::new(config.try_into().expect("a good channel"), ObstacleField::new(obstacles), Seed(1))
}

#[test]
fn a_room_from_a_file_has_one_obstacle_for_each_material() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("rooms");
    std::fs::create_dir_all(&folder).unwrap();
    let obstacles = read(&folder, "room.obj", &room(), "name = \"room\"").unwrap();
    let found: Vec<_> = obstacles.iter().map(|obstacle| (obstacle.name().unwrap(), obstacle.material())).collect();
    let named = |name: &str| Material::named(name);
    assert_eq!(
        found,
        [
            ("room, itu-concrete", named("itu-concrete")),
            ("room, glass", named("glass")),
            ("room, metal", named("metal")),
        ]
    );
    // A material of its own is that of all faces.
    let wooden = read(&folder, "room.obj", &room(), "material = \"wood\"").unwrap();
    assert_eq!(wooden.iter().map(Obstacle::material).collect::<Vec<_>>(), [named("wood")]);
    // The same room as boxes gives the same rays.
    let law = "path_loss.close_in = { carrier_ghz = 60, exponent = 2 }\nreflections = { order = 2, edges = true, most = 255 }";
    let box_of = |material: &str, center: [f64; 3], size: [f64; 3]| -> Obstacle {
        let text = format!("material = \"{material}\"\nshape.box = {{ center_m = {center:?}, size_m = {size:?} }}");
        toml::from_str::<ObstacleConfig>(&text).unwrap().try_into().unwrap()
    };
    let boxes = vec![
        box_of("itu-concrete", [0.0, 0.0, -0.1], [20.0, 20.0, 0.2]),
        box_of("itu-concrete", [8.0, 0.0, 2.0], [0.3, 20.0, 4.0]),
        box_of("glass", [0.0, 5.0, 2.0], [8.0, 0.006, 4.0]),
        box_of("metal", [-6.0, -3.0, 1.0], [0.4, 4.0, 2.0]),
    ];
    let (of_file, of_boxes) = (channel(obstacles, law), channel(boxes, law));
    for (from, to) in [
        (Position::new(-3.0, 1.0, 1.5), Position::new(4.0, -2.0, 1.0)),
        (Position::new(-2.0, 2.0, 0.5), Position::new(2.5, 3.0, 2.0)),
        (Position::new(-8.0, -2.5, 1.0), Position::new(3.0, -2.8, 1.2)),
    ] {
        let (found, expected) = (rays(&of_file, from, to), rays(&of_boxes, from, to));
        assert_eq!(found.len(), expected.len(), "{found:#?} {expected:#?}");
        assert!(found.len() > 4, "{found:?}");
        for (one, other) in found.iter().zip(&expected) {
            let is_same_loss = (one.loss.0 - other.loss.0).abs() < 1e-6 || one.loss.0 > 1000.0;
            assert!(is_same_loss && one.departure.distance_m(other.departure) < 1e-6, "{one:?} {other:?}");
            assert_eq!((one.bounces, one.is_diffracted), (other.bounces, other.is_diffracted));
        }
    }
    let why = read(&folder, "odd.obj", &room().replace("Glass.001", "Unobtainium"), "").unwrap_err();
    assert!(why.contains("Unobtainium") && why.contains("\"plasterboard\""), "{why}");
    let open = room().replacen("f 9 12 11 10\n", "", 1);
    let why = read(&folder, "open.obj", &open, "").unwrap_err();
    assert!(why.contains("Glass.001") && why.contains("closed mesh"), "{why}");
}
