//! Means of a measure against a setting.

use std::collections::BTreeMap;

use sextant::summary::Unit;
use sextant_figure::Curves;

use super::groups::{Curve, Groups};
use super::{Drawn, Points, add, averaged, note};
use crate::sweep::finished_table::FinishedTable;
use crate::sweep::setting::SettingName;

/// The curves of a measure: one of each map and combination of the other settings.
pub(super) fn curves(table: &FinishedTable, title: &str, across: usize, drawn: &Drawn) -> Curves {
    let groups = Groups::new(table, drawn.column, &[across]);
    let mut curves: BTreeMap<Curve, Points> = BTreeMap::new();
    for row in table.rows_of(drawn.column) {
        if let (Some(x), Some(y)) = (table.number(row, across), drawn.number(table, row)) {
            add(curves.entry(groups.of(row)).or_default(), x, y);
        }
    }
    let what = if drawn.unit == Unit::Outcome { "share" } else { "mean" };
    let note = note(what, curves.values().flatten().map(|(_, values)| values.len()));
    let series = curves.into_iter().map(|(curve, points)| averaged(curve.name(what), points, drawn.unit));
    Curves {
        title: title.to_owned(),
        note,
        across: SettingName::of(&table.columns()[across]).axis(),
        up: drawn.label.clone(),
        series: series.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = "cell,replicate,seed,a.kind,b.rate,map,error,mac.prr,mapped\n\
                         0,0,1,20,10,p,,0.5,1\n0,0,1,20,10,q,,0.5,3\n0,1,2,20,10,p,,0.7,\n1,0,1,20,2.5,p,,0.9,3\n\
                         2,0,1,3,10,p,,0.25,4\n3,0,1,3,2.5,,boom,,\n";

    fn drawn(name: &str) -> Curves {
        let table = FinishedTable::parse(TABLE).unwrap();
        assert_eq!(table.across().map(|column| table.columns()[column].as_str()), Some("b.rate"));
        let drawn = Drawn::of(&table, table.measure(name).unwrap());
        curves(&table, "t", table.across().unwrap(), &drawn)
    }

    #[test]
    fn each_combination_of_other_settings_is_a_curve_of_means_in_the_order_of_numbers() {
        let curves = drawn("mac.prr");
        let points: Vec<_> = curves.series.iter().map(|series| (&*series.name, series.points.clone())).collect();
        assert_eq!(points, [("a kind 3", vec![(10.0, 0.25)]), ("a kind 20", vec![(2.5, 0.9), (10.0, 0.6)])]);
        // Two runs, of which one has two rows: t(0.975; 1) = 12.706 times 0.1414 / sqrt(2).
        assert!((curves.series[1].intervals[1].unwrap()[1] - 0.6 - 1.2706).abs() < 1e-3);
        assert_eq!((&*curves.up, &*curves.across), ("packet reception ratio", "b rate"));
    }

    #[test]
    fn an_outcome_is_a_share_whose_interval_stays_from_0_to_1() {
        let text = "cell,replicate,seed,rate,map,error,applications.detarsk.captured\n0,0,1,1,,,1.0\n0,1,2,1,,,1.0\n\
                    0,2,3,1,,,0.0\n0,3,4,1,,,1.0\n0,4,5,1,,,1.0\n1,0,1,2,,,1.0\n1,1,2,2,,,1.0\n";
        let table = FinishedTable::parse(text).unwrap();
        let curves = curves(&table, "t", 3, &Drawn::of(&table, 6));
        assert_eq!(curves.series[0].points, [(1.0, 0.8), (2.0, 1.0)]);
        let [few, all] = [0, 1].map(|i| curves.series[0].intervals[i].unwrap());
        assert!((few[0] - 0.2836).abs() < 1e-4 && (few[1] - 0.9949).abs() < 1e-4, "{few:?}");
        // If it happened in both runs, the low end is the square root of 0.025.
        assert!((all[0] - 0.025_f64.sqrt()).abs() < 1e-6 && (all[1] - 1.0).abs() < 1e-9, "{all:?}");
        assert_eq!(curves.note, "share of 2 to 5 runs, with 95 % intervals");
    }

    #[test]
    fn each_map_has_a_curve() {
        let curves = drawn("mapped");
        let names: Vec<_> = curves.series.iter().map(|series| &*series.name).collect();
        assert_eq!(names, ["p, a kind 3", "p, a kind 20", "q, a kind 20"]);
    }
}
