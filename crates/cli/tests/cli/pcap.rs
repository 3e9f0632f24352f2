//! Captures: our own parser and tshark can read them, and a failing disk is reported.

#![expect(clippy::unwrap_used, reason = "a test fails at the first error")]

mod capture;
mod dmg;
mod failure;
mod packet;
mod run;
pub(crate) mod tshark;
