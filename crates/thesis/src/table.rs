//! A table of the thesis as its file has it.

use std::collections::BTreeMap;
use std::num::NonZeroU32;

use serde::Deserialize;

use super::better::Better;
use super::chart::ChartKind;
use super::open::OpenEntry;
use super::values::Values;
use super::words::{Item, Only};

/// The file of a table, or of several that differ in an item of a list.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Table {
    /// One table for each combination of items of these lists.
    #[serde(default)]
    pub(crate) each: Vec<String>,
    /// Number of the table or figure, or a word.
    pub(crate) id: String,
    /// Its title.
    pub(crate) title: String,
    /// Runs of each scenario, if the user does not choose.
    pub(crate) runs: NonZeroU32,
    /// Where published values are printed, if an entry does not say so.
    pub(crate) source: Option<String>,
    /// The scenario of entries that name none.
    pub(crate) scenario: Option<String>,
    /// The settings of the cell of entries that name none.
    pub(crate) at: Option<BTreeMap<String, String>>,
    /// The measure of entries that name none.
    pub(crate) measure: Option<String>,
    /// The items that variables of all entries may have.
    #[serde(default)]
    pub(crate) only: Only,
    /// Whether lines without a value are left out, if others have one.
    #[serde(default)]
    pub(crate) leave_out_empty_lines: bool,
    /// Notes on different definitions, and on what the thesis does not say.
    pub(crate) notes: Vec<String>,
    /// Lists of its own, beside those of the chapter.
    #[serde(default)]
    pub(crate) lists: BTreeMap<String, Vec<Item>>,
    /// Texts of its own.
    #[serde(default)]
    pub(crate) texts: BTreeMap<String, String>,
    /// Runs of each scenario under a reading, if the user does not choose.
    #[serde(default = "reading_runs")]
    pub(crate) reading_runs: NonZeroU32,
    /// What the thesis leaves open.
    #[serde(default)]
    pub(crate) open: Vec<OpenEntry>,
    /// Names of what is open and is also read together.
    #[serde(default)]
    pub(crate) together: Vec<[String; 2]>,
    /// Its lines.
    pub(crate) lines: Vec<Entry>,
    /// The conclusions that are checked.
    #[serde(default)]
    pub(crate) conclusions: Vec<Entry>,
    /// Its figures.
    #[serde(default)]
    pub(crate) charts: Vec<ChartEntry>,
    /// Its pictures of one run.
    #[serde(default)]
    pub(crate) pictures: Vec<PictureEntry>,
}

/// A reading is judged by a fifth of the published value, which few runs tell.
fn reading_runs() -> NonZeroU32 {
    const { NonZeroU32::new(5).expect("five is above zero") }
}

/// What the tables of a chapter share.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Shared {
    /// Lists by name.
    pub(crate) lists: BTreeMap<String, Vec<Item>>,
    /// Texts by name.
    #[serde(default)]
    pub(crate) texts: BTreeMap<String, String>,
    /// Entries by name, for `use`.
    #[serde(default)]
    pub(crate) shared: BTreeMap<String, Vec<Entry>>,
}

/// A line or a conclusion for each combination of items, or a group of entries. An entry has what its group says, where it
/// says nothing itself.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Entry {
    /// One for each combination of items of these lists.
    pub(crate) each: Vec<String>,
    /// Variables with the id of their item.
    pub(crate) with: BTreeMap<String, String>,
    /// The items that variables may have.
    pub(crate) only: Only,
    /// The entries of a group.
    pub(crate) lines: Vec<Entry>,
    /// The name of shared entries, which are those of the group.
    pub(crate) r#use: Option<String>,
    /// Its description.
    pub(crate) what: Option<String>,
    /// The scenario that it reads.
    pub(crate) scenario: Option<String>,
    /// The settings of the cell in the sweep of the scenario, by key; an empty one is left out.
    pub(crate) at: Option<BTreeMap<String, String>>,
    /// The path of what is measured in the summary of a run.
    pub(crate) measure: Option<String>,
    /// The printed unit, if it is not that of the measure.
    pub(crate) unit: Option<String>,
    /// The published value.
    pub(crate) published: Option<String>,
    /// Published values of some of the items; the first that fits counts.
    pub(crate) published_where: Vec<PublishedWhere>,
    /// The table, figure or section with the published value.
    pub(crate) source: Option<String>,
    /// Which values are better, if it is an error or a time of the method of the thesis, or a share that it wants.
    pub(crate) better: Option<Better>,
    /// The share of the runs with at least this value, and not the mean.
    pub(crate) at_least: Option<f64>,
    /// The cell with the least mean, and not that of this entry.
    pub(crate) least: Option<LeastEntry>,
    /// A likelihood, which needs no run.
    pub(crate) likelihood: Option<Likelihood>,
    /// The condition of a conclusion.
    pub(crate) check: Option<Condition>,
    /// What a conclusion compares: variables with the id of their item. One without any if there are none.
    pub(crate) terms: Vec<BTreeMap<String, String>>,
}

/// A published value of some items.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PublishedWhere {
    /// The items.
    pub(crate) only: Only,
    /// The value.
    pub(crate) value: String,
    /// Its source, if it is not that of the entry.
    pub(crate) source: Option<String>,
}

/// The cell with the least mean.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LeastEntry {
    /// The lists over which it is sought.
    pub(crate) over: Vec<String>,
    /// What is shown of it; the mean if nothing.
    pub(crate) show: Option<String>,
    /// The variable whose other values are shown too if they are not significantly worse.
    pub(crate) beside: Option<String>,
}

/// The likelihood of a node that was heard at one of several stops (thesis, eq. 3.2 and 3.3).
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Likelihood {
    /// Reception probability next to the node.
    pub(crate) p0: f64,
    /// Distance up to which the probability is `p0` (m).
    pub(crate) plateau_m: f64,
    /// Nothing is received at this distance or beyond (m).
    pub(crate) range_m: f64,
    /// The stop at which it was heard; the first is 1.
    pub(crate) heard_at: usize,
    /// Distances to the stops (m).
    pub(crate) distances_m: Vec<f64>,
}

/// The condition of a conclusion.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Condition {
    /// Each mean is above the previous one.
    Rising,
    /// The first is below each of the others.
    Least,
    /// The first is above each of the others.
    Greatest,
    /// All differences are less than this.
    Within(f64),
    /// The ratio of the first to the second is in this range.
    Ratio([f64; 2]),
    /// The first less the second is in this range.
    Difference([f64; 2]),
    /// The mean is below this limit.
    Below(f64),
    /// The mean is above this limit.
    Above(f64),
}

/// A figure for each combination of items.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ChartEntry {
    /// One for each combination of items of these lists.
    #[serde(default)]
    pub(crate) each: Vec<String>,
    /// Variables with the id of their item.
    #[serde(default)]
    pub(crate) with: BTreeMap<String, String>,
    /// The items that variables may have.
    #[serde(default)]
    pub(crate) only: Only,
    /// The name of its file.
    pub(crate) name: String,
    /// How values are drawn.
    pub(crate) kind: ChartKind,
    /// The unit of the values.
    #[serde(default)]
    pub(crate) values: Values,
    /// The title.
    pub(crate) title: String,
    /// The note below the title; `{runs}` is the number of runs.
    pub(crate) note: String,
    /// Name of the horizontal axis, with its unit.
    pub(crate) across: String,
    /// Name of the vertical axis, with its unit.
    pub(crate) up: String,
    /// The scenario, if it is not that of the table.
    pub(crate) scenario: Option<String>,
    /// The measure, if it is not that of the table.
    pub(crate) measure: Option<String>,
    /// A curve, or the bars of one colour, for each combination of items.
    pub(crate) curves: CurveEntry,
    /// The points of each curve.
    pub(crate) points: PointEntry,
}

/// A picture of one run for each combination of items.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PictureEntry {
    /// One for each combination of items of these lists.
    #[serde(default)]
    pub(crate) each: Vec<String>,
    /// The items that variables may have.
    #[serde(default)]
    pub(crate) only: Only,
    /// The scenario, if it is not that of the table.
    pub(crate) scenario: Option<String>,
    /// The name of the figure, as `sextant figure` names its file.
    pub(crate) figure: String,
    /// What it shows.
    pub(crate) title: String,
}

/// The curves of a figure.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CurveEntry {
    /// The lists.
    #[serde(default)]
    pub(crate) each: Vec<String>,
    /// The name in the legend.
    pub(crate) name: String,
}

/// The points of a curve.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PointEntry {
    /// The lists.
    pub(crate) each: Vec<String>,
    /// The horizontal value.
    pub(crate) x: HorizontalEntry,
}

/// A horizontal value.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum HorizontalEntry {
    /// A number.
    Number(String),
    /// The logarithm of a number, base 10.
    Log10(String),
    /// The mean of a measure of the same cell.
    Measured(String),
}

impl Entry {
    /// The entry with what its group says, where it says nothing itself.
    pub(crate) fn under(&self, group: &Self) -> Self {
        let or = |own: &Option<String>, of_group: &Option<String>| own.clone().or_else(|| of_group.clone());
        let published_where =
            if self.published_where.is_empty() { &group.published_where } else { &self.published_where };
        Self {
            what: or(&self.what, &group.what),
            scenario: or(&self.scenario, &group.scenario),
            at: self.at.clone().or_else(|| group.at.clone()),
            measure: or(&self.measure, &group.measure),
            unit: or(&self.unit, &group.unit),
            published: or(&self.published, &group.published),
            published_where: published_where.clone(),
            source: or(&self.source, &group.source),
            better: self.better.or(group.better),
            check: self.check.or(group.check),
            ..self.clone()
        }
    }
}
