//! Why a measurement is no code book.

use std::path::PathBuf;

/// Why a measurement is no code book.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ConvertError {
    /// The file cannot be read.
    #[error("`{path}` cannot be read: {cause}", path = .path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: String,
    },
    /// The file is neither a MATLAB file nor a table.
    #[error("`{path}` is neither a MATLAB file (version 5 to 7.2) nor a table in text, but {seen}", path = .path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What it is.
        seen: String,
    },
    /// The MATLAB file is damaged, or of a version that is not read.
    #[error("the MATLAB file {0}")]
    Mat(String),
    /// The file has nothing by the name of something that is needed.
    #[error("no {what}: found {found}; allowed: {allowed}")]
    Missing {
        /// What is needed.
        what: &'static str,
        /// What the file has.
        found: String,
        /// The names that are known, and how to give another one.
        allowed: String,
    },
    /// The lengths of the arrays do not say which axis is which, or do not fit together.
    #[error("the array of gains is {found}; allowed: {allowed}")]
    Shape {
        /// Its dimensions, and those of the axes.
        found: String,
        /// What would fit.
        allowed: String,
    },
    /// A value is invalid.
    #[error("{place}: {found}; allowed: {allowed}")]
    Invalid {
        /// Where it is.
        place: String,
        /// The value.
        found: String,
        /// What is allowed.
        allowed: String,
    },
    /// An elevation is beyond the vertical.
    #[error("{place}: {found}; allowed: {allowed}")]
    Elevation {
        /// Where it is.
        place: String,
        /// The elevation.
        found: String,
        /// What is allowed.
        allowed: String,
    },
    /// No sector has this number.
    #[error("{place}: {found}; allowed: {allowed}")]
    Identity {
        /// Where it is.
        place: String,
        /// The number.
        found: String,
        /// What is allowed.
        allowed: String,
    },
    /// An option does not fit the format.
    #[error("option `{option}` is {found}; allowed: {allowed}")]
    Option {
        /// The option.
        option: &'static str,
        /// What was found.
        found: &'static str,
        /// What is allowed.
        allowed: &'static str,
    },
    /// Nothing says the unit of the gains.
    #[error(
        "the unit of the gains `{name}` is not known: found {found}; allowed: a given unit, `linear`, `db` or `dbi`"
    )]
    UnknownUnit {
        /// What they are called.
        name: String,
        /// Their values.
        found: String,
    },
    /// Nothing says whether angles are degrees or radians.
    #[error(
        "the unit of the angles `{name}` is not known: found {found}, as angles in radians are; allowed: a given unit, radians or degrees"
    )]
    UnknownAngles {
        /// What they are called.
        name: String,
        /// Their values.
        found: String,
    },
    /// The name of angles has another unit than the user gives.
    #[error("the angles `{name}` are in {named} by their name, but {given} are given; allowed: one of them")]
    AngleUnits {
        /// What they are called.
        name: String,
        /// The unit in the name.
        named: &'static str,
        /// The unit that is given.
        given: &'static str,
    },
    /// Nothing says what angles are measured from.
    #[error(
        "the angles `{name}` may be measured from the zenith, as in spherical coordinates, or from the horizontal plane: found \
         {found}; allowed: one of the two, given"
    )]
    UnknownOrigin {
        /// What they are called.
        name: String,
        /// Their values.
        found: String,
    },
    /// Nothing says which way azimuths turn.
    #[error(
        "the horizontal cut is not the same on both sides, and nothing says which way its azimuths turn; allowed: one of the two, \
         given, clockwise or counterclockwise seen from above"
    )]
    UnknownTurning,
    /// Several columns or variables may be the gains.
    #[error("several columns may be the gains: `{}`; allowed: the name of one of them", .found.join("`, `"))]
    SeveralGains {
        /// They.
        found: Vec<String>,
    },
}
