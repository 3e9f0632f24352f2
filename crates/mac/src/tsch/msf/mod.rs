//! The minimal scheduling function of 6TiSCH (MSF, RFC 9033): cells that stations know by addresses, and cells that they agree on.
//!
//! Goes in: who the parent is, what was sent in cells to it, messages of neighbours ([`SixP`](super::SixP)), and the number of the
//! slot. Comes out: messages to neighbours and cells. Random numbers are arguments.

mod autonomous;
mod counters;
mod machine;
mod negotiated;
mod peer;
mod rules;
#[cfg(test)]
mod tests;
mod transactions;

pub use autonomous::Autonomous;
pub use machine::Msf;
pub use peer::Ended;
pub use rules::{MsfRules, MsfUse};
