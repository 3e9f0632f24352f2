//! Maps of hop counts.

use sextant_channel::Position;
use sextant_mapper::{
    AxesConfig, CountConfig, ExtremeConfig, Frame, LandmarksConfig, MapError, Tpm, TpmConfig,
    topology_preservation_error,
};

use super::network::{Network, lattice};

fn tpm(config: TpmConfig) -> Tpm {
    Tpm::try_from(config).expect("good settings")
}

fn preservation(network: &Network, config: TpmConfig) -> f64 {
    let map = tpm(config).map(&network.knowledge()).expect("a map").aligned_to(&network.truth(), 4);
    topology_preservation_error(&network.places, &map.positions()).expect("lines of nodes")
}

#[test]
fn the_map_of_a_lattice_keeps_its_lines_in_order() {
    // The paper reports below 2 % with random nodes; farthest points lie on the boundary and do better.
    let network = Network::new(lattice([20, 20, 1], 0.1), 23, 1.6, 5.0, 0.0);
    let farthest = TpmConfig::default();
    let error = preservation(&network, farthest);
    assert!(error < 0.01, "{error}");
    let error = preservation(&network, TpmConfig { axes: AxesConfig::Landmarks, ..farthest });
    assert!(error < 0.015, "axes from the landmarks: {error}");
    for landmarks in [
        LandmarksConfig::Random(CountConfig { count: 20 }),
        LandmarksConfig::ExtremeNodeSearch(ExtremeConfig { hops: 3 }),
        LandmarksConfig::Anchors {},
    ] {
        let error = preservation(&network, TpmConfig { landmarks, ..farthest });
        assert!(error < 0.05, "{landmarks:?}: {error}");
    }
}

#[test]
fn a_lattice_in_space_keeps_its_lines_too() {
    let network = Network::new(lattice([7, 7, 7], 0.0), 15, 1.5, 4.0, 0.0);
    let error = preservation(&network, TpmConfig::default());
    assert!(error < 0.04, "{error}");
}

#[test]
fn nodes_with_the_same_hops_share_a_place_and_are_counted() {
    // In a full mesh all nodes but the landmarks are one hop from everybody.
    let network = Network::new(lattice([5, 5, 1], 0.0), 25, 100.0, 5.0, 0.0);
    let config =
        TpmConfig { landmarks: LandmarksConfig::FarthestPoints(CountConfig { count: 6 }), ..TpmConfig::default() };
    let map = tpm(config).map(&network.knowledge()).unwrap();
    assert!(map.coincident() >= 19, "{}", map.coincident());
}

#[test]
fn each_part_of_a_network_that_falls_apart_has_its_own_map() {
    let mut places = lattice([8, 8, 1], 0.1);
    places.extend(lattice([8, 8, 1], 0.1).iter().map(|&p| p + Position::new(40.0, 5.0, 0.0)));
    // Two nodes alone are no map.
    places.extend([Position::new(90.0, 0.0, 0.0), Position::new(91.0, 0.0, 0.0)]);
    let network = Network::new(places, 10, 1.6, 5.0, 0.0);
    let map = tpm(TpmConfig::default()).map(&network.knowledge()).unwrap();
    let Frame::Relative(parts) = &map.frame else { panic!("a map of hops is relative") };
    assert_eq!((parts[0], parts[63], parts[64], parts[127], parts[128]), (0, 0, 1, 1, 2));
    assert_eq!((map.mapped(), map.unmapped()), (128, 2));
    let aligned = map.aligned_to(&network.truth(), 4);
    let error = topology_preservation_error(&network.places[..64], &aligned.positions()[..64]).unwrap();
    assert!(error < 0.02, "{error}");
    let far = aligned.positions()[100].unwrap();
    assert!(far.distance_m(network.places[100]) < 1.5, "{far}");
}

#[test]
fn the_same_knowledge_gives_the_same_bits_on_any_number_of_threads() {
    let network = Network::new(lattice([12, 12, 1], 0.2), 9, 1.8, 5.0, 0.0);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| tpm(TpmConfig::default()).map(&network.knowledge()).expect("a map"))
    };
    assert_eq!(on(1), on(4));
}

#[test]
fn without_neighbours_or_enough_anchors_there_is_no_map() {
    let network = Network::new(lattice([4, 4, 1], 0.0), 8, 1.5, 5.0, 0.0);
    let error = tpm(TpmConfig::default()).map(&network.robot_only()).unwrap_err();
    assert!(matches!(error, MapError::Missing { algorithm: "tpm", .. }) && error.to_string().contains("`discovery`"));
    let config = TpmConfig { landmarks: LandmarksConfig::Anchors {}, ..TpmConfig::default() };
    let error = tpm(config).map(&network.knowledge()).unwrap_err();
    assert_eq!(error, MapError::TooFewAnchors { algorithm: "tpm", found: 2, needed: 4 });
    assert!(error.to_string().contains("`anchors`"));
    for (config, key) in [
        (TpmConfig { link_share: 0.0, ..TpmConfig::default() }, "link_share"),
        (TpmConfig { dimensions: Some(4), ..TpmConfig::default() }, "dimensions"),
        (
            TpmConfig { landmarks: LandmarksConfig::Random(CountConfig { count: 3 }), ..TpmConfig::default() },
            "landmarks.random.count",
        ),
    ] {
        assert_eq!(Tpm::try_from(config).unwrap_err().key, key);
    }
}
