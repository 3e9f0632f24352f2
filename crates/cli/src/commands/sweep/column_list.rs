//! `sextant sweep --columns`: what the columns of a table mean.

use std::io::{self, Write};

use sextant::columns::{Align, columns};
use sextant_study::sweep::{DescribedColumn, Sweep, described_columns};

use super::super::options::Printing;

/// Prints the columns that the table of `plan` may have, or those that tables may have.
pub(super) fn print(plan: Option<&Sweep>, printing: Printing) -> io::Result<()> {
    let described = described_columns(plan);
    printing.print(&described, |out| {
        let line = |column: &DescribedColumn| vec![column.name.clone(), column.unit.clone(), column.meaning.clone()];
        let head = ["column", "unit", "meaning"].map(str::to_owned).to_vec();
        let rows: Vec<_> = [head].into_iter().chain(described.iter().map(line)).collect();
        columns(&rows, &[Align::Left; 3], out)?;
        writeln!(out, "\nA measure without a value in any row has no column in the file.")
    })
}
