//! Times of logs, exact to the nanosecond, and the zones that they are in.

pub(crate) mod instant;
pub(crate) mod time_zone;
