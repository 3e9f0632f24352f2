//! Maps of logs whose truth the tests alone know.

mod calibration;
mod comparators;
mod ml_tm;
mod profiles;
mod self_calibrated;
