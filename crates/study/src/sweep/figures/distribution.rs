//! The distribution of a measure over the runs, as steps.

use std::collections::BTreeMap;

use sextant_figure::{Curves, Series};
use sextant_kernel::text::counted;

use super::Drawn;
use super::groups::{Curve, Groups};
use crate::sweep::finished_table::FinishedTable;

/// The share of the runs of each cell and map with at most each value.
pub(super) fn steps(table: &FinishedTable, title: &str, drawn: &Drawn) -> Curves {
    let groups = Groups::new(table, drawn.column, &[]);
    let mut curves: BTreeMap<Curve, Vec<f64>> = BTreeMap::new();
    for row in table.rows_of(drawn.column) {
        if let Some(value) = drawn.number(table, row) {
            curves.entry(groups.of(row)).or_default().push(value);
        }
    }
    let end = curves.values().flatten().copied().fold(f64::NEG_INFINITY, f64::max);
    let most = curves.values().map(Vec::len).max().unwrap_or(0);
    let series = curves.into_iter().map(|(curve, values)| Series {
        name: curve.name("runs"),
        points: stairs(values, end),
        half_widths: Vec::new(),
    });
    Curves {
        title: title.to_owned(),
        note: format!("distribution over up to {}", counted(most, "run")),
        across: drawn.label.clone(),
        up: "share of runs with at most this value".to_owned(),
        series: series.collect(),
    }
}

/// The corners of the stairs from the least value to the end of the axis.
fn stairs(mut values: Vec<f64>, end: f64) -> Vec<(f64, f64)> {
    values.sort_by(f64::total_cmp);
    let runs = values.len() as f64;
    let mut corners = Vec::new();
    for (i, value) in values.into_iter().enumerate() {
        corners.extend([(value, i as f64 / runs), (value, (i + 1) as f64 / runs)]);
    }
    corners.push((end, 1.0));
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_distribution_rises_by_one_run_at_each_value() {
        let text = "cell,replicate,seed,map,error,mapped\n0,0,1,a,,4\n0,0,1,b,,1\n0,1,2,a,,2\n";
        let table = FinishedTable::parse(text).unwrap();
        let curves = steps(&table, "t", &Drawn::of(&table, 5));
        assert_eq!(curves.series[0].points, [(2.0, 0.0), (2.0, 0.5), (4.0, 0.5), (4.0, 1.0), (4.0, 1.0)]);
        assert_eq!(curves.series[1].points, [(1.0, 0.0), (1.0, 1.0), (4.0, 1.0)]);
        assert_eq!(curves.series[1].name, "b");
    }
}
