//! Figures of a run for papers and pages: from a recording to pictures, SVG or PNG.
//!
//! Goes in: the reception log of a recording and what it shows in space. Comes out: a [`Figure`] each of the network
//! with the survey, of every map, of the distribution of all maps' errors, and of every likelihood surface. The same
//! recording gives the same bytes. Colours are told apart with any colour vision: Okabe and Ito's for kinds, viridis,
//! darker for more, for numbers.
//!
//! ```no_run
//! use std::path::Path;
//! use sextant::figure::{self, FileFormat, Source};
//! use sextant::recording::{read_drawn, read_log};
//!
//! let recording = Path::new("circular.mcap");
//! let (run, drawn) = (read_log(recording)?, read_drawn(recording)?);
//! for figure in figure::all(&Source { title: "circular", log: &run.log, drawn: &drawn }) {
//!     figure.write(Path::new("."), FileFormat::Svg)?;
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod axes;
mod curves;
mod distribution;
mod likelihood;
mod map;
mod network;
mod paint;
mod palette;
mod picture;
mod sheet;
mod silhouette;
mod source;
mod ticks;
mod view;

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};

pub use curves::{Curves, Series};
use distribution::NodeError;
use picture::Picture;
pub use source::Source;

/// Strokes and gaps of several curves in turn [px].
const PATTERNS: [&[f64]; 4] = [&[], &[9.0, 4.0], &[2.5, 3.0], &[9.0, 3.0, 2.5, 3.0]];

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
    name: String,
    picture: Picture,
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
        // The encoder of pixels goes by the ending.
        let part = folder.join(format!("{}.part.{}", self.name, format.extension()));
        let written = match format {
            FileFormat::Svg => paint::svg(&self.picture).and_then(|text| std::fs::write(&part, text)),
            FileFormat::Png => paint::png(&self.picture, &part),
        };
        match written.and_then(|()| std::fs::rename(&part, &path)) {
            Ok(()) => Ok(path),
            Err(error) => {
                // Only the error that came first is worth telling.
                let _ = std::fs::remove_file(&part);
                Err(error)
            }
        }
    }
}

/// All figures of a recording: `network`, `map-NAME` for each map, `error-cdf` and `connectivity-cdf` if the true
/// places are known,
/// `likelihood-NAME-NODE` for each surface.
#[must_use]
pub fn all(source: &Source<'_>) -> Vec<Figure> {
    let mut figures = vec![("network".to_owned(), network::draw(source))];
    for (name, places) in &source.drawn.maps {
        figures.push((format!("map-{name}"), map::draw(source, name, places)));
    }
    for (name, what) in [("error-cdf", NodeError::Position), ("connectivity-cdf", NodeError::Connectivity)] {
        figures.extend(distribution::draw(source, what).map(|picture| (name.to_owned(), picture)));
    }
    for surface in &source.drawn.likelihoods {
        let name = format!("likelihood-{}-{}", surface.map, surface.node);
        figures.push((name, likelihood::draw(source, surface)));
    }
    let mut taken = BTreeSet::new();
    figures.into_iter().map(|(name, picture)| Figure { name: file_name(&name, &mut taken), picture }).collect()
}

/// `name` with what file systems do not like replaced, and a number if it is taken; systems that do not tell
/// capitals from small letters are thought of.
fn file_name(name: &str, taken: &mut BTreeSet<String>) -> String {
    const LONGEST: usize = 80;
    let plain = |letter: char| if letter.is_alphanumeric() || "-_.+".contains(letter) { letter } else { '_' };
    let name: String = name.chars().take(LONGEST).map(plain).collect();
    let numbered = |number: u32| if number == 1 { name.clone() } else { format!("{name}-{number}") };
    let free = (1..).map(numbered).find(|name| taken.insert(name.to_lowercase()));
    free.expect("one of all numbers is free")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_are_plain_and_unique() {
        let mut taken = BTreeSet::new();
        let mut name = |name| file_name(name, &mut taken);
        assert_eq!(name("likelihood-ml-tm-a/b"), "likelihood-ml-tm-a_b");
        assert_eq!(name("likelihood-ml-tm-a b"), "likelihood-ml-tm-a_b-2");
        assert_eq!(name("likelihood-ml-tm-A:b"), "likelihood-ml-tm-A_b-3");
        assert_eq!(name("map-é"), "map-é");
        assert!(name(&"x".repeat(1000)).len() < 100);
    }
}
