//! Antennas as files: what an antenna with sectors does in each direction, and measurements of others as code books.

mod book_file;
mod boresight;
mod convert;
mod coverage;

pub use book_file::{BookError, read_book};
pub use convert::{AngleUnit, ArrayOrder, ConvertError, ConvertedBook, GainUnit, SourceNames, Turning, convert};
pub use coverage::{AntennaCoverage, PatternSummary};
