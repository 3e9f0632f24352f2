//! What the columns of a table mean.

use serde::Serialize;
use sextant::summary::Measure;
use sextant::summary::measures::{Subjects, all};
use sextant_scenario::{Explanation, explain};

use super::plan::Sweep;
use super::setting::SettingName;
use super::tidy::{ERROR, IDENTITY, MAP, SWEEP, measured};

/// A column of the table of a sweep, and what it means.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct DescribedColumn {
    /// Its name.
    pub name: String,
    /// Its unit: empty of counts and texts, `1` of shares.
    pub unit: String,
    /// What its values are of.
    pub of: ColumnSubject,
    /// What it means.
    pub meaning: String,
}

/// What the values of a column are of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ColumnSubject {
    /// Which row it is.
    Row,
    /// A setting that varies.
    Setting,
    /// The whole run: the same in each of its rows.
    Run,
    /// A map.
    Map,
}

/// The columns that the table of `plan` may have; without a plan, all that tables may have, where `NAME` is that of a network or
/// an application. A measure without any value has no column in the file.
#[must_use]
pub fn described_columns(plan: Option<&Sweep>) -> Vec<DescribedColumn> {
    let row = |name: &str, meaning: &str| DescribedColumn {
        name: name.to_owned(),
        unit: String::new(),
        of: ColumnSubject::Row,
        meaning: meaning.to_owned(),
    };
    let [cell, replicate, seed] = IDENTITY;
    let mut columns = vec![
        row(cell, "number of the cell, from 0: a cell is one combination of settings"),
        row(replicate, "number of the run of the cell, from 0"),
        row(seed, "seed of the run: the same runs of all cells have the same seeds"),
    ];
    match plan {
        Some(plan) => columns.extend(plan.keys().iter().map(|key| of_setting(&key.name))),
        None => columns.push(DescribedColumn {
            of: ColumnSubject::Setting,
            ..row("KEY", "each setting that varies, by its key in the scenario; the unit is the end of the key")
        }),
    }
    columns.push(row(MAP, "name of the map that the row is of; empty if the run computes no map"));
    columns.push(row(ERROR, "why the run failed; empty if it did not"));
    columns.extend(match plan {
        Some(plan) => {
            let measures = |measured: super::tidy::Measured| measured.any().map(|i| of_measure(&plan.measures()[i]));
            measured(plan).into_iter().filter_map(measures).collect::<Vec<_>>()
        }
        None => {
            let (of_maps, of_runs): (Vec<_>, Vec<_>) =
                all(&Subjects::every("NAME")).into_iter().partition(|measure| measure.map().is_some());
            of_runs.iter().chain(&of_maps).map(of_measure).collect()
        }
    });
    columns.push(row(SWEEP, "mark of the sweep that the row is of: scenario, files, first seed and version"));
    columns
}

fn of_measure(measure: &Measure) -> DescribedColumn {
    DescribedColumn {
        name: measure.column(),
        unit: measure.unit().symbol().to_owned(),
        of: if measure.map().is_some() { ColumnSubject::Map } else { ColumnSubject::Run },
        meaning: measure.meaning(),
    }
}

fn of_setting(key: &str) -> DescribedColumn {
    let name = SettingName::of(key);
    let meaning = match explain(key) {
        Ok(Explanation::Key { key, .. }) => key.summary().to_owned(),
        Ok(Explanation::Several(_)) | Err(_) => name.words().to_owned(),
    };
    DescribedColumn { name: key.to_owned(), unit: name.unit().to_owned(), of: ColumnSubject::Setting, meaning }
}
