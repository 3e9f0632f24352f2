//! Benchmarks and tables of times, with the inputs that they share.

pub mod queue_candidates;
pub mod workload;
