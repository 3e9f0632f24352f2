//! Readings of the thesis: what it leaves open gets another value.

use std::fmt;

use super::claim::{Check, Claim};
use super::computation::Computation;
use super::error::TableError;
use super::open::{OpenEntry, OpenValueEntry};
use super::quantity::Quantity;
use super::runs::Term;
use super::variant::Variant;
use super::words::Scope;

/// A reading of the thesis: what its lines and conclusions are computed from if something open has another value.
#[derive(Clone, Debug)]
pub struct Reading {
    /// What has which value: one setting, or two together.
    pub choices: Vec<Choice>,
    /// How the lines of the experiment are computed, in their order.
    pub lines: Vec<Computation>,
    /// What its conclusions compare, in their order.
    pub checks: Vec<Check>,
}

/// A value of something open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choice {
    /// What is open, in words.
    pub name: String,
    /// Its key.
    pub key: String,
    /// The value in words.
    pub value: String,
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.name, self.value)
    }
}

impl Reading {
    /// The reading in words.
    #[must_use]
    pub fn name(&self) -> String {
        self.choices.iter().map(Choice::to_string).collect::<Vec<_>>().join(", ")
    }

    /// The scenarios that it runs or reads.
    pub fn variants(&self) -> impl Iterator<Item = &Variant> {
        let of_lines = self.lines.iter().flat_map(Computation::terms);
        let of_checks = self.checks.iter().flat_map(Check::terms);
        of_lines.chain(of_checks).map(|term| &term.variant)
    }
}

/// A value of an entry of `[[open]]`.
type Valued<'a> = (&'a OpenEntry, &'a OpenValueEntry);

/// The readings of `open`, one value at a time, and of the pairs of names in `together`.
pub(crate) fn readings(
    open: &[OpenEntry],
    together: &[[String; 2]],
    scope: &Scope<'_>,
    lines: &[Quantity],
    claims: &[Claim],
) -> Result<Vec<Reading>, TableError> {
    let mut here = Vec::new();
    for entry in open {
        if scope.keeps(&entry.only)? {
            here.push(entry);
        }
    }
    let of = |name: &String| -> Result<Vec<Valued<'_>>, TableError> {
        if open.iter().all(|entry| entry.name != *name) {
            return Err(TableError::NoOpen { name: name.clone() });
        }
        Ok(here.iter().copied().filter(|entry| entry.name == *name).flat_map(entries_of).collect())
    };
    let mut all: Vec<Vec<Valued<'_>>> = here.iter().copied().flat_map(entries_of).map(|one| vec![one]).collect();
    for [first, second] in together {
        let (first, second) = (of(first)?, of(second)?);
        all.extend(first.iter().flat_map(|&a| second.iter().map(move |&b| vec![a, b])));
    }
    all.into_iter().map(|valued| reading(&valued, scope, lines, claims)).collect()
}

fn entries_of(entry: &OpenEntry) -> Vec<Valued<'_>> {
    entry.values.iter().map(|value| (entry, value)).collect()
}

fn reading(
    valued: &[Valued<'_>],
    scope: &Scope<'_>,
    lines: &[Quantity],
    claims: &[Claim],
) -> Result<Reading, TableError> {
    let (mut choices, mut changes) = (Vec::new(), Vec::new());
    for (entry, value) in valued {
        let choice =
            Choice { name: scope.fill(&entry.name)?, key: entry.key.clone(), value: scope.fill(&value.value)? };
        let scenarios = entry.scenarios.iter().map(|name| scope.fill(name)).collect::<Result<Vec<_>, _>>()?;
        changes.push(Change { name: choice.to_string(), scenarios, to: value });
        choices.push(choice);
    }
    let mut reading = Reading { choices, lines: Vec::new(), checks: Vec::new() };
    let mut change = |term: &Term| changed(term, &changes);
    reading.lines = lines.iter().map(|line| line.ours.with_terms(&mut change)).collect::<Result<_, _>>()?;
    reading.checks = claims.iter().map(|claim| claim.check.with_terms(&mut change)).collect::<Result<_, _>>()?;
    Ok(reading)
}

/// What a choice changes.
struct Change<'a> {
    /// The choice in words.
    name: String,
    /// The scenarios that it changes; all if none are named.
    scenarios: Vec<String>,
    to: &'a OpenValueEntry,
}

/// The term after these changes.
fn changed(term: &Term, changes: &[Change<'_>]) -> Result<Term, TableError> {
    let mut term = term.clone();
    for Change { name, scenarios, to } in changes {
        if !(scenarios.is_empty() || scenarios.contains(&term.variant.scenario)) {
            continue;
        }
        if !to.set.is_empty() {
            let reading = &mut term.variant.reading;
            *reading = if reading.is_empty() { name.clone() } else { format!("{reading}, {name}") };
            term.variant.set.extend(to.set.iter().cloned());
        }
        for (key, value) in &to.at {
            match term.settings.iter_mut().find(|(other, _)| other == key) {
                Some((_, old)) => old.clone_from(value),
                None => term.settings.push((key.clone(), value.clone())),
            }
        }
        for (from, to) in &to.files {
            term.variant.scenario = term.variant.scenario.replace(from.as_str(), to);
        }
        for (from, to) in &to.measures {
            let path = term.measure.path();
            if path.contains(from.as_str()) {
                term.measure = path.replace(from.as_str(), to).parse()?;
            }
        }
    }
    Ok(term)
}
