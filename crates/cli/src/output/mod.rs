//! The output files of a command. Each is written completely or not at all, and no two share a name.

mod distinct;
mod draft;
mod folder;
mod whole;

pub(crate) use distinct::reject_shared;
pub(crate) use draft::{Draft, DraftError};
pub(crate) use folder::open_folder;
pub(crate) use whole::{write_file, write_whole};
