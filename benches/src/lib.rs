//! benches

pub mod queue_candidates;
pub mod workload;
