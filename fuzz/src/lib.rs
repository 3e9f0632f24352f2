//! Fuzz targets: what reads, maps and simulates, given any octets.
//!
//! A [`Target`] is a function of octets that panics if a property does not hold. `fuzz/run.sh` looks for such octets, guided by
//! coverage. `cargo test` replays those that are kept: the seeds in `fuzz/corpus`, and every input in `fuzz/crashes` that
//! once broke a property. How to run a target is in `docs/fuzzing.md`.
//!
//! ```
//! let target = sextant_fuzz::target("frames").expect("it is a target");
//! target.run(b"\x41\x88\x01\xcd\xab\xff\xff\x01\x00");
//! ```

mod budget;
mod named_texts;
mod properties;
mod scratch;
mod targets;
mod threads;

pub use targets::{TARGETS, Target, target};
