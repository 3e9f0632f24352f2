//! What the readings of an experiment give: how far its numbers and conclusions depend on what the thesis leaves open.

use std::path::Path;

use super::experiment::Experiment;
use super::finding::Verdict;
use super::line::{Line, NamedReading};
use super::open::OpenSetting;
use super::ours::Ours;
use super::published::PublishedRange;
use super::reading::Reading;
use super::runs::{Runs, Term};
use sextant_recording::output::{CsvFile, EmptyCell, OutputError};
use sextant_study::sweep::Mean;

/// What the readings of an experiment give.
#[derive(Clone, Debug, Default)]
pub struct Readings {
    /// What the thesis leaves open, with the values that were tried.
    pub open: Vec<OpenSetting>,
    /// The most runs of a reading.
    pub runs: usize,
    /// The published numbers that a reading changes, with the index of their line.
    pub numbers: Vec<(usize, Moved)>,
    /// The conclusions that a reading changes, with their index.
    pub conclusions: Vec<(usize, Moved)>,
}

/// A number or a conclusion of the thesis under the readings that change it.
#[derive(Clone, Debug)]
pub struct Moved {
    /// The line with the values that are taken.
    pub line: Line,
    /// Our value under each reading.
    pub under: Vec<ReadValue>,
}

/// Our value under a reading.
#[derive(Clone, Debug)]
pub struct ReadValue {
    /// The reading in words.
    pub reading: String,
    /// The value.
    pub ours: Ours,
    /// By how much it differs from the value that is taken, over runs of the same seed.
    pub difference: Option<Mean>,
}

impl Readings {
    /// Those of `experiment` that have all their runs in `runs`.
    pub(crate) fn of(experiment: &Experiment, runs: &Runs) -> Self {
        let made: Vec<&Reading> = experiment.readings.iter().filter(|reading| runs.has(reading.variants())).collect();
        let mut readings = Self::default();
        for (i, quantity) in experiment.lines.iter().enumerate() {
            let is_number = quantity.published.as_ref().is_some_and(|of| PublishedRange::read(&of.value).is_some());
            let changing = changing(&made, &quantity.ours.terms(), |reading| reading.lines[i].terms());
            let under = changing.into_iter().map(|reading| ReadValue {
                reading: reading.name(),
                ours: reading.lines[i].ours(runs),
                difference: quantity.ours.moved(&reading.lines[i], runs),
            });
            let under = under.filter(|value| value.ours != Ours::Missing && !value.is_same());
            let under: Vec<_> = under.filter(|_| is_number).collect();
            if !under.is_empty() {
                readings.numbers.push((i, Moved { line: quantity.line(quantity.ours.ours(runs)), under }));
            }
        }
        for (i, claim) in experiment.claims.iter().enumerate() {
            let changing = changing(&made, &claim.check.terms(), |reading| reading.checks[i].terms());
            let under = changing.into_iter().filter_map(|reading| {
                let ours = Ours::Finding(reading.checks[i].finding(runs)?);
                Some(ReadValue { reading: reading.name(), ours, difference: None })
            });
            let under: Vec<_> = under.filter(|_| claim.published.is_some()).collect();
            if !under.is_empty() {
                readings.conclusions.push((i, Moved { line: claim.line(runs), under }));
            }
        }
        if !(readings.numbers.is_empty() && readings.conclusions.is_empty()) {
            readings.open = tried(&experiment.open, &made);
        }
        let made = made.iter().flat_map(|reading| reading.variants()).filter(|variant| !variant.is_shipped());
        readings.runs = made.map(|variant| runs.made(variant) as usize).max().unwrap_or(0);
        readings
    }

    /// Gives the `lines` of numbers and the `conclusions` of the experiment the readings on which their verdicts depend.
    pub(crate) fn name_in(&self, lines: &mut [Line], conclusions: &mut [Line]) {
        for (i, moved) in &self.numbers {
            lines[*i].reading = moved
                .reached_by()
                .filter(|_| moved.is_far())
                .map(|value| NamedReading { name: value.reading.clone(), ours: value.ours.clone() });
        }
        for (i, moved) in &self.conclusions {
            if verdict(&moved.line.ours) != Some(Verdict::Holds) {
                let holds = moved.under.iter().find(|value| verdict(&value.ours) == Some(Verdict::Holds));
                conclusions[*i].reading =
                    holds.map(|value| NamedReading { name: value.reading.clone(), ours: value.ours.clone() });
            }
        }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty() && self.conclusions.is_empty()
    }

    /// Writes the values under all readings to the table at `path`.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub(crate) fn write_csv(&self, path: &Path) -> Result<(), OutputError> {
        let header =
            ["what", "published", "unit", "reading", "ours", "difference", "half_width_95", "runs", "verdict"];
        let mut file = CsvFile::new(header, EmptyCell::Bare);
        for (_, Moved { line, under }) in self.numbers.iter().chain(&self.conclusions) {
            for ReadValue { reading, ours, difference } in under {
                let of_reading = Line { ours: ours.clone(), ..line.clone() };
                let published = line.published.as_ref().map(|of| of.value.clone()).unwrap_or_default();
                let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
                file.row([
                    line.what.clone(),
                    published,
                    line.unit.clone(),
                    reading.clone(),
                    number(ours.number()),
                    number(difference.map(|of| of.mean)),
                    number(difference.and_then(|of| of.half_width_95)),
                    of_reading.runs().map_or_else(String::new, |runs| runs.to_string()),
                    of_reading.verdict().unwrap_or_default().to_owned(),
                ]);
            }
        }
        file.save(path)
    }
}

impl ReadValue {
    /// Whether each of its runs has the value that is taken: the setting does not concern it.
    fn is_same(&self) -> bool {
        self.difference
            .is_some_and(|of| of.mean == 0.0 && of.half_width_95.is_none_or(|half_width| half_width == 0.0))
    }
}

impl Moved {
    /// Whether the value that is taken is neither in the interval nor within a fifth.
    fn is_far(&self) -> bool {
        self.line.agreement().is_some_and(|agreement| !agreement.is_near())
    }

    /// How far a value is from the published one, as a share of that.
    fn distance(&self, ours: &Ours) -> Option<f64> {
        let range = PublishedRange::read(&self.line.published.as_ref()?.value)?;
        Some(range.distance(ours.number()?))
    }

    /// The nearest of the readings that are within a fifth of the published number, and whose half intervals are at most half of it:
    /// few runs that scatter say nothing.
    fn reached_by(&self) -> Option<&ReadValue> {
        let range = PublishedRange::read(&self.line.published.as_ref()?.value)?;
        let is_known = |ours: &Ours| match (ours, ours.number()) {
            (Ours::Mean(mean), Some(value)) => {
                let published = value.clamp(range.low, range.high).abs();
                mean.half_width_95.is_none_or(|half_width| half_width <= 0.5 * published)
            }
            _ => true,
        };
        let reached = self.under.iter().filter_map(|value| Some((value, self.distance(&value.ours)?)));
        let reached = reached.filter(|(value, distance)| *distance <= 0.2 && is_known(&value.ours));
        reached.min_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(value, _)| value)
    }

    /// The reading that comes nearest to the published number; `None` if that is the value that is taken.
    #[must_use]
    pub fn nearest(&self) -> Option<&ReadValue> {
        let far = |ours: &Ours| self.distance(ours).unwrap_or(f64::INFINITY);
        let nearest = self.under.iter().min_by(|a, b| far(&a.ours).total_cmp(&far(&b.ours)))?;
        (far(&nearest.ours) < far(&self.line.ours)).then_some(nearest)
    }

    /// The least and the greatest value over the readings and that which is taken.
    #[must_use]
    pub fn range(&self) -> Option<[f64; 2]> {
        let values = self.under.iter().map(|value| &value.ours).chain([&self.line.ours]).filter_map(Ours::number);
        values.fold(None, |range, value| {
            let [low, high] = range.unwrap_or([value; 2]);
            Some([value.min(low), value.max(high)])
        })
    }

    /// The reading that moves the value most, and by how much.
    #[must_use]
    pub fn most(&self) -> Option<(&ReadValue, f64)> {
        let taken = self.line.ours.number();
        let by = |value: &ReadValue| match value.difference {
            Some(difference) => Some(difference.mean),
            None => Some(value.ours.number()? - taken?),
        };
        let moves = self.under.iter().filter_map(|value| Some((value, by(value)?)));
        moves.max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()))
    }

    /// The readings under which the conclusion is decided, and otherwise than with the values that are taken. Of two settings
    /// together only where neither does it alone.
    #[must_use]
    pub fn changes(&self) -> Vec<(&str, Verdict)> {
        let taken = verdict(&self.line.ours);
        let changing = self.under.iter().filter_map(|value| {
            let verdict = verdict(&value.ours)?;
            let is_change = Some(verdict) != taken && verdict != Verdict::CannotBeTold;
            is_change.then_some((value.reading.as_str(), verdict))
        });
        let all: Vec<_> = changing.collect();
        let alone = |&(reading, of): &(&str, Verdict)| {
            let is_part = |&(other, its): &(&str, Verdict)| its == of && other != reading && reading.contains(other);
            !all.iter().any(is_part)
        };
        all.iter().filter(|change| alone(change)).copied().collect()
    }
}

/// What is `open`, with the values that `made` readings have.
fn tried(open: &[OpenSetting], made: &[&Reading]) -> Vec<OpenSetting> {
    let is_made = |name: &str, value: &str| {
        let mut choices = made.iter().flat_map(|reading| &reading.choices);
        choices.any(|choice| choice.name == name && choice.value == value)
    };
    let mut open = open.to_vec();
    open.iter_mut().for_each(|of| of.values.retain(|value| is_made(&of.name, value)));
    open.retain(|of| !of.values.is_empty());
    open
}

/// Those of `readings` whose terms are neither those that are `taken` nor those of a reading before: of two settings together,
/// one may change nothing here.
fn changing<'a>(
    readings: &[&'a Reading],
    taken: &[&Term],
    terms: impl Fn(&'a Reading) -> Vec<&'a Term>,
) -> Vec<&'a Reading> {
    let mut found: Vec<&Reading> = Vec::new();
    for &reading in readings {
        let own = terms(reading);
        if own != taken && found.iter().all(|&other| terms(other) != own) {
            found.push(reading);
        }
    }
    found
}

fn verdict(ours: &Ours) -> Option<Verdict> {
    match ours {
        Ours::Finding(finding) => Some(finding.verdict),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::finding::Finding;
    use super::super::published::Published;
    use super::*;

    fn mean(mean: f64) -> Ours {
        Ours::Mean(Mean { mean, half_width_95: Some(0.1), runs: 5 })
    }

    fn moved(taken: f64, under: &[(&str, f64)]) -> Moved {
        let value = |&(reading, value): &(&str, f64)| ReadValue {
            reading: reading.to_owned(),
            ours: mean(value),
            difference: None,
        };
        Moved {
            line: Line {
                what: "E".into(),
                published: Some(Published::new("40", "table 3.6")),
                unit: "%".into(),
                better: None,
                ours: mean(taken),
                reading: None,
            },
            under: under.iter().map(value).collect(),
        }
    }

    #[test]
    fn the_range_the_strongest_and_the_nearest_reading_are_told() {
        let of = moved(15.0, &[("few anchors", 37.5), ("short hops", 12.0), ("one packet", 60.0)]);
        assert_eq!(of.range(), Some([12.0, 60.0]));
        let (strongest, by) = of.most().unwrap();
        assert_eq!((strongest.reading.as_str(), by), ("one packet", 45.0));
        assert_eq!(of.nearest().unwrap().reading, "few anchors");
        assert!(moved(39.0, &[("few anchors", 37.5)]).nearest().is_none(), "the value that is taken is nearer");
    }

    #[test]
    fn a_setting_that_changes_no_run_does_not_concern_a_number() {
        let by = |mean, half_width_95| Some(Mean { mean, half_width_95, runs: 5 });
        let value = |difference| ReadValue { reading: "anchors".to_owned(), ours: mean(1.0), difference };
        assert!(value(by(0.0, Some(0.0))).is_same());
        assert!(value(by(0.0, None)).is_same());
        assert!(!value(by(0.0, Some(0.1))).is_same(), "runs differ, and their mean does not");
        assert!(!value(None).is_same(), "nothing is known of single runs");
    }

    #[test]
    fn a_conclusion_changes_with_a_setting_alone_rather_than_with_two() {
        let finding = |of: Verdict| {
            let margin = Mean { mean: 1.0, half_width_95: Some(0.1), runs: 5 };
            Ours::Finding(Finding { verdict: of, margin, unit: "m" })
        };
        let value = |(reading, of): (&str, Verdict)| ReadValue {
            reading: reading.to_owned(),
            ours: finding(of),
            difference: None,
        };
        use Verdict::{CannotBeTold, DoesNotHold, Holds};
        let mut of = moved(1.0, &[]);
        of.line.ours = finding(DoesNotHold);
        of.under = [
            ("radius: 4 m", Holds),
            ("radius: 5 m", CannotBeTold),
            ("lanes: 2 m", DoesNotHold),
            ("radius: 4 m, lanes: 2 m", Holds),
            ("radius: 5 m, lanes: 2 m", Holds),
        ]
        .map(value)
        .to_vec();
        assert_eq!(of.changes(), [("radius: 4 m", Holds), ("radius: 5 m, lanes: 2 m", Holds)]);
    }

    #[test]
    fn a_verdict_names_a_reading_only_if_the_value_that_is_taken_is_far_and_the_reading_is_near() {
        let named = |of: Moved| {
            let mut lines = [of.line.clone()];
            Readings { numbers: vec![(0, of)], ..Readings::default() }.name_in(&mut lines, &mut []);
            let [line] = lines;
            (line.verdict().unwrap(), line.reading.map(|reading| reading.name))
        };
        let near = ("within 20 % for a reading", Some("few".to_owned()));
        assert_eq!(named(moved(15.0, &[("few", 33.0)])), near);
        assert_eq!(named(moved(15.0, &[("few", 31.0)])), ("other", None), "31 is 22 % away");
        assert_eq!(named(moved(41.0, &[("few", 40.0)])), ("within 20 %", None));
        let mut scattered = moved(15.0, &[("few", 40.0), ("fewer", 35.0)]);
        scattered.under[0].ours = Ours::Mean(Mean { mean: 40.0, half_width_95: Some(20.5), runs: 2 });
        assert_eq!(named(scattered).1.as_deref(), Some("fewer"), "40 ± 20.5 says nothing");
    }
}
