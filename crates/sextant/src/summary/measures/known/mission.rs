//! The numbers of an application.

use std::sync::LazyLock;

use super::{Count, Joule, KnownMeasure, Made, Metre, Second, Share, known};
use crate::summary::SEARCH_INSTANTS_S;
use crate::summary::Unit::{BitPerSecond, Decibel, Outcome, PerSecond, Plain};

/// Of any application.
pub(super) const MISSION: &[KnownMeasure<'static>] = &[
    known("captured", Outcome, "share of runs that captured all targets"),
    known("arrived", Outcome, "share of runs that arrived: at the level, the source or the end of the way"),
    known("time_s", Second, "time to the last capture, the first arrival or the end of the way"),
    known("sim_time_s", Second, "simulated time of the application"),
    known("captures", Count, "targets captured"),
    known("map_error_m", Metre, "mean error of the map of the application"),
    known("prediction_error_m.mean", Metre, "mean error of predicted places of targets"),
    known("prediction_error_m.median", Metre, "median error of predicted places of targets"),
    known("prediction_error_m.p90", Metre, "90th percentile of the error of predicted places of targets"),
    known("own_place_error_m.mean", Metre, "mean error of the places of robots"),
    known("field_error.mean", Plain, "mean error of worked-out values of the field"),
    known("source_m", Metre, "distance of the nearest source at the first arrival"),
    known("level", Plain, "level that was sought"),
    known("largest_value", Plain, "largest true value where a robot was"),
    known("arrivals", Count, "arrivals at the level"),
    known("arrived_twice", Outcome, "share of runs with a second arrival"),
    known("second_arrival_s", Second, "time to the second arrival"),
    known("least_arrival_value", Plain, "least true value at an arrival"),
    known("law_minimum_s", Second, "least time in which the control law can reach the level in the exact field"),
    known("missed_detections", Count, "passages of targets that sensors missed"),
    known("false_detections", Count, "detections of targets that were not there"),
    known("path_length_m", Metre, "length of the paths of all its robots"),
    known("messages.sent", Count, "frames on air: without repetitions"),
    known("messages.sent_per_s", PerSecond, "frames on air per second: without repetitions"),
    known("messages.octets", Count, "octets of all payloads"),
    known("energy_j.total", Joule, "energy of nodes"),
    known("energy_j.tx", Joule, "energy of nodes for transmitting"),
    known("energy_j.rx", Joule, "energy of nodes for receiving"),
];

/// Of robots that keep a link.
pub(super) const LINK: &[KnownMeasure<'static>] = &[
    known("link.throughput_bit_per_s", BitPerSecond, "payload over the link that robots keep"),
    known("link.ideal_throughput_bit_per_s", BitPerSecond, "payload with the best sectors at any time"),
    known("link.outage", Share, "outage: share of the data time without a scheme that is received"),
    known("link.ideal_outage", Share, "outage with the best sectors at any time"),
    known("link.overhead", Share, "share of the time that trainings of beams take"),
    known("link.snr_loss_db", Decibel, "mean loss of the link against the best sectors"),
    known("link.frames_lost", Share, "share of the data frames that were not received"),
    known("link.searches", Count, "trainings with all sectors"),
    known("link.near_trainings", Count, "trainings with the sectors round a predicted one"),
    known("link.failed_trainings", Count, "trainings that left a robot without a link"),
    known("link.handovers", Count, "links that went on to another node"),
];

/// Of a search for targets: its course, at each of the instants.
pub(super) static COURSE: LazyLock<Vec<Made>> = LazyLock::new(|| {
    let numbers = [
        ("distance_to_target_m", "distance of robots to the nearest target", ": 0 once all are captured"),
        ("prediction_error_m", "mean error of predicted places since the instant before,", ""),
    ];
    let at = |(what, words, more): (&str, &str, &str)| {
        SEARCH_INSTANTS_S.map(|time_s| Made {
            path: format!("{what}.at_{time_s}_s"),
            unit: Metre,
            meaning: format!("{words} after {time_s} s{more}"),
        })
    };
    numbers.into_iter().flat_map(at).collect()
});
