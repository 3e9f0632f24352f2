//! The command line of Sextant: scenario files, commands, recordings, tables.
//!
//! Input: the arguments of a command and the files that they name. Output: recordings, summaries, tables and an exit
//! code. The library crates do the work; this crate reads, prints and writes.
//!
//! ```
//! let folder = std::env::temp_dir();
//! let missing = folder.join("no-such-scenario.toml");
//! let errors = sextant::scenario::Scenario::load(&missing, &[], None).err().expect("there is no such file");
//! assert!(errors.to_string().starts_with("there is no file"));
//! ```

pub mod commands;
pub mod diagnostic;
pub mod figure;
pub mod interrupt;
pub mod mapping;
mod mcap_file;
pub mod measure;
mod output;
pub mod recording;
pub mod reproduce;
pub mod robot_log;
mod robot_names;
pub mod run;
pub mod scenario;
pub mod summary;
pub mod sweep;
pub mod terminal;
mod text;
