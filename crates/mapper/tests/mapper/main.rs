//! Maps of logs whose truth only the tests know.

#![allow(clippy::disallowed_methods, reason = "oracles may be those of the C library")]

mod bounds;
mod calibration;
mod cells;
mod comparators;
mod concerns;
mod estimators;
mod features;
mod grid_sizes;
mod heights;
mod metamorphic;
mod ml_tm;
mod mm_tm;
mod own_place;
mod parts;
mod pattern;
mod profiles;
mod real_links;
mod sectored;
mod self_calibrated;
mod stitched_regions;
mod stitching;
mod watched;
