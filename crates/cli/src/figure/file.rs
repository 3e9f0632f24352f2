//! A picture with the name of its file.

use std::io;
use std::path::{Path, PathBuf};

use super::paint;
use super::picture::Picture;
use crate::output::write_whole;

/// A format of picture files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum FileFormat {
    /// Lines and text, for papers and pages
    #[default]
    Svg,
    /// Pixels, 192 an inch
    Png,
}

impl FileFormat {
    /// What the names of its files end in.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
        }
    }
}

/// A picture and the name of its file without the format.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    pub(super) name: String,
    pub(super) picture: Picture,
}

impl Figure {
    /// Name of its file without the format; unique in a recording.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Writes the picture to a file in `folder` and returns the path. The file is written completely or not at all.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, folder: &Path, format: FileFormat) -> io::Result<PathBuf> {
        let path = folder.join(format!("{}.{}", self.name, format.extension()));
        let bytes = match format {
            FileFormat::Svg => paint::svg(&self.picture)?.into_bytes(),
            FileFormat::Png => paint::png(&self.picture)?,
        };
        write_whole(&path, &bytes)?;
        Ok(path)
    }
}
