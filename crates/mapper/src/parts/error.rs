//! Errors of maps part by part.

use std::error::Error;

use sextant_kernel::Interrupted;

use crate::error::MapError;

/// Why a log cannot be mapped part by part.
#[derive(Debug, thiserror::Error)]
pub enum PartsError {
    /// The map cannot be computed.
    #[error(transparent)]
    Map(#[from] MapError),
    /// A part of the log cannot be read. Holds the error of whoever reads it.
    #[error(transparent)]
    Read(Box<dyn Error + Send + Sync>),
}

impl From<Interrupted> for PartsError {
    fn from(interrupted: Interrupted) -> Self {
        Self::Map(interrupted.into())
    }
}
