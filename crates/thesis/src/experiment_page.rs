//! The part of a page that one experiment has: its summary, its numbers and conclusions, and what they depend on.

use std::path::Path;

use super::agreement::Agreement;
use super::finding::Verdict;
use super::line::{Line, NamedReading};
use super::open::OpenSetting;
use super::ours::Ours;
use super::page::{PagePart, Span};
use super::readings::{Moved, Readings};
use super::results::Results;
use super::tally::Tally;
use sextant_kernel::text::counted;
use sextant_recording::output::OutputError;

/// The parts of an experiment. Its figures are in the folder `out`.
pub(crate) fn parts(of: &Results, out: &Path) -> Result<Vec<PagePart>, OutputError> {
    let mut parts = vec![PagePart::Heading(2, format!("{} {}", of.id, of.title)), made(of)];
    parts.extend(summary(of));
    let (stated, ours): (Vec<&Line>, Vec<&Line>) = of.lines.iter().partition(|line| line.published.is_some());
    if !stated.is_empty() {
        parts.push(numbers(&stated));
    }
    let (claims, claims_of_ours): (Vec<&Line>, Vec<&Line>) =
        of.conclusions.iter().partition(|line| line.published.is_some());
    if !claims.is_empty() {
        parts.push(conclusions(&claims));
    }
    parts.extend(depends(&of.readings));
    if !claims_of_ours.is_empty() {
        let summary = counted(claims_of_ours.len(), "conclusion");
        parts.push(PagePart::Folded(format!("{summary} of ours"), vec![conclusions(&claims_of_ours)]));
    }
    // Those of an experiment with published numbers are in its table alone.
    if stated.is_empty() && !ours.is_empty() {
        let summary = format!("{} that the thesis does not state", counted(ours.len(), "number"));
        parts.push(PagePart::Folded(summary, vec![own_numbers(&ours)]));
    }
    for (name, title) in &of.figures {
        let file = format!("{name}.svg");
        let path = out.join(&file);
        let svg = std::fs::read_to_string(&path).map_err(|error| OutputError::new(&path, &error))?;
        parts.push(PagePart::Figure { file, title: title.clone(), svg });
    }
    // An interrupted reproduction has not all of them.
    let pictures = of.pictures.iter().filter(|picture| out.join(picture.file()).is_file());
    let pictures: Vec<_> = pictures.map(|of| PagePart::Picture(of.file(), of.title.clone())).collect();
    if !pictures.is_empty() {
        let summary = format!("{} of the first run", counted(pictures.len(), "picture"));
        parts.push(PagePart::Folded(summary, pictures));
    }
    if !of.notes.is_empty() {
        parts.push(PagePart::List(of.notes.iter().map(|note| with_code(note)).collect()));
    }
    Ok(parts)
}

fn made(of: &Results) -> PagePart {
    let csv = format!("{}.csv", of.id);
    let mut text: Vec<Span> = vec![format!("{}. Command: ", of.runs()).into()];
    let command = if of.readings.is_empty() { String::new() } else { " --readings".to_owned() };
    text.extend([
        Span::Code(format!("sextant reproduce {}{command}", of.id)),
        ". All numbers: ".into(),
        Span::File(csv.clone(), csv),
    ]);
    if !of.readings.is_empty() {
        let csv = format!("{}-readings.csv", of.id);
        text.extend(["; under each reading: ".into(), Span::File(csv.clone(), csv)]);
    }
    text.push(".".into());
    PagePart::Text(text)
}

/// How many numbers and conclusions of the thesis have which verdict.
fn summary(of: &Results) -> Option<PagePart> {
    let tally = Tally::of_thesis([of]);
    let told = |counts: &[usize], words: Vec<&str>, what: &str| {
        let all: usize = counts.iter().sum();
        let each = counts.iter().zip(words).filter(|(count, _)| **count > 0);
        let each: Vec<_> = each.map(|(count, words)| format!("{words} {count}")).collect();
        (all > 0).then(|| format!("Of {} of the thesis: {}.", counted(all, what), each.join(", ")))
    };
    let agreements = Agreement::ALL.map(Agreement::words).to_vec();
    let verdicts = Verdict::ALL.map(Verdict::words).to_vec();
    let told = [told(&tally.numbers, agreements, "number"), told(&tally.claims, verdicts, "conclusion")]
        .into_iter()
        .flatten();
    let told: Vec<_> = told.collect();
    (!told.is_empty()).then(|| PagePart::Text(vec![told.join(" ").into()]))
}

fn table<'a>(header: &[&str], rows: impl Iterator<Item = Vec<String>> + 'a) -> PagePart {
    let rows = rows.map(|cells| cells.into_iter().map(Span::from).collect()).collect();
    PagePart::Table(header.iter().map(|&cell| cell.to_owned()).collect(), rows)
}

fn runs(line: &Line) -> String {
    line.runs().map_or_else(String::new, |runs| runs.to_string())
}

/// The verdict of a line, with the reading that it depends on.
fn verdict(line: &Line) -> String {
    let words = line.verdict().unwrap_or_default();
    match &line.reading {
        Some(NamedReading { name, ours }) if !matches!(ours, Ours::Finding(_)) => {
            format!("{words}: {name} ({})", ours.text(&line.unit))
        }
        Some(NamedReading { name, .. }) => format!("{words}: {name}"),
        None => words.to_owned(),
    }
}

fn numbers(lines: &[&Line]) -> PagePart {
    let row = |line: &&Line| {
        let [what, published, source, ours, _] = line.cells();
        vec![what, published, source, ours, runs(line), verdict(line)]
    };
    table(&["number", "published", "in", "ours (mean ± 95 % interval)", "runs", "verdict"], lines.iter().map(row))
}

fn own_numbers(lines: &[&Line]) -> PagePart {
    let row = |line: &&Line| {
        let [what, _, _, ours, _] = line.cells();
        vec![what, ours, runs(line)]
    };
    table(&["number", "ours (mean ± 95 % interval)", "runs"], lines.iter().map(row))
}

fn conclusions(lines: &[&Line]) -> PagePart {
    let row = |line: &&Line| {
        let [what, published, source, ours, _] = line.cells();
        let published = if line.published.is_some() { published } else { "ours".to_owned() };
        let margin = ours.trim_start_matches("margin ").to_owned();
        vec![what, published, source, margin, runs(line), verdict(line)]
    };
    table(&["conclusion", "published", "in", "margin", "runs", "verdict"], lines.iter().map(row))
}

/// What the thesis leaves open, and what depends on it.
fn depends(readings: &Readings) -> Vec<PagePart> {
    if readings.is_empty() {
        return Vec::new();
    }
    let mut parts = vec![
        PagePart::Heading(3, "What it depends on".to_owned()),
        PagePart::Text(vec![
            format!(
                "The thesis leaves these open. Each was tried one at a time, and some together, {}. The value that is taken \
                 stays. That another one comes near a published number is no proof that it was meant, and those of different \
                 numbers need not go together.",
                match readings.runs {
                    0 => "with the runs that are there anyway".to_owned(),
                    runs => format!("with at most {} of the same seeds", counted(runs, "run")),
                }
            )
            .into(),
        ]),
    ];
    let header = ["open", "key", "taken", "also tried", "the thesis says"].map(str::to_owned).to_vec();
    let row = |of: &OpenSetting| {
        let key = Span::Code(of.key.clone());
        vec![
            of.name.clone().into(),
            key,
            of.taken.clone().into(),
            of.values.join("; ").into(),
            of.says.clone().into(),
        ]
    };
    parts.push(PagePart::Table(header, readings.open.iter().map(row).collect()));
    if !readings.numbers.is_empty() {
        let header = ["number", "published", "ours", "range over the readings", "moved most by", "nearest"];
        parts.push(table(&header, readings.numbers.iter().map(|(_, moved)| moved_row(moved))));
    }
    let changes = |moved: &Moved| {
        let mut under: Vec<(Verdict, Vec<&str>)> = Vec::new();
        for (reading, verdict) in moved.changes() {
            match under.iter_mut().find(|(other, _)| *other == verdict) {
                Some((_, readings)) => readings.push(reading),
                None => under.push((verdict, vec![reading])),
            }
        }
        under.iter().map(|(of, readings)| format!("{}: {}", of.words(), readings.join(". Or "))).collect::<Vec<_>>()
    };
    let changed = readings.conclusions.iter().map(|(_, moved)| (moved, changes(moved)));
    let changed: Vec<_> = changed.filter(|(_, changes)| !changes.is_empty()).collect();
    if changed.is_empty() && !readings.conclusions.is_empty() {
        let all = counted(readings.conclusions.len(), "conclusion");
        parts.push(PagePart::Text(vec![format!("No reading changes any of the {all} that it could.").into()]));
    }
    if !changed.is_empty() {
        let row = |(moved, changes): &(&Moved, Vec<String>)| {
            let taken = moved.line.verdict().unwrap_or_default().to_owned();
            vec![moved.line.what.clone(), taken, changes.join(". ")]
        };
        let header = ["conclusion that changes with a reading", "as taken", "otherwise"];
        parts.push(table(&header, changed.iter().map(row)));
    }
    parts
}

fn moved_row(moved: &Moved) -> Vec<String> {
    let [what, published, _, ours, _] = moved.line.cells();
    let unit = &moved.line.unit;
    let of_unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    let range = moved.range().map_or_else(String::new, |[low, high]| format!("{low:.2} to {high:.2}{of_unit}"));
    let most = match moved.most() {
        Some((value, by)) if by.abs() >= 0.005 => format!("{} ({by:+.2}{of_unit})", value.reading),
        _ => "nothing that was tried".to_owned(),
    };
    let nearest = match moved.nearest() {
        Some(nearest) => format!("{} ({})", nearest.reading, nearest.ours.text(unit)),
        None => "the value that is taken".to_owned(),
    };
    vec![what, published, ours, range, most, nearest]
}

/// The text with what is in code marks as code.
fn with_code(text: &str) -> Vec<Span> {
    let span = |(i, part): (usize, &str)| if i % 2 == 0 { part.into() } else { Span::Code(part.to_owned()) };
    text.split('`').enumerate().map(span).collect()
}
