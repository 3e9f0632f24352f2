//! Output files. Each is written completely or not at all.

mod csv_file;
mod draft;
mod error;
mod folder;
pub(crate) mod foreign_folder;
mod identity;
mod part_file;
mod scratch;
pub mod store;
mod whole;

pub use csv_file::{CsvFile, EmptyCell};
pub(crate) use draft::{Draft, DraftError, Leftover, PART, RECOVERING, kept_name, part_of};
pub use error::OutputError;
pub use folder::open_folder;
pub(crate) use folder::try_folder;
pub use identity::{FileIdentity, is_claimed, plain};
pub use part_file::PartFile;
pub use scratch::open_scratch;
pub use whole::{WholeFile, write_file, write_whole};
