//! Whole logs: what form a log has, where its parts are, and how they are read and written.

mod companions;
mod drive;
pub(crate) mod file_names;
mod form;
mod layout;
pub(crate) mod memory_log;
pub(crate) mod names;
pub(crate) mod part_name;
mod recognition;
pub(crate) mod row_log;
pub(crate) mod source;
mod stop_files;
mod stop_log;
pub(crate) mod tags;
pub(crate) mod writing;
