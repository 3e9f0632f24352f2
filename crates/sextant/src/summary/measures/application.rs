//! The numbers of an application.

use super::number::{Number, Unit, count, numbers};
use crate::summary::{ApplicationSummary, EnergySummary, ErrorSummary};

fn flag(is: Option<bool>) -> Option<f64> {
    is.map(|is| f64::from(u8::from(is)))
}

fn error(of: Option<ErrorSummary>, read: fn(&ErrorSummary) -> f64) -> Option<f64> {
    of.as_ref().map(read)
}

fn captures(application: &ApplicationSummary) -> Option<f64> {
    application.captured?;
    let captured = application.targets.iter().filter(|target| target.captured_s.is_some()).count();
    Some(count(captured as u64))
}

fn per_second(application: &ApplicationSummary, number: f64) -> Option<f64> {
    (application.sim_time_s > 0.0).then(|| number / application.sim_time_s)
}

/// The smallest true value of the field at an arrival.
fn least_arrival_value(application: &ApplicationSummary) -> Option<f64> {
    application.arrivals.iter().map(|arrival| arrival.value).min_by(f64::total_cmp)
}

fn energy_j(of: EnergySummary) -> f64 {
    of.tx + of.rx + of.idle
}

numbers! { ApplicationSummary {
    CAPTURED "captured" Outcome |application| flag(application.captured);
    ARRIVED "arrived" Outcome |application| flag(application.arrived);
    TIME_S "time_s" Second |application| application.time_s;
    SIM_TIME_S "sim_time_s" Second |application| Some(application.sim_time_s);
    CAPTURES "captures" Count captures;
    MAP_ERROR_M "map_error_m" Metre |application| application.map_error_m;
    PREDICTION_ERROR_MEAN_M "prediction_error_m.mean" Metre
        |application| error(application.prediction_error_m, |error| error.mean);
    PREDICTION_ERROR_MEDIAN_M "prediction_error_m.median" Metre
        |application| error(application.prediction_error_m, |error| error.median);
    PREDICTION_ERROR_P90_M "prediction_error_m.p90" Metre
        |application| error(application.prediction_error_m, |error| error.p90);
    OWN_PLACE_ERROR_MEAN_M "own_place_error_m.mean" Metre
        |application| error(application.own_place_error_m, |error| error.mean);
    FIELD_ERROR_MEAN "field_error.mean" Plain |application| error(application.field_error, |error| error.mean);
    LEVEL "level" Plain |application| application.level;
    LARGEST_VALUE "largest_value" Plain |application| application.largest_value;
    ARRIVALS "arrivals" Count |application| application.arrived.map(|_| count(application.arrivals.len() as u64));
    ARRIVED_TWICE "arrived_twice" Outcome
        |application| flag(application.arrived.map(|_| application.arrivals.len() > 1));
    SECOND_ARRIVAL_S "second_arrival_s" Second |application| Some(application.arrivals.get(1)?.time_s);
    LEAST_ARRIVAL_VALUE "least_arrival_value" Plain least_arrival_value;
    LAW_MINIMUM_S "law_minimum_s" Second |application| application.law_minimum_s;
    PATH_LENGTH_M "path_length_m" Metre |application| Some(application.path_length_m);
    MESSAGES_SENT "messages.sent" Count |application| Some(count(application.messages.sent));
    MESSAGES_SENT_PER_S "messages.sent_per_s" PerSecond
        |application| per_second(application, count(application.messages.sent));
    MESSAGES_OCTETS "messages.octets" Count |application| application.messages.octets.map(count);
    ENERGY_TOTAL_J "energy_j.total" Joule |application| Some(energy_j(application.energy_j));
    ENERGY_TX_J "energy_j.tx" Joule |application| Some(application.energy_j.tx);
    ENERGY_RX_J "energy_j.rx" Joule |application| Some(application.energy_j.rx);
}}
