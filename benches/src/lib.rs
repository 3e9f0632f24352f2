//! Benchmarks and tables of times, with the inputs that they share.

pub mod estimators;
pub mod folders;
pub mod laws;
pub mod measured;
pub mod regret;
pub mod simulated;
pub mod sites;
pub mod workload;
