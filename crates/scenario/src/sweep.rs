//! The table `[sweep]` of a scenario: the settings that vary, and their values.

use std::collections::BTreeMap;
use std::num::NonZeroU32;

use serde::{Deserialize, Serialize};

use super::document::effective;
use super::document::key_path::{KeyPath, MOST_STEPS, PathStep, TOO_DEEP};
use super::document::{Document, Entry, Value};
use super::error::ScenarioError;
use super::refusal::Refusal;

/// Maximum number of cells of a sweep; more are surely a mistake.
const MOST_CELLS: usize = 1_000_000;

/// Default number of runs of each cell.
const DEFAULT_RUNS: NonZeroU32 = NonZeroU32::new(10).expect("ten is above zero");

/// The settings that `sextant sweep` varies, as written in a scenario. Each key is the path of a setting:
/// `channel.environment` or `robots.0.speed_m_per_s`. The cells of the sweep are all combinations of a cell of
/// `product`, a cell of `zip` and a cell of `list`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct SweepConfig {
    /// Runs of each cell, with the seeds `seed`, `seed` + 1, .. (the same in each cell); 10 if absent.
    pub runs: Option<NonZeroU32>,
    /// Settings with arrays of values: each combination of values is a cell.
    pub product: BTreeMap<String, serde_json::Value>,
    /// Settings with arrays of values that change together: the first values form a cell, the second values the next.
    pub zip: BTreeMap<String, serde_json::Value>,
    /// A list of cells, each a table of settings.
    pub list: Vec<BTreeMap<String, serde_json::Value>>,
}

/// One setting of a cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    /// Path of the key.
    pub key: String,
    /// The value in TOML.
    pub value: String,
}

impl Setting {
    /// The setting in one line: `path.to.key=value`.
    #[must_use]
    pub fn line(&self) -> String {
        format!("{}={}", self.key, self.value)
    }
}

/// The cells of a sweep, each with the settings that differ from the scenario.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SweepAxes {
    /// Runs of each cell, unless they are given with the sweep.
    pub runs: NonZeroU32,
    /// The cells. A scenario without `[sweep]` has one cell without settings.
    pub cells: Vec<Vec<Setting>>,
    /// Where `[sweep]` has the values of each key of `product` and `zip`, as written: `sweep.product."radio.tx_power_dbm"`.
    pub(super) places: BTreeMap<String, String>,
}

impl SweepAxes {
    /// The sweep of a document.
    pub(super) fn of(document: &Document) -> Result<Self, ScenarioError> {
        let path = KeyPath(vec![PathStep::Key("sweep".to_owned())]);
        let mut runs = DEFAULT_RUNS;
        let mut groups: Vec<Vec<Vec<Setting>>> = Vec::new();
        let mut places = BTreeMap::new();
        if let Some(entry) = document.root.child(&path.0[0]) {
            let reader = Reader { document };
            for (key, entry) in reader.table(entry, &path)? {
                let path = path.child(PathStep::Key(key.clone()));
                match key.as_str() {
                    "runs" => runs = reader.runs(entry, &path)?,
                    "product" => {
                        let axes = reader.axes(entry, &path, &mut places)?;
                        check_count(document, &path, axes.iter().map(|(_, values)| values.len()))?;
                        groups.push(product(axes));
                    }
                    "zip" => groups.push(reader.zipped(entry, &path, &mut places)?),
                    "list" => groups.push(reader.list(entry, &path)?),
                    _ => {
                        let expected = &["runs", "product", "zip", "list"];
                        let refusal = Refusal::UnknownField { field: key.clone(), expected };
                        return Err(document.refused(&path, &refusal));
                    }
                }
            }
        }
        check_count(document, &path, groups.iter().map(Vec::len))?;
        let cells = groups.into_iter().fold(vec![Vec::new()], |cells, group| combined(&cells, &group));
        let this = Self { runs, cells, places };
        this.check_keys(document, &path)?;
        Ok(this)
    }

    /// Rejects settings that are given twice, and keys that a sweep cannot vary, such as the seed.
    fn check_keys(&self, document: &Document, path: &KeyPath) -> Result<(), ScenarioError> {
        let refuse = |found: String, expected: &str| {
            let refusal = Refusal::Unfit { found, expected: expected.to_owned() };
            Err(document.refused(path, &refusal))
        };
        for cell in &self.cells {
            for (i, Setting { key, .. }) in cell.iter().enumerate() {
                if cell[..i].iter().any(|other| other.key == *key) {
                    return refuse(
                        format!("a sweep that sets `{key}` twice"),
                        "each setting in only one of `product`, `zip` and `list`",
                    );
                }
                if key == "seed" || key == "extends" || key == "sweep" || key.starts_with("sweep.") {
                    return refuse(
                        format!("a sweep over `{key}`"),
                        "settings of the scenario; the seeds come from `seed` and `runs`",
                    );
                }
            }
        }
        Ok(())
    }
}

/// Refuses more combinations of values than a sweep can have, before there are any.
fn check_count(
    document: &Document,
    path: &KeyPath,
    counts: impl IntoIterator<Item = usize>,
) -> Result<(), ScenarioError> {
    let count = counts.into_iter().try_fold(1_usize, |product, count| product.checked_mul(count));
    if count.is_some_and(|count| count <= MOST_CELLS) {
        return Ok(());
    }
    let cells = count.map_or_else(|| "too many".to_owned(), |count| count.to_string());
    let found = format!("a sweep of {cells} cells");
    Err(document.refused(path, &Refusal::Unfit { found, expected: format!("at most {MOST_CELLS} cells") }))
}

/// All combinations of the values of `axes`; the last axis varies fastest.
fn product(axes: Vec<(String, Vec<String>)>) -> Vec<Vec<Setting>> {
    axes.into_iter().fold(vec![Vec::new()], |cells, (key, values)| {
        let axis: Vec<_> = values.into_iter().map(|value| vec![Setting { key: key.clone(), value }]).collect();
        combined(&cells, &axis)
    })
}

/// Each of `cells` combined with each of `group`; the latter varies fastest.
fn combined(cells: &[Vec<Setting>], group: &[Vec<Setting>]) -> Vec<Vec<Setting>> {
    cells.iter().flat_map(|cell| group.iter().map(|more| [cell.as_slice(), more].concat())).collect()
}

/// Reads the parts of `[sweep]`; errors point at the key.
struct Reader<'a> {
    document: &'a Document,
}

impl<'a> Reader<'a> {
    fn unfit(&self, path: &KeyPath, found: impl Into<String>, expected: impl Into<String>) -> ScenarioError {
        let refusal = Refusal::Unfit { found: found.into(), expected: expected.into() };
        self.document.refused(path, &refusal)
    }

    /// The entries of a table in the order of the file.
    fn table(&self, entry: &'a Entry, path: &KeyPath) -> Result<Vec<(&'a String, &'a Entry)>, ScenarioError> {
        let Value::Table(table) = &entry.value else {
            return Err(self.unfit(path, "not a table", "a table"));
        };
        let mut entries: Vec<_> = table.iter().collect();
        entries.sort_by_key(|(_, entry)| (entry.origin.source, entry.origin.head().start));
        Ok(entries)
    }

    fn runs(&self, entry: &Entry, path: &KeyPath) -> Result<NonZeroU32, ScenarioError> {
        let runs = match entry.value {
            Value::Integer(runs) => u32::try_from(runs).ok().and_then(NonZeroU32::new),
            _ => None,
        };
        runs.ok_or_else(|| self.unfit(path, effective::inline(&entry.value), "a whole number, 1 or above"))
    }

    /// The axes in a table: paths of settings, and the values of each. Notes their `places`.
    fn axes(
        &self,
        entry: &Entry,
        path: &KeyPath,
        places: &mut BTreeMap<String, String>,
    ) -> Result<Vec<(String, Vec<String>)>, ScenarioError> {
        let mut axes = Vec::new();
        self.leaves(entry, path, &KeyPath::default(), &mut |path, key, value| {
            let Value::Array(items) = value else {
                return Err(self.unfit(path, effective::inline(value), "an array of values"));
            };
            if items.is_empty() {
                return Err(self.unfit(path, "an empty array", "at least one value"));
            }
            places.insert(key.clone(), path.to_string());
            axes.push((key, items.iter().map(|item| effective::inline(&item.value)).collect()));
            Ok(())
        })?;
        Ok(axes)
    }

    fn zipped(
        &self,
        entry: &Entry,
        path: &KeyPath,
        places: &mut BTreeMap<String, String>,
    ) -> Result<Vec<Vec<Setting>>, ScenarioError> {
        let axes = self.axes(entry, path, places)?;
        let Some((first, values)) = axes.first() else {
            return Ok(vec![Vec::new()]);
        };
        if let Some((key, others)) = axes.iter().find(|(_, others)| others.len() != values.len()) {
            let found = format!("{} values of `{first}` and {} of `{key}`", values.len(), others.len());
            return Err(self.unfit(path, found, "the same number of values for each key"));
        }
        let cell = |i: usize| {
            axes.iter().map(|(key, values)| Setting { key: key.clone(), value: values[i].clone() }).collect()
        };
        Ok((0..values.len()).map(cell).collect())
    }

    fn list(&self, entry: &Entry, path: &KeyPath) -> Result<Vec<Vec<Setting>>, ScenarioError> {
        let Value::Array(items) = &entry.value else {
            return Err(self.unfit(path, "not an array", "an array with one table of settings per cell"));
        };
        if items.is_empty() {
            return Err(self.unfit(path, "an empty array", "at least one cell"));
        }
        let mut cells = Vec::new();
        for (i, item) in items.iter().enumerate() {
            let mut cell = Vec::new();
            self.leaves(item, &path.child(PathStep::Index(i)), &KeyPath::default(), &mut |_, key, value| {
                cell.push(Setting { key, value: effective::inline(value) });
                Ok(())
            })?;
            cells.push(cell);
        }
        Ok(cells)
    }

    /// Visits all values in `entry` except tables. `path` is the path of `entry`, and `key` that of the setting that it
    /// varies.
    fn leaves(
        &self,
        entry: &Entry,
        path: &KeyPath,
        key: &KeyPath,
        visit: &mut impl FnMut(&KeyPath, String, &Value) -> Result<(), ScenarioError>,
    ) -> Result<(), ScenarioError> {
        for (name, entry) in self.table(entry, path)? {
            let path = path.child(PathStep::Key(name.clone()));
            let steps = KeyPath::parse(name).map_err(|error| {
                self.unfit(&path, format!("no path of a setting: {}", error.message), "path.to.key")
            })?;
            let key = KeyPath([key.0.as_slice(), &steps.0].concat());
            if key.0.len() > MOST_STEPS {
                return Err(self.unfit(&path, format!("no path of a setting: {TOO_DEEP}"), "path.to.key"));
            }
            match &entry.value {
                Value::Table(_) => self.leaves(entry, &path, &key, visit)?,
                value => visit(&path, key.to_string(), value)?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;
    use std::sync::Arc;

    use super::super::document;
    use super::super::source::Source;
    use super::*;

    fn sweep(text: &str) -> Result<SweepAxes, ScenarioError> {
        let source = Source { name: "s.toml".into(), text: Arc::from(text), folder: PathBuf::new() };
        let sources = vec![source];
        let root = document::parse(&sources, 0)?;
        SweepAxes::of(&Document { root, sources, text: String::new() })
    }

    fn flags(sweep: &SweepAxes) -> Vec<String> {
        let cell = |cell: &Vec<Setting>| cell.iter().map(Setting::line).collect::<Vec<_>>().join(" ");
        sweep.cells.iter().map(cell).collect()
    }

    #[test]
    fn the_cells_are_all_combinations_in_the_order_of_the_file() {
        let sweep = sweep(
            "[sweep]\nruns = 3\n[sweep.product]\nz.p = [1, 2]\n\"a.b\" = [\"x\"]\n[sweep.zip]\nc = [0.5, 1.5]\n\
             d.0.e = [true, false]\n[[sweep.list]]\nf = 1\n[[sweep.list]]\nf = 2\ng = [1, 2]\n",
        )
        .unwrap();
        assert_eq!(sweep.runs.get(), 3);
        let expected = [
            "z.p=1 a.b=\"x\" c=0.5 d.0.e=true f=1",
            "z.p=1 a.b=\"x\" c=0.5 d.0.e=true f=2 g=[1, 2]",
            "z.p=1 a.b=\"x\" c=1.5 d.0.e=false f=1",
            "z.p=1 a.b=\"x\" c=1.5 d.0.e=false f=2 g=[1, 2]",
        ];
        assert_eq!(flags(&sweep)[..4], expected);
        assert_eq!(sweep.cells.len(), 8);
    }

    #[test]
    fn a_scenario_without_a_sweep_has_one_cell() {
        let none = SweepAxes { runs: DEFAULT_RUNS, cells: vec![Vec::new()], places: BTreeMap::new() };
        assert_eq!(sweep("seed = 1").unwrap(), none);
    }

    #[test]
    fn an_invalid_sweep_is_rejected_at_its_key() {
        for (text, message, place) in [
            ("[sweep]\nruns = 0", "`sweep.runs` is 0; allowed: a whole number, 1 or above", "s.toml:2:8"),
            ("[sweep]\nproduct.a = 3", "`sweep.product.a` is 3; allowed: an array of values", "s.toml:2:13"),
            ("[sweep]\nzip = { a = [1], b = [1, 2] }", "and 2 of `b`", "s.toml:2:1"),
            ("[sweep]\nprodukt = {}", "unknown key `produkt` in `sweep`", "s.toml:2:1"),
            ("[sweep]\nproduct.seed = [1]", "a sweep over `seed`", "s.toml:1:2"),
            ("[sweep]\nproduct.a = [1]\nzip.a = [1]", "sets `a` twice", "s.toml:1:2"),
            ("[sweep]\nlist = []", "at least one cell", "s.toml:2:8"),
        ] {
            let error = sweep(text).unwrap_err();
            assert!(error.to_string().contains(message), "{text}: {error}");
            assert_eq!(error.place().unwrap(), place, "{text}");
        }
    }

    #[test]
    fn a_sweep_with_too_many_cells_is_rejected() {
        let many = format!("[{}]", "1,".repeat(101));
        let error = sweep(&format!("[sweep.product]\na = {many}\nb = {many}\nc = {many}\n")).unwrap_err();
        assert!(error.to_string().contains("at most 1000000 cells"), "{error}");
    }
}
