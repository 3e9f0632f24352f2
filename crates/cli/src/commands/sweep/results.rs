//! The results of a sweep, cell by cell.

use std::cell::RefCell;
use std::io::{self, Write};
use std::path::Path;

use serde::Serialize;
use serde::ser::{Error, SerializeSeq, Serializer};
use serde_json::{Map, Value, json};

use crate::commands::options::Format;
use crate::diagnostic::Failure;
use sextant::columns::{Align, columns};
use sextant::summary::Measure;
use sextant_kernel::text::counted;
use sextant_study::sweep::{Average, CellSummary, Column, ColumnKind, Overview, Rows, Sweep, TableError, summaries};

/// Of a large sweep, so many cells are printed.
const MOST_CELLS: usize = 100;

/// The rows of a sweep, summarised for each cell.
pub(in crate::commands) struct Results<'a> {
    pub(in crate::commands) plan: &'a Sweep,
    pub(in crate::commands) rows: &'a dyn Rows,
}

impl Results<'_> {
    /// Prints them; they are in the table `out`.
    pub(in crate::commands) fn tell(
        &self,
        out: &Path,
        format: Format,
        stdout: &mut impl Write,
    ) -> Result<(), Failure> {
        match format {
            Format::Text => {
                let cells = summaries(self.plan, self.rows).take(MOST_CELLS).collect::<Result<_, TableError>>()?;
                let printed = Printed { plan: self.plan, overview: self.rows.overview(), cells };
                Ok(printed.print(out, stdout)?)
            }
            Format::Json => self.print_json(stdout),
        }
    }

    /// Prints one cell after the other.
    fn print_json(&self, stdout: &mut impl Write) -> Result<(), Failure> {
        let Self { plan, rows } = *self;
        let unreadable = RefCell::new(None);
        let cells = JsonCells { plan, rows, unreadable: &unreadable };
        let sweep = JsonSweep { runs: plan.runs(), seed: plan.seed(), rows: rows.overview().rows, cells };
        let written = serde_json::to_writer_pretty(&mut *stdout, &JsonResults { sweep });
        if let Some(error) = unreadable.take() {
            return Err(error.into());
        }
        written.map_err(io::Error::from)?;
        Ok(writeln!(stdout)?)
    }
}

/// The results as an object.
#[derive(Serialize)]
struct JsonResults<'a> {
    sweep: JsonSweep<'a>,
}

#[derive(Serialize)]
struct JsonSweep<'a> {
    runs: u32,
    seed: u64,
    rows: usize,
    cells: JsonCells<'a>,
}

/// The cells, which are summarised while they are written.
struct JsonCells<'a> {
    plan: &'a Sweep,
    rows: &'a dyn Rows,
    /// Why a row could not be read.
    unreadable: &'a RefCell<Option<TableError>>,
}

impl Serialize for JsonCells<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut list = serializer.serialize_seq(None)?;
        for (i, summary) in summaries(self.plan, self.rows).enumerate() {
            let summary = summary.map_err(|error| {
                let message = S::Error::custom(&error);
                self.unreadable.replace(Some(error));
                message
            })?;
            list.serialize_element(&self.cell(i, &summary))?;
        }
        list.end()
    }
}

impl JsonCells<'_> {
    fn cell(&self, i: usize, summary: &CellSummary) -> Value {
        let (keys, cell) = (self.plan.keys(), &self.plan.cells()[i]);
        let settings = keys.iter().zip(cell.values(keys)).filter(|(_, value)| !value.is_empty());
        let settings: Map<_, _> = settings.map(|(key, value)| (key.name.clone(), value_of(key, value))).collect();
        let mut means = Map::new();
        for measure in self.plan.measures() {
            if let Some(average) = summary.average(self.plan, measure) {
                means.insert(measure.path(), average.json().into());
            }
        }
        json!({"cell": i, "settings": settings, "failed": summary.failed, "measures": means})
    }
}

/// The value of a setting: a number if all its values are numbers.
fn value_of(key: &Column, value: &str) -> Value {
    let number = || serde_json::from_str(value).ok().filter(Value::is_number);
    match key.kind {
        ColumnKind::Integer | ColumnKind::Unsigned | ColumnKind::Real => number().unwrap_or_else(|| json!(value)),
        ColumnKind::Text => json!(value),
    }
}

/// The results as text.
struct Printed<'a> {
    plan: &'a Sweep,
    overview: Overview,
    /// The cells that are printed.
    cells: Vec<CellSummary>,
}

impl Printed<'_> {
    /// The averages of a measure with their intervals by cell, all in the unit that suits the largest of them: `6.0 ± 0.3 %`,
    /// and `80 % (28 to 99 %)` of an outcome; `-` without a value. If not all runs of the cell have a value, their number
    /// follows: `6.0 ± 0.3 % (n = 4)`.
    fn written(&self, path: &str) -> Vec<String> {
        let average = |cell: &CellSummary| cell.average(self.plan, self.measure(path)?);
        let averages: Vec<Option<Average>> = self.cells.iter().map(average).collect();
        let largest = averages.iter().flatten().map(|average| average.value().abs()).fold(0.0, f64::max);
        let (factor, unit) = self.measure(path).map_or((1.0, ""), |measure| measure.unit().for_size(largest));
        let text = |(average, cell): (Option<Average>, &CellSummary)| {
            let Some(average) = average else { return "-".to_owned() };
            let runs = average.runs();
            let count = if runs == cell.succeeded { String::new() } else { format!(" (n = {runs})") };
            average.rounded(factor, unit) + &count
        };
        averages.into_iter().zip(&self.cells).map(text).collect()
    }

    fn measure(&self, path: &str) -> Option<&Measure> {
        self.plan.measures().iter().find(|measure| measure.path() == path)
    }

    /// The names of the measures that may be printed, with their paths, the most important ones first: those of which any cell has
    /// a value.
    fn measures(&self) -> Vec<(String, String)> {
        let of_map = |what: &str, path: &str| {
            let named = |map: &String| (format!("{map}: {what}"), format!("maps.{map}.{path}"));
            self.plan.maps().iter().map(named).collect::<Vec<_>>()
        };
        let of_application = |name: &String| {
            [("captured", "captured"), ("arrived", "arrived"), ("time", "time_s")]
                .map(|(what, path)| (format!("{name}: {what}"), format!("applications.{name}.{path}")))
        };
        let of_networks = |(what, path): (&str, &str)| {
            let named = |name: &String| (format!("{name}: {what}"), format!("networks.{name}.{path}"));
            self.plan.networks().iter().map(named).collect::<Vec<_>>()
        };
        let of_networks =
            [("PRR", "prr"), ("throughput", "throughput_bit_per_s"), ("mean delay", "delay_s.mean")].map(of_networks);
        let of_run = [
            ("delivery", "routing.delivery"),
            ("delay end to end", "routing.delay_s.mean"),
            ("hops", "routing.hops.mean"),
            ("transmissions", "routing.transmissions_per_delivery"),
            ("PRR", "mac.prr"),
            ("throughput", "mac.throughput_bit_per_s"),
            ("mean delay", "mac.delay_s.mean"),
            ("detections", "sensing.detections"),
            ("path", "gathering.path_length_m"),
        ];
        let of_run = of_run.map(|(name, path)| (name.to_owned(), path.to_owned()));
        let measures = of_map("mean error", "position_error_m.mean")
            .into_iter()
            .chain(self.plan.applications().iter().flat_map(of_application))
            .chain(of_networks.into_iter().flatten())
            .chain(of_run)
            .chain(of_map("connectivity error", "connectivity_error"));
        measures.filter(|(_, path)| self.has(path)).collect()
    }

    /// Whether any run has a value of a measure.
    fn has(&self, path: &str) -> bool {
        let at = self.plan.measures().iter().position(|measure| measure.path() == path);
        at.is_some_and(|at| self.overview.has_value.get(at) == Some(&true))
    }

    fn print(&self, out: &Path, stdout: &mut impl Write) -> io::Result<()> {
        let cells = 0..self.cells.len();
        let mut named = vec![
            ("cell".to_owned(), cells.clone().map(|i| i.to_string()).collect::<Vec<_>>()),
            ("runs".to_owned(), self.cells.iter().map(|cell| cell.succeeded.to_string()).collect()),
        ];
        for (i, name) in shortened(self.plan.keys()).enumerate() {
            named.push((name, cells.clone().map(|cell| self.plan.values(cell)[i].clone()).collect()));
        }
        let mut width: usize = named.iter().map(width_of).sum();
        let mut left_out = Vec::new();
        for (number, (name, path)) in self.measures().into_iter().enumerate() {
            let column = (name, self.written(&path));
            // One measure is printed, however wide.
            if number == 0 || width + width_of(&column) <= WIDTH {
                width += width_of(&column);
                named.push(column);
            } else {
                left_out.push(column.0);
            }
        }
        let align = vec![Align::Right; named.len()];
        let header = named.iter().map(|(name, _)| name.clone()).collect();
        let row = |i: usize| named.iter().map(|(_, texts): &(String, Vec<String>)| texts[i].clone()).collect();
        let rows: Vec<_> = [header].into_iter().chain(cells.map(row)).collect();
        columns(&rows, &align, stdout)?;
        let cells_left_out = self.plan.cells().len() - self.cells.len();
        if cells_left_out > 0 {
            writeln!(stdout, "and {} that are in the table only", counted(cells_left_out, "cell"))?;
        }
        if !left_out.is_empty() {
            writeln!(stdout, "in the table only: {}", left_out.join(", "))?;
        }
        for map in self.plan.maps() {
            self.print_unmapped(map, stdout)?;
        }
        let Overview { rows, failed, .. } = self.overview;
        let failures = if failed > 0 { format!(", {failed} of them failed (column error)") } else { String::new() };
        writeln!(stdout, "\n{}: {}{failures}", out.display(), counted(rows, "run"))
    }
}

impl Printed<'_> {
    /// Says how many nodes have no place on a map: errors leave them out.
    fn print_unmapped(&self, map: &str, stdout: &mut impl Write) -> io::Result<()> {
        let Some(measure) = self.measure(&format!("maps.{map}.unmapped")) else { return Ok(()) };
        let unmapped = |cell: &CellSummary| cell.average(self.plan, measure).map(|mean| mean.value());
        let most = self.cells.iter().filter_map(unmapped).fold(0.0, f64::max);
        if most > 0.0 {
            writeln!(
                stdout,
                "{map}: up to {most:.1} nodes of a cell have no place on average, and the errors leave them out (column `unmapped`)"
            )?;
        }
        Ok(())
    }
}

/// Columns of the terminal that the printed table may take.
const WIDTH: usize = 80;

/// How wide a column is printed, with the space beside it.
fn width_of((name, texts): &(String, Vec<String>)) -> usize {
    texts.iter().chain([name]).map(|text| text.chars().count()).max().unwrap_or(0) + 2
}

/// The shortest end of each key that no other key has: `p0` for `maps.0.algorithm.ml_tm.profile.trapezoid.p0`.
fn shortened(keys: &[Column]) -> impl Iterator<Item = String> {
    let is_end_of = |end: &str, key: &str| key == end || key.ends_with(&format!(".{end}"));
    keys.iter().map(move |Column { name, .. }| {
        let ends = name.rmatch_indices('.').map(|(dot, _)| &name[dot + 1..]);
        let alone = |end: &&str| keys.iter().filter(|other| is_end_of(end, &other.name)).count() == 1;
        ends.into_iter().find(alone).unwrap_or(name).to_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_settings_are_numbers() {
        let of = |kind, value| value_of(&Column::new("key", kind), value);
        assert_eq!(of(ColumnKind::Real, "1.0"), json!(1.0));
        assert_eq!(of(ColumnKind::Integer, "-2"), json!(-2));
        assert_eq!(of(ColumnKind::Text, "1.0"), json!("1.0"));
    }

    #[test]
    fn keys_are_shortened_but_stay_distinct() {
        let keys = ["a.b.p0", "a.c.range_m", "a.d.range_m", "seed"].map(|key| Column::new(key, ColumnKind::Real));
        assert_eq!(shortened(&keys).collect::<Vec<_>>(), ["p0", "c.range_m", "d.range_m", "seed"]);
    }
}
