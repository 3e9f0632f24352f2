//! What is wrong with a floor plan.

use std::path::PathBuf;

/// Why a floor plan was not read.
#[derive(Debug, thiserror::Error)]
pub enum FloorPlanError {
    /// Its form is not known.
    #[error(
        "`{}` is not a floor plan that can be read; allowed: an image (.png, .pgm), a map of ROS (map.yaml), GeoJSON (.geojson, .json), a drawing (.dxf) or walls of a scenario (.toml)",
        path.display()
    )]
    Form {
        /// The file.
        path: PathBuf,
    },
    /// An image without a scale.
    #[error("`{}` is an image: how long is a pixel? Option `scale` says it in metres", path.display())]
    NoScale {
        /// The file.
        path: PathBuf,
    },
    /// A drawing without a unit.
    #[error("`{}` does not say the unit of its lengths ($INSUNITS): option `unit` says it", path.display())]
    NoUnit {
        /// The file.
        path: PathBuf,
    },
    /// GeoJSON whose coordinates are no longitudes and latitudes of one building, or none near the log.
    #[error("`{}`: {problem}; if its coordinates are lengths, option `unit` says their unit", path.display())]
    NotDegrees {
        /// The file.
        path: PathBuf,
        /// Why not.
        problem: String,
    },
    /// The file cannot be read.
    #[error("cannot read `{}`: {why}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        why: String,
    },
    /// The file has something wrong in it.
    #[error("`{}`: {problem}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What.
        problem: String,
    },
    /// An option is wrong.
    #[error("option `{option}` is {found}; allowed: {allowed}")]
    Option {
        /// The option.
        option: &'static str,
        /// What was found.
        found: String,
        /// What is allowed.
        allowed: String,
    },
    /// There is nothing in it.
    #[error("`{}` has no walls{}", path.display(), if notes.is_empty() { String::new() } else { format!(": {notes}") })]
    NoWalls {
        /// The file.
        path: PathBuf,
        /// What was not read.
        notes: String,
    },
}
