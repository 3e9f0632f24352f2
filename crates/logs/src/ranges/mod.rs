//! Measured ranges.

pub(crate) mod range_table;
pub(crate) mod units;
