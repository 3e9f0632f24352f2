//! Recordings and logs of robots: they are read back equal, and damage is reported.

#![expect(clippy::unwrap_used, reason = "a test fails at the first error")]

mod damage;
mod failure;
mod geodetic;
mod python;
mod robot_log;
mod round_trip;
pub(crate) mod sample;
