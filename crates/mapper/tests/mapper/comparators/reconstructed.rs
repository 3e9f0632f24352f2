//! DR-MDS and NTLDV-HOP, as they are reconstructed.

use sextant_channel::{Anchor, Position};
use sextant_kernel::{NodeId, Purpose, Seed, Unwatched};
use sextant_mapper::{
    Comparator, DrMds, DrMdsConfig, MapError, MdsMap, MdsMapConfig, NtldvHop, NtldvHopConfig, RangingConfig,
};

use super::network::{Network, RANGING, lattice, mean_error_m};

fn dr_mds(config: DrMdsConfig) -> DrMds {
    DrMds::try_from(DrMdsConfig { ranging: RANGING, ..config }).expect("good settings")
}

fn ntldv_hop(config: NtldvHopConfig) -> NtldvHop {
    NtldvHop::try_from(config).expect("good settings")
}

fn random(count: u64, size_m: [f64; 3], seed: u64) -> Vec<Position> {
    let draw = |i, axis: usize| size_m[axis] * Seed(seed).uniform(Purpose::new(8), [i, axis as u64, 2]);
    (0..count).map(|i| Position::new(draw(i, 0), draw(i, 1), draw(i, 2))).collect()
}

#[test]
fn exact_ranges_over_at_most_two_hops_give_the_exact_map() {
    for (size_m, hop_m) in [([6.0, 6.0, 0.0], 5.0), ([5.0, 5.0, 5.0], 5.5)] {
        let network = Network::new(random(60, size_m, 5), 9, hop_m, 5.0, 0.0);
        let map = dr_mds(DrMdsConfig::default()).map(&network.knowledge(), &Unwatched).unwrap();
        let error_m = mean_error_m(&network, &map);
        assert!(error_m < 1e-5, "{size_m:?}: {error_m}");
        let by_hops = MdsMap::try_from(MdsMapConfig::default()).unwrap().map(&network.knowledge(), &Unwatched);
        assert!(mean_error_m(&network, &by_hops.unwrap()) > 0.1);
    }
}

#[test]
fn straight_distances_beat_hops_in_a_large_network_and_a_refinement_makes_them_exact() {
    let network = Network::new(lattice([7, 7, 7], 0.2), 11, 1.9, 5.0, 0.0);
    let error_m = |config| {
        let map = dr_mds(config).map(&network.knowledge(), &Unwatched).unwrap();
        mean_error_m(&network, &map)
    };
    let scaled_m = error_m(DrMdsConfig::default());
    let by_hops = MdsMap::try_from(MdsMapConfig::default()).unwrap().map(&network.knowledge(), &Unwatched).unwrap();
    assert!(scaled_m < 0.6 * mean_error_m(&network, &by_hops), "{scaled_m}");
    let refined_m = error_m(DrMdsConfig { rounds: 100, ..DrMdsConfig::default() });
    assert!(refined_m < 0.5 * scaled_m, "{refined_m} of {scaled_m}");
}

#[test]
fn noise_of_ranges_does_not_stop_it() {
    let network = Network::new(lattice([6, 6, 4], 0.2), 7, 1.9, 5.0, 4.0);
    let ranging = RangingConfig { sigma_db: Some(4.0), ..RANGING };
    let map = DrMds::try_from(DrMdsConfig { ranging, ..DrMdsConfig::default() }).unwrap();
    let map = map.map(&network.knowledge(), &Unwatched).unwrap();
    let error_m = mean_error_m(&network, &map);
    assert!(error_m < 2.5, "{error_m}");
}

#[test]
fn hops_along_the_axes_of_a_lattice_give_the_places_on_it() {
    // Nodes at most one metre apart hear each other, and all anchors are on one axis each: hops along the axes are exact.
    let axis = |at: fn(f64) -> Position| (0..7).map(move |i| at(f64::from(i)));
    let mut places: Vec<Position> = axis(|x| Position::new(x, 0.0, 0.0)).collect();
    places.extend(axis(|y| Position::new(0.0, y, 0.0)).skip(1));
    places.extend(axis(|z| Position::new(0.0, 0.0, z)).skip(1));
    let network = Network::new(places, 6, 1.0, 5.0, 0.0);
    assert_eq!(network.anchors.len(), 4);
    let map = ntldv_hop(NtldvHopConfig::plain()).map(&network.knowledge(), &Unwatched).unwrap();
    let found = map.positions();
    // Between two ends, 12 hops cover 6 √2 m; from the corner, 6 hops cover 6 m. Corner: 1 m a hop; ends: the mean.
    let end_m = (6.0 + 2.0 * 72.0_f64.sqrt()) / (6.0 + 24.0);
    for (node, length_m) in [(2, 1.0), (5, end_m)] {
        // Hops to the corner, to the end of the own axis, and to the other ends.
        let hops = [node as f64, 6.0 - node as f64, 6.0 + node as f64];
        let x = (hops[0].powi(2) - hops[1].powi(2)) * length_m * length_m / 12.0 + 3.0;
        let y = (hops[0].powi(2) - hops[2].powi(2)) * length_m * length_m / 12.0 + 3.0;
        let expected = Position::new(x, y, y);
        assert!(found[node].unwrap().distance_m(expected) < 1e-9, "{:?} for {expected}", found[node]);
    }
}

#[test]
fn the_improvements_place_nodes_better_than_plain_hops() {
    let network = Network::new(lattice([8, 8, 5], 0.3), 13, 1.9, 5.0, 0.0);
    let error_m = |config| mean_error_m(&network, &ntldv_hop(config).map(&network.knowledge(), &Unwatched).unwrap());
    let (improved_m, plain_m) = (error_m(NtldvHopConfig::default()), error_m(NtldvHopConfig::plain()));
    assert!(improved_m < 0.9 * plain_m && improved_m < 0.6 * 1.9, "{improved_m}, {plain_m}");
}

#[test]
fn anchors_that_are_nearly_flat_are_rejected() {
    // All anchors but two lie nearly in a plane; without the two, no tetrahedron stands up.
    let mut places = lattice([6, 6, 4], 0.1);
    places.sort_by(|a, b| a.z_m.total_cmp(&b.z_m));
    let mut network = Network::new(places, 7, 1.9, 5.0, 0.0);
    network.anchors.retain(|anchor| anchor.position.z_m < 0.2);
    assert!(network.anchors.len() >= 4);
    let placed = |config| ntldv_hop(config).map(&network.knowledge(), &Unwatched).unwrap().mapped();
    assert_eq!(placed(NtldvHopConfig::default()), network.anchors.len(), "only the anchors");
    let kept = NtldvHopConfig { reject_flat_anchors: false, ..NtldvHopConfig::default() };
    assert_eq!(placed(kept), network.places.len());
}

/// Nodes on both faces of racks, half a metre apart, row by row.
fn racks() -> Vec<Position> {
    let faces = [0.0, 1.0, 3.0, 4.0, 6.0, 7.0];
    let face = |y: f64| (0..24).flat_map(move |x| (0..5).map(move |z| (0.5 * f64::from(x), y, 0.5 * f64::from(z))));
    faces.into_iter().flat_map(face).map(|(x, y, z)| Position::new(x, y, z)).collect()
}

#[test]
fn more_anchors_never_leave_more_nodes_without_a_place() {
    // On a face of a rack many anchors are one hop away. With more anchors, the first of a list all stand on this face.
    let placed = |every| {
        let network = Network::new(racks(), every, 2.3, 5.0, 0.0);
        ntldv_hop(NtldvHopConfig::default()).map(&network.knowledge(), &Unwatched).unwrap().mapped()
    };
    let counts = [64, 32, 16, 8, 4, 2].map(placed);
    assert!(counts.is_sorted(), "{counts:?}");
    assert_eq!(counts, [racks().len(); 6], "all nodes reach anchors on several faces");
}

#[test]
fn the_order_of_nodes_in_a_file_does_not_change_the_map() {
    let listed = Network::new(racks(), 6, 2.3, 5.0, 0.0);
    let last = listed.places.len() - 1;
    let mut reversed = Network::new(racks().into_iter().rev().collect(), 6, 2.3, 5.0, 0.0);
    let turned = |anchor: &Anchor| Anchor { node: NodeId::from_index(last - anchor.node.index()), ..*anchor };
    reversed.anchors = listed.anchors.iter().rev().map(turned).collect();
    let of = |network: &Network| ntldv_hop(NtldvHopConfig::default()).map(&network.knowledge(), &Unwatched).unwrap();
    let (forwards, backwards) = (of(&listed).positions(), of(&reversed).positions());
    for (node, place) in forwards.iter().enumerate() {
        let apart_m = place.unwrap().distance_m(backwards[last - node].unwrap());
        assert!(apart_m < 1e-6, "node {node}: {apart_m} m");
    }
}

#[test]
fn too_few_anchors_are_an_error_with_the_number_needed() {
    let mut network = Network::new(lattice([4, 4, 4], 0.1), 9, 1.9, 5.0, 0.0);
    network.anchors.truncate(3);
    network.anchors[2].position.z_m += 1.0;
    let error = ntldv_hop(NtldvHopConfig::default()).map(&network.knowledge(), &Unwatched).unwrap_err();
    assert_eq!(error, MapError::TooFewAnchors { algorithm: "ntldv-hop", found: 3, needed: 4 });
    let error = dr_mds(DrMdsConfig::default()).map(&network.knowledge(), &Unwatched).unwrap_err();
    assert_eq!(error, MapError::TooFewAnchors { algorithm: "dr-mds", found: 3, needed: 5 });
    let error = dr_mds(DrMdsConfig::default()).map(&network.robot_only(), &Unwatched).unwrap_err();
    assert!(matches!(error, MapError::Missing { algorithm: "dr-mds", .. }));
    let shares = [NtldvHopConfig { link_share: 0.0, ..NtldvHopConfig::default() }];
    assert_eq!(NtldvHop::try_from(shares[0]).unwrap_err().key, "link_share");
    let error = DrMds::try_from(DrMdsConfig::default()).unwrap_err();
    assert_eq!(error.key, "ranging.exponent");
}
