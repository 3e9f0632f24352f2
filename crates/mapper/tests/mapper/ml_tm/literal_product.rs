//! ML-TM finds what the literal product finds.

use proptest::prelude::*;
use sextant_channel::Position;
use sextant_kernel::{NodeId, Purpose, Seed, Unwatched};
use sextant_mapper::{
    EstimateKind, MlTmConfig, ProfileConfig, ReceptionProfile, SectorsConfig, TableProfile, TieRule, TrapezoidConfig,
};

use super::cases::{Case, NODES, case, sector_case, table_case};
use super::oracle::Oracle;
use super::{entry, log, ml_tm};

fn agrees_with_the_literal_product(case: Case) -> Result<(), TestCaseError> {
    let mut log = log(NODES, &case.stops, case.receptions);
    if let Some(sectors) = case.sectors {
        log = log.with_sectors(sectors).expect("sectors of the table");
    }
    let config = MlTmConfig {
        ties: TieRule::First,
        sectors: Some(SectorsConfig { tolerance: case.tolerance, silence: case.silence, ..SectorsConfig::default() }),
        ..MlTmConfig::new(case.step_m, ProfileConfig::Trapezoid(case.profile.clone()))
    };
    let mut argmax = ml_tm(config.clone());
    let mut posterior = ml_tm(MlTmConfig { estimate: EstimateKind::PosteriorMean, ..config });
    if !case.table.is_empty() {
        let step_m = case.profile.range_m / f64::from(u32::try_from(case.table.len() - 1).expect("a short table"));
        let table = TableProfile::new(step_m, case.table.clone(), case.profile.floor, case.profile.ceiling);
        let profile = ReceptionProfile::Table(table.expect("a good table"));
        argmax = argmax.with_profile(profile.clone());
        posterior = posterior.with_profile(profile);
    }
    let lattice = argmax.lattice(&log).expect("a lattice");
    let table = if let ReceptionProfile::Table(table) = argmax.profile() { Some(table) } else { None };
    let profile = TrapezoidConfig { range_m: argmax.profile().range_m(), ..case.profile.clone() };
    let (tolerance, silence) = (case.tolerance, case.silence);
    let oracle = Oracle { profile: &profile, table, log: &log, lattice: &lattice, tolerance, silence };
    let (argmax_map, posterior_map) =
        (argmax.map(&log, &Unwatched).expect("a map"), posterior.map(&log, &Unwatched).expect("a map"));
    for node in 0..NODES {
        let (likelihoods, infeasible) = oracle.likelihoods(NodeId(node));
        let found = &argmax_map.estimates[node as usize];
        let mean = &posterior_map.estimates[node as usize];
        if likelihoods.is_empty() {
            prop_assert!(found.is_none() && mean.is_none());
            let unheard = argmax.surface(&log, NodeId(node), &Unwatched).is_err();
            prop_assert!(unheard);
            continue;
        }
        let (highest, maximisers) = Oracle::maximisers(&likelihoods);
        let found = found.as_ref().expect("the literal product finds a place");
        prop_assert_eq!(found.infeasible, infeasible);
        prop_assert_eq!(found.position, lattice.position(lattice.vertex(maximisers[0])));
        prop_assert_eq!(found.ties as usize, maximisers.len());
        prop_assert!((found.log_likelihood.expect("a likelihood") - highest.ln()).abs() < 1e-9);

        let mean = mean.as_ref().expect("the literal product finds a place");
        let (expected, covariance) = oracle.mean_and_covariance(&likelihoods);
        prop_assert!(mean.position.distance_m(expected) < 1e-9, "{:?} {:?}", mean, expected);
        let found = mean.covariance.expect("a posterior mean has a covariance");
        for (found, expected) in found.as_flattened().iter().zip(covariance.as_flattened()) {
            prop_assert!((found - expected).abs() < 1e-8, "{} {}", found, expected);
        }

        let surface = argmax.surface(&log, NodeId(node), &Unwatched).expect("a surface");
        let finite = surface.log_likelihood.iter().filter(|value| value.is_finite());
        prop_assert_eq!(finite.count(), likelihoods.len());
        prop_assert!((surface.maximum().1 - highest.ln()).abs() < 1e-9);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_plane_has_the_argmax_ties_and_mean_of_the_literal_product(case in case(0.0, 0.5, 1.0..4.0)) {
        agrees_with_the_literal_product(case)?;
    }

    #[test]
    fn space_has_the_argmax_ties_and_mean_of_the_literal_product(case in case(3.0, 0.8, 1.0..2.5)) {
        agrees_with_the_literal_product(case)?;
    }

    #[test]
    fn sectors_in_the_plane_have_the_argmax_ties_and_mean_of_the_literal_product(
        case in sector_case(0.0, 0.5, 1.5..6.0),
    ) {
        agrees_with_the_literal_product(case)?;
    }

    #[test]
    fn sectors_in_space_have_the_argmax_ties_and_mean_of_the_literal_product(
        case in sector_case(3.0, 0.8, 1.5..4.0),
    ) {
        agrees_with_the_literal_product(case)?;
    }

    #[test]
    fn a_table_has_the_argmax_ties_and_mean_of_the_literal_product(
        plane in table_case(0.0, 0.5, 1.0..4.0),
        space in table_case(3.0, 0.8, 1.0..2.5),
    ) {
        agrees_with_the_literal_product(plane)?;
        agrees_with_the_literal_product(space)?;
    }
}

#[test]
fn many_stops_with_outliers_have_the_argmax_of_the_sum_of_logarithms() {
    // Large enough for several batches of vertices and stops; products would underflow.
    let draw = |i: u64, what| Seed(5).uniform(Purpose::new(8), [i, what, 0]);
    let stops: Vec<Position> = (0..300)
        .map(|i| Position::new(25.0 * draw(i, 0), 25.0 * draw(i, 1), 0.0))
        .chain([Position::new(60.0, 45.0, 0.0)])
        .collect();
    let profile = TrapezoidConfig::new(0.9, 2.0, 10.0);
    let mut receptions = Vec::new();
    let truth = [Position::new(12.0, 13.0, 0.0), Position::new(2.0, 20.0, 0.0)];
    for (node, place) in (0..).zip(truth) {
        for (i, &stop) in (0..).zip(&stops) {
            let heard = draw(u64::from(i), 2 + u64::from(node)) < 0.95 - 0.1 * place.distance_m(stop);
            // The last stop hears the second node from 60 m away, and counts more packets than a product holds.
            match (heard, i == 300 && node == 1) {
                (_, true) => receptions.push(entry(node, i, 3, 300)),
                (true, _) => receptions.push(entry(node, i, 1, 1)),
                _ => {}
            }
        }
    }
    let log = log(2, &stops, receptions);
    for step_m in [0.3, 0.45] {
        let ml_tm = ml_tm(MlTmConfig::new(step_m, ProfileConfig::Trapezoid(profile.clone())));
        let map = ml_tm.map(&log, &Unwatched).unwrap();
        let lattice = ml_tm.lattice(&log).unwrap();
        assert_eq!(map.infeasible(), 1, "only the node with the outlier");
        for node in 0..2 {
            let mut counts = vec![(0, 1); stops.len()];
            for r in log.of(NodeId(node)) {
                counts[r.stop as usize] = (r.received, r.sent);
            }
            let mut best = (0, f64::NEG_INFINITY);
            for index in 0..lattice.len() {
                let vertex = lattice.position(lattice.vertex(index));
                let mut sum = 0.0;
                let mut in_reach = (0, 0);
                for (&(received, sent), &place) in counts.iter().zip(&stops) {
                    let d = vertex.distance_m(place);
                    let s = (0.9 * (10.0 - d) / 8.0).clamp(1e-6, 0.9);
                    sum += f64::from(received) * s.ln() + f64::from(sent - received) * (1.0 - s).ln();
                    in_reach.0 += u32::from(received > 0 && d < 10.0);
                    in_reach.1 += u32::from(received > 0);
                }
                let admitted = if node == 0 { in_reach.0 == in_reach.1 } else { in_reach.0 > 0 };
                if admitted && sum > best.1 + 1e-9 {
                    best = (index, sum);
                }
            }
            let estimate = map.estimates[node as usize].as_ref().unwrap();
            assert_eq!(estimate.position, lattice.position(lattice.vertex(best.0)), "node {node}");
            assert!((estimate.log_likelihood.expect("a likelihood") - best.1).abs() < 1e-9);
            assert!(estimate.position.distance_m(truth[node as usize]) < 2.0);
        }
        // The work is a small part of the lattice, outlier or not.
        assert!(map.vertices_evaluated < lattice.len() / 20, "{}", map.vertices_evaluated);
    }
}
