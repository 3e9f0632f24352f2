//! Recordings and logs of robots: what is written comes back, and what is broken says so.

#![expect(clippy::unwrap_used, reason = "a test ends at the first surprise")]

mod damage;
mod failure;
mod python;
mod robot_log;
mod round_trip;
pub(crate) mod sample;
