//! Two sources, one after the other (section 7.4.1, figure 7.8).

use super::super::claim::{Check, Claim};
use super::super::experiment::{Content, Experiment};
use super::super::line::Line;
use super::super::published::Published;
use super::super::runs::Runs;
use super::method::{METHODS, Method, Snr};
use super::seeking::{DEFINITIONS, MOST, Seeking, TIME_S, TRUE_LEVEL, TRUE_VALUE};
use sextant::summary::measures::application;

const TWO_SOURCES: Seeking =
    Seeking { scenario: "seek/two-sources.toml", place: "", methods: METHODS, snrs: &[Snr::NoOffsets, Snr::Db20] };

pub(super) fn experiment() -> Experiment {
    Experiment {
        id: "7.8",
        title: "Two sources, which a robot removes one after the other",
        content: Content::Computed { scenarios: &[TWO_SOURCES.scenario], lines, figures: |_| Vec::new() },
        distributions: &[],
        charts: Vec::new(),
        claims: METHODS.iter().flat_map(|method| TWO_SOURCES.snrs.iter().map(|&snr| claim(method, snr))).collect(),
        notes: &[
            DEFINITIONS,
            "The thesis gives neither start nor speed; ours are (50, 55) and 1 m/s. It does not say how the traces of a removed source fade; \
             here they stay for 40 s. After 600 s a robot gives up.",
        ],
    }
}

fn claim(method: &'static Method, snr: Snr) -> Claim {
    let published =
        (snr == Snr::NoOffsets && method.is_level_set()).then(|| Published::new("both sources", "figure 7.8"));
    Claim {
        text: format!("more than two in three runs arrive twice, {}, {}", method.name, snr.words()),
        published,
        check: Check::Above(TWO_SOURCES.term(method, snr, &application::ARRIVED_TWICE), MOST),
    }
}

fn lines(runs: &Runs) -> Vec<Line> {
    let mut lines = Vec::new();
    for (&snr, &method) in TWO_SOURCES.snrs.iter().flat_map(|snr| METHODS.iter().map(move |method| (snr, method))) {
        let is_published = snr == Snr::NoOffsets && method.is_level_set();
        let published = |value: &str, source| is_published.then(|| Published::new(value, source));
        let share =
            |what, number, counts: &dyn Fn(f64) -> bool| TWO_SOURCES.share(runs, (what, method, snr), number, counts);
        let second = &application::SECOND_ARRIVAL_S;
        lines.extend([
            share("runs that arrived twice", &application::ARRIVED_TWICE, &|is| is > 0.5),
            share("runs whose arrivals all have a true value of at least 8.5", TRUE_VALUE, &|value| {
                value >= TRUE_LEVEL
            }),
            TWO_SOURCES.mean(runs, ("first arrival", method, snr), TIME_S, published("76", "figure 7.8")),
            TWO_SOURCES.mean(runs, ("second arrival", method, snr), second, published("160", "figure 7.8")),
        ]);
    }
    lines
}
