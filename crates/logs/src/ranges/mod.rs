//! Measured ranges.

pub(crate) mod range_table;
