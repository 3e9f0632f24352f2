//! benches

pub mod queue_candidates;
