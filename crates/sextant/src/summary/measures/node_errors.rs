//! The distribution of the connectivity errors of the nodes of one map: the share of the nodes whose error is at most
//! each of [`NODE_ERRORS`](crate::summary::NODE_ERRORS).

use super::number::{Number, Unit, numbers};
use crate::summary::MapSummary;

fn within<const I: usize>(map: &MapSummary) -> Option<f64> {
    map.connectivity_errors.first()?.node_error_cdf.map(|cdf| cdf[I][1])
}

numbers! { MapSummary {
    WITHIN_0 "node_error_cdf_0" Share within::<0>;
    WITHIN_0_05 "node_error_cdf_0.05" Share within::<1>;
    WITHIN_0_1 "node_error_cdf_0.1" Share within::<2>;
    WITHIN_0_15 "node_error_cdf_0.15" Share within::<3>;
    WITHIN_0_2 "node_error_cdf_0.2" Share within::<4>;
    WITHIN_0_25 "node_error_cdf_0.25" Share within::<5>;
    WITHIN_0_3 "node_error_cdf_0.3" Share within::<6>;
    WITHIN_0_4 "node_error_cdf_0.4" Share within::<7>;
    WITHIN_0_5 "node_error_cdf_0.5" Share within::<8>;
    WITHIN_0_75 "node_error_cdf_0.75" Share within::<9>;
    WITHIN_1 "node_error_cdf_1" Share within::<10>;
}}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::summary::{ConnectivitySummary, NODE_ERRORS};

    #[test]
    fn each_column_has_its_limit_in_its_name_and_the_share_there() {
        let cdf = std::array::from_fn(|i| [NODE_ERRORS[i], 0.5 + 0.01 * i as f64]);
        let connectivity = ConnectivitySummary { node_error_cdf: Some(cdf), ..ConnectivitySummary::default() };
        let map = MapSummary { connectivity_errors: vec![connectivity], ..MapSummary::default() };
        assert_eq!(ALL.len(), NODE_ERRORS.len());
        for (number, [limit, share]) in ALL.iter().zip(cdf) {
            assert_eq!(number.column, format!("node_error_cdf_{limit}"));
            assert_eq!((number.read)(&map), Some(share));
        }
    }
}
