//! The curves of a measure: rows of one map with the same settings, but one.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use crate::sweep::finished_table::{FinishedTable, exact_number};
use crate::sweep::setting::SettingName;

/// What tells a curve from the others: its map and settings. Curves are ordered by the map, then by the settings: numbers by
/// size, and words by their first row.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    /// The rank of the map, and its name if the legend needs it.
    map: (usize, Option<String>),
    /// The values of settings.
    settings: Vec<Value>,
    /// More about the curve, after the settings.
    note: Option<String>,
}

/// A value of a setting.
#[derive(Clone, Debug)]
struct Value {
    /// Rank of the value among the texts of the column.
    rank: usize,
    /// The number, if all values of the column are numbers.
    number: Option<f64>,
    /// As in a legend.
    words: String,
}

impl Value {
    fn order(&self, other: &Self) -> Ordering {
        match (self.number, other.number) {
            (Some(a), Some(b)) => a.total_cmp(&b),
            _ => self.rank.cmp(&other.rank),
        }
    }
}

/// The curves of a measure of a table.
pub(super) struct Groups<'a> {
    table: &'a FinishedTable,
    /// The settings that tell curves apart.
    settings: Vec<Setting<'a>>,
    has_maps: bool,
}

/// A setting that tells curves apart.
struct Setting<'a> {
    column: usize,
    name: SettingName,
    are_numbers: bool,
    /// Ranks of its texts, by their first rows.
    ranks: BTreeMap<&'a str, usize>,
}

impl<'a> Groups<'a> {
    /// Of the numbers in `column`; the settings `merged` do not tell curves apart.
    pub(super) fn new(table: &'a FinishedTable, column: usize, merged: &[usize]) -> Self {
        let setting = |column: usize| {
            let mut ranks = BTreeMap::new();
            for &row in table.runs() {
                let rank = ranks.len();
                ranks.entry(table.cell(row, column)).or_insert(rank);
            }
            let are_numbers = ranks.keys().all(|text| exact_number(text).is_some());
            Setting { column, name: SettingName::of(&table.columns()[column]), are_numbers, ranks }
        };
        let settings = table.settings().filter(|column| !merged.contains(column)).map(setting).collect();
        Self { table, settings, has_maps: table.is_of_maps(column) }
    }

    /// The curve of a row.
    pub(super) fn of(&self, row: usize) -> Curve {
        self.of_map(row, self.table.map(row))
    }

    /// The curve of a map with the settings of a row.
    pub(super) fn of_map(&self, row: usize, map: &str) -> Curve {
        let table = self.table;
        let map = match (self.has_maps, table.maps()) {
            (true, maps @ [_, _, ..]) => {
                (maps.iter().position(|other| other == map).unwrap_or(0), Some(map.to_owned()))
            }
            _ => (0, None),
        };
        let value = |setting: &Setting| {
            let text = table.cell(row, setting.column);
            let words = if text.is_empty() { String::new() } else { setting.name.with(text) };
            let number = table.number(row, setting.column).filter(|_| setting.are_numbers);
            Value { rank: setting.ranks.get(text).copied().unwrap_or(0), number, words }
        };
        Curve { map, settings: self.settings.iter().map(value).collect(), note: None }
    }
}

impl Curve {
    /// The same with more about it.
    pub(super) fn noted(self, note: &str) -> Self {
        Self { note: Some(note.to_owned()), ..self }
    }

    /// Its name in the legend; `else_name` if nothing tells it from others.
    pub(super) fn name(&self, else_name: &str) -> String {
        let settings = self.settings.iter().map(|value| value.words.clone()).filter(|words| !words.is_empty());
        let parts: Vec<String> = self.map.1.iter().cloned().chain(settings).chain(self.note.clone()).collect();
        if parts.is_empty() { else_name.to_owned() } else { parts.join(", ") }
    }
}

impl Ord for Curve {
    fn cmp(&self, other: &Self) -> Ordering {
        let settings = || {
            let mut pairs = self.settings.iter().zip(&other.settings).map(|(a, b)| a.order(b));
            pairs.find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
        };
        self.map.0.cmp(&other.map.0).then_with(settings).then_with(|| self.note.cmp(&other.note))
    }
}

impl PartialOrd for Curve {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Curve {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Curve {}
