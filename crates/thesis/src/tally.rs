//! How many claims and numbers of a chapter have each verdict.

use serde_json::{Map, Value, json};

use super::agreement::Agreement;
use super::finding::Verdict;
use super::line::Line;
use super::results::Results;

/// How many conclusions and numbers have each verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Conclusions, in the order of [`Verdict::ALL`].
    pub claims: [usize; 4],
    /// Published numbers, in the order of [`Agreement::ALL`].
    pub numbers: [usize; 6],
    /// Conclusions and published numbers without a verdict, because all runs failed.
    pub none: usize,
}

impl Tally {
    /// Of what the thesis states in these results: its conclusions and its numbers.
    #[must_use]
    pub(crate) fn of_thesis<'a>(results: impl IntoIterator<Item = &'a Results>) -> Self {
        let lines = results.into_iter().flat_map(Results::all);
        Self::of(lines.filter(|line| line.published.is_some()))
    }

    /// Of the conclusions that are ours.
    #[must_use]
    pub(crate) fn of_ours<'a>(results: impl IntoIterator<Item = &'a Results>) -> Self {
        Self::of(results.into_iter().flat_map(|of| &of.conclusions).filter(|line| line.published.is_none()))
    }

    fn of<'a>(lines: impl Iterator<Item = &'a Line>) -> Self {
        let mut tally = Self::default();
        for line in lines {
            let words = line.verdict();
            let claim = Verdict::ALL.iter().position(|verdict| Some(verdict.words()) == words);
            let number = Agreement::ALL.iter().position(|agreement| Some(agreement.words()) == words);
            match (claim, number) {
                (Some(claim), _) => tally.claims[claim] += 1,
                (_, Some(number)) => tally.numbers[number] += 1,
                (None, None) => tally.none += 1,
            }
        }
        tally
    }

    /// Whether there is nothing to count.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The header of its [`cells`](Self::cells).
    #[must_use]
    pub fn header() -> Vec<&'static str> {
        Verdict::ALL.iter().map(|verdict| verdict.words()).chain(Agreement::ALL.iter().map(|of| of.words())).collect()
    }

    /// The counts as texts; `-` where nothing is counted.
    #[must_use]
    pub fn cells(&self) -> Vec<String> {
        let texts = |counts: &[usize]| -> Vec<String> {
            let is_empty = counts.iter().all(|&count| count == 0);
            counts.iter().map(|count| if is_empty { "-".to_owned() } else { count.to_string() }).collect()
        };
        [texts(&self.claims), texts(&self.numbers)].concat()
    }

    /// The counts by verdict.
    #[must_use]
    pub fn json(&self) -> Value {
        let of = |words: &[&str], counts: &[usize]| -> Map<String, Value> {
            words.iter().zip(counts).map(|(&word, &count)| (word.to_owned(), json!(count))).collect()
        };
        let claims = of(&Verdict::ALL.map(Verdict::words), &self.claims);
        let numbers = of(&Agreement::ALL.map(Agreement::words), &self.numbers);
        json!({"conclusions": claims, "numbers": numbers, "without_verdict": self.none})
    }
}

/// The tally of each chapter: its name in tables, and the counts. What is ours has a row of its own.
#[must_use]
pub fn by_chapter(results: &[Results]) -> Vec<(String, Tally)> {
    let mut rows = Vec::new();
    let mut chapters: Vec<u8> = results.iter().map(|of| of.chapter).collect();
    chapters.dedup();
    for chapter in chapters {
        let of_chapter = || results.iter().filter(|of| of.chapter == chapter);
        rows.push((format!("chapter {chapter}"), Tally::of_thesis(of_chapter())));
        rows.push((format!("chapter {chapter}, conclusions of ours"), Tally::of_ours(of_chapter())));
    }
    if rows.len() > 2 {
        rows.push(("all chapters".to_owned(), Tally::of_thesis(results)));
        rows.push(("all chapters, conclusions of ours".to_owned(), Tally::of_ours(results)));
    }
    rows.retain(|(_, tally)| !tally.is_empty());
    rows
}
