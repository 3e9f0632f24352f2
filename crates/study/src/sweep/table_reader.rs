//! The rows of a sweep, read back from its table.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::{Path, PathBuf};

use super::error::TableError;
use super::plan::Sweep;
use super::row::RunRow;
use super::rows::{Overview, RowIter, Rows};
use super::table_file::{TextIter, TextRows, end_of_whole_runs, stream_texts};
use super::tidy::{ERROR, IDENTITY, MAP, Measured, SWEEP, measured};

/// The rows of a table. They stay in its file if it has them in the order in which this program writes them; otherwise they
/// are in memory.
#[derive(Debug)]
pub struct TableRows<'a> {
    path: PathBuf,
    /// Where its whole runs end (octets), if its last row was cut off.
    end: Option<u64>,
    plan: &'a Sweep,
    overview: Overview,
    /// The most runs of a cell.
    runs: u32,
    /// Of each run of the plan, by its number, whether it has a row.
    has: Vec<bool>,
    /// All rows, if the file has another order.
    sorted: Option<Vec<RunRow>>,
}

/// Reads the rows of the table at `path`, which [`write_table`](super::write_table) wrote for a sweep with the cells and
/// columns of `plan`, with any number of runs and by any version.
///
/// # Errors
/// If the file cannot be read, or is the table of another sweep.
pub fn read_table(path: &Path, plan: &Sweep) -> Result<Vec<RunRow>, TableError> {
    sorted(path, None, plan)
}

/// The rows up to `end` by cell, then replicate.
fn sorted(path: &Path, end: Option<u64>, plan: &Sweep) -> Result<Vec<RunRow>, TableError> {
    let mut runs: BTreeMap<(usize, u32), RunRow> = BTreeMap::new();
    let mut rows = MapRows::open(path, end, plan)?;
    while let Some(row) = rows.next() {
        let row = row?;
        match runs.entry((row.cell, row.replicate)) {
            Entry::Vacant(entry) => {
                entry.insert(row);
            }
            Entry::Occupied(mut entry) => join(entry.get_mut(), row).ok_or_else(|| rows.contradiction())?,
        }
    }
    Ok(runs.into_values().collect())
}

/// Reads the rows of the table at `path` if it is of the very sweep `plan`, with any number of runs: the same scenario,
/// files, first seed and version. If the last row of a CSV table was cut off, its run is left out.
///
/// # Errors
/// If the file cannot be read, or is the table of another sweep.
pub fn read_own_table<'a>(path: &Path, plan: &'a Sweep) -> Result<TableRows<'a>, TableError> {
    let end = end_of_whole_runs(path, plan.mark())?;
    let texts = stream_texts(path, end)?;
    if texts.columns.last().is_none_or(|column| column != SWEEP) {
        let why = format!("it has no last column `{SWEEP}`");
        return Err(TableError::Other { path: path.to_owned(), why });
    }
    for row in texts.rows {
        if row?.last().is_none_or(|mark| mark != plan.mark()) {
            return Err(TableError::OtherSweep { path: path.to_owned() });
        }
    }
    TableRows::open(path, end, plan)
}

impl<'a> TableRows<'a> {
    fn open(path: &Path, end: Option<u64>, plan: &'a Sweep) -> Result<Self, TableError> {
        let mut this = Self {
            path: path.to_owned(),
            end,
            plan,
            overview: Overview::default(),
            runs: 0,
            has: vec![false; plan.work().len()],
            sorted: None,
        };
        let mut last = None;
        let mut is_in_order = true;
        for row in RunRows::open(path, end, plan)? {
            let row = row?;
            is_in_order = last.replace(row.run()).is_none_or(|last| last < row.run());
            if !is_in_order {
                break;
            }
            this.add(&row);
        }
        if !is_in_order {
            let rows = sorted(path, end, plan)?;
            this.overview = Overview::default();
            rows.iter().for_each(|row| this.add(row));
            this.sorted = Some(rows);
        }
        Ok(this)
    }

    fn add(&mut self, row: &RunRow) {
        self.overview.add(row);
        self.runs = self.runs.max(row.replicate + 1);
        if let Some(number) = self.plan.work().number_of(row.run()) {
            self.has[number] = true;
        }
    }

    /// The most runs of a cell.
    #[must_use]
    pub fn runs(&self) -> u32 {
        self.runs
    }

    /// Whether it has the run with this number.
    pub(super) fn has(&self, number: usize) -> bool {
        self.has.get(number) == Some(&true)
    }
}

impl Rows for TableRows<'_> {
    fn overview(&self) -> Overview {
        self.overview.clone()
    }

    fn read(&self) -> RowIter<'_> {
        match &self.sorted {
            Some(rows) => Box::new(rows.iter().cloned().map(Ok)),
            None => match RunRows::open(&self.path, self.end, self.plan) {
                Ok(rows) => Box::new(rows),
                Err(error) => Box::new(std::iter::once(Err(error))),
            },
        }
    }
}

/// The rows in the file of a table: one for each run and map.
struct MapRows<'a> {
    path: PathBuf,
    plan: &'a Sweep,
    /// Where the file has which measures.
    columns: Vec<(usize, Measured)>,
    texts: TextIter,
    /// How many were read.
    count: usize,
}

impl<'a> MapRows<'a> {
    /// Those of the file at `path` up to `end`, if its columns are those of `plan`.
    fn open(path: &Path, end: Option<u64>, plan: &'a Sweep) -> Result<Self, TableError> {
        let TextRows { columns: names, rows: texts } = stream_texts(path, end)?;
        let columns = columns_of(&names, plan).map_err(|why| TableError::Other { path: path.to_owned(), why })?;
        Ok(Self { path: path.to_owned(), plan, columns, texts, count: 0 })
    }

    /// The last row that was read contradicts one before it.
    fn contradiction(&self) -> TableError {
        let why = format!("row {} contradicts one before it", self.count);
        TableError::Other { path: self.path.clone(), why }
    }
}

impl Iterator for MapRows<'_> {
    type Item = Result<RunRow, TableError>;

    fn next(&mut self) -> Option<Self::Item> {
        let texts = self.texts.next()?;
        self.count += 1;
        Some(texts.and_then(|texts| {
            row(&texts, self.plan, &self.columns).ok_or_else(|| {
                let why = format!("row {} is none of this scenario", self.count);
                TableError::Other { path: self.path.clone(), why }
            })
        }))
    }
}

/// The rows of a table with those of the maps of a run as one, where they follow one another.
struct RunRows<'a> {
    rows: MapRows<'a>,
    /// The first row of the next run.
    next: Option<RunRow>,
}

impl<'a> RunRows<'a> {
    fn open(path: &Path, end: Option<u64>, plan: &'a Sweep) -> Result<Self, TableError> {
        Ok(Self { rows: MapRows::open(path, end, plan)?, next: None })
    }

    fn next_run(&mut self) -> Result<Option<RunRow>, TableError> {
        let Some(mut run) = self.next.take().map_or_else(|| self.rows.next().transpose(), |row| Ok(Some(row)))?
        else {
            return Ok(None);
        };
        while let Some(row) = self.rows.next() {
            let row = row?;
            if row.run() != run.run() {
                self.next = Some(row);
                break;
            }
            join(&mut run, row).ok_or_else(|| self.rows.contradiction())?;
        }
        Ok(Some(run))
    }
}

impl Iterator for RunRows<'_> {
    type Item = Result<RunRow, TableError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_run().transpose()
    }
}

/// Which of the columns `names` has which measures; why they are not those of `plan`.
fn columns_of(names: &[String], plan: &Sweep) -> Result<Vec<(usize, Measured)>, String> {
    let head: Vec<&str> =
        IDENTITY.into_iter().chain(plan.keys().iter().map(|key| key.name.as_str())).chain([MAP, ERROR]).collect();
    for (i, expected) in head.iter().enumerate() {
        if names.get(i).is_none_or(|found| found != expected) {
            return Err(format!("it has no column `{expected}` where this scenario has one"));
        }
    }
    let mut known = measured(plan);
    let mut columns: Vec<(usize, Measured)> = Vec::new();
    for (i, name) in names.iter().enumerate().skip(head.len()) {
        match known.iter().position(|measured| measured.column.name == *name) {
            Some(at) => columns.push((i, known.swap_remove(at))),
            None if name == SWEEP => {}
            None => return Err(format!("it has a column `{name}`, which this scenario has not")),
        }
    }
    Ok(columns)
}

/// The row of texts: cell, replicate, seed, settings, map, error, values. It has the values of one map.
fn row(texts: &[String], plan: &Sweep, columns: &[(usize, Measured)]) -> Option<RunRow> {
    let (cell, replicate): (usize, u32) = (texts.first()?.parse().ok()?, texts.get(1)?.parse().ok()?);
    let map_at = IDENTITY.len() + plan.keys().len();
    let settings = texts.get(IDENTITY.len()..map_at)?;
    let has_settings =
        cell < plan.cells().len() && settings.iter().zip(&plan.values(cell)).all(|(found, own)| is_same(found, own));
    let has_seed = texts.get(2)?.parse() == Ok(plan.seed_of(replicate));
    if !(has_settings && has_seed) {
        return None;
    }
    let (map, error) = (texts.get(map_at)?, texts.get(map_at + 1)?);
    if !error.is_empty() {
        return Some(RunRow { cell, replicate, outcome: Err(error.clone()) });
    }
    if !map.is_empty() && !plan.maps().contains(map) {
        return None;
    }
    let mut values = vec![None; plan.measures().len()];
    for (i, measured) in columns {
        let text = texts.get(*i)?;
        if !text.is_empty() {
            values[measured.measure(map)?] = Some(text.parse().ok().filter(|value: &f64| value.is_finite())?);
        }
    }
    Some(RunRow { cell, replicate, outcome: Ok(values) })
}

/// Whether two values of a setting are the same; a number may be written in two ways.
fn is_same(a: &str, b: &str) -> bool {
    let number = |text: &str| text.parse::<f64>().ok();
    a == b || number(a).zip(number(b)).is_some_and(|(a, b)| a.total_cmp(&b).is_eq())
}

/// Adds the values of another map of the same run; nothing if the two contradict each other.
fn join(run: &mut RunRow, other: RunRow) -> Option<()> {
    let (Ok(values), Ok(others)) = (&mut run.outcome, other.outcome) else { return None };
    for (value, other) in values.iter_mut().zip(others) {
        match (*value, other) {
            (Some(known), Some(other)) if known.total_cmp(&other).is_ne() => return None,
            (None, other) => *value = other,
            _ => {}
        }
    }
    Some(())
}

#[cfg(test)]
pub(super) mod tests {
    use std::num::NonZeroU32;

    use super::*;
    use crate::sweep::table_file::read_texts;
    use crate::sweep::write_table;

    /// A sweep of two cells with two maps.
    pub(in crate::sweep) fn plan(folder: &Path, axis: &str, runs: u32) -> Sweep {
        let smoke = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/smoke.toml");
        let map = "[maps.algorithm.ml_tm]\ngrid_step_m = 0.5\n\
                   profile.trapezoid = { p0 = 0.9, plateau_m = 1.0, range_m = 6.0 }\n";
        let text = format!(
            "extends = {smoke:?}\n[[maps]]\n{map}[[maps]]\nname = \"fine\"\n{map}[sweep]\n[sweep.product]\n{axis}\n"
        );
        let scenario = folder.join("s.toml");
        std::fs::write(&scenario, text).unwrap();
        Sweep::read(&scenario, &[], None, NonZeroU32::new(runs)).unwrap()
    }

    pub(in crate::sweep) const STEPS: &str = "maps.0.algorithm.ml_tm.grid_step_m = [0.5, 1.0]";

    /// Rows with two maps, one map, none, and an error.
    pub(in crate::sweep) fn made_up(plan: &Sweep) -> Vec<RunRow> {
        let values = |maps: &[&str], seed: u32| {
            let value = |(i, measure): (u32, &sextant::summary::Measure)| {
                let has = measure.map().is_none_or(|map| maps.contains(&map));
                (i % 2 == 0 && has).then(|| f64::from(1000 * seed + i))
            };
            Ok((0..).zip(plan.measures()).map(value).collect())
        };
        vec![
            RunRow { cell: 0, replicate: 0, outcome: values(&["ml-tm", "fine"], 1) },
            RunRow { cell: 0, replicate: 1, outcome: values(&["fine"], 2) },
            RunRow { cell: 1, replicate: 0, outcome: values(&[], 3) },
            RunRow { cell: 1, replicate: 1, outcome: Err("a, \"b\"".into()) },
        ]
    }

    #[test]
    fn rows_are_read_back_only_by_a_sweep_with_the_same_cells_and_columns() {
        let folder = tempfile::tempdir().unwrap();
        let two = plan(folder.path(), STEPS, 2);
        let rows = made_up(&two);
        for table in [
            "t.csv",
            #[cfg(feature = "parquet")]
            "t.parquet",
        ] {
            let table = folder.path().join(table);
            write_table(&table, &two, &rows.as_slice()).unwrap();
            assert_eq!(read_table(&table, &two).unwrap(), rows);
            let more = plan(folder.path(), STEPS, 20);
            let own = read_own_table(&table, &more).unwrap();
            let found = own.read().collect::<Result<Vec<_>, _>>().unwrap();
            assert_eq!((found, own.runs(), own.sorted.is_none()), (rows.clone(), 2, true), "more runs");
            assert_eq!(own.overview(), rows.as_slice().overview());
            assert_eq!((0..more.work().len()).filter(|number| own.has(*number)).count(), rows.len());
            for axis in ["maps.0.algorithm.ml_tm.grid_step_m = [0.5, 2.0]", "channel.max_range_m = [9.0, 10.0]"] {
                let other = plan(folder.path(), axis, 2);
                assert!(matches!(read_table(&table, &other), Err(TableError::Other { .. })), "{axis}");
                assert!(matches!(read_own_table(&table, &other), Err(TableError::OtherSweep { .. })), "{axis}");
            }
        }
        assert!(matches!(read_table(&folder.path().join("u.csv"), &two), Err(TableError::Read { .. })));
    }

    #[test]
    fn a_run_has_a_row_for_each_map_and_its_own_measures_stand_in_each() {
        let folder = tempfile::tempdir().unwrap();
        let plan = plan(folder.path(), STEPS, 2);
        let table = folder.path().join("t.csv");
        write_table(&table, &plan, &made_up(&plan).as_slice()).unwrap();
        let texts = read_texts(&table).unwrap();
        let at = |name: &str| texts.columns.iter().position(|column| column == name).unwrap();
        let cells = |name: &str| texts.rows.iter().map(|row| row[at(name)].as_str()).collect::<Vec<_>>();
        assert_eq!(cells("cell"), ["0", "0", "0", "1", "1"]);
        assert_eq!(cells("map"), ["ml-tm", "fine", "fine", "", ""]);
        assert_eq!(cells("error"), ["", "", "", "", "a, \"b\""]);
        assert_eq!(cells("nodes"), ["1000", "1000", "2000", "3000", ""]);
        assert!(cells("sweep").iter().all(|mark| *mark == plan.mark() && mark.len() == 16));
        // Of 56 measures of a run and those of a map, half have values; the others have no column.
        let odd = plan.measures()[1].column();
        assert!(!texts.columns.contains(&odd), "{odd}");
        assert!(texts.columns.len() < plan.columns().len() && texts.columns.len() > 40);
    }

    #[test]
    fn rows_in_another_order_are_sorted() {
        let folder = tempfile::tempdir().unwrap();
        let plan = plan(folder.path(), STEPS, 2);
        let rows = made_up(&plan);
        let table = folder.path().join("t.csv");
        write_table(&table, &plan, &rows.as_slice()).unwrap();
        let text = std::fs::read_to_string(&table).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        let turned: Vec<&str> = lines[..1].iter().chain(lines[1..].iter().rev()).copied().collect();
        std::fs::write(&table, turned.join("\n")).unwrap();
        let own = read_own_table(&table, &plan).unwrap();
        assert_eq!(own.read().collect::<Result<Vec<_>, _>>().unwrap(), rows);
        assert_eq!((own.overview(), own.runs(), own.sorted.is_some()), (rows.as_slice().overview(), 2, true));
    }

    #[test]
    fn a_run_whose_last_row_was_cut_off_is_left_out_wherever_the_cut_is() {
        let folder = tempfile::tempdir().unwrap();
        let plan = plan(folder.path(), STEPS, 2);
        let mut rows = made_up(&plan);
        // The last run has two maps, and the texts of failed runs may have quotes.
        rows[3].outcome = rows[0].outcome.clone();
        rows[2].outcome = Err("a, \"b\"\nc".into());
        let table = folder.path().join("t.csv");
        write_table(&table, &plan, &rows.as_slice()).unwrap();
        let whole = std::fs::read(&table).unwrap();
        let rows_at = |length: usize| {
            std::fs::write(&table, &whole[..length]).unwrap();
            let own = read_own_table(&table, &plan).unwrap();
            let found = own.read().collect::<Result<Vec<_>, _>>().unwrap();
            assert_eq!(found, rows[..found.len()], "{length} octets");
            assert_eq!(own.overview().rows, found.len());
            found.len()
        };
        let starts: Vec<usize> = std::iter::once(0)
            .chain((1..whole.len()).filter(|&at| whole[at - 1] == b'\n'))
            .filter(|&at| whole[at..].starts_with(b"1,") || at == 0)
            .collect();
        let [_, third, fourth, second_map] = starts[..] else { panic!("{starts:?}") };
        // A row of which only `1,0` is left may be of the run before it, which is then done again too.
        for (range, expected) in [
            (third + 1..third + 4, 1),
            (third + 4..fourth, 2),
            (fourth + 1..fourth + 4, 2),
            (fourth + 4..second_map, 3),
            (second_map + 1..whole.len() - 1, 3),
        ] {
            for length in range.step_by(7) {
                assert_eq!(rows_at(length), expected, "{length} octets");
            }
        }
        assert_eq!((rows_at(whole.len() - 2), rows_at(whole.len() - 1), rows_at(whole.len())), (3, 4, 4));
    }

    #[test]
    fn rows_that_contradict_each_other_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let plan = plan(folder.path(), STEPS, 2);
        let table = folder.path().join("t.csv");
        write_table(&table, &plan, &made_up(&plan).as_slice()).unwrap();
        let text = std::fs::read_to_string(&table).unwrap();
        std::fs::write(&table, text.replacen(",1000,", ",1001,", 1)).unwrap();
        let error = read_table(&table, &plan).unwrap_err().to_string();
        assert!(error.contains("row 2 contradicts one before it"), "{error}");
    }
}
