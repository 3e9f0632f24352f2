//! Figures of the table of a sweep: measures against a setting, differences between runs with the same seed, and
//! distributions over runs.

mod difference;
mod distribution;
mod groups;
mod means;
mod theory;

use std::path::Path;

use sextant::summary::Unit;
use sextant_figure::{Figure, Series};
use sextant_recording::output::CsvFile;
use sextant_scenario::Scenario;

use super::average::Average;
use super::error::TableError;
use super::finished_table::{FinishedTable, check_numbers};
use difference::{Differences, Reference};

/// What is drawn of a table.
#[derive(Clone, Copy, Default)]
pub struct StudyFigures<'a> {
    /// The measures, as names of columns; the usual ones if empty.
    pub columns: &'a [String],
    /// The scenario of the table: what theory says is drawn beside the means, where its assumptions hold.
    pub scenario: Option<&'a Scenario>,
    /// Draws differences to this map, or to this value of a setting (`KEY=VALUE`), instead of means.
    pub against: Option<&'a str>,
    /// Draws the distribution over the runs instead of means.
    pub distributions: bool,
}

/// The figures of a table, and its paired differences as a table if they are asked for.
#[derive(Clone, Debug)]
pub struct StudyDrawing {
    /// The figures.
    pub figures: Vec<Figure>,
    /// The differences: one row for each measure, cell and map.
    pub differences: Option<CsvFile>,
}

/// A measure that is drawn: its column, its unit there, its name on an axis, and the factor to the unit of the axis.
struct Drawn {
    column: usize,
    unit: Unit,
    label: String,
    factor: f64,
}

impl Drawn {
    fn of(table: &FinishedTable, column: usize) -> Self {
        let name = &table.columns()[column];
        let Some(measure) = table.known(column) else {
            return Self { column, unit: Unit::Plain, label: name.clone(), factor: 1.0 };
        };
        let numbers = table.rows_of(column).into_iter().filter_map(|row| table.number(row, column));
        let largest = numbers.fold(0.0, |largest: f64, number| largest.max(number.abs()));
        let (factor, unit) = match measure.unit() {
            // An axis of shares goes from 0 to 1.
            Unit::Share | Unit::Outcome => (1.0, ""),
            unit => unit.for_size(largest),
        };
        let words = measure.name_in_words();
        let label = if unit.is_empty() { words } else { format!("{words} ({unit})") };
        Self { column, unit: measure.unit(), label, factor }
    }

    /// The number of a row, in the unit of the axis.
    fn number(&self, table: &FinishedTable, row: usize) -> Option<f64> {
        table.number(row, self.column).map(|number| self.factor * number)
    }
}

impl StudyFigures<'_> {
    /// The figures of the table at `path`, CSV or Parquet, of each wanted measure. Each combination of map and settings is a
    /// curve: of means with their 95 % intervals against the numeric setting with the most values, of differences between
    /// runs with the same seed, or of a distribution.
    ///
    /// # Errors
    /// If the file cannot be read, is not the table of a sweep, or has no such column, map or value. Means need a numeric
    /// setting.
    pub fn draw(&self, path: &Path) -> Result<StudyDrawing, TableError> {
        let table = FinishedTable::read(path)?;
        let title = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let wanted: Vec<usize> = if self.columns.is_empty() {
            table.measures().filter(|&column| table.is_drawn(column)).collect()
        } else {
            self.columns.iter().map(|name| table.measure(name)).collect::<Result<_, _>>()?
        };
        // Columns that others added may have texts, but not beside numbers in a figure.
        for &column in &wanted {
            check_numbers(&table, column).map_err(|why| TableError::Rows { path: path.to_owned(), why })?;
        }
        let drawn: Vec<Drawn> = wanted.into_iter().map(|column| Drawn::of(&table, column)).collect();
        let name = |drawn: &Drawn| table.columns()[drawn.column].replace(['.', '/'], "-");
        if let Some(against) = self.against {
            let reference = Reference::parse(&table, against).map_err(|why| why.of(path))?;
            let of: Vec<_> = drawn.iter().filter_map(|drawn| Differences::of(&table, drawn, &reference)).collect();
            if of.iter().all(|differences| differences.pairs() == 0) {
                let (of_reference, others) = reference.counts(&table);
                let path = path.to_owned();
                return Err(TableError::NoPairs { path, against: against.to_owned(), of_reference, others });
            }
            let figures = of.iter().filter_map(|differences| {
                let figure = differences
                    .curves(&title)?
                    .figure_of_differences(&format!("{title}-difference-{}", name(differences.drawn)));
                Some(figure)
            });
            return Ok(StudyDrawing {
                figures: figures.collect(),
                differences: Some(difference::table(&table, &of)),
            });
        }
        if self.distributions {
            let figure = |drawn: &Drawn| {
                distribution::steps(&table, &title, drawn).figure_of_lines(&format!("{title}-ecdf-{}", name(drawn)))
            };
            return Ok(StudyDrawing { figures: drawn.iter().map(figure).collect(), differences: None });
        }
        let Some(across) = table.across() else {
            return Err(TableError::NoAxis { path: path.to_owned() });
        };
        let figure = |drawn: &Drawn| {
            let mut curves = means::curves(&table, &title, across, drawn);
            let theory = self.scenario.map(|scenario| theory::curves(&table, scenario, across, drawn));
            curves.series.extend(theory.unwrap_or_default());
            curves.figure_apart(&format!("{title}-{}", name(drawn)))
        };
        Ok(StudyDrawing { figures: drawn.iter().map(figure).collect(), differences: None })
    }
}

/// Points of a curve, by the number across: the values there.
type Points = Vec<(f64, Vec<f64>)>;

/// Adds a value to the points.
fn add(points: &mut Points, x: f64, y: f64) {
    match points.iter_mut().find(|(known, _)| known.total_cmp(&x).is_eq()) {
        Some((_, values)) => values.push(y),
        None => points.push((x, vec![y])),
    }
}

/// The curve of the averages of points of this unit by the number across, with their intervals.
fn averaged(name: String, mut points: Points, unit: Unit) -> Series {
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let averages = points.iter().filter_map(|(x, values)| Some((*x, Average::of(unit, values)?)));
    let (points, intervals) = averages.map(|(x, average)| ((x, average.value()), average.interval_95())).unzip();
    Series { name, points, intervals }
}

/// The note of a figure of points with so many runs each.
fn note(what: &str, counts: impl Iterator<Item = usize> + Clone) -> String {
    let (least, most) = (counts.clone().min().unwrap_or(0), counts.max().unwrap_or(0));
    match (least, most) {
        (_, ..=1) => format!("{what} of one run"),
        (1, most) => format!("{what} of 1 to {most} runs, with 95 % intervals where there are several"),
        (least, most) if least < most => format!("{what} of {least} to {most} runs, with 95 % intervals"),
        (_, most) => format!("{what} of up to {most} runs, with 95 % intervals"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_note_says_of_how_many_runs_the_means_are() {
        let note = |counts: &[usize]| note("mean", counts.iter().copied());
        assert_eq!((note(&[]), note(&[1, 1])), ("mean of one run".to_owned(), "mean of one run".to_owned()));
        assert_eq!(note(&[3, 3]), "mean of up to 3 runs, with 95 % intervals");
        assert_eq!(note(&[2, 5]), "mean of 2 to 5 runs, with 95 % intervals");
        assert_eq!(note(&[1, 5]), "mean of 1 to 5 runs, with 95 % intervals where there are several");
    }
}
