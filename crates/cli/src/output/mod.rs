//! The files that a command leaves: whole or not at all, each with a name of its own.

mod distinct;
mod draft;
mod whole;

pub(crate) use distinct::refuse_shared;
pub(crate) use draft::{Draft, DraftError};
pub(crate) use whole::{write_file, write_whole};
