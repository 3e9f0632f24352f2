//! Volumes that are not solid, obstacles with a fixed loss, and obstacles at the carrier of each channel.

use sextant_channel::{
    Channel, ChannelConfig, ChannelLaw, Db, Dbm, Material, Obstacle, ObstacleConfig, ObstacleField, Position,
};
use sextant_kernel::Seed;

fn field(obstacles: &[&str]) -> ObstacleField {
    let read = |text: &&str| {
        let config: ObstacleConfig = toml::from_str(text).unwrap_or_else(|error| panic!("{error}"));
        Obstacle::try_from(config).unwrap_or_else(|error| panic!("{error}"))
    };
    ObstacleField::new(obstacles.iter().map(read).collect())
}

fn law(text: &str) -> ChannelLaw {
    toml::from_str::<ChannelConfig>(text).expect("a channel").try_into().expect("a good channel")
}

const CROP: &str = "material = \"foliage\"\nsolid = false\nshape.box = { center_m = [5, 0, 1], size_m = [4, 4, 2] }";
const RACK: &str = "loss_db = 20\nname = \"rack\"\nshape.box = { center_m = [20, 0, 1], size_m = [1, 4, 2] }";

fn at(x: f64) -> Position {
    Position::new(x, 0.0, 1.0)
}

#[test]
fn only_the_length_inside_a_volume_counts() {
    let field = field(&[CROP]).at_carrier(Some(73.0));
    let db_per_m = 0.45 * 73_f64.powf(0.284);
    for (from, to, inside_m) in
        [(0.0, 10.0, 4.0), (5.0, 10.0, 2.0), (4.0, 6.5, 2.5), (0.0, 3.5, 0.5), (8.0, 9.0, 0.0)]
    {
        let loss = field.loss(at(from), at(to));
        assert!((loss.0 - db_per_m * inside_m).abs() < 1e-9, "{from} {to}: {loss:?}");
        assert_eq!(loss, field.loss(at(to), at(from)));
    }
}

#[test]
fn nodes_stand_in_volumes_and_robots_drive_through_them() {
    let field = field(&[CROP, RACK]);
    assert_eq!((field.containing(at(5.0)), field.fault(at(5.0))), (None, None));
    assert_eq!(field.containing(at(20.0)), Some(1));
    assert!(field.fault(at(20.0)).expect("a fault").0.contains("obstacle `rack`"));
    let clear_m = field.clearance_m(at(0.0), Position::new(1.0, 0.0, 0.0), 100.0, 0.5);
    assert!((clear_m - 19.0).abs() < 1e-6, "{clear_m}");
    assert!((field.clearance_m(at(5.0), Position::new(1.0, 0.0, 0.0), 100.0, 0.5) - 14.0).abs() < 1e-6);
    assert!((field.distance_m(at(5.0)) - 14.5).abs() < 1e-9);
    assert_eq!((field.blocking(at(0.0), at(10.0)), field.blocking(at(0.0), at(30.0))), (None, Some(1)));
    let mut crossings = Vec::new();
    field.crossings(at(0.0), at(30.0), &mut crossings);
    assert_eq!(crossings.len(), 2);
    // A world of volumes alone stops nothing.
    let crop = self::field(&[CROP]);
    assert!((crop.clearance_m(at(0.0), Position::new(1.0, 0.0, 0.0), 9.0, 0.5) - 9.0).abs() < 1e-12);
    assert!(crop.distance_m(at(5.0)).is_infinite());
}

#[test]
fn a_fixed_loss_does_not_depend_on_the_length_inside() {
    let field = field(&[
        RACK,
        "loss_db = 3\nabsorption_per_m = 2\nshape.box = { center_m = [20, 9, 1], size_m = [1, 4, 2] }",
        "loss_db = inf\nshape.box = { center_m = [40, 0, 1], size_m = [1, 4, 2] }",
    ]);
    assert_eq!(field.loss(at(0.0), at(30.0)), Db(20.0));
    assert_eq!(field.loss(Position::new(20.0, -5.0, 1.0), Position::new(20.0, 6.0, 1.0)), Db(20.0));
    assert_eq!(field.loss(at(0.0), at(10.0)), Db(0.0));
    let both = field.loss(Position::new(0.0, 9.0, 1.0), Position::new(30.0, 9.0, 1.0));
    assert!((both.0 - 3.0 - 20.0 * std::f64::consts::LOG10_E).abs() < 1e-9, "{both:?}");
    let law = law("environment = \"mmtm-warehouse\"");
    let channel = Channel::new(law, field, Seed(1));
    assert_eq!(channel.mean_power(Dbm(20.0), at(0.0), at(50.0)), Some(Dbm::SILENCE));
    assert!(channel.law().reception_probability(Dbm(20.0), Dbm(-60.0), 50.0, Db(f64::INFINITY)) <= 0.0);
}

#[test]
fn each_channel_sees_the_obstacles_at_its_own_carrier() {
    let wall = "material = \"glass\"\nshape.box = { center_m = [5, 0, 0], size_m = [0.01, 9, 9] }";
    let own = "absorption_per_m = 100\nshape.box = { center_m = [15, 0, 0], size_m = [0.01, 9, 9] }";
    let field = field(&[wall, own]);
    let loss = |text: &str, from, to| Channel::new(law(text), field.clone(), Seed(1)).obstacle_loss(at(from), at(to));
    let glass = Material::named("glass").expect("glass");
    let expected = |alpha: f64| 10.0 * std::f64::consts::LOG10_E * alpha * 0.01;
    for (text, carrier_ghz) in [
        ("environment = \"suburban\"", None),
        ("path_loss.close_in = { carrier_ghz = 2.45, exponent = 2 }", Some(2.45)),
        ("environment = \"office-28-los\"", Some(28.0)),
        ("environment = \"mmtm-warehouse\"", Some(73.0)),
    ] {
        let alpha = glass.absorption_at_per_m(carrier_ghz);
        assert!((loss(text, 0.0, 10.0).0 - expected(alpha)).abs() < 1e-9, "{text}");
        assert!((loss(text, 10.0, 20.0).0 - expected(100.0)).abs() < 1e-9, "{text}");
    }
    // A law without a carrier has that of its radios.
    let of_radios = Channel::new(law("environment = \"suburban\"").for_radios_at(28.0), field.clone(), Seed(1));
    let alpha = glass.absorption_at_per_m(Some(28.0));
    assert!((of_radios.obstacle_loss(at(0.0), at(10.0)).0 - expected(alpha)).abs() < 1e-9);
    let key = |obstacle: usize| format!("obstacles[{obstacle}]");
    assert_eq!(field.check_carrier(73.0, key), Ok(()));
    let brick =
        self::field(&[wall, "material = \"brick\"\nshape.box = { center_m = [9, 0, 0], size_m = [1, 9, 9] }"]);
    let error = brick.check_carrier(73.0, key).expect_err("brick is not known at 73 GHz");
    assert_eq!(error.key, "obstacles[1].material");
}
