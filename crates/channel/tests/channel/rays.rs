//! Rays against closed forms: the two-ray model with complex fields, images between walls, a knife edge.

use std::f64::consts::{PI, TAU};

use proptest::prelude::*;
use sextant_channel::{Channel, Position, Ray, angles_rad};

use crate::reflections::{channel, rays};

const LIGHT_M_PER_S: f64 = 299_792_458.0;
const CARRIER_GHZ: f64 = 28.0;
const FREE: &str = "path_loss.close_in = { carrier_ghz = 28, exponent = 2, min_distance_m = 0.001 }";

/// Thickness of panes of glass (m), and the loss of a reflection (dB).
const PANES: [(f64, f64); 4] = [(0.002, 10.2183), (0.004, 5.9269), (0.006, 4.2456), (0.05, 6.5877)];

/// A complex number as a pair.
type C = (f64, f64);

fn mul(a: C, b: C) -> C {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

fn div(a: C, b: C) -> C {
    let (re, im) = mul(a, (b.0, -b.1));
    let square = b.0 * b.0 + b.1 * b.1;
    (re / square, im / square)
}

/// The root in polar form.
fn root(z: C) -> C {
    let (size, angle) = (z.0.hypot(z.1).sqrt(), z.1.atan2(z.0) / 2.0);
    (size * angle.cos(), size * angle.sin())
}

/// `λ / (4π d) e^(-j 2π d / λ)`.
fn wave(length_m: f64) -> C {
    let wavelength_m = LIGHT_M_PER_S / (CARRIER_GHZ * 1e9);
    let (size, angle) = (wavelength_m / (4.0 * PI * length_m), -TAU * length_m / wavelength_m);
    (size * angle.cos(), size * angle.sin())
}

fn gain_db((re, im): C) -> f64 {
    10.0 * (re * re + im * im).log10()
}

fn near(found_db: f64, expected_db: f64) -> bool {
    (found_db - expected_db).abs() < 1e-4
}

#[test]
fn the_fields_of_two_rays_over_concrete_sum_to_the_exact_two_ray_model() {
    for polarisation in ["vertical", "horizontal"] {
        let ground = format!("ground_z_m = 0, ground_material = \"itu-concrete\", polarisation = \"{polarisation}\"");
        let channel = channel(&format!("{FREE}\nreflections = {{ {ground} }}"), &[]);
        for (across, h1, h2) in [(10.0_f64, 2.0, 1.0), (50.0, 1.5, 1.5), (3.0, 0.2, 4.0), (200.0, 3.0, 1.7)] {
            let (from, to) = (Position::new(0.0, 0.0, h1), Position::new(0.0, across, h2));
            let found = rays(&channel, from, to);
            assert_eq!(found.len(), 2);
            let (direct, bounced) = (across.hypot(h1 - h2), across.hypot(h1 + h2));
            // η = a f^b - j 17.98 c f^d / f of concrete; cos θ of the angle with the vertical.
            let eta = (5.24, -17.98 * 0.0462 * CARRIER_GHZ.powf(0.7822) / CARRIER_GHZ);
            let cos = (h1 + h2) / bounced;
            let inner = root((eta.0 - (1.0 - cos * cos), eta.1));
            let front = if polarisation == "vertical" { (eta.0 * cos, eta.1 * cos) } else { (cos, 0.0) };
            let reflected = div((front.0 - inner.0, front.1 - inner.1), (front.0 + inner.0, front.1 + inner.1));
            let (one, other) = (wave(direct), mul(reflected, wave(bounced)));
            assert!(near(-found[1].loss.0, gain_db(other)), "{polarisation} {found:?}");
            let sum = Ray::field_sum(&found).0;
            assert!(near(sum, gain_db((one.0 + other.0, one.1 + other.1))), "{polarisation} {across}: {sum}");
            // Where it comes from, and when.
            let [azimuth, elevation] = angles_rad(found[1].arrival);
            assert!((azimuth + PI / 2.0).abs() < 1e-12 && (elevation + (h1 + h2).atan2(across)).abs() < 1e-12);
            assert!((found[1].delay_s() * LIGHT_M_PER_S - bounced).abs() < 1e-9);
            assert_eq!((found[0].bounces, found[1].bounces), (0, 1));
        }
    }
}

/// Walls of metal at `y = 0` and `y = width`, so long that they have no ends.
fn corridor(width: f64, law: &str) -> Channel {
    let wall =
        |y: f64| format!("material = \"metal\"\nshape.box = {{ center_m = [0, {y}, 0], size_m = [4000, 1, 4000] }}");
    channel(&format!("{FREE}\nreflections = {{ most = 255, {law} }}"), &[wall(-0.5), wall(width + 0.5)])
}

#[test]
fn rays_between_two_walls_are_the_images_of_a_parallel_plate_guide() {
    let (width, across) = (3.0, 20.0);
    let (from, to) = (Position::new(0.0, 0.8, 0.0), Position::new(across, 2.1, 0.5));
    // Images of the sender: 2 n w ± y. Those with up to two reflections, and how often each is reflected.
    let images = [(0.8, 0), (-0.8, 1), (2.0 * width - 0.8, 1), (2.0 * width + 0.8, 2), (-2.0 * width + 0.8, 2)];
    let length_m = |y: f64| Position::new(0.0, y, 0.0).distance_m(to);
    for order in 0..=2_u8 {
        // A loss of zero is a mirror: the field turns its sign at each reflection.
        let channel = corridor(width, &format!("order = {order}, loss_db = 0"));
        let found = rays(&channel, from, to);
        let expected: Vec<(f64, u8)> = images.into_iter().filter(|&(_, bounces)| bounces <= order).collect();
        assert_eq!(found.len(), expected.len(), "{found:?}");
        let (mut re, mut im) = (0.0, 0.0);
        for &(y, bounces) in &expected {
            let ray =
                found.iter().find(|ray| (ray.length_m - length_m(y)).abs() < 1e-9).expect("the ray of an image");
            assert_eq!(ray.bounces, bounces);
            let (sent, received) = (ray.departure, ray.arrival);
            assert!((received.y_m - (y - to.y_m) / length_m(y)).abs() < 1e-9, "{y}: {received}");
            assert!((sent.y_m.abs() - received.y_m.abs()).abs() < 1e-9 && (sent.x_m + received.x_m).abs() < 1e-9);
            let sign = if bounces == 1 { -1.0 } else { 1.0 };
            (re, im) = (re + sign * wave(length_m(y)).0, im + sign * wave(length_m(y)).1);
        }
        assert!(near(Ray::field_sum(&found).0, gain_db((re, im))), "{order}: {}", Ray::field_sum(&found).0);
    }
    // With their own permittivity, walls of metal reflect a vertical field almost the same.
    let (ideal, metal) = (corridor(width, "order = 2, loss_db = 0"), corridor(width, "order = 2"));
    let level = Position::new(across, 2.1, 0.0);
    let (ideal, metal) = (rays(&ideal, from, level), rays(&metal, from, level));
    assert_eq!(ideal.len(), metal.len());
    assert!((Ray::field_sum(&ideal).0 - Ray::field_sum(&metal).0).abs() < 0.05);
}

#[test]
fn a_thin_pane_reflects_by_its_thickness_and_a_wall_hides_what_is_behind() {
    let law = format!("{FREE}\nreflections = {{}}");
    let pane = |thick: f64| {
        format!(
            "material = \"glass\"\nshape.box = {{ center_m = [0, {}, 0], size_m = [9, {thick}, 4] }}",
            3.0 + thick / 2.0
        )
    };
    let (from, to) = (Position::new(-2.0, 0.0, 0.0), Position::new(2.0, 0.0, 0.0));
    // By the formula of a slab, computed with complex numbers elsewhere: TE at 33.69 degrees, 28 GHz.
    for (thick, loss_db) in PANES {
        let found = rays(&channel(&law, &[pane(thick)]), from, to);
        let free_db = 20.0 * (4.0 * PI * 52_f64.sqrt() * CARRIER_GHZ * 1e9 / LIGHT_M_PER_S).log10();
        assert!((found[1].loss.0 - free_db - loss_db).abs() < 0.01, "{thick}: {}", found[1].loss.0 - free_db);
    }
    // Obstacles of unknown permittivity do not reflect.
    let unknown = "loss_db = 3\nshape.box = { center_m = [0, 3.5, 0], size_m = [9, 1, 4] }".to_owned();
    assert_eq!(rays(&channel(&law, &[unknown]), from, to).len(), 1);
}

#[test]
fn behind_a_screen_the_signal_bends_round_both_edges() {
    let screen = "material = \"metal\"\nshape.box = { center_m = [0, 0, 0], size_m = [0.01, 2, 40] }".to_owned();
    let law = format!("{FREE}\nreflections = {{ order = 0, edges = true }}");
    let channel = channel(&law, &[screen]);
    let (from, to) = (Position::new(-5.0, 0.2, 1.0), Position::new(3.0, 0.2, 1.0));
    let found = rays(&channel, from, to);
    assert_eq!(found.len(), 3, "{found:?}");
    let wavelength_m = LIGHT_M_PER_S / (CARRIER_GHZ * 1e9);
    for (ray, aside_m) in found[1..].iter().zip([0.8, 1.2]) {
        // The edges are 5 mm before and behind the middle of the screen.
        let nu = aside_m * (2.0 / wavelength_m * (1.0 / 5.0 + 1.0 / 3.0)).sqrt();
        let loss_db = 6.9 + 20.0 * ((((nu - 0.1) * (nu - 0.1)) + 1.0).sqrt() + nu - 0.1).log10();
        let free_db = 20.0 * (4.0 * PI * 8.0 / wavelength_m).log10();
        assert!((ray.loss.0 - free_db - loss_db).abs() < 0.05 && ray.is_diffracted, "{ray:?} {loss_db}");
        assert!((ray.length_m - 5_f64.hypot(aside_m) - 3_f64.hypot(aside_m)).abs() < 0.01);
    }
    // In sight of each other there is the straight way alone.
    assert_eq!(rays(&channel, from, Position::new(-5.0, 6.0, 1.0)).len(), 1);
}

proptest! {
    #[test]
    fn rays_have_the_same_fields_in_both_directions(
        boxes in prop::collection::vec(
            (prop::array::uniform3(-8.0..8.0_f64), prop::array::uniform3(0.5..6.0_f64), -90.0..90.0_f64), 1..4),
        a in prop::array::uniform3(-9.0..9.0_f64), b in prop::array::uniform3(-9.0..9.0_f64),
    ) {
        let texts: Vec<_> = boxes.iter().map(|(center, size, yaw)| {
            format!("material = \"brick\"\nshape.box = {{ center_m = {center:?}, size_m = {size:?}, yaw_deg = {yaw} }}")
        }).collect();
        let channel = channel(&format!("{FREE}\nreflections = {{ order = 2, edges = true, most = 255 }}"), &texts);
        let (a, b) = (Position::from(a), Position::from(b));
        let field = channel.obstacles();
        prop_assume!(field.containing(a).is_none() && field.containing(b).is_none() && a.distance_m(b) > 0.1);
        let found = rays(&channel, a, b);
        let back: Vec<Ray> = rays(&channel, b, a).into_iter().map(Ray::reversed).collect();
        prop_assert_eq!(&found, &back);
        for ray in &found {
            prop_assert!(ray.loss.0 >= channel.law().path_loss().loss(ray.length_m).0 - 1e-9 || ray.is_diffracted);
            prop_assert!(ray.length_m >= a.distance_m(b) - 1e-9 && ray.phase_rad.abs() <= PI + 1e-9);
            prop_assert!((ray.departure.length_m() - 1.0).abs() < 1e-9 && (ray.arrival.length_m() - 1.0).abs() < 1e-9);
        }
        // One reflection a ray finds the same as the rays with one of two.
        let texts: Vec<_> = texts.iter().map(String::as_str).map(str::to_owned).collect();
        let once = self::channel(&format!("{FREE}\nreflections = {{ most = 255 }}"), &texts);
        let count = |rays: &[Ray]| rays.iter().filter(|ray| ray.bounces == 1).count();
        prop_assert_eq!(count(&rays(&once, a, b)), count(&found));
    }
}
