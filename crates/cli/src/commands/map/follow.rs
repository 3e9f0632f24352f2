//! `sextant map --follow`: maps a log again whenever it has grown, and shows the map in a browser.

use std::collections::BTreeMap;
use std::thread;
use std::time::Duration;

use sextant::mapping::{ComputedMap, Input};
use sextant_channel::Position;
use sextant_kernel::Watch;
use sextant_kernel::text::counted;
use sextant_mapper::Mapper;
use sextant_report::Report;

use super::Arguments;
use super::growth::{Sizes, UntilGrown, sizes};
use crate::commands::with_flags;
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::live::{APART, BrowserView, Document, Place, SHARE, Story};
use crate::terminal::{Watcher, say};

/// A signal is noticed this often.
const LOOK: Duration = Duration::from_millis(50);
/// What is told with a quick map.
const QUICK: &str = "quick map: the whole one follows when the log rests";

/// Shows the map until somebody ends the program.
pub(super) fn execute(arguments: &Arguments, interrupt: &Interrupt) -> Result<(), Failure> {
    // What is wrong with the flags or with the log as it is now is told at once.
    let mut story = LogStory::new(arguments, interrupt);
    if arguments.log.exists() {
        let _keeper = interrupt.keep();
        story.ready = story.next()?;
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

/// The story of a log that grows. A quick map follows each growth at once, with what the last map learned; the whole one, as
/// without `--follow`, when the log rests.
struct LogStory {
    arguments: Arguments,
    interrupt: Interrupt,
    /// The files of the last document.
    sizes: Option<Sizes>,
    places: Places,
    /// The mappers of a quick map: those of the last one, after what they learned. Empty if one of them always begins from the
    /// start.
    quick: Vec<Mapper>,
    /// Whether the last map was made from the start.
    is_whole: bool,
    /// A document that nobody has seen yet.
    ready: Option<Document>,
}

impl LogStory {
    fn new(arguments: &Arguments, interrupt: &Interrupt) -> Self {
        let (arguments, interrupt) = (arguments.clone(), interrupt.clone());
        let (places, quick) = (Places::new(), Vec::new());
        Self { arguments, interrupt, sizes: None, places, quick, is_whole: true, ready: None }
    }

    /// The document of the log as it is; the next one tells what is new since then. `None` if the log grew before its whole map
    /// was made.
    fn next(&mut self) -> Result<Option<Document>, Failure> {
        let now = sizes(&self.arguments);
        self.is_whole = self.quick.is_empty() || self.sizes.as_ref() == Some(&now);
        let watcher = Watcher::new(&self.interrupt, true);
        let made = if self.is_whole && !self.quick.is_empty() {
            self.mapped(&UntilGrown::new(watcher, &self.arguments, &now))
        } else {
            self.mapped(&watcher)
        };
        self.sizes = Some(now);
        let Some(made) = made? else { return Ok(None) };
        (self.places, self.quick) = (made.places, made.quick);
        Ok(Some(made.document))
    }

    /// The report of the log as it is, and what is new in it. `None` if the log grew.
    fn mapped(&self, watch: &dyn Watch) -> Result<Option<Made>, Failure> {
        let Arguments { log, network, algorithm, profile, overrides, .. } = &self.arguments;
        let network = network.as_deref();
        let mut input = Input::read(log, network, &self.arguments.reading.options())?;
        let mut settings = input.map_settings(*algorithm, profile.as_deref(), network, &overrides.set)?;
        if !self.is_whole {
            settings.maps.iter_mut().zip(&self.quick).for_each(|(job, quick)| job.mapper = quick.clone());
        }
        self.arguments.know(&mut input, &settings)?;
        let mapped = Report::of_log(&super::title(log), &mut input, &settings, with_flags, watch)?;
        let Some((report, maps)) = mapped else {
            return if self.interrupt.is_requested() { Err(Failure::Interrupted) } else { Ok(None) };
        };
        let quick: Option<Vec<Mapper>> =
            maps.iter().map(|map| map.named.mapper.after(map.learned.as_ref()?)).collect();
        let places = maps.first().map(|map| places(&input, map)).unwrap_or_default();
        let news = news(input.log().stops().len(), &self.places, &places);
        let news = if self.is_whole { news } else { format!("{news}; {QUICK}") };
        let document = Document { text: report.to_json(), news: Some(news) };
        Ok(Some(Made { document, places, quick: quick.unwrap_or_default() }))
    }
}

/// A document, and what the next one begins with.
struct Made {
    document: Document,
    places: Places,
    quick: Vec<Mapper>,
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
        self.ready.is_some() || !self.is_whole || self.sizes.as_ref() != Some(&sizes(&self.arguments))
    }

    fn is_told_elsewhere(&self) -> bool {
        !self.arguments.work.quiet
    }

    fn rest(&self, took: Duration) -> Duration {
        // What is quick follows at once.
        if self.quick.is_empty() { APART.max(took * SHARE) } else { APART }
    }

    fn document(&mut self, _is_last: bool) -> Result<Option<Document>, String> {
        let made = self.ready.take().map_or_else(|| self.next(), |ready| Ok(Some(ready)));
        let told = match &made {
            Ok(None) => return Ok(None),
            Ok(Some(document)) => document.news.clone().unwrap_or_default(),
            // A line that is being written is whole at the next look.
            Err(failure) => format!("the log cannot be mapped as it is now: {}", failure.text()),
        };
        if !self.arguments.work.quiet {
            say(&told);
        }
        made.map_err(|_| told)
    }
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
}
