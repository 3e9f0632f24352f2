//! Pictures of one run: the network with the way of the robot, a map, or the ways of a search.

use std::path::Path;

use super::variant::flat_name;
use sextant_recording::disk;
use sextant_recording::output::{OutputError, write_file};

/// A picture of the first run of a scenario, as `sextant figure` draws it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// The scenario.
    pub scenario: String,
    /// The name of the figure, such as `network`, `map-ml-tm` or `application-detarsk`.
    pub figure: String,
    /// What it shows.
    pub title: String,
}

/// The folder with the figures of one run of each scenario, in the folder of a reproduction.
pub const FIGURES: &str = "figures";

impl Picture {
    /// Its file in the folder of a reproduction.
    #[must_use]
    pub fn file(&self) -> String {
        format!("{FIGURES}/{}/{}.svg", flat_name(&self.scenario), self.figure)
    }

    /// Copies it from an earlier reproduction in the folder `from` to that in `out`. Returns whether it is there.
    ///
    /// # Errors
    /// If it cannot be copied.
    pub fn copy(&self, from: &Path, out: &Path) -> Result<bool, OutputError> {
        let (old, new) = (from.join(self.file()), out.join(self.file()));
        if !old.is_file() {
            return Ok(false);
        }
        if let Some(folder) = new.parent() {
            disk::create_folders(folder).map_err(|error| OutputError::new(folder, &error))?;
        }
        let svg = std::fs::read(&old).map_err(|error| OutputError::new(&old, &error))?;
        write_file(&new, &svg)?;
        Ok(true)
    }
}
