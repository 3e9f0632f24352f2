//! The pages of a reproduction: one with the verdicts, and one for each chapter.

use std::path::Path;

use super::costs::Costs;
use super::experiment::Experiment;
use super::experiment_page;
use super::page::{Page, PagePart, Span};
use super::results::Results;
use super::tables::experiments;
use super::tally::{Tally, by_chapter};
use sextant_recording::output::{OutputError, write_file};

/// Writes the pages of `results` into the folder `out`, each as Markdown and as HTML: `index` and `chapter-N`. The figures
/// are in `out` already. The first run of each scenario had the `first_seed`, or that of the scenario.
///
/// # Errors
/// If a file cannot be written or a figure cannot be read.
pub fn write_pages(results: &[Results], first_seed: Option<u64>, out: &Path) -> Result<(), OutputError> {
    let mut chapters: Vec<u8> = results.iter().map(|of| of.chapter).collect();
    chapters.dedup();
    let mut pages = vec![index(results, &chapters, first_seed)];
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

fn index(results: &[Results], chapters: &[u8], first_seed: Option<u64>) -> Page {
    let first = first_seed.unwrap_or(1);
    let mut parts = vec![
        PagePart::Heading(1, "Results of the reproduction".to_owned()),
        PagePart::Text(vec![
            "The tables and figures of the thesis (Gunathillake, 2018), published values beside ours. All files of this \
             folder are written by "
                .into(),
            Span::Code("sextant reproduce".to_owned()),
            format!(
                ", version {}. The runs of a scenario have the seeds {first}, {}, ..",
                env!("CARGO_PKG_VERSION"),
                first.saturating_add(1)
            )
            .into(),
        ]),
        PagePart::Heading(2, "Verdicts".to_owned()),
        PagePart::Table(
            std::iter::once("").chain(Tally::header()).map(str::to_owned).collect(),
            by_chapter(results).into_iter().map(|(name, tally)| row(name, tally.cells())).collect(),
        ),
        PagePart::List(MEANING.map(|meaning| vec![meaning.into()]).to_vec()),
        PagePart::Heading(2, "Experiments".to_owned()),
        PagePart::Table(
            EXPERIMENTS.map(str::to_owned).to_vec(),
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
const MEANING: [&str; 10] = [
    "holds: the 95 % interval of each comparison supports the conclusion completely",
    "holds for a reading: not so with the values that are taken, but for another value that the text allows; the page names it",
    "does not hold: the 95 % interval of a comparison contradicts it completely",
    "cannot be told: neither; the runs do not decide",
    "within interval: the published number is in our 95 % interval; of a published range or bound, a part is in it",
    "within 20 %: ours differs from the published number, or from the nearer end of a range, by at most a fifth of that",
    "within 20 % for a reading: none of these, but within 20 % for another value that the text allows, which the page names. \
     Its interval is at most ± half the published number",
    "better than published: none of these, and the error or the time is less than the thesis has, or the share more",
    "within a factor 2: none of these, and ours is at least half and at most twice that",
    "other: none of these",
];

fn row(name: String, cells: Vec<String>) -> Vec<Span> {
    std::iter::once(name).chain(cells).map(Span::from).collect()
}

/// The header of the table of experiments.
const EXPERIMENTS: [&str; 5] = [
    "",
    "what",
    "runs",
    "conclusions of the thesis that hold (for a reading)",
    "numbers within interval or 20 % (for a reading)",
];

fn experiment_row(of: &Results) -> Vec<Span> {
    let tally = Tally::of_thesis([of]);
    // How many of the first counts there are, and in brackets that which follows.
    let share = |counts: &[usize], good: usize| match counts.iter().sum::<usize>() {
        0 => "-".to_owned(),
        all => {
            let for_a_reading = if counts[good] > 0 { format!(" (+ {})", counts[good]) } else { String::new() };
            format!("{}{for_a_reading} of {all}", counts[..good].iter().sum::<usize>())
        }
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
    parts.push(PagePart::Table(
        EXPERIMENTS.map(str::to_owned).to_vec(),
        of_chapter.iter().map(|of| experiment_row(of)).collect(),
    ));
    for of in of_chapter {
        parts.extend(experiment_page::parts(of, out)?);
    }
    Ok(Page { name: file_name(chapter), parts })
}
