//! Whole pictures, each of a source of data.

pub(crate) mod antenna;
mod applications;
mod errors;
pub(crate) mod gallery;
pub(crate) mod maps;
pub(crate) mod networks;
pub(crate) mod packets;
pub(crate) mod source;
