//! A picture with the name of its file.

use std::io;
use std::path::{Path, PathBuf};

use super::paint;
use super::picture::Picture;

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

    /// Writes it into `folder` and returns where: first beside it, then renamed, so that the file is whole.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn write(&self, folder: &Path, format: FileFormat) -> io::Result<PathBuf> {
        let path = folder.join(format!("{}.{}", self.name, format.extension()));
        let part = folder.join(format!("{}.{}.part", self.name, format.extension()));
        let bytes = match format {
            FileFormat::Svg => paint::svg(&self.picture)?.into_bytes(),
            FileFormat::Png => paint::png(&self.picture)?,
        };
        match std::fs::write(&part, bytes).and_then(|()| std::fs::rename(&part, &path)) {
            Ok(()) => Ok(path),
            Err(error) => {
                // Only the error that came first is worth telling.
                let _ = std::fs::remove_file(&part);
                Err(error)
            }
        }
    }
}
