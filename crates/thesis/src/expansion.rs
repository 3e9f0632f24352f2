//! From the file of a table to experiments: each entry for each combination of its items.

use std::collections::BTreeMap;

use sextant::summary::Measure;

use super::chart::{Across, Chart, ChartLine};
use super::claim::{Check, Claim};
use super::computation::{Candidate, Computation, Least, likelihood};
use super::error::TableError;
use super::experiment::Experiment;
use super::picture::Picture;
use super::published::Published;
use super::quantity::Quantity;
use super::reading::readings;
use super::runs::Term;
use super::table::{ChartEntry, Condition, Entry, HorizontalEntry, LeastEntry, PictureEntry, Shared, Table};
use super::variant::Variant;
use super::words::{Scope, Words};

/// The experiments of the text of a table, in the chapter of this number that shares `shared`.
pub(crate) fn experiments(text: &str, shared: &str, chapter: u8) -> Result<Vec<Experiment>, TableError> {
    let (table, shared): (Table, Shared) = (toml::from_str(text)?, toml::from_str(shared)?);
    let mut words = Words { lists: shared.lists, texts: shared.texts };
    words.lists.extend(table.lists.clone());
    words.texts.extend(table.texts.clone());
    if let Some(list) = words.lists.iter().find(|(_, items)| items.iter().any(|item| item.id().is_empty())) {
        return Err(TableError::NoId { list: list.0.clone() });
    }
    let expansion = Expansion { shared: &shared.shared, chapter };
    let scopes = Scope::new(&words).each(&table.each)?;
    scopes.into_iter().map(|scope| expansion.experiment(&table, scope.only(&table.only))).collect()
}

struct Expansion<'a> {
    shared: &'a BTreeMap<String, Vec<Entry>>,
    chapter: u8,
}

/// An entry of one combination of items.
type Single<'a> = (Entry, Scope<'a>);

impl<'a> Expansion<'a> {
    fn experiment(&self, table: &'a Table, scope: Scope<'a>) -> Result<Experiment, TableError> {
        let group = Entry {
            scenario: table.scenario.clone(),
            at: table.at.clone(),
            measure: table.measure.clone(),
            source: table.source.clone(),
            ..Entry::default()
        };
        let (mut lines, mut claims, mut charts) = (Vec::new(), Vec::new(), Vec::new());
        self.singles(&table.lines, &group, &scope, &mut |single| {
            lines.push(quantity(&single)?);
            Ok(())
        })?;
        self.singles(&table.conclusions, &group, &scope, &mut |single| {
            claims.push(claim(&single)?);
            Ok(())
        })?;
        for entry in &table.charts {
            charts.extend(self::charts(entry, &group, &scope)?);
        }
        let mut pictures = Vec::new();
        for entry in &table.pictures {
            pictures.extend(self::pictures(entry, &group, &scope)?);
        }
        let mut open = Vec::new();
        for entry in &table.open {
            open.extend(entry.setting(&scope)?);
        }
        Ok(Experiment {
            readings: readings(&table.open, &table.together, &scope, &lines, &claims)?,
            open,
            reading_runs: table.reading_runs,
            id: scope.fill(&table.id)?,
            title: scope.fill(&table.title)?,
            chapter: self.chapter,
            runs: table.runs,
            lines,
            leave_out_empty_lines: table.leave_out_empty_lines,
            charts,
            pictures,
            claims,
            notes: table.notes.iter().map(|note| scope.fill(note)).collect::<Result<_, _>>()?,
        })
    }

    /// Gives `then` each of the `entries` of a `group` in each combination of its items.
    fn singles(
        &self,
        entries: &'a [Entry],
        group: &Entry,
        scope: &Scope<'a>,
        then: &mut impl FnMut(Single<'a>) -> Result<(), TableError>,
    ) -> Result<(), TableError> {
        for entry in entries {
            let own = entry.under(group);
            for scope in scope.clone().only(&entry.only).each(&entry.each)? {
                let scope = scope.with(&entry.with)?;
                let shared = match &entry.r#use {
                    None => &[][..],
                    Some(name) => self.shared.get(name).ok_or_else(|| TableError::NoShared { name: name.clone() })?,
                };
                if entry.lines.is_empty() && shared.is_empty() {
                    if scope.is_meant()? {
                        then((own.clone(), scope))?;
                    }
                } else {
                    self.singles(&entry.lines, &own, &scope, then)?;
                    self.singles(shared, &own, &scope, then)?;
                }
            }
        }
        Ok(())
    }
}

/// What an entry must have.
fn needed<'e, T>(key: &'static str, value: &'e Option<T>, entry: &Entry) -> Result<&'e T, TableError> {
    value.as_ref().ok_or_else(|| TableError::Missing { key, what: entry.what.clone().unwrap_or_default() })
}

fn term(entry: &Entry, scope: &Scope<'_>) -> Result<Term, TableError> {
    let mut settings = Vec::new();
    for (key, value) in entry.at.iter().flatten() {
        let value = scope.fill(value)?;
        if !value.is_empty() {
            settings.push((key.clone(), value));
        }
    }
    let measure: Measure = scope.fill(needed("measure", &entry.measure, entry)?)?.parse()?;
    let variant = Variant::shipped(&scope.fill(needed("scenario", &entry.scenario, entry)?)?);
    Ok(Term { variant, settings, measure })
}

fn published(entry: &Entry, scope: &Scope<'_>) -> Result<Option<Published>, TableError> {
    let mut value = (entry.published.as_ref(), entry.source.as_ref());
    for one in entry.published_where.iter().rev() {
        if scope.keeps(&one.only)? {
            value = (Some(&one.value), one.source.as_ref().or(entry.source.as_ref()));
        }
    }
    let (Some(value), source) = value else { return Ok(None) };
    let source = source.ok_or_else(|| TableError::Missing { key: "source", what: value.clone() })?;
    Ok(Some(Published::new(scope.fill(value)?, scope.fill(source)?)))
}

fn quantity((entry, scope): &Single<'_>) -> Result<Quantity, TableError> {
    let ours = match (&entry.likelihood, &entry.least, entry.at_least) {
        (Some(of), None, None) => Computation::Exact(likelihood(of)),
        (None, Some(least), None) => Computation::Least(self::least(least, entry, scope)?),
        (None, None, Some(limit)) => Computation::AtLeast(term(entry, scope)?, limit),
        (None, None, None) => Computation::Mean(term(entry, scope)?),
        _ => return Err(TableError::Several { what: entry.what.clone().unwrap_or_default() }),
    };
    if entry.check.is_some() || !entry.terms.is_empty() {
        return Err(TableError::Several { what: entry.what.clone().unwrap_or_default() });
    }
    Ok(Quantity {
        what: scope.fill(needed("what", &entry.what, entry)?)?,
        published: published(entry, scope)?,
        better: entry.better,
        unit: entry.unit.clone().unwrap_or_else(|| ours.unit().to_owned()),
        ours,
    })
}

fn least(of: &LeastEntry, entry: &Entry, scope: &Scope<'_>) -> Result<Least, TableError> {
    let scopes = scope.each(&of.over)?;
    // Two cells are beside each other if they differ in this variable alone.
    let is_beside = |a: &Scope<'_>, b: &Scope<'_>| {
        of.over.iter().all(|name| (a.id(name) == b.id(name)) != (of.beside.as_ref() == Some(name)))
    };
    let candidate = |scope: &Scope<'_>| {
        Ok(Candidate {
            term: term(entry, scope)?,
            shown: scope.fill(of.show.as_deref().unwrap_or_default())?,
            beside: (0..scopes.len()).filter(|&i| of.beside.is_some() && is_beside(scope, &scopes[i])).collect(),
        })
    };
    let candidates = scopes.iter().map(candidate).collect::<Result<_, TableError>>()?;
    Ok(Least { candidates, is_shown: of.show.is_some() })
}

fn claim((entry, scope): &Single<'_>) -> Result<Claim, TableError> {
    let one = [BTreeMap::new()];
    let bound = if entry.terms.is_empty() { &one[..] } else { &entry.terms };
    let terms = bound.iter().map(|values| term(entry, &scope.with(values)?)).collect::<Result<Vec<_>, _>>()?;
    let text = scope.fill(needed("what", &entry.what, entry)?)?;
    let check = check(*needed("check", &entry.check, entry)?, terms)
        .map_err(|(wanted, found)| TableError::Terms { what: text.clone(), wanted, found })?;
    Ok(Claim { text, published: published(entry, scope)?, check })
}

/// The check of a condition; the wanted number of terms and that found if they differ.
fn check(condition: Condition, terms: Vec<Term>) -> Result<Check, (&'static str, usize)> {
    let found = terms.len();
    let pair = |terms: Vec<Term>| <[Term; 2]>::try_from(terms).map_err(|_| ("2", found));
    let single = |terms: Vec<Term>| <[Term; 1]>::try_from(terms).map_err(|_| ("1", found));
    let several = if found > 1 { Ok(()) } else { Err(("2 or more", found)) };
    Ok(match condition {
        Condition::Rising => several.map(|()| Check::Rising(terms))?,
        Condition::Least => several.map(|()| Check::Least(terms))?,
        Condition::Greatest => several.map(|()| Check::Greatest(terms))?,
        Condition::Within(most) => several.map(|()| Check::Within(terms, most))?,
        Condition::Ratio([low, high]) => Check::Ratio(pair(terms)?, low..high),
        Condition::Difference([low, high]) => Check::Difference(pair(terms)?, low..high),
        Condition::Below(limit) => {
            let [term] = single(terms)?;
            Check::Below(term, limit)
        }
        Condition::Above(limit) => {
            let [term] = single(terms)?;
            Check::Above(term, limit)
        }
    })
}

fn charts<'a>(entry: &'a ChartEntry, group: &Entry, scope: &Scope<'a>) -> Result<Vec<Chart>, TableError> {
    let own = Entry { scenario: entry.scenario.clone(), measure: entry.measure.clone(), ..Entry::default() };
    let own = own.under(group);
    let scopes = scope.clone().only(&entry.only).each(&entry.each)?;
    scopes.into_iter().map(|scope| chart(entry, &own, &scope.with(&entry.with)?)).collect()
}

fn chart(entry: &ChartEntry, own: &Entry, scope: &Scope<'_>) -> Result<Chart, TableError> {
    let mut lines = Vec::new();
    for scope in scope.each(&entry.curves.each)? {
        let mut points = Vec::new();
        for scope in scope.each(&entry.points.each)? {
            if scope.is_meant()? {
                points.push((across(&entry.points.x, own, &scope)?, term(own, &scope)?));
            }
        }
        if !points.is_empty() {
            lines.push(ChartLine { name: scope.fill(&entry.curves.name)?, points });
        }
    }
    Ok(Chart {
        name: scope.fill(&entry.name)?,
        kind: entry.kind,
        values: entry.values,
        title: scope.fill(&entry.title)?,
        note: scope.fill(&entry.note)?,
        across: scope.fill(&entry.across)?,
        up: scope.fill(&entry.up)?,
        lines,
    })
}

fn across(x: &HorizontalEntry, own: &Entry, scope: &Scope<'_>) -> Result<Across, TableError> {
    let number = |text: &str| {
        let text = scope.fill(text)?;
        text.parse::<f64>().map_err(|_| TableError::NoNumber { text })
    };
    Ok(match x {
        HorizontalEntry::Number(text) => Across::Setting(number(text)?),
        HorizontalEntry::Log10(text) => Across::Setting(libm::log10(number(text)?)),
        HorizontalEntry::Measured(path) => {
            let measured = Entry { measure: Some(path.clone()), ..own.clone() };
            Across::Measured(term(&measured, scope)?)
        }
    })
}

fn pictures<'a>(entry: &'a PictureEntry, group: &Entry, scope: &Scope<'a>) -> Result<Vec<Picture>, TableError> {
    let scenario = entry.scenario.as_ref().or(group.scenario.as_ref());
    let scenario = scenario.ok_or_else(|| TableError::Missing { key: "scenario", what: entry.title.clone() })?;
    let mut pictures = Vec::new();
    for scope in scope.clone().only(&entry.only).each(&entry.each)? {
        if scope.is_meant()? {
            let [scenario, figure, title] = [scenario, &entry.figure, &entry.title].map(|text| scope.fill(text));
            pictures.push(Picture { scenario: scenario?, figure: figure?, title: title? });
        }
    }
    Ok(pictures)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHARED: &str = "[lists]\nroom = ['hall', 'yard']\n[[shared.pair]]\nwhat = 'two'\ncheck = 'least'\n\
                          terms = [{ room = 'hall' }, { room = 'yard' }]\n";

    fn table(entries: &str) -> String {
        let head = "id = 'a'\ntitle = 'A'\nruns = 2\nsource = 'table 1'\nscenario = '{room}.toml'\nmeasure = 'gathering.stops'\nnotes = []\n";
        format!("{head}{entries}")
    }

    fn read(entries: &str) -> Result<Experiment, TableError> {
        Ok(experiments(&table(entries), SHARED, 3)?.remove(0))
    }

    #[test]
    fn an_entry_has_what_its_group_says_and_shared_entries_are_those_of_the_group() {
        let experiment = read(
            "[[lines]]\neach = ['room']\npublished = '{room} 1'\npublished_where = [{ only = { room = ['yard'] }, value = '2' }]\n\
             [[lines.lines]]\nwhat = '{room}, stops'\n[[lines.lines]]\nwhat = '{room}, nodes'\nmeasure = 'simulation.nodes'\n\
             source = 'table 2'\n[[conclusions]]\nuse = 'pair'\npublished = 'yes'\n",
        )
        .unwrap();
        let lines = experiment.lines.iter().map(|line| {
            let Published { value, source } = line.published.clone().unwrap();
            let term = line.ours.terms()[0].clone();
            [line.what.clone(), term.variant.scenario, term.measure.path(), value, source]
        });
        assert_eq!(
            lines.collect::<Vec<_>>(),
            [
                ["hall, stops", "hall.toml", "gathering.stops", "hall 1", "table 1"],
                ["hall, nodes", "hall.toml", "simulation.nodes", "hall 1", "table 2"],
                ["yard, stops", "yard.toml", "gathering.stops", "2", "table 1"],
                ["yard, nodes", "yard.toml", "simulation.nodes", "2", "table 2"],
            ]
        );
        assert_eq!(experiment.scenarios(), ["hall.toml", "yard.toml"]);
        let [claim] = experiment.claims.as_slice() else { panic!("{:?}", experiment.claims) };
        let terms = claim.check.terms();
        assert_eq!((claim.text.as_str(), terms.len(), terms[1].variant.scenario.as_str()), ("two", 2, "yard.toml"));
    }

    const OPEN: &str = "[[lines]]\nwith = { room = 'hall' }\nwhat = 'w'\n\
                        [[open]]\nname = 'size'\nkey = 'world.size'\ntaken = 'small'\nsays = 'nothing'\n\
                        values = [{ value = 'large', set = ['size=9'] }, { value = 'huge', files = { hall = 'yard' } }]\n\
                        [[open]]\nname = 'stops'\nkey = 'gathering.stops'\ntaken = 'stops'\nsays = 'stops'\n\
                        scenarios = ['hall.toml']\n\
                        values = [{ value = 'nodes', measures = { 'gathering.stops' = 'simulation.nodes' }, at = { a = 'b' } }]\n";

    #[test]
    fn a_reading_changes_the_terms_of_its_scenarios_alone_and_pairs_change_both() {
        let experiment = read(&format!("together = [['size', 'stops']]\n{OPEN}")).unwrap();
        let found = experiment.readings.iter().map(|reading| {
            let [Computation::Mean(term)] = reading.lines.as_slice() else { panic!("{:?}", reading.lines) };
            let Term { variant, settings, measure } = term;
            (reading.name(), variant.scenario.as_str(), variant.set.join(" "), settings.len(), measure.path())
        });
        let expected = [
            ("size: large", "hall.toml", "size=9", 0, "gathering.stops"),
            ("size: huge", "yard.toml", "", 0, "gathering.stops"),
            ("stops: nodes", "hall.toml", "", 1, "simulation.nodes"),
            ("size: large, stops: nodes", "hall.toml", "size=9", 1, "simulation.nodes"),
            // The second is for the hall alone, and the first reads the yard.
            ("size: huge, stops: nodes", "yard.toml", "", 0, "gathering.stops"),
        ];
        let expected =
            expected.map(|(name, file, set, count, path)| (name.into(), file, set.into(), count, path.into()));
        assert_eq!(found.collect::<Vec<_>>(), expected);
        let runs: Vec<_> = experiment.of_readings().into_iter().map(|variant| variant.table_name()).collect();
        assert_eq!(runs, ["runs-hall--size-large.csv", "runs-yard.csv"], "a measure needs no runs of its own");
        assert_eq!(experiment.open[0].values, ["large", "huge"]);
    }

    #[test]
    fn what_is_open_and_changes_nothing_or_has_no_such_name_is_rejected() {
        let error = |entries: &str| read(entries).unwrap_err().to_string();
        assert!(error(&format!("together = [['size', 'stop']]\n{OPEN}")).contains("`stop`"));
        let empty = OPEN.replace("set = ['size=9']", "set = []");
        assert!(error(&empty).contains("`large` of `size` needs `set`"), "{}", error(&empty));
    }

    #[test]
    fn a_table_that_is_not_understood_is_rejected() {
        let line = "[[lines]]\nwith = { room = 'hall' }\nwhat = 'w'\n";
        for (entries, part) in [
            (format!("{line}measured = 'gathering.stops'\n"), "measured"),
            (format!("{line}measure = 'gathering.steps'\n"), "`gathering.steps`"),
            (format!("{line}at_least = 1.0\nleast = {{ over = ['room'] }}\n"), "at most one of"),
            (format!("{line}check = 'least'\n"), "no `check`"),
            (format!("{line}[[conclusions]]\nwhat = 'c'\nwith = {{ room = 'hall' }}\n"), "needs `check`"),
            (format!("{line}[[conclusions]]\nwith = {{ room = 'hall' }}\ncheck = 'least'\n"), "needs `what`"),
            (
                format!("{line}[[conclusions]]\nwhat = 'c'\nwith = {{ room = 'hall' }}\ncheck = 'least'\n"),
                "compares 1 terms",
            ),
            (
                format!(
                    "{line}[[conclusions]]\nwhat = 'c'\ncheck = {{ above = 1.0 }}\nterms = [{{ room = 'hall' }}, {{ room = 'yard' }}]\n"
                ),
                "it needs 1",
            ),
            (format!("{line}[[conclusions]]\nuse = 'pairs'\n"), "`pairs`"),
            ("[[lines]]\nwhat = 'w'\n".to_owned(), "`room`"),
            ("[[lines]]\nwith = { room = 'attic' }\nwhat = 'w'\n".to_owned(), "`attic`"),
        ] {
            let error = read(&entries).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
    }
}
