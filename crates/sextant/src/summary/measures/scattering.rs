//! The position errors of the nodes of a map that they computed themselves, by their error of neighbour scattering.

use super::number::{Number, Unit, count, numbers};
use crate::summary::MapSummary;

/// Upper edges of the bins that have columns.
pub const EDGES: [f64; 10] = [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5];

/// A bin: upper edge, number of nodes, mean and 90th percentile of their errors (m).
type Bin = (f64, usize, f64, f64);

fn bins(map: &MapSummary) -> &[Bin] {
    map.distributed.as_ref().map_or(&[], |work| &work.scattering)
}

fn bin<const I: usize>(map: &MapSummary) -> Option<&Bin> {
    bins(map).iter().find(|(edge, ..)| (edge - EDGES[I]).abs() < 1e-6)
}

fn mean_m<const I: usize>(map: &MapSummary) -> Option<f64> {
    bin::<I>(map).map(|&(_, _, mean_m, _)| mean_m)
}

fn p90_m<const I: usize>(map: &MapSummary) -> Option<f64> {
    bin::<I>(map).map(|&(.., p90_m)| p90_m)
}

/// Number of the nodes in the bins up to the `I`-th, and the sum of their errors (m).
fn up_to<const I: usize>(map: &MapSummary) -> (f64, f64) {
    let within = bins(map).iter().filter(|(edge, ..)| *edge < EDGES[I] + 1e-6);
    within.fold((0.0, 0.0), |(nodes, sum_m), &(_, in_bin, mean_m, _)| {
        let in_bin = count(in_bin as u64);
        (nodes + in_bin, sum_m + in_bin * mean_m)
    })
}

fn mean_up_to_m<const I: usize>(map: &MapSummary) -> Option<f64> {
    let (nodes, sum_m) = up_to::<I>(map);
    (nodes > 0.0).then(|| sum_m / nodes)
}

fn share_up_to<const I: usize>(map: &MapSummary) -> Option<f64> {
    let all: usize = bins(map).iter().map(|&(_, nodes, ..)| nodes).sum();
    (all > 0).then(|| up_to::<I>(map).0 / count(all as u64))
}

numbers! { MapSummary {
    SHARE_UP_TO_0_1 "distributed.scattering_up_to_0.1.nodes" Share share_up_to::<1>;
    SHARE_UP_TO_0_2 "distributed.scattering_up_to_0.2.nodes" Share share_up_to::<3>;
    MEAN_UP_TO_0_1_M "distributed.scattering_up_to_0.1.position_error_m.mean" Metre mean_up_to_m::<1>;
    MEAN_UP_TO_0_2_M "distributed.scattering_up_to_0.2.position_error_m.mean" Metre mean_up_to_m::<3>;
    MEAN_0_05_M "distributed.scattering_0.05.position_error_m.mean" Metre mean_m::<0>;
    MEAN_0_1_M "distributed.scattering_0.1.position_error_m.mean" Metre mean_m::<1>;
    MEAN_0_15_M "distributed.scattering_0.15.position_error_m.mean" Metre mean_m::<2>;
    MEAN_0_2_M "distributed.scattering_0.2.position_error_m.mean" Metre mean_m::<3>;
    MEAN_0_25_M "distributed.scattering_0.25.position_error_m.mean" Metre mean_m::<4>;
    MEAN_0_3_M "distributed.scattering_0.3.position_error_m.mean" Metre mean_m::<5>;
    MEAN_0_35_M "distributed.scattering_0.35.position_error_m.mean" Metre mean_m::<6>;
    MEAN_0_4_M "distributed.scattering_0.4.position_error_m.mean" Metre mean_m::<7>;
    MEAN_0_45_M "distributed.scattering_0.45.position_error_m.mean" Metre mean_m::<8>;
    MEAN_0_5_M "distributed.scattering_0.5.position_error_m.mean" Metre mean_m::<9>;
    P90_0_05_M "distributed.scattering_0.05.position_error_m.p90" Metre p90_m::<0>;
    P90_0_1_M "distributed.scattering_0.1.position_error_m.p90" Metre p90_m::<1>;
    P90_0_15_M "distributed.scattering_0.15.position_error_m.p90" Metre p90_m::<2>;
    P90_0_2_M "distributed.scattering_0.2.position_error_m.p90" Metre p90_m::<3>;
    P90_0_25_M "distributed.scattering_0.25.position_error_m.p90" Metre p90_m::<4>;
    P90_0_3_M "distributed.scattering_0.3.position_error_m.p90" Metre p90_m::<5>;
    P90_0_35_M "distributed.scattering_0.35.position_error_m.p90" Metre p90_m::<6>;
    P90_0_4_M "distributed.scattering_0.4.position_error_m.p90" Metre p90_m::<7>;
    P90_0_45_M "distributed.scattering_0.45.position_error_m.p90" Metre p90_m::<8>;
    P90_0_5_M "distributed.scattering_0.5.position_error_m.p90" Metre p90_m::<9>;
}}

/// The mean errors by bin, in the order of [`EDGES`].
pub static MEANS_M: [&Number<MapSummary>; 10] = [
    &MEAN_0_05_M,
    &MEAN_0_1_M,
    &MEAN_0_15_M,
    &MEAN_0_2_M,
    &MEAN_0_25_M,
    &MEAN_0_3_M,
    &MEAN_0_35_M,
    &MEAN_0_4_M,
    &MEAN_0_45_M,
    &MEAN_0_5_M,
];

/// The 90th percentiles by bin, in the order of [`EDGES`].
pub static P90S_M: [&Number<MapSummary>; 10] = [
    &P90_0_05_M,
    &P90_0_1_M,
    &P90_0_15_M,
    &P90_0_2_M,
    &P90_0_25_M,
    &P90_0_3_M,
    &P90_0_35_M,
    &P90_0_4_M,
    &P90_0_45_M,
    &P90_0_5_M,
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::summary::DistributedSummary;

    fn map(scattering: Vec<Bin>) -> MapSummary {
        MapSummary {
            distributed: Some(DistributedSummary { scattering, ..Default::default() }),
            ..Default::default()
        }
    }

    #[test]
    fn each_column_has_its_edge_in_its_name_and_the_errors_there() {
        let map = map((0..20).map(|i| (0.05 * f64::from(i + 1), 1, f64::from(i), 100.0 + f64::from(i))).collect());
        for (i, edge) in EDGES.into_iter().enumerate() {
            assert_eq!(MEANS_M[i].column, format!("distributed.scattering_{edge}.position_error_m.mean"));
            assert_eq!(P90S_M[i].column, format!("distributed.scattering_{edge}.position_error_m.p90"));
            assert_eq!(((MEANS_M[i].read)(&map), (P90S_M[i].read)(&map)), (Some(i as f64), Some(100.0 + i as f64)));
        }
    }

    #[test]
    fn errors_of_several_bins_are_weighed_by_their_nodes() {
        let map = map(vec![(0.05, 30, 0.4, 0.6), (0.1, 10, 0.8, 0.9), (0.2, 40, 1.0, 1.5), (0.3, 20, 3.0, 4.0)]);
        for (number, value) in [
            (&SHARE_UP_TO_0_1, 0.4),
            (&SHARE_UP_TO_0_2, 0.8),
            (&MEAN_UP_TO_0_1_M, (30.0 * 0.4 + 10.0 * 0.8) / 40.0),
            (&MEAN_UP_TO_0_2_M, (12.0 + 8.0 + 40.0) / 80.0),
        ] {
            let read = (number.read)(&map).expect("there are nodes");
            assert!((read - value).abs() < 1e-12, "{}: {read}", number.column);
        }
        assert_eq!((MEAN_0_15_M.read)(&map), None, "an empty bin has no error");
        assert_eq!((MEAN_UP_TO_0_1_M.read)(&MapSummary::default()), None);
    }
}
