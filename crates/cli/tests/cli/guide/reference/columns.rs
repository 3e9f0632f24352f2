//! The columns of the tables of sweeps as a page.

use sextant_study::sweep::{ColumnSubject, DescribedColumn};

const PREFACE: &str = "# Reference of columns\n\n\
    Here is every column that the table of `sextant sweep` may have. A measure without a value in any row has no column in \
    the file. `sextant sweep --columns SCENARIO.toml` prints those of one scenario. [Metrics](../metrics.md) defines the \
    numbers.\n\n\
    Units are SI. A share has the unit 1 and is between 0 and 1; counts have no unit. `NAME` is the name of an application.\n";

/// The page of all columns, by what they are of.
pub(super) fn page(columns: &[DescribedColumn]) -> String {
    let sections = [
        (ColumnSubject::Row, "Which row it is"),
        (ColumnSubject::Setting, "Settings"),
        (ColumnSubject::Run, "Of the run: the same in each of its rows"),
        (ColumnSubject::Map, "Of the map"),
    ];
    let section = |(of, heading): (ColumnSubject, &str)| {
        let row = |column: &DescribedColumn| {
            format!("| `{}` | {} | {} |\n", column.name, column.unit, column.meaning.replace('|', "\\|"))
        };
        let rows: String = columns.iter().filter(|column| column.of == of).map(row).collect();
        format!("\n## {heading}\n| column | unit | meaning |\n| --- | --- | --- |\n{rows}")
    };
    PREFACE.to_owned() + &sections.into_iter().map(section).collect::<String>()
}
