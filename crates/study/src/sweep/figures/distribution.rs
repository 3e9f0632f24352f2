//! The distribution of a measure over the runs, as steps.

use std::collections::BTreeMap;

use sextant_figure::{Curves, Series};
use sextant_kernel::text::counted;

use super::Drawn;
use super::groups::{Curve, Groups};
use crate::sweep::finished_table::FinishedTable;

/// The share of the successful runs of each cell and map with at most each value. A run without a value has none that is at
/// most anything, so a curve ends at the share of the runs that have one.
pub(super) fn steps(table: &FinishedTable, title: &str, drawn: &Drawn) -> Curves {
    let groups = Groups::new(table, drawn.column, &[]);
    let maps: Vec<&str> =
        if table.is_of_maps(drawn.column) { table.maps().iter().map(String::as_str).collect() } else { vec![""] };
    let mut curves: BTreeMap<Curve, Runs> = BTreeMap::new();
    for &run in table.runs().iter().filter(|&&run| table.has_succeeded(run)) {
        for map in &maps {
            let row = if map.is_empty() { Some(run) } else { table.row_of(run, map) };
            let runs = curves.entry(groups.of_map(run, map)).or_default();
            runs.count += 1;
            runs.values.extend(row.and_then(|row| drawn.number(table, row)));
        }
    }
    // Nothing is known of a map that none of these runs has.
    curves.retain(|_, runs| !runs.values.is_empty());
    let end = curves.values().flat_map(|runs| &runs.values).copied().fold(f64::NEG_INFINITY, f64::max);
    let most = counted(curves.values().map(|runs| runs.count).max().unwrap_or(0), "run");
    let lacks_values = curves.values().any(|runs| runs.values.len() < runs.count);
    let series = curves.into_iter().map(|(curve, runs)| Series {
        name: curve.name("runs"),
        points: runs.stairs(end),
        intervals: Vec::new(),
    });
    let more = if lacks_values { "; a curve ends at the share of its runs that have a value" } else { "" };
    Curves {
        title: title.to_owned(),
        note: format!("distribution over up to {most}{more}"),
        across: drawn.label.clone(),
        up: "share of runs with at most this value".to_owned(),
        series: series.collect(),
    }
}

/// The successful runs of a curve.
#[derive(Default)]
struct Runs {
    count: usize,
    /// The values of those that have one.
    values: Vec<f64>,
}

impl Runs {
    /// The corners of the stairs from the least value to the end of the axis.
    fn stairs(mut self, end: f64) -> Vec<(f64, f64)> {
        self.values.sort_by(f64::total_cmp);
        let share = |runs: usize| runs as f64 / self.count as f64;
        let mut corners = Vec::new();
        for (i, &value) in self.values.iter().enumerate() {
            corners.extend([(value, share(i)), (value, share(i + 1))]);
        }
        corners.push((end, share(self.values.len())));
        corners
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_ends_at_the_share_of_the_runs_that_have_a_value() {
        let text = "cell,replicate,seed,map,error,applications.a.captured,applications.a.time_s\n0,0,1,,,1,4\n0,1,2,,,1,2\n\
                    0,2,3,,,0,\n0,3,4,,,1,6\n0,4,5,,,1,8\n0,5,6,,boom,,\n";
        let table = FinishedTable::parse(text).unwrap();
        let curves = steps(&table, "t", &Drawn::of(&table, 6));
        assert_eq!(curves.series[0].points.last(), Some(&(8.0, 0.8)), "the failed run does not count");
        assert_eq!(curves.series[0].points[1], (2.0, 0.2));
        let note = "distribution over up to 5 runs; a curve ends at the share of its runs that have a value";
        assert_eq!(curves.note, note);
    }

    #[test]
    fn a_run_without_a_map_that_others_of_its_curve_have_counts() {
        let text =
            "cell,replicate,seed,rate,map,error,mapped\n0,0,1,5,a,,4\n0,0,1,5,b,,1\n0,1,2,5,a,,2\n1,0,1,6,a,,3\n";
        let table = FinishedTable::parse(text).unwrap();
        let curves = steps(&table, "t", &Drawn::of(&table, 6));
        let ends: Vec<_> =
            curves.series.iter().map(|series| (&*series.name, series.points.last().unwrap().1)).collect();
        assert_eq!(ends, [("a, rate 5", 1.0), ("a, rate 6", 1.0), ("b, rate 5", 0.5)]);
    }

    #[test]
    fn a_distribution_rises_by_one_run_at_each_value() {
        let text = "cell,replicate,seed,map,error,mapped\n0,0,1,a,,4\n0,0,1,b,,1\n0,1,2,a,,2\n";
        let table = FinishedTable::parse(text).unwrap();
        let curves = steps(&table, "t", &Drawn::of(&table, 5));
        assert_eq!(curves.series[0].points, [(2.0, 0.0), (2.0, 0.5), (4.0, 0.5), (4.0, 1.0), (4.0, 1.0)]);
        assert_eq!(curves.series[1].points, [(1.0, 0.0), (1.0, 0.5), (4.0, 0.5)]);
        assert_eq!(curves.series[1].name, "b");
    }
}
