use std::collections::BTreeMap;
use std::path::Path;

use sextant_channel::{
    BoxConfig, Obstacle, ObstacleConfig, ObstacleField, Position, ShapeConfig, StoreyConfig, Storeys,
};
use sextant_kernel::{Files, Seed, SettingError};

use super::*;

/// A box of 4 by 6 m around the origin, called `shed`.
fn shed() -> ObstacleField {
    let shape = BoxConfig::new(Position::ORIGIN, [4.0, 6.0, 3.0]);
    let shape = ShapeConfig::Box(shape);
    let config = ObstacleConfig { name: Some("shed".into()), ..ObstacleConfig::absorbing(shape, 1.0) };
    ObstacleField::new(vec![Obstacle::try_from(config).unwrap()])
}

fn place(nodes: &NodesConfig, obstacles: &ObstacleField, seed: u64) -> Result<Vec<PlacedNode>, SettingError> {
    nodes.place(obstacles, Seed(seed), &Files::default())
}

fn positions(nodes: &NodesConfig, seed: u64) -> Vec<Position> {
    place(nodes, &shed(), seed).unwrap().into_iter().map(|node| node.position).collect()
}

fn disc(radius_m: f64) -> RegionConfig {
    RegionConfig::Disc { center_m: Position::ORIGIN, radius_m }
}

fn lattice(count: Option<usize>) -> LatticeConfig {
    LatticeConfig {
        spacing_m: 1.0,
        jitter_m: 0.2,
        count,
        origin_m: None,
        clearance_m: 0.1,
        storey: None,
        region: disc(8.0),
    }
}

fn random(count: usize) -> RandomConfig {
    RandomConfig { count, min_distance_m: 0.5, clearance_m: 0.3, storey: None, region: disc(8.0) }
}

#[test]
fn the_requested_number_of_nodes_is_inside_the_region_and_clear_of_obstacles() {
    let region = Region::try_from(&disc(8.0)).unwrap();
    for seed in 0..20 {
        for (nodes, clearance_m) in
            [(NodesConfig::Lattice(lattice(Some(150))), 0.1), (NodesConfig::Random(random(150)), 0.3)]
        {
            let positions = positions(&nodes, seed);
            assert_eq!(positions.len(), 150);
            for p in positions {
                assert!(region.contains(p), "{p:?}");
                // Distance to the box by its formula.
                let outside_m = (p.x_m.abs() - 2.0).max(0.0).hypot((p.y_m.abs() - 3.0).max(0.0));
                assert!(outside_m >= clearance_m, "{p:?}");
            }
        }
    }
}

#[test]
fn nodes_of_a_lattice_are_within_the_jitter_of_their_sites() {
    let config = LatticeConfig { origin_m: Some(Position::new(0.25, 0.0, 0.0)), ..lattice(None) };
    let mut farthest_m: f64 = 0.0;
    for p in positions(&NodesConfig::Lattice(config), 1) {
        let (x, y) = (p.x_m - 0.25, p.y_m);
        farthest_m = farthest_m.max((x - x.round()).abs()).max((y - y.round()).abs());
    }
    // 300 draws: all below 0.19 of 0.2 once in five million seeds.
    assert!(farthest_m <= 0.2 && farthest_m > 0.19, "{farthest_m}");
}

#[test]
fn a_lattice_fills_a_rectangle_with_its_cells() {
    let region = RegionConfig::Rectangle { min_m: Position::ORIGIN, max_m: Position::new(30.0, 30.0, 0.0) };
    let config = LatticeConfig { jitter_m: 0.2, count: None, region, ..lattice(None) };
    assert_eq!(place(&NodesConfig::Lattice(config), &ObstacleField::default(), 1).unwrap().len(), 900);
    let region = RegionConfig::Box { min_m: Position::ORIGIN, max_m: Position::new(3.0, 4.0, 5.0) };
    let config = LatticeConfig { jitter_m: 0.0, region, ..lattice(None) };
    let nodes = place(&NodesConfig::Lattice(config), &ObstacleField::default(), 1).unwrap();
    assert_eq!(nodes.len(), 60);
    assert_eq!(nodes[0], PlacedNode { name: "n0".into(), position: Position::new(0.5, 0.5, 0.5) });
    assert_eq!(nodes[59], PlacedNode { name: "n59".into(), position: Position::new(2.5, 3.5, 4.5) });
}

#[test]
fn more_nodes_do_not_move_the_others() {
    let few = positions(&NodesConfig::Lattice(lattice(Some(80))), 3);
    let many = positions(&NodesConfig::Lattice(lattice(Some(130))), 3);
    assert_eq!(many[..80], few);
    let few = positions(&NodesConfig::Random(random(80)), 3);
    let many = positions(&NodesConfig::Random(random(130)), 3);
    assert_eq!(many[..80], few);
    // A larger region adds sites and moves none.
    let origin_m = Some(Position::ORIGIN);
    let small = positions(&NodesConfig::Lattice(LatticeConfig { origin_m, ..lattice(None) }), 3);
    let great = positions(&NodesConfig::Lattice(LatticeConfig { origin_m, region: disc(9.0), ..lattice(None) }), 3);
    assert!(great.len() > small.len());
    assert!(small.iter().all(|p| great.contains(p)));
}

#[test]
fn a_seed_gives_one_layout() {
    for nodes in [NodesConfig::Lattice(lattice(Some(100))), NodesConfig::Random(random(100))] {
        assert_eq!(positions(&nodes, 7), positions(&nodes, 7));
        assert_ne!(positions(&nodes, 7), positions(&nodes, 8));
    }
}

#[test]
fn random_nodes_keep_their_distance_and_spread_evenly() {
    let positions = positions(&NodesConfig::Random(RandomConfig { min_distance_m: 0.3, ..random(400) }), 5);
    for (i, p) in positions.iter().enumerate() {
        assert!(positions[..i].iter().all(|q| p.distance_m(*q) >= 0.3));
    }
    // East and west have equal chances: binomial, five standard deviations are 50 of 400.
    let east = positions.iter().filter(|p| p.x_m > 0.0).count();
    assert!(east.abs_diff(200) < 50, "{east} in the east");
}

#[test]
fn too_many_nodes_are_rejected_with_the_number_that_fits_and_a_spacing_that_works() {
    let error = place(&NodesConfig::Lattice(lattice(Some(400))), &shed(), 1).unwrap_err();
    assert_eq!((error.key.as_str(), error.found()), ("lattice.count", "400"));
    let spacing = error.allowed().rsplit(' ').next().unwrap();
    let config = LatticeConfig { spacing_m: spacing.parse().unwrap(), ..lattice(Some(400)) };
    assert_eq!(place(&NodesConfig::Lattice(config), &shed(), 1).unwrap().len(), 400, "{error}");
    let error =
        place(&NodesConfig::Random(RandomConfig { min_distance_m: 3.0, ..random(400) }), &shed(), 1).unwrap_err();
    assert_eq!(error.key, "random.count");
}

#[test]
fn invalid_settings_are_rejected_with_their_key() {
    let key = |nodes: NodesConfig| place(&nodes, &shed(), 1).unwrap_err().key;
    let on_lattice = |config| key(NodesConfig::Lattice(config));
    assert_eq!(on_lattice(lattice(Some(0))), "lattice.count");
    assert_eq!(on_lattice(LatticeConfig { spacing_m: -1.0, ..lattice(None) }), "lattice.spacing_m");
    assert_eq!(on_lattice(LatticeConfig { spacing_m: 1e-5, jitter_m: 0.0, ..lattice(None) }), "lattice.spacing_m");
    assert_eq!(on_lattice(LatticeConfig { jitter_m: f64::NAN, ..lattice(None) }), "lattice.jitter_m");
    assert_eq!(on_lattice(LatticeConfig { clearance_m: -0.1, ..lattice(None) }), "lattice.clearance_m");
    assert_eq!(on_lattice(LatticeConfig { region: disc(0.0), ..lattice(None) }), "lattice.region.disc.radius_m");
    assert_eq!(on_lattice(LatticeConfig { region: disc(1.0), ..lattice(None) }), "lattice.spacing_m");
    let at_random = |config| key(NodesConfig::Random(config));
    assert_eq!(at_random(random(0)), "random.count");
    assert_eq!(at_random(RandomConfig { min_distance_m: f64::INFINITY, ..random(1) }), "random.min_distance_m");
}

#[test]
fn listed_nodes_are_rejected_in_obstacles_and_without_distinct_names() {
    let explicit = |positions_m: Vec<Position>, names: Option<Vec<&str>>| {
        let names = names.map(|names| names.into_iter().map(Into::into).collect());
        place(&NodesConfig::Explicit(ExplicitConfig { positions_m, names, storeys: BTreeMap::new() }), &shed(), 1)
    };
    let (a, b) = (Position::new(5.0, 0.0, 0.0), Position::new(5.0, 1.0, 0.0));
    let names = |nodes: Vec<PlacedNode>| nodes.into_iter().map(|node| node.name).collect::<Vec<_>>();
    assert_eq!(names(explicit(vec![a, b], None).unwrap()), ["n0", "n1"]);
    assert_eq!(names(explicit(vec![a, b], Some(vec!["x", "y"])).unwrap()), ["x", "y"]);
    assert_eq!(explicit(vec![], None).unwrap_err().key, "explicit.positions_m");
    assert_eq!(explicit(vec![a], Some(vec!["x", "y"])).unwrap_err().key, "explicit.names");
    assert_eq!(explicit(vec![a, b], Some(vec!["x", " "])).unwrap_err().key, "explicit.names[1]");
    assert_eq!(explicit(vec![a, b], Some(vec!["x", "x"])).unwrap_err().key, "explicit.names[1]");
    let nan = explicit(vec![a, Position::new(0.0, f64::NAN, 0.0)], None).unwrap_err();
    assert_eq!((nan.key.as_str(), nan.found()), ("explicit.positions_m[1]", "[0, NaN, 0]"));
    let inside = explicit(vec![a, Position::new(1.0, -1.0, 0.0)], None).unwrap_err();
    assert_eq!(inside.found(), "[1, -1, 0], inside obstacle `shed`");
}

#[test]
fn a_table_in_a_file_is_found_from_the_folder_of_the_scenario() {
    let missing = NodesConfig::Csv(CsvConfig { file: "no-such-table.csv".into() });
    let error = missing.place(&shed(), Seed(1), &Files::of_folder(Path::new("/no/such/folder"))).unwrap_err();
    assert_eq!(error.key, "csv.file");
    assert!(error.found().contains("/no/such/folder/no-such-table.csv"), "{error}");
}

#[test]
fn nodes_in_a_storey_have_their_heights_above_its_floor() {
    let storey = |name: &str, floor_m| StoreyConfig { name: name.into(), height_m: 2.5, floor_m, slab: None };
    let storeys = Storeys::new(&[storey("ground", None), storey("upper", Some(3.0))]).unwrap();
    let heights = |nodes: &NodesConfig| -> Vec<f64> {
        let nodes = nodes.above_zero(&storeys).unwrap();
        place(&nodes, &ObstacleField::default(), 1).unwrap().iter().map(|node| node.position.z_m).collect()
    };
    let positions_m = vec![Position::new(1.0, 1.0, 1.5), Position::new(2.0, 1.0, 0.5)];
    let upper =
        |names: &[&str]| BTreeMap::from([("upper".to_owned(), names.iter().map(|&name| name.into()).collect())]);
    let explicit =
        |storeys| NodesConfig::Explicit(ExplicitConfig { positions_m: positions_m.clone(), names: None, storeys });
    assert_eq!(heights(&explicit(upper(&["n1"]))), [1.5, 3.5]);
    let upstairs = Some("upper".to_owned());
    let on_lattice = NodesConfig::Lattice(LatticeConfig { storey: upstairs.clone(), ..lattice(Some(4)) });
    assert_eq!(heights(&on_lattice), [3.0; 4]);
    assert_eq!(heights(&NodesConfig::Random(RandomConfig { storey: upstairs, ..random(3) })), [3.0; 3]);
    let refused = |nodes: NodesConfig| nodes.above_zero(&storeys).unwrap_err().to_string();
    let found = refused(explicit(BTreeMap::from([("attic".to_owned(), vec!["n0".to_owned()])])));
    assert!(found.contains("`explicit.storeys` is `attic`") && found.contains("`ground`, `upper`"), "{found}");
    let found = refused(explicit(upper(&["n2"])));
    assert!(found.contains("`explicit.storeys.upper[0]` is `n2`"), "{found}");
    let twice = BTreeMap::from(["ground", "upper"].map(|storey| (storey.to_owned(), vec!["n0".to_owned()])));
    let found = refused(explicit(twice));
    assert!(found.contains("`n0`, which is in `ground`"), "{found}");
    let found = refused(NodesConfig::Random(RandomConfig { storey: Some("attic".to_owned()), ..random(3) }));
    assert!(found.contains("`random.storey` is `attic`"), "{found}");
}
