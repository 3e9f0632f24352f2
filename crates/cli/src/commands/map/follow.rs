//! `sextant map --follow`: maps a log again whenever it has grown, and shows the map in a browser.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, SystemTime};

use sextant::mapping::{ComputedMap, Input};
use sextant_channel::Position;
use sextant_kernel::text::counted;
use sextant_report::Report;

use super::Arguments;
use crate::commands::with_flags;
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::live::{BrowserView, Document, Place, Story};
use crate::terminal::{Watcher, say};

/// A signal is noticed this often.
const LOOK: Duration = Duration::from_millis(50);
/// Folders in a log are looked into so far.
const DEPTH: usize = 3;

/// Shows the map until somebody ends the program.
pub(super) fn execute(arguments: &Arguments, interrupt: &Interrupt) -> Result<(), Failure> {
    // What is wrong with the flags or with the log as it is now is told at once.
    let mut story = LogStory::new(arguments, interrupt);
    if arguments.log.exists() {
        let _keeper = interrupt.keep();
        story.ready = Some(story.next()?);
    }
    let title = super::title(&arguments.log);
    let place = Place { host: &arguments.host, port: arguments.port, title: &title };
    let view = BrowserView::start(place, story, None)?;
    arguments.work.note(&format!("the map is shown at {}; Ctrl-C ends it", view.address(&arguments.host)));
    let _keeper = interrupt.keep();
    while !interrupt.is_requested() {
        thread::sleep(LOOK);
    }
    Ok(())
}

/// The places of the nodes on the first map, by their names.
type Places = BTreeMap<String, Position>;
/// Sizes of files and when they were changed.
type Sizes = BTreeMap<PathBuf, (u64, Option<SystemTime>)>;

/// The story of a log that grows.
struct LogStory {
    arguments: Arguments,
    interrupt: Interrupt,
    /// The files of the last document.
    sizes: Option<Sizes>,
    places: Places,
    /// A document that nobody has seen yet.
    ready: Option<Document>,
}

impl LogStory {
    fn new(arguments: &Arguments, interrupt: &Interrupt) -> Self {
        let (arguments, interrupt) = (arguments.clone(), interrupt.clone());
        Self { arguments, interrupt, sizes: None, places: Places::new(), ready: None }
    }

    /// The document of the log as it is; the next one tells what is new since then.
    fn next(&mut self) -> Result<Document, Failure> {
        self.sizes = Some(self.sizes());
        let (document, places) = self.mapped()?;
        self.places = places;
        Ok(document)
    }

    fn sizes(&self) -> Sizes {
        let mut sizes = Sizes::new();
        let files = [Some(self.arguments.log.as_path())].into_iter().chain(self.arguments.reading.files());
        for file in files.flatten() {
            // A file that cannot be looked at is told of when it is read.
            let _ = look(file, DEPTH, &mut sizes);
        }
        sizes
    }

    /// The report of the log as it is, and what is new in it.
    fn mapped(&self) -> Result<(Document, Places), Failure> {
        let Arguments { log, network, algorithm, profile, overrides, .. } = &self.arguments;
        let network = network.as_deref();
        let mut input = Input::read(log, network, &self.arguments.reading.options())?;
        let settings = input.map_settings(*algorithm, profile.as_deref(), network, &overrides.set)?;
        self.arguments.know(&mut input, &settings)?;
        let watcher = Watcher::new(&self.interrupt, true);
        let mapped = Report::of_log(&super::title(log), &mut input, &settings, with_flags, &watcher)?;
        let (report, maps) = mapped.ok_or(Failure::Interrupted)?;
        let places = maps.first().map(|map| places(&input, map)).unwrap_or_default();
        let news = news(input.log().stops().len(), &self.places, &places);
        Ok((Document { text: report.to_json(), news: Some(news) }, places))
    }
}

/// The places of a map.
fn places(input: &Input, map: &ComputedMap<'_>) -> Places {
    let positions = map.map.positions().into_iter().enumerate();
    positions.filter_map(|(node, place)| Some((input.log().names().get(node)?.clone(), place?))).collect()
}

/// What changed since the last map, in a sentence.
fn news(stops: usize, before: &Places, places: &Places) -> String {
    let heard = format!("{}, {} on the map", counted(stops, "stop"), counted(places.len(), "node"));
    if before.is_empty() {
        return heard;
    }
    let moved = |(name, place): (&'_ String, &Position)| Some((place.distance_m(*before.get(name)?), name.clone()));
    let mut moves: Vec<(f64, String)> = places.iter().filter_map(moved).collect();
    moves.sort_by(|a, b| a.0.total_cmp(&b.0));
    let new = places.keys().filter(|name| !before.contains_key(*name)).count();
    let gone = before.keys().filter(|name| !places.contains_key(*name)).count();
    let counts = [(new, "new"), (gone, "no longer on it")].into_iter().filter(|(count, _)| *count > 0);
    let counts: String = counts.map(|(count, what)| format!("; {} {what}", counted(count, "node"))).collect();
    let moved = match (moves.get(moves.len() / 2), moves.last()) {
        (Some((half_m, _)), Some((most_m, name))) => {
            format!("; half of the places moved by {half_m:.2} m or less, `{name}` most, by {most_m:.2} m")
        }
        _ => String::new(),
    };
    heard + &counts + &moved
}

impl Story for LogStory {
    fn has_more(&mut self) -> bool {
        self.ready.is_some() || self.sizes.as_ref() != Some(&self.sizes())
    }

    fn is_told_elsewhere(&self) -> bool {
        !self.arguments.work.quiet
    }

    fn document(&mut self, _is_last: bool) -> Result<Option<Document>, String> {
        let made = self.ready.take().map_or_else(|| self.next(), Ok);
        let told = match &made {
            Ok(document) => document.news.clone().unwrap_or_default(),
            // A line that is being written is whole at the next look.
            Err(failure) => format!("the log cannot be mapped as it is now: {}", failure.text()),
        };
        if !self.arguments.work.quiet {
            say(&told);
        }
        made.map(Some).map_err(|_| told)
    }
}

/// Notes the files at `path` and in folders below it.
fn look(path: &Path, depth: usize, sizes: &mut Sizes) -> io::Result<()> {
    let about = fs::metadata(path)?;
    if !about.is_dir() {
        sizes.insert(path.to_owned(), (about.len(), about.modified().ok()));
    } else if depth > 0 {
        for entry in fs::read_dir(path)? {
            look(&entry?.path(), depth - 1, sizes)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(places: &[(&str, f64)]) -> Places {
        places.iter().map(|&(name, x_m)| (name.to_owned(), Position::new(x_m, 0.0, 0.0))).collect()
    }

    #[test]
    fn what_changed_is_told_by_numbers_and_by_the_node_that_moved_most() {
        let before = at(&[("a", 0.0), ("b", 0.0), ("c", 0.0), ("gone", 0.0)]);
        let now = at(&[("a", 0.1), ("b", 0.2), ("c", 3.0), ("new", 0.0)]);
        assert_eq!(news(5, &Places::new(), &now), "5 stops, 4 nodes on the map");
        let changed = "6 stops, 4 nodes on the map; 1 node new; 1 node no longer on it; half of the places moved by 0.20 m \
                       or less, `c` most, by 3.00 m";
        assert_eq!(news(6, &before, &now), changed);
    }

    #[test]
    fn files_in_folders_are_looked_at_too() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("bag")).unwrap();
        fs::write(folder.path().join("bag/part.mcap"), "abc").unwrap();
        let mut sizes = Sizes::new();
        look(folder.path(), DEPTH, &mut sizes).unwrap();
        assert_eq!(sizes.values().map(|size| size.0).collect::<Vec<_>>(), [3]);
    }
}
