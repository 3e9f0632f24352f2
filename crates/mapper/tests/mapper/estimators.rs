//! The estimators that map a log of receptions.

use sextant_mapper::{AlgorithmConfig, AnyLog};

/// Those that need measured ranges, or sectors of an antenna.
const OF_OTHER_LOGS: [&str; 4] = ["range-ml", "time-of-arrival", "time-difference", "angle-of-arrival"];

/// All others that can be named without settings.
pub(crate) fn of_receptions() -> impl Iterator<Item = AnyLog> {
    AlgorithmConfig::of_any_log().into_iter().filter(|any_log| !OF_OTHER_LOGS.contains(&any_log.name))
}
