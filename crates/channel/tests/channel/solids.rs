//! Solids for the tests, each with its own rule for what is inside.

use sextant_channel::{
    BoxConfig, ConvexConfig, CylinderConfig, MeshConfig, Obstacle, ObstacleConfig, Position, PrismConfig, Shape,
    ShapeConfig,
};
use sextant_kernel::{Files, Purpose, Seed};

pub(crate) fn at(x: f64, y: f64, z: f64) -> Position {
    Position::new(x, y, z)
}

pub(crate) fn shape(config: ShapeConfig) -> Shape {
    Shape::read(config, &Files::default()).expect("a good shape")
}

pub(crate) fn upright_box(center_m: Position, size_m: [f64; 3], yaw_deg: f64) -> ShapeConfig {
    ShapeConfig::Box(BoxConfig { center_m, size_m, yaw_deg })
}

pub(crate) fn cylinder(base_m: Position, radius_m: f64, height_m: f64) -> ShapeConfig {
    ShapeConfig::Cylinder(CylinderConfig { base_m, radius_m, height_m })
}

pub(crate) fn prism(corners_m: &[[f64; 2]], bottom_m: f64, height_m: f64) -> ShapeConfig {
    ShapeConfig::Prism(PrismConfig { corners_m: corners_m.to_vec(), bottom_m, height_m })
}

pub(crate) fn convex(points: &[[f64; 3]]) -> ShapeConfig {
    ShapeConfig::Convex(ConvexConfig { points_m: points.iter().map(|&p| p.into()).collect() })
}

pub(crate) fn mesh(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> ShapeConfig {
    ShapeConfig::Mesh(MeshConfig {
        file: None,
        vertices_m: Some(vertices.iter().map(|&p| p.into()).collect()),
        triangles: Some(triangles.to_vec()),
    })
}

/// An upright box from `min` to `max` as a mesh; its faces turn inwards if `hollow`.
fn box_skin(min: [f64; 3], max: [f64; 3], hollow: bool) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let corner = |i: usize| [[min, max][i & 1][0], [min, max][i >> 1 & 1][1], [min, max][i >> 2 & 1][2]];
    let mut triangles = vec![
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    if hollow {
        triangles.iter_mut().for_each(|t: &mut [u32; 3]| t.swap(0, 1));
    }
    ((0..8).map(corner).collect(), triangles)
}

/// The cube from 0 to 1 in each way of writing it.
pub(crate) fn cubes() -> Vec<(&'static str, ShapeConfig)> {
    let (corners, skin) = box_skin([0.0; 3], [1.0; 3], false);
    let inverted = box_skin([0.0; 3], [1.0; 3], true).1;
    vec![
        ("box", upright_box(at(0.5, 0.5, 0.5), [1.0; 3], 0.0)),
        ("turned box", upright_box(at(0.5, 0.5, 0.5), [1.0; 3], 90.0)),
        ("prism", prism(&[[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.5, 0.0]], 0.0, 1.0)),
        ("convex", convex(&corners)),
        ("mesh", mesh(&corners, &skin)),
        ("inverted mesh", mesh(&corners, &inverted)),
    ]
}

/// Solids with a rule that says which places are inside, written without the library.
pub(crate) type Rule = fn(Position) -> bool;

pub(crate) fn solids() -> Vec<(&'static str, ShapeConfig, Rule)> {
    let turned: Rule = |p| {
        let (s, c) = 0.5_f64.sin_cos();
        let (x, y) = (p.x_m - 1.0, p.y_m + 0.5);
        (c * x + s * y).abs() < 1.5 && (c * y - s * x).abs() < 0.6 && (p.z_m - 0.3).abs() < 1.0
    };
    let round: Rule = |p| (p.x_m - 0.4).powi(2) + (p.y_m - 0.2).powi(2) < 1.44 && p.z_m > -1.0 && p.z_m < 1.2;
    let wedge: Rule = |p| p.y_m > -1.0 && p.x_m > -1.0 && p.x_m + p.y_m < 1.5 && p.z_m > -0.7 && p.z_m < 0.9;
    let octahedron: Rule = |p| p.x_m.abs() + p.y_m.abs() + p.z_m.abs() < 1.7;
    let angle: Rule = |p| {
        let within = |x0: f64, x1: f64, y0: f64, y1: f64| p.x_m > x0 && p.x_m < x1 && p.y_m > y0 && p.y_m < y1;
        p.z_m.abs() < 1.0 && (within(-1.5, 1.5, -1.5, -0.5) || within(-1.5, -0.5, -1.0, 1.5))
    };
    let shell: Rule = |p| {
        let cube = |h: f64| p.x_m.abs() < h && p.y_m.abs() < h && p.z_m.abs() < h;
        cube(1.4) && !cube(0.8)
    };
    let r = 1.7;
    let tips =
        [[r, 0.0, 0.0], [-r, 0.0, 0.0], [0.0, r, 0.0], [0.0, -r, 0.0], [0.0, 0.0, r], [0.0, 0.0, -r], [0.1; 3]];
    let (mut corners, mut skin) = box_skin([-1.4; 3], [1.4; 3], false);
    let (inner, cavity) = box_skin([-0.8; 3], [0.8; 3], true);
    corners.extend(inner);
    skin.extend(cavity.iter().map(|t| t.map(|i| i + 8)));
    vec![
        ("turned box", upright_box(at(1.0, -0.5, 0.3), [3.0, 1.2, 2.0], 0.5_f64.to_degrees()), turned),
        ("cylinder", cylinder(at(0.4, 0.2, -1.0), 1.2, 2.2), round),
        ("prism", prism(&[[-1.0, -1.0], [-1.0, 2.5], [2.5, -1.0]], -0.7, 1.6), wedge),
        ("convex", convex(&tips), octahedron),
        ("angle mesh", angle_mesh(), angle),
        ("shell mesh", mesh(&corners, &skin), shell),
    ]
}

/// A wall around a corner, an L seen from above: a mesh that is not convex.
fn angle_mesh() -> ShapeConfig {
    let ring = [[-1.5, -1.5], [1.5, -1.5], [1.5, -0.5], [-0.5, -0.5], [-0.5, 1.5], [-1.5, 1.5]];
    let vertices: Vec<_> = [-1.0, 1.0].iter().flat_map(|&z| ring.map(|[x, y]| [x, y, z])).collect();
    let mut triangles = Vec::new();
    for [a, b, c] in [[0, 1, 2], [0, 2, 3], [0, 3, 5], [3, 4, 5]] {
        triangles.push([a, c, b]);
        triangles.push([a + 6, b + 6, c + 6]);
    }
    for i in 0..6 {
        let next = (i + 1) % 6;
        triangles.push([i, next, next + 6]);
        triangles.push([i, next + 6, i + 6]);
    }
    mesh(&vertices, &triangles)
}

/// Random place number `index` in the cube with half the edge `half_m`.
pub(crate) fn random_place(index: u64, half_m: f64) -> Position {
    let draw = |axis| (2.0 * Seed(5).uniform(Purpose::new(1), [index, axis, 0]) - 1.0) * half_m;
    at(draw(0), draw(1), draw(2))
}

pub(crate) fn obstacle(shape: ShapeConfig, absorption_per_m: f64) -> Obstacle {
    ObstacleConfig::absorbing(shape, absorption_per_m).try_into().expect("a good obstacle")
}
