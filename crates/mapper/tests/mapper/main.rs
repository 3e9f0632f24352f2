//! Maps of logs whose truth only the tests know.

mod bounds;
mod calibration;
mod comparators;
mod concerns;
mod features;
mod heights;
mod ml_tm;
mod mm_tm;
mod own_place;
mod parts;
mod pattern;
mod profiles;
mod real_links;
mod sectored;
mod self_calibrated;
mod stitching;
mod watched;
