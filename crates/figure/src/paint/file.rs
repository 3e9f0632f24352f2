//! A picture and its file.

use std::io;
use std::path::{Path, PathBuf};

use super::backend;
use super::picture::Picture;
use sextant_recording::output::write_whole;

/// The format of a picture file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FileFormat {
    /// Vector graphics
    #[default]
    Svg,
    /// Pixels, 192 per inch
    Png,
}

impl FileFormat {
    /// The extension of file names.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
        }
    }
}

/// A picture and the name of its file, without extension.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    pub(crate) name: String,
    pub(crate) picture: Picture,
}

impl Figure {
    /// The name of its file, without extension; unique in a recording.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Writes the picture to a file in `folder` and returns the path. The file is written completely or not at all.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, folder: &Path, format: FileFormat) -> io::Result<PathBuf> {
        let path = self.path(folder, format);
        write_whole(&path, &self.encode(format)?)?;
        Ok(path)
    }

    /// The path of its file in `folder`.
    #[must_use]
    pub fn path(&self, folder: &Path, format: FileFormat) -> PathBuf {
        folder.join(format!("{}.{}", self.name, format.extension()))
    }

    /// The contents of its file.
    ///
    /// # Errors
    /// If the picture cannot be encoded.
    pub fn encode(&self, format: FileFormat) -> io::Result<Vec<u8>> {
        match format {
            FileFormat::Svg => backend::svg(&self.picture).map(String::into_bytes),
            FileFormat::Png => backend::png(&self.picture),
        }
    }
}
