//! The distribution of the position errors of the nodes of one map, at each of the [`POSITION_ERRORS_M`](crate::summary::POSITION_ERRORS_M).

use super::number::{Number, Unit, numbers};
use crate::summary::MapSummary;

fn within<const I: usize>(map: &MapSummary) -> Option<f64> {
    map.position_error_cdf.map(|cdf| cdf[I][1])
}

numbers! { MapSummary {
    WITHIN_0_05_M "position_error_cdf_0.05" Share within::<0>;
    WITHIN_0_1_M "position_error_cdf_0.1" Share within::<1>;
    WITHIN_0_15_M "position_error_cdf_0.15" Share within::<2>;
    WITHIN_0_2_M "position_error_cdf_0.2" Share within::<3>;
    WITHIN_0_3_M "position_error_cdf_0.3" Share within::<4>;
    WITHIN_0_5_M "position_error_cdf_0.5" Share within::<5>;
    WITHIN_0_7_M "position_error_cdf_0.7" Share within::<6>;
    WITHIN_1_M "position_error_cdf_1" Share within::<7>;
    WITHIN_1_5_M "position_error_cdf_1.5" Share within::<8>;
    WITHIN_2_M "position_error_cdf_2" Share within::<9>;
    WITHIN_3_M "position_error_cdf_3" Share within::<10>;
    WITHIN_5_M "position_error_cdf_5" Share within::<11>;
    WITHIN_7_M "position_error_cdf_7" Share within::<12>;
    WITHIN_10_M "position_error_cdf_10" Share within::<13>;
    WITHIN_20_M "position_error_cdf_20" Share within::<14>;
}}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::summary::POSITION_ERRORS_M;

    #[test]
    fn each_column_has_its_limit_in_its_name_and_the_share_there() {
        let cdf = std::array::from_fn(|i| [POSITION_ERRORS_M[i], 0.5 + 0.01 * i as f64]);
        let map = MapSummary { position_error_cdf: Some(cdf), ..MapSummary::default() };
        assert_eq!(ALL.len(), POSITION_ERRORS_M.len());
        for (number, [limit_m, share]) in ALL.iter().zip(cdf) {
            assert_eq!(number.column, format!("position_error_cdf_{limit_m}"));
            assert_eq!((number.read)(&map), Some(share));
        }
    }
}
