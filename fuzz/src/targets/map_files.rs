//! Files about maps: maps, true positions, areas, tables of sweeps.

use sextant_logs::{LocalPlane, Names, read_area, read_map, read_truth};
use sextant_study::sweep::FinishedTable;

use crate::scratch;

/// All readers of maps read it or refuse it, and places are numbers.
pub(crate) fn check(octets: &[u8]) {
    let path = scratch::file("map.csv", octets);
    if let Ok(places) = read_map(&path) {
        assert!(places.values().all(|place| place.is_finite()), "a place that is no number");
        let truth = read_truth(&path, None, None, &mut Vec::new());
        assert!(truth.is_err() || truth.is_ok_and(|truth| truth.places == places), "a map as true positions");
    }
    let plane = LocalPlane::new(50.0, 3.0, 20.0);
    for plane in [None, Some(&plane)] {
        if let Ok(truth) = read_truth(&path, None, plane, &mut Vec::new()) {
            assert!(truth.places.values().all(|place| place.is_finite()), "a true position that is no number");
        }
        if let Ok(area) = read_area(&path, plane) {
            let [low, high] = area.bounds();
            assert!(low[0] <= high[0] && low[1] <= high[1], "an area without bounds");
        }
    }
    let _ = Names::read(&path, &mut Vec::new());
    if let Ok(table) = FinishedTable::read(&path) {
        assert!(table.measures().end <= table.columns().len() && table.settings().end <= table.columns().len());
        for column in table.measures() {
            let rows = table.rows_of(column).len();
            assert!(rows <= table.rows_of(table.error_column()).len().max(rows), "rows of column {column}");
        }
    }
}
