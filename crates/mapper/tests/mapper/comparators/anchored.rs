//! Maps from the anchors that nodes heard.

use sextant_channel::Position;
use sextant_kernel::Unwatched;
use sextant_mapper::{
    Apit, ApitConfig, Centroid, Comparator, MapError, RangingConfig, TriangleCentroid, TriangleCentroidConfig,
    TriangleWeights, WeightedCentroid, WeightedCentroidConfig,
};

use super::network::{Network, RANGING, lattice, mean_error_m};

fn triangles(config: TriangleCentroidConfig) -> TriangleCentroid {
    TriangleCentroid::try_from(config).expect("good settings")
}

#[test]
fn exact_strengths_give_exact_places_in_the_plane_and_in_space() {
    for (counts, every) in [([9, 9, 1], 5), ([5, 5, 5], 6)] {
        let network = Network::new(lattice(counts, 0.2), every, 2.0, 6.0, 0.0);
        for weights in [TriangleWeights::Equal, TriangleWeights::InverseDistance] {
            let config = TriangleCentroidConfig { ranging: RANGING, weights, ..TriangleCentroidConfig::default() };
            let map = triangles(config).map(&network.knowledge(), &Unwatched).unwrap();
            let error_m = mean_error_m(&network, &map);
            assert!(error_m < 1e-6, "{counts:?}: {error_m}");
        }
    }
}

#[test]
fn shadowing_spoils_triangles_more_the_stronger_it_is() {
    let error_m = |sigma_db| {
        let network = Network::new(lattice([12, 12, 1], 0.2), 5, 2.0, 6.0, sigma_db);
        let config = TriangleCentroidConfig { ranging: RANGING, ..TriangleCentroidConfig::default() };
        mean_error_m(&network, &triangles(config).map(&network.knowledge(), &Unwatched).unwrap())
    };
    let errors = [0.0, 1.0, 4.0, 9.6].map(error_m);
    assert!(errors.windows(2).all(|pair| pair[0] < pair[1]), "{errors:?}");
}

#[test]
fn a_node_with_few_anchors_falls_back_and_one_without_is_not_placed() {
    // Anchors at 0, 3 and 100 m, nodes between the first two and far from all.
    let places = [0.0, 1.0, 3.0, 50.0, 100.0].map(|x| Position::new(x, 0.0, 0.0));
    let mut places = places.to_vec();
    places.swap(1, 3);
    let order = [0, 2, 4];
    let mut network = Network::new(places.clone(), 2, 2.0, 5.0, 0.0);
    network.anchors.retain(|anchor| order.contains(&anchor.node.index()));
    let config = TriangleCentroidConfig { ranging: RANGING, ..TriangleCentroidConfig::default() };
    let map = triangles(config).map(&network.knowledge(), &Unwatched).unwrap();
    assert_eq!(map.positions()[1], None, "nobody is within 5 m of 50 m");
    // Node 3 stands at 1 m, one from the anchor at 0 and two from that at 3: weights 1 and 1/2.
    let found = map.positions()[3].unwrap();
    assert!(found.distance_m(Position::new(1.0, 0.0, 0.0)) < 1e-9, "{found}");
    let centroid = Centroid.map(&network.knowledge(), &Unwatched).unwrap().positions();
    assert!(centroid[3].unwrap().distance_m(Position::new(1.5, 0.0, 0.0)) < 1e-12);
    let config = WeightedCentroidConfig { ranging: RANGING, degree: 2.0 };
    let weighted =
        WeightedCentroid::try_from(config).unwrap().map(&network.knowledge(), &Unwatched).unwrap().positions();
    // Weights 1 and 1/4.
    assert!(weighted[3].unwrap().distance_m(Position::new(0.6, 0.0, 0.0)) < 1e-9);
    assert_eq!((centroid[1], weighted[1]), (None, None));
    assert_eq!(centroid[4], Some(network.places[4]), "an anchor is where it is");
}

#[test]
fn anchors_and_a_law_are_needed() {
    let network = Network::new(lattice([4, 4, 1], 0.0), 8, 1.5, 5.0, 0.0);
    let config = TriangleCentroidConfig { ranging: RANGING, ..TriangleCentroidConfig::default() };
    let error = triangles(config).map(&network.knowledge(), &Unwatched).unwrap_err();
    assert_eq!(error, MapError::TooFewAnchors { algorithm: "rssi-triangle-centroid", found: 2, needed: 3 });
    let error = Centroid.map(&network.robot_only(), &Unwatched).unwrap_err();
    assert!(matches!(error, MapError::TooFewAnchors { algorithm: "centroid", found: 0, needed: 1 }));
    let unknown = TriangleCentroidConfig { ranging: RangingConfig::default(), ..config };
    assert_eq!(TriangleCentroid::try_from(unknown).unwrap_err().key, "ranging.exponent");
    let many = TriangleCentroidConfig { strongest: 21, ..config };
    assert_eq!(TriangleCentroid::try_from(many).unwrap_err().key, "strongest");
    let flat = WeightedCentroidConfig { ranging: RANGING, degree: 0.0 };
    assert_eq!(WeightedCentroid::try_from(flat).unwrap_err().key, "degree");
}

#[test]
fn triangles_judged_without_noise_beat_the_centroid() {
    let network = Network::new(lattice([12, 12, 1], 0.2), 5, 2.0, 6.0, 0.0);
    let apit = Apit::try_from(ApitConfig { grid_step_m: 0.25, ..ApitConfig::default() }).unwrap();
    let apit_m = mean_error_m(&network, &apit.map(&network.knowledge(), &Unwatched).unwrap());
    let centroid_m = mean_error_m(&network, &Centroid.map(&network.knowledge(), &Unwatched).unwrap());
    assert!(apit_m < 0.7 * centroid_m, "{apit_m} against {centroid_m}");
    let space = Network::new(lattice([4, 4, 4], 0.2), 5, 2.0, 6.0, 0.0);
    assert_eq!(apit.map(&space.knowledge(), &Unwatched), Err(MapError::PlanarOnly("apit")));
    assert_eq!(
        Apit::try_from(ApitConfig { grid_step_m: -1.0, ..ApitConfig::default() }).unwrap_err().key,
        "grid_step_m"
    );
}
