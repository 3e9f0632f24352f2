//! Maps of hop counts.

use sextant_channel::Position;
use sextant_kernel::Unwatched;
use sextant_mapper::lateration::{Range, multilaterate};
use sextant_mapper::{
    AxesConfig, Comparator, CoordinateFrame, CountConfig, DvHop, DvHopConfig, ExtremeConfig, FrameConfig, HopLength,
    LandmarksConfig, MapError, MdsMap, MdsMapConfig, Tpm, TpmConfig, topology_preservation_error,
};

use super::network::{Network, lattice, mean_error_m};

fn tpm(config: TpmConfig) -> Tpm {
    Tpm::try_from(config).expect("good settings")
}

fn preservation(network: &Network, config: TpmConfig) -> f64 {
    let map = tpm(config).map(&network.knowledge(), &Unwatched).expect("a map").aligned_to(&network.truth(), 4);
    topology_preservation_error(&network.places, &map.positions(), &Unwatched)
        .expect("nobody interrupts")
        .expect("lines of nodes")
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
    // In a full mesh, each node that is not a landmark is one hop from all landmarks.
    let network = Network::new(lattice([5, 5, 1], 0.0), 25, 100.0, 5.0, 0.0);
    let config =
        TpmConfig { landmarks: LandmarksConfig::FarthestPoints(CountConfig { count: 6 }), ..TpmConfig::default() };
    let map = tpm(config).map(&network.knowledge(), &Unwatched).unwrap();
    assert!(map.coincident() >= 19, "{}", map.coincident());
}

#[test]
fn each_part_of_a_network_that_falls_apart_has_its_own_map() {
    let mut places = lattice([8, 8, 1], 0.1);
    places.extend(lattice([8, 8, 1], 0.1).iter().map(|&p| p + Position::new(40.0, 5.0, 0.0)));
    // Two nodes alone have no map.
    places.extend([Position::new(90.0, 0.0, 0.0), Position::new(91.0, 0.0, 0.0)]);
    let network = Network::new(places, 10, 1.6, 5.0, 0.0);
    let map = tpm(TpmConfig::default()).map(&network.knowledge(), &Unwatched).unwrap();
    let CoordinateFrame::Relative(parts) = &map.frame else { panic!("a map of hops is relative") };
    assert_eq!((parts[0], parts[63], parts[64], parts[127], parts[128]), (0, 0, 1, 1, 2));
    assert_eq!((map.mapped(), map.unmapped()), (128, 2));
    let aligned = map.aligned_to(&network.truth(), 4);
    let aligned = aligned.positions();
    let error = topology_preservation_error(&network.places[..64], &aligned[..64], &Unwatched).unwrap().unwrap();
    assert!(error < 0.02, "{error}");
    let far = aligned[100].unwrap();
    assert!(far.distance_m(network.places[100]) < 1.5, "{far}");
}

#[test]
fn the_same_knowledge_gives_the_same_bits_on_any_number_of_threads() {
    let network = Network::new(lattice([12, 12, 1], 0.2), 9, 1.8, 5.0, 0.0);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| tpm(TpmConfig::default()).map(&network.knowledge(), &Unwatched).expect("a map"))
    };
    assert_eq!(on(1), on(4));
}

#[test]
fn without_neighbours_or_enough_anchors_there_is_no_map() {
    let network = Network::new(lattice([4, 4, 1], 0.0), 8, 1.5, 5.0, 0.0);
    let error = tpm(TpmConfig::default()).map(&network.robot_only(), &Unwatched).unwrap_err();
    assert!(matches!(error, MapError::Missing { algorithm: "tpm", .. }) && error.to_string().contains("`discovery`"));
    let config = TpmConfig { landmarks: LandmarksConfig::Anchors {}, ..TpmConfig::default() };
    let error = tpm(config).map(&network.knowledge(), &Unwatched).unwrap_err();
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

#[test]
fn hops_along_a_line_of_equal_steps_are_distances() {
    // A line of nodes one metre apart, bent into the plane by two short arms so that places follow. Hop lengths are exact
    // along axes: every anchor sees one metre a hop.
    let line = |along: fn(f64) -> Position| (0..9).map(move |i| along(f64::from(i)));
    let mut places: Vec<Position> = line(|x| Position::new(x, 0.0, 0.0)).collect();
    places.extend(line(|y| Position::new(0.0, y, 0.0)).skip(1));
    // Anchors: the corner and both ends; between the ends 16 hops cover sqrt(128) m, so each end sees
    // (8 + sqrt(128))/24 m a hop, and the corner 1 m.
    let mut network = Network::new(places, 8, 1.1, 5.0, 0.0);
    assert_eq!(network.anchors.len(), 3);
    let exact = DvHop::try_from(DvHopConfig::default()).unwrap();
    let found = exact.map(&network.knowledge(), &Unwatched).unwrap().positions();
    let end_m = (8.0 + 128.0_f64.sqrt()) / 24.0;
    // The node at (2, 0) is nearest to the corner: 1 m a hop, 2, 6 and 10 hops.
    let misfit = |place: Position, length_m: f64, hops: [f64; 3]| {
        let anchors = [Position::ORIGIN, Position::new(8.0, 0.0, 0.0), Position::new(0.0, 8.0, 0.0)];
        let ranges: Vec<Range> =
            anchors.iter().zip(hops).map(|(&anchor, hops)| Range::new(anchor, length_m * hops)).collect();
        let best = multilaterate(&ranges, 2).expect("three anchors");
        place.distance_m(best)
    };
    assert!(misfit(found[2].unwrap(), 1.0, [2.0, 6.0, 10.0]) < 1e-9);
    assert!(misfit(found[6].unwrap(), end_m, [6.0, 2.0, 14.0]) < 1e-9);
    assert_eq!(found[8], Some(network.places[8]), "an anchor is where it is");
    // Least squares weigh far anchors more: (8·8 + 16·sqrt(128))/(64 + 256) m a hop.
    let squares = DvHop::try_from(DvHopConfig { hop_length: HopLength::LeastSquares, ..DvHopConfig::default() });
    let found = squares.unwrap().map(&network.knowledge(), &Unwatched).unwrap().positions();
    let end_m = (64.0 + 16.0 * 128.0_f64.sqrt()) / 320.0;
    assert!(misfit(found[6].unwrap(), end_m, [6.0, 2.0, 14.0]) < 1e-9);
    network.anchors.truncate(2);
    assert!(matches!(
        exact.map(&network.knowledge(), &Unwatched),
        Err(MapError::TooFewAnchors { found: 2, needed: 3, .. })
    ));
}

#[test]
fn hops_place_the_nodes_of_a_lattice_within_a_fraction_of_the_radius() {
    let network = Network::new(lattice([15, 15, 1], 0.2), 17, 2.5, 5.0, 0.0);
    let dv_hop = DvHop::try_from(DvHopConfig::default()).unwrap().map(&network.knowledge(), &Unwatched).unwrap();
    let mds_map = MdsMap::try_from(MdsMapConfig::default()).unwrap().map(&network.knowledge(), &Unwatched).unwrap();
    // The literature has 0.3 to 0.5 of the radius at lower density.
    for map in [&dv_hop, &mds_map] {
        let error_m = mean_error_m(&network, map);
        assert!(error_m < 0.4 * 2.5, "{}: {error_m}", map.algorithm);
    }
    assert_eq!((&dv_hop.frame, &mds_map.frame), (&CoordinateFrame::World, &CoordinateFrame::AlignedToAnchors));
    let relative = MdsMapConfig { frame: FrameConfig::Relative, ..MdsMapConfig::default() };
    let relative = MdsMap::try_from(relative).unwrap().map(&network.knowledge(), &Unwatched).unwrap();
    assert!(matches!(relative.frame, CoordinateFrame::Relative(_)));
    let aligned = relative.aligned_to(&network.truth(), 4);
    assert!(mean_error_m(&network, &aligned) < mean_error_m(&network, &mds_map) + 0.05);
}

#[test]
fn hops_in_space_are_scaled_in_space() {
    let network = Network::new(lattice([5, 5, 5], 0.1), 7, 1.8, 4.0, 0.0);
    let mds_map = MdsMap::try_from(MdsMapConfig::default()).unwrap().map(&network.knowledge(), &Unwatched).unwrap();
    let error_m = mean_error_m(&network, &mds_map);
    assert!(error_m < 0.4 * 1.8, "{error_m}");
    let dv_hop = DvHop::try_from(DvHopConfig::default()).unwrap().map(&network.knowledge(), &Unwatched).unwrap();
    assert!(mean_error_m(&network, &dv_hop) < 0.6 * 1.8);
}
