//! How many threads a user may ask for.

/// The most threads that may be asked for: more are surely a mistake.
pub const MOST_THREADS: usize = 1024;
