//! The tables of the thesis that are reproduced, in its order.

use std::collections::BTreeMap;
use std::num::NonZeroU32;

use super::expansion;
use super::experiment::Experiment;
use super::runs::RunCounts;
use super::variant::Variant;

/// A chapter: its number, what its tables share, and the tables, each with the name of its file.
struct Chapter {
    number: u8,
    shared: &'static str,
    tables: &'static [(&'static str, &'static str)],
}

macro_rules! text {
    ($chapter:literal, $name:literal) => {
        include_str!(concat!("../tables/", $chapter, "/", $name, ".toml"))
    };
}

macro_rules! chapter {
    ($number:literal, $chapter:literal: $($name:literal),* $(,)?) => {
        Chapter {
            number: $number,
            shared: text!($chapter, "shared"),
            tables: &[$((concat!($chapter, "/", $name), text!($chapter, $name))),*],
        }
    };
}

const CHAPTERS: [Chapter; 5] = [
    chapter!(3, "chapter_3":
        "3.2-worked-example",
        "3.3-trajectories",
        "3.5-sensitivity",
        "3.6-comparison",
        "3.12-space",
        "energy",
    ),
    chapter!(4, "chapter_4": "4.5-sectors", "4.8-comparison", "4.10-energy"),
    chapter!(5, "chapter_5":
        "5.3-scattering",
        "5.6-static",
        "5.9-heard",
        "5.10-hybrid",
        "5.11-comparison",
        "5.12-energy",
    ),
    chapter!(6, "chapter_6":
        "6.1-time",
        "6.ways",
        "6.elements",
        "6.3-prediction",
        "6.6-distance",
        "6.messages",
        "6.maps",
        "6.filters",
        "6.sensors",
    ),
    chapter!(7, "chapter_7": "7.5-slow-robot", "7.8-two-sources", "7.9-gradient", "7.11-room", "seek"),
];

/// All experiments, in the order of the thesis.
///
/// # Panics
/// Never: the files of the tables are part of the program, and a test reads all of them.
#[must_use]
pub fn experiments() -> Vec<Experiment> {
    let mut all = Vec::new();
    for Chapter { number, shared, tables } in &CHAPTERS {
        for (name, text) in *tables {
            all.extend(
                expansion::experiments(text, shared, *number).unwrap_or_else(|error| panic!("{name}: {error}")),
            );
        }
    }
    all
}

/// How often each scenario is run if the user does not choose: the most that an experiment wants, so that it does not depend
/// on which experiments are chosen.
#[must_use]
pub fn usual_runs() -> RunCounts {
    let mut counts: BTreeMap<Variant, NonZeroU32> = BTreeMap::new();
    for experiment in experiments() {
        let shipped = experiment.shipped().into_iter().map(|variant| (variant, experiment.runs));
        let of_readings = experiment.of_readings().into_iter().map(|variant| (variant, experiment.reading_runs));
        for (variant, runs) in shipped.chain(of_readings) {
            let most = counts.entry(variant).or_insert(runs);
            *most = runs.max(*most);
        }
    }
    RunCounts::Usual(counts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_read() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tables");
        let mut files = Vec::new();
        for chapter in std::fs::read_dir(folder).unwrap() {
            let chapter = chapter.unwrap();
            if chapter.path().is_file() {
                continue;
            }
            for file in std::fs::read_dir(chapter.path()).unwrap() {
                let (chapter, file) = (chapter.file_name(), file.unwrap().file_name());
                files.push(format!("{}/{}", chapter.to_str().unwrap(), file.to_str().unwrap()));
            }
        }
        let tables = CHAPTERS.iter().flat_map(|chapter| chapter.tables);
        let mut read: Vec<_> = tables.map(|(name, _)| format!("{name}.toml")).collect();
        read.extend((3..8).map(|chapter| format!("chapter_{chapter}/shared.toml")));
        files.sort();
        read.sort();
        assert_eq!(read, files);
    }
}
