//! The course of a search for targets, at each of the [`SEARCH_INSTANTS_S`](crate::summary::SEARCH_INSTANTS_S).

use super::number::{Number, Unit, numbers};
use crate::summary::ApplicationSummary;

fn distance_m<const I: usize>(application: &ApplicationSummary) -> Option<f64> {
    application.course.get(I)?.distance_to_target_m
}

fn prediction_error_m<const I: usize>(application: &ApplicationSummary) -> Option<f64> {
    application.course.get(I)?.prediction_error_m
}

numbers! { ApplicationSummary {
    DISTANCE_4_S_M "distance_to_target_m.at_4_s" Metre distance_m::<0>;
    DISTANCE_8_S_M "distance_to_target_m.at_8_s" Metre distance_m::<1>;
    DISTANCE_12_S_M "distance_to_target_m.at_12_s" Metre distance_m::<2>;
    DISTANCE_16_S_M "distance_to_target_m.at_16_s" Metre distance_m::<3>;
    DISTANCE_20_S_M "distance_to_target_m.at_20_s" Metre distance_m::<4>;
    DISTANCE_24_S_M "distance_to_target_m.at_24_s" Metre distance_m::<5>;
    DISTANCE_28_S_M "distance_to_target_m.at_28_s" Metre distance_m::<6>;
    DISTANCE_32_S_M "distance_to_target_m.at_32_s" Metre distance_m::<7>;
    DISTANCE_36_S_M "distance_to_target_m.at_36_s" Metre distance_m::<8>;
    DISTANCE_40_S_M "distance_to_target_m.at_40_s" Metre distance_m::<9>;
    DISTANCE_44_S_M "distance_to_target_m.at_44_s" Metre distance_m::<10>;
    DISTANCE_48_S_M "distance_to_target_m.at_48_s" Metre distance_m::<11>;
    DISTANCE_52_S_M "distance_to_target_m.at_52_s" Metre distance_m::<12>;
    DISTANCE_56_S_M "distance_to_target_m.at_56_s" Metre distance_m::<13>;
    DISTANCE_60_S_M "distance_to_target_m.at_60_s" Metre distance_m::<14>;
    DISTANCE_64_S_M "distance_to_target_m.at_64_s" Metre distance_m::<15>;
    DISTANCE_68_S_M "distance_to_target_m.at_68_s" Metre distance_m::<16>;
    DISTANCE_72_S_M "distance_to_target_m.at_72_s" Metre distance_m::<17>;
    DISTANCE_76_S_M "distance_to_target_m.at_76_s" Metre distance_m::<18>;
    DISTANCE_80_S_M "distance_to_target_m.at_80_s" Metre distance_m::<19>;
    DISTANCE_84_S_M "distance_to_target_m.at_84_s" Metre distance_m::<20>;
    PREDICTION_ERROR_4_S_M "prediction_error_m.at_4_s" Metre prediction_error_m::<0>;
    PREDICTION_ERROR_8_S_M "prediction_error_m.at_8_s" Metre prediction_error_m::<1>;
    PREDICTION_ERROR_12_S_M "prediction_error_m.at_12_s" Metre prediction_error_m::<2>;
    PREDICTION_ERROR_16_S_M "prediction_error_m.at_16_s" Metre prediction_error_m::<3>;
    PREDICTION_ERROR_20_S_M "prediction_error_m.at_20_s" Metre prediction_error_m::<4>;
    PREDICTION_ERROR_24_S_M "prediction_error_m.at_24_s" Metre prediction_error_m::<5>;
    PREDICTION_ERROR_28_S_M "prediction_error_m.at_28_s" Metre prediction_error_m::<6>;
    PREDICTION_ERROR_32_S_M "prediction_error_m.at_32_s" Metre prediction_error_m::<7>;
    PREDICTION_ERROR_36_S_M "prediction_error_m.at_36_s" Metre prediction_error_m::<8>;
    PREDICTION_ERROR_40_S_M "prediction_error_m.at_40_s" Metre prediction_error_m::<9>;
    PREDICTION_ERROR_44_S_M "prediction_error_m.at_44_s" Metre prediction_error_m::<10>;
    PREDICTION_ERROR_48_S_M "prediction_error_m.at_48_s" Metre prediction_error_m::<11>;
    PREDICTION_ERROR_52_S_M "prediction_error_m.at_52_s" Metre prediction_error_m::<12>;
    PREDICTION_ERROR_56_S_M "prediction_error_m.at_56_s" Metre prediction_error_m::<13>;
    PREDICTION_ERROR_60_S_M "prediction_error_m.at_60_s" Metre prediction_error_m::<14>;
    PREDICTION_ERROR_64_S_M "prediction_error_m.at_64_s" Metre prediction_error_m::<15>;
    PREDICTION_ERROR_68_S_M "prediction_error_m.at_68_s" Metre prediction_error_m::<16>;
    PREDICTION_ERROR_72_S_M "prediction_error_m.at_72_s" Metre prediction_error_m::<17>;
    PREDICTION_ERROR_76_S_M "prediction_error_m.at_76_s" Metre prediction_error_m::<18>;
    PREDICTION_ERROR_80_S_M "prediction_error_m.at_80_s" Metre prediction_error_m::<19>;
    PREDICTION_ERROR_84_S_M "prediction_error_m.at_84_s" Metre prediction_error_m::<20>;
}}

/// The distances to the target, by instant.
#[must_use]
pub fn distances_m() -> &'static [&'static Number<ApplicationSummary>] {
    ALL.split_at(ALL.len() / 2).0
}

/// The errors of prediction, by instant.
#[must_use]
pub fn prediction_errors_m() -> &'static [&'static Number<ApplicationSummary>] {
    ALL.split_at(ALL.len() / 2).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::summary::{SEARCH_INSTANTS_S, SearchInstant};

    #[test]
    fn each_column_has_its_instant_in_its_name_and_the_value_then() {
        let value = |i: usize| i as f64;
        let instant = |i: usize| SearchInstant {
            distance_to_target_m: Some(value(i)),
            prediction_error_m: Some(100.0 + value(i)),
        };
        let course = (0..SEARCH_INSTANTS_S.len()).map(instant).collect();
        let application = ApplicationSummary { course, ..ApplicationSummary::default() };
        assert_eq!(ALL.len(), 2 * SEARCH_INSTANTS_S.len());
        for (i, time_s) in SEARCH_INSTANTS_S.into_iter().enumerate() {
            let (distance, error) = (distances_m()[i], prediction_errors_m()[i]);
            assert_eq!(distance.column, format!("distance_to_target_m.at_{time_s}_s"));
            assert_eq!(error.column, format!("prediction_error_m.at_{time_s}_s"));
            assert_eq!(
                ((distance.read)(&application), (error.read)(&application)),
                (Some(value(i)), Some(100.0 + value(i)))
            );
        }
        assert_eq!((ALL[0].read)(&ApplicationSummary::default()), None);
    }
}
