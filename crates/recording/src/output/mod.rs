//! Output files. Each is written completely or not at all.

mod csv_file;
mod draft;
mod error;
mod folder;
mod part_file;
mod whole;

pub use csv_file::{CsvFile, EmptyCell};
pub(crate) use draft::{Draft, DraftError};
pub use error::OutputError;
pub use folder::open_folder;
pub use part_file::PartFile;
pub use whole::{write_file, write_whole};
