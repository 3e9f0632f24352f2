//! What was measured between tags and receivers at known places.

mod of_log;
mod reading_table;
pub(crate) mod readings;
mod repeated;
