//! Reflections against the formula of two rays and against mirror images of triangles.

use proptest::prelude::*;
use sextant_channel::{Channel, ChannelConfig, Dbm, Obstacle, ObstacleConfig, ObstacleField, Position, Ray};
use sextant_kernel::Seed;

pub(crate) fn channel(law: &str, obstacles: &[String]) -> Channel {
    let config: ChannelConfig = toml::from_str(law).unwrap_or_else(|error| panic!("{error}"));
    let read = |text: &String| {
        let config: ObstacleConfig = toml::from_str(text).unwrap_or_else(|error| panic!("{error}"));
        Obstacle::try_from(config).unwrap_or_else(|error| panic!("{error}"))
    };
    let field = ObstacleField::new(obstacles.iter().map(read).collect());
    Channel::new(config.try_into().expect("a good channel"), field, Seed(1))
}

pub(crate) fn rays(channel: &Channel, from: Position, to: Position) -> Vec<Ray> {
    let mut rays = Vec::new();
    channel.rays(from, to, &mut rays);
    rays
}

const FREE: &str = "path_loss.close_in = { carrier_ghz = 60, exponent = 2, min_distance_m = 0.01 }";

#[test]
fn a_link_over_the_ground_has_the_power_of_two_rays() {
    let channel = channel(&format!("{FREE}\nreflections = {{ loss_db = 6, ground_z_m = 0 }}"), &[]);
    for (distance, h1, h2) in [(10.0, 2.0, 1.0), (50.0, 1.5, 1.5), (3.0, 0.2, 4.0)] {
        let (from, to) = (Position::new(0.0, 0.0, h1), Position::new(0.0, distance, h2));
        let found = rays(&channel, from, to);
        assert_eq!(found.len(), 2);
        let direct = distance.hypot(h1 - h2);
        let bounced = distance.hypot(h1 + h2);
        // Powers add: 1/d1² + Γ²/d2², with the loss of free space at 1 m.
        let wave_m = 299_792_458.0 / 60e9;
        let first = (wave_m / (4.0 * std::f64::consts::PI)).powi(2);
        let factor = first * (1.0 / (direct * direct) + 10_f64.powf(-0.6) / (bounced * bounced));
        let power = channel.mean_power(Dbm(20.0), from, to).expect("no hard radius");
        assert!((power.0 - 20.0 - 10.0 * factor.log10()).abs() < 1e-9, "{power:?}");
        // The ray leaves downwards by the angle of the mirror image.
        let expected = Position::new(0.0, distance / bounced, -(h1 + h2) / bounced);
        assert!(found[1].departure.distance_m(expected) < 1e-12, "{found:?}");
        assert!((found[1].arrival.z_m - expected.z_m).abs() < 1e-12);
    }
    // Nothing is reflected below the ground.
    assert_eq!(rays(&channel, Position::new(0.0, 0.0, -1.0), Position::new(5.0, 0.0, 1.0)).len(), 1);
}

fn wall(x: f64, length: f64) -> String {
    format!("loss_db = 30\nshape.box = {{ center_m = [{x}, 5, 0], size_m = [{length}, 1, 4] }}")
}

#[test]
fn a_face_in_the_shadow_of_another_reflects_nothing() {
    let law = format!("{FREE}\nreflections = {{ loss_db = 6 }}");
    let (from, to) = (Position::new(-4.0, 0.0, 0.0), Position::new(4.0, 0.0, 0.0));
    let open = channel(&law, &[wall(0.0, 9.0)]);
    let found = rays(&open, from, to);
    assert_eq!(found.len(), 2);
    let length = 8_f64.hypot(9.0);
    assert!((found[1].loss.0 - 68.01 - 6.0 - 20.0 * length.log10()).abs() < 0.01, "{found:?}");
    let screen = "loss_db = 30\nshape.box = { center_m = [-2, 2.25, 0], size_m = [0.2, 1, 4] }".to_owned();
    assert_eq!(rays(&channel(&law, &[wall(0.0, 9.0), screen.clone()]), from, to).len(), 1);
    // A volume dims the ray instead.
    let crop = rays(&channel(&law, &[wall(0.0, 9.0), format!("solid = false\n{screen}")]), from, to);
    assert!((crop[1].loss - found[1].loss).0 - 30.0 < 1e-9 && crop.len() == 2);
    // The wall is too far to the side: the line to the mirror image misses it.
    assert_eq!(rays(&channel(&law, &[wall(9.0, 9.0)]), from, to).len(), 1);
    // An own loss of the obstacle comes first; without reflections there is one ray.
    let bright = channel(&law, &[format!("reflection_loss_db = 1\n{}", wall(0.0, 9.0))]);
    assert!((rays(&bright, from, to)[1].loss - found[1].loss).0 + 5.0 < 1e-9);
    assert_eq!(rays(&channel(FREE, &[wall(0.0, 9.0)]), from, to).len(), 1);
}

/// Whether the line from `a` to `b` passes through the triangle, by signed volumes.
fn passes(a: Position, b: Position, t: [Position; 3]) -> bool {
    let volume = |p: Position, q: Position, r: Position, s: Position| (q - p).cross(r - p).dot(s - p);
    let ends = (volume(t[0], t[1], t[2], a), volume(t[0], t[1], t[2], b));
    let turns = [volume(a, b, t[0], t[1]), volume(a, b, t[1], t[2]), volume(a, b, t[2], t[0])];
    ends.0 * ends.1 < 0.0 && (turns.iter().all(|&v| v > 0.0) || turns.iter().all(|&v| v < 0.0))
}

proptest! {
    #[test]
    fn reflections_are_those_of_mirror_images_and_equal_in_both_directions(
        boxes in prop::collection::vec(
            (prop::array::uniform3(-8.0..8.0_f64), prop::array::uniform3(0.5..6.0_f64), -90.0..90.0_f64), 1..5),
        a in prop::array::uniform3(-9.0..9.0_f64), b in prop::array::uniform3(-9.0..9.0_f64),
    ) {
        let texts: Vec<_> = boxes.iter().map(|(center, size, yaw)| {
            format!("loss_db = 30\nshape.box = {{ center_m = {center:?}, size_m = {size:?}, yaw_deg = {yaw} }}")
        }).collect();
        let channel = channel(&format!("{FREE}\nreflections = {{ loss_db = 6, most = 255 }}"), &texts);
        let (a, b) = (Position::from(a), Position::from(b));
        let field = channel.obstacles();
        prop_assume!(field.containing(a).is_none() && field.containing(b).is_none() && a.distance_m(b) > 0.1);
        let found = rays(&channel, a, b);
        let back: Vec<Ray> = rays(&channel, b, a).into_iter().map(Ray::reversed).collect();
        prop_assert_eq!(&found, &back);
        let mut expected = Vec::new();
        for obstacle in field.obstacles() {
            let (vertices, triangles) = obstacle.mesh();
            for triangle in triangles {
                let corners = triangle.map(|i| vertices[i as usize]);
                let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
                let normal = normal * (1.0 / normal.length_m());
                let (ha, hb) = (normal.dot(a - corners[0]), normal.dot(b - corners[0]));
                let image = a - normal * (2.0 * ha);
                if ha <= 0.0 || hb <= 0.0 || !passes(image, b, corners) {
                    continue;
                }
                let place = image + (b - image) * (ha / (ha + hb));
                let outside = place + normal * 1e-7;
                if field.blocking(a, outside).is_none() && field.blocking(outside, b).is_none() {
                    expected.push(channel.law().path_loss().loss(image.distance_m(b)).0 + 6.0);
                }
            }
        }
        expected.sort_by(f64::total_cmp);
        let losses: Vec<f64> = found[1..].iter().map(|ray| ray.loss.0).collect();
        prop_assert_eq!(losses.len(), expected.len());
        prop_assert!(losses.iter().zip(&expected).all(|(x, y)| (x - y).abs() < 1e-9), "{:?} {:?}", losses, expected);
    }
}
