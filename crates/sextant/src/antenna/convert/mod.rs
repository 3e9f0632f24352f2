//! Measurements of antennas in other formats, as code books.

mod angles;
mod arrays;
mod book;
mod error;
#[cfg(test)]
mod files_tests;
mod foreign;
mod gain_unit;
mod mat;
mod names;
mod ns3;
mod planet;
mod table;
#[cfg(test)]
mod tests;

use std::path::Path;

use sextant_kernel::{LARGEST_FILE, read_at_most};

pub use book::ConvertedBook;
pub use error::ConvertError;
pub use gain_unit::GainUnit;
pub use names::{AngleUnit, ArrayOrder, SourceNames, Turning};

use angles::AngleNames;
use book::Rows;
use names::Format;

/// Reads the measurement in the file `path` and makes a code book of it: a MATLAB file (`.mat`, version 5 to 7.2) with
/// vectors and an array of gains, a table (`.csv`, `.tsv`, `.txt`) with a row for each sector and direction, with a
/// column for each sector, or of one pattern, a code book of ns-3 in numbers, or a pattern of MSI and Planet (`.msi`, `.pln`).
///
/// What the angles are measured in and from, and the unit of the gains, must follow from their names or be given. Azimuths are turned into −180 to 180 degrees. Several gains of one direction become their mean in decibels. Gaps stay
/// gaps.
///
/// # Errors
/// If the file cannot be read, it does not say what is needed, or an option has no effect; the message names what it has.
pub fn convert(path: &Path, names: &SourceNames, unit: Option<GainUnit>) -> Result<ConvertedBook, ConvertError> {
    let octets = read_at_most(path, LARGEST_FILE)
        .map_err(|cause| ConvertError::Unreadable { path: path.to_owned(), cause: cause.to_string() })?;
    let source = if octets.starts_with(b"MATLAB") {
        names.check(Format::Matlab)?;
        arrays::rows(&mat::read(&octets)?, names)?
    } else {
        if let Some(seen) = foreign::seen(path, &octets) {
            return Err(ConvertError::Foreign { path: path.to_owned(), seen });
        }
        let text = String::from_utf8_lossy(&octets);
        if planet::is_pattern(&text) {
            names.check(Format::Planet)?;
            if let Some(unit) = unit.filter(|unit| *unit != GainUnit::Dbi) {
                let allowed = "`dbi`, or nothing: such a pattern says its unit";
                return Err(ConvertError::Option { option: "unit", found: unit.word(), allowed });
            }
            planet::rows(&text, names)?
        } else if ns3::is_book(&text) {
            names.check(Format::Ns3)?;
            ns3::rows(&text)?
        } else {
            names.check(Format::Table)?;
            table::rows(&text, names)?
        }
    };
    source.book(names, unit)
}

/// The rows of a measurement, in degrees and from the horizontal plane, and the unit that the name of its gains says.
struct Source {
    rows: Rows,
    named_unit: Option<GainUnit>,
    /// What the gains are called.
    gains: String,
    notes: Vec<String>,
}

impl Source {
    fn book(self, names: &SourceNames, unit: Option<GainUnit>) -> Result<ConvertedBook, ConvertError> {
        let Self { rows, named_unit, gains, notes } = self;
        let unit = unit.or(named_unit).ok_or_else(|| rows.without_unit(&gains))?;
        rows.book(names, unit, notes)
    }
}
