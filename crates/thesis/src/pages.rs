//! The pages of a reproduction: one with the verdicts, and one for each chapter.

use std::path::Path;

use super::costs::Costs;
use super::experiment::Experiment;
use super::line::Line;
use super::page::{Page, PagePart, Span};
use super::results::Results;
use super::tables::experiments;
use super::tally::{Tally, by_chapter};
use sextant_recording::output::{OutputError, write_file};

/// Writes the pages of `results` into the folder `out`, each as Markdown and as HTML: `index` and `chapter-N`. The figures
/// are in `out` already.
///
/// # Errors
/// If a file cannot be written or a figure cannot be read.
pub fn write_pages(results: &[Results], out: &Path) -> Result<(), OutputError> {
    let mut chapters: Vec<u8> = results.iter().map(|of| of.chapter).collect();
    chapters.dedup();
    let mut pages = vec![index(results, &chapters)];
    for chapter in chapters {
        pages.push(self::chapter(chapter, results, out)?);
    }
    for page in pages {
        write_file(&out.join(format!("{}.md", page.name)), page.markdown().as_bytes())?;
        write_file(&out.join(format!("{}.html", page.name)), page.html().as_bytes())?;
    }
    Ok(())
}

fn file_name(chapter: u8) -> String {
    format!("chapter-{chapter}")
}

fn index(results: &[Results], chapters: &[u8]) -> Page {
    let mut parts = vec![
        PagePart::Heading(1, "Results of the reproduction".to_owned()),
        PagePart::Text(vec![
            "The tables and figures of the thesis (Gunathillake, 2018), published values beside ours. All files of this \
             folder are written by "
                .into(),
            Span::Code("sextant reproduce".to_owned()),
            format!(", version {}. The runs of a scenario have the seeds 1, 2, ..", env!("CARGO_PKG_VERSION")).into(),
        ]),
        PagePart::Heading(2, "Verdicts".to_owned()),
        PagePart::Table(
            std::iter::once("").chain(Tally::header()).map(str::to_owned).collect(),
            by_chapter(results).into_iter().map(|(name, tally)| row(name, tally.cells())).collect(),
        ),
        PagePart::List(MEANING.map(|meaning| vec![meaning.into()]).to_vec()),
        PagePart::Heading(2, "Experiments".to_owned()),
        PagePart::Table(
            ["", "what", "runs", "conclusions of the thesis that hold", "numbers within interval or 20 %"]
                .map(str::to_owned)
                .to_vec(),
            results.iter().map(experiment_row).collect(),
        ),
        PagePart::List(
            chapters.iter().map(|&n| vec![Span::Page(format!("Chapter {n}"), file_name(n))]).collect(),
        ),
    ];
    let all = experiments();
    let left_out: Vec<&Experiment> = all.iter().filter(|of| results.iter().all(|made| made.id != of.id)).collect();
    if !left_out.is_empty() {
        parts.push(PagePart::Heading(2, "Not in these pages".to_owned()));
        parts.push(PagePart::List(left_out.into_iter().map(left_out_item).collect()));
    }
    Page { name: "index".to_owned(), parts }
}

/// What the verdicts mean.
const MEANING: [&str; 7] = [
    "holds: the 95 % interval of each comparison supports the conclusion completely",
    "does not hold: the 95 % interval of a comparison contradicts it completely",
    "cannot be told: neither; the runs do not decide",
    "within interval: the published number is in our 95 % interval; of a published range or bound, a part is in it",
    "within 20 %: ours differs from the published number, or from the nearer end of a range, by at most a fifth of that",
    "within a factor 2: ours is at least half and at most twice that",
    "other: none of these",
];

fn row(name: String, cells: Vec<String>) -> Vec<Span> {
    std::iter::once(name).chain(cells).map(Span::from).collect()
}

fn experiment_row(of: &Results) -> Vec<Span> {
    let tally = Tally::of_thesis([of]);
    let share = |counts: &[usize], good: usize| match counts.iter().sum::<usize>() {
        0 => "-".to_owned(),
        all => format!("{} of {all}", counts[..good].iter().sum::<usize>()),
    };
    vec![
        Span::Page(of.id.clone(), file_name(of.chapter)),
        of.title.as_str().into(),
        of.runs().into(),
        share(&tally.claims, 1).into(),
        share(&tally.numbers, 2).into(),
    ]
}

fn left_out_item(experiment: &Experiment) -> Vec<Span> {
    let runs = experiment.runs;
    let cost = match Costs::measured().of_runs_s(experiment.scenarios()) {
        Some(run_s) => format!(", about {:.0} s of CPU time for {runs} runs", run_s * f64::from(runs.get())),
        None => format!(", {runs} runs, of which the CPU time was not measured"),
    };
    vec![
        format!("{} {}: ", experiment.id, experiment.title).into(),
        Span::Code(format!("sextant reproduce {}", experiment.id)),
        cost.into(),
    ]
}

fn chapter(chapter: u8, results: &[Results], out: &Path) -> Result<Page, OutputError> {
    let of_chapter: Vec<&Results> = results.iter().filter(|of| of.chapter == chapter).collect();
    let mut parts = vec![
        PagePart::Heading(1, format!("Chapter {chapter}")),
        PagePart::Text(vec![Span::Page("All chapters, and what the verdicts mean".to_owned(), "index".to_owned())]),
    ];
    let verdicts = by_chapter(&of_chapter.iter().map(|&of| of.clone()).collect::<Vec<_>>());
    parts.push(PagePart::Table(
        std::iter::once("").chain(Tally::header()).map(str::to_owned).collect(),
        verdicts.into_iter().map(|(name, tally)| row(name, tally.cells())).collect(),
    ));
    for of in of_chapter {
        experiment(of, out, &mut parts)?;
    }
    Ok(Page { name: file_name(chapter), parts })
}

fn experiment(of: &Results, out: &Path, parts: &mut Vec<PagePart>) -> Result<(), OutputError> {
    parts.push(PagePart::Heading(2, format!("{} {}", of.id, of.title)));
    let csv = format!("{}.csv", of.id);
    let mut text: Vec<Span> = vec![format!("{}. Command: ", of.runs()).into()];
    text.extend([
        Span::Code(format!("sextant reproduce {}", of.id)),
        ". All numbers: ".into(),
        Span::File(csv.clone(), csv),
        ".".into(),
    ]);
    parts.push(PagePart::Text(text));
    // The numbers that the thesis states; of an experiment for which it states none, all.
    let states = of.lines.iter().any(|line| line.published.is_some());
    let lines: Vec<&Line> = of.lines.iter().filter(|line| line.published.is_some() || !states).collect();
    if !lines.is_empty() {
        let header = if states {
            vec!["number", "published", "in", "ours (mean ± 95 % interval)", "runs", "verdict"]
        } else {
            vec!["number", "ours (mean ± 95 % interval)", "runs"]
        };
        let cells = |line: &&Line| {
            let [what, published, source, ours, verdict] = line.cells();
            let runs = line.runs().map_or_else(String::new, |runs| runs.to_string());
            let cells =
                if states { vec![what, published, source, ours, runs, verdict] } else { vec![what, ours, runs] };
            cells.into_iter().map(Span::from).collect()
        };
        parts.push(PagePart::Table(
            header.into_iter().map(str::to_owned).collect(),
            lines.iter().map(cells).collect(),
        ));
    }
    if !of.conclusions.is_empty() {
        let header = ["conclusion", "published", "in", "margin", "runs", "verdict"].map(str::to_owned).to_vec();
        let cells = |line: &Line| {
            let [what, published, source, ours, verdict] = line.cells();
            let published = if line.published.is_some() { published } else { "ours".to_owned() };
            let runs = line.runs().map_or_else(String::new, |runs| runs.to_string());
            let margin = ours.trim_start_matches("margin ").to_owned();
            [what, published, source, margin, runs, verdict].map(Span::from).to_vec()
        };
        parts.push(PagePart::Table(header, of.conclusions.iter().map(cells).collect()));
    }
    for (name, title) in &of.figures {
        let file = format!("{name}.svg");
        let path = out.join(&file);
        let svg = std::fs::read_to_string(&path).map_err(|error| OutputError::new(&path, &error))?;
        parts.push(PagePart::Figure { file, title: title.clone(), svg });
    }
    if !of.notes.is_empty() {
        parts.push(PagePart::List(of.notes.iter().map(|note| with_code(note)).collect()));
    }
    Ok(())
}

/// The text with what is in code marks as code.
fn with_code(text: &str) -> Vec<Span> {
    let span = |(i, part): (usize, &str)| if i % 2 == 0 { part.into() } else { Span::Code(part.to_owned()) };
    text.split('`').enumerate().map(span).collect()
}
