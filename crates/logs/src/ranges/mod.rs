//! Measured ranges.

pub(crate) mod dwm1001;
pub(crate) mod levers;
mod odd_values;
pub(crate) mod range_table;
pub(crate) mod units;
