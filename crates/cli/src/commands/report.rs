//! `sextant report`: a run, a log, a sweep or a reproduction as one HTML file.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;

use super::floorplan;
use super::map::algorithms;
use super::options::Work;
use super::outputs::{Replacing, admit, keep_logs, reads_given};
use super::reading::Reading;
use super::with_flags;
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::{Watcher, stdout};
use sextant::mapping::{self, Input};
use sextant::scenario::AlgorithmName;
use sextant_kernel::FileForm;
use sextant_logs::{self as robot_log, FieldNames, Source};
use sextant_recording::admission::OutputKind;
use sextant_recording::output::write_file;
use sextant_report::{Report, ReportError};
use sextant_thesis::experiments;

/// Arguments of `sextant report`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Arguments {
    /// A recording of `run`, the log of a robot (as for `map`), a CSV table of `sweep`, or the folder of `reproduce` or a table
    /// in it
    #[arg(value_name = "RUN.mcap|LOG|TABLE.csv|REPRODUCTION")]
    pub(crate) input: PathBuf,
    /// The HTML file to write [default: NAME.html in the working folder]
    #[arg(long, value_name = "REPORT.html")]
    pub(crate) out: Option<PathBuf>,
    /// Map the log with this algorithm. The default for the log of a robot is `auto`; a recording of `run` is shown with its
    /// own maps, unless this is given
    #[arg(long, value_parser = algorithms(), value_name = "ALGORITHM")]
    pub(crate) algorithm: Option<AlgorithmName>,
    /// Compare the maps with the true positions in this CSV file, with columns node,x_m,y_m,z_m, or node,lat,lon,alt_m if
    /// the log has lat,lon
    #[arg(long, value_name = "nodes.csv")]
    pub(crate) truth: Option<PathBuf>,
    /// The columns of the file of true positions, if they have other names, as for `map`
    #[arg(long, value_name = "FIELDS", requires = "truth", value_parser = FieldNames::parse_truth)]
    pub(crate) truth_fields: Option<FieldNames>,
    /// Walls under the map of a log: a map of ROS, GeoJSON, DXF or walls.toml, as for `map`
    #[arg(long, value_name = "PLAN")]
    pub(crate) floorplan: Option<PathBuf>,
    /// The unit of the floor plan.
    #[command(flatten)]
    pub(crate) plan_unit: floorplan::PlanUnit,
    /// What may be replaced.
    #[command(flatten)]
    pub(crate) replacing: Replacing,
    /// How the work is done.
    #[command(flatten)]
    pub(crate) work: Work,
    /// How the log of a robot is read. This has headings of its own, which would hold for flags below.
    #[command(flatten)]
    pub(crate) reading: Reading,
}

pub(crate) fn execute(arguments: &Arguments, interrupt: &Interrupt) -> Result<(), Failure> {
    let out = arguments.out.clone().unwrap_or_else(|| file_name(&arguments.input));
    let mut outputs = arguments.replacing.outputs();
    let given = [Some(arguments.input.as_path()), arguments.truth.as_deref(), arguments.floorplan.as_deref()];
    reads_given(&mut outputs, given.into_iter().chain(arguments.reading.files()));
    outputs.writes("--out", &out, OutputKind::Report);
    admit(&outputs, Some(arguments.work))?;
    keep_logs(Some(&arguments.input), [("--out", out.as_path())])?;
    arguments.work.start_threads()?;
    let report = report(arguments, interrupt)?;
    let html = report.to_html();
    // Drawing may be stopped at any time, writing may not.
    let _keeper = interrupt.keep();
    if interrupt.is_requested() {
        return Err(Failure::Interrupted);
    }
    write_file(&out, html.as_bytes())?;
    writeln!(stdout(), "{} ({})", out.display(), size(html.len()))?;
    Ok(())
}

/// The report of the input, by its kind.
fn report(arguments: &Arguments, interrupt: &Interrupt) -> Result<Report, Failure> {
    let Arguments { input, algorithm, truth, floorplan, .. } = arguments;
    if Report::is_reproduction(input) {
        return Ok(Report::of_reproduction(input, &titles())?);
    }
    // A file of another form is told by the reader of logs.
    if input.extension().is_some_and(|extension| extension == "csv") && FileForm::of_file(input).is_none() {
        match Report::of_table(input, &titles()) {
            Err(ReportError::NotATable { columns, .. }) if columns.iter().any(|column| is_of_log(column)) => {}
            report => return Ok(report?),
        }
    }
    if Source::of(input).is_some() {
        return of_log(arguments, interrupt);
    }
    if input.extension().is_some_and(|extension| extension == "parquet") {
        return Err(Failure::bad_input_with_help(
            format!("`{}` is a Parquet table, which a report cannot read", input.display()),
            "`sextant sweep SCENARIO.toml --out TABLE.csv` writes the table as CSV",
        ));
    }
    if algorithm.is_some() || truth.is_some() || floorplan.is_some() {
        return of_log(arguments, interrupt);
    }
    robot_log::refuse_options(input, &arguments.reading.options()).map_err(mapping::MapLogError::from)?;
    Ok(Report::of_recording(input)?)
}

/// Whether a column of a table says that it belongs to the log of a robot.
fn is_of_log(column: &str) -> bool {
    ["x_m", "lat", "t_s", "stop", "node"].contains(&column)
}

/// Maps a log and reports the map.
fn of_log(arguments: &Arguments, interrupt: &Interrupt) -> Result<Report, Failure> {
    let mut input = Input::read(&arguments.input, None, &arguments.reading.options())?;
    let settings = input.map_settings(arguments.algorithm, None, None, &[])?;
    if let Some(path) = &arguments.truth {
        let fields = arguments.truth_fields.as_ref();
        let truth = robot_log::read_truth(path, fields, input.plane.as_ref(), &mut input.notes)?;
        input.take_truth(truth);
    }
    floorplan::lay(arguments.floorplan.as_deref(), &arguments.plan_unit, &mut input)?;
    let watcher = Watcher::new(interrupt, arguments.work.quiet);
    let mapped = Report::of_log(&whole_name(&arguments.input), &mut input, &settings, with_flags, &watcher)?;
    watcher.clear();
    let (report, _) = mapped.ok_or(Failure::Interrupted)?;
    for note in &input.notes {
        arguments.work.note(note);
    }
    Ok(report)
}

/// What the experiments of the reproduction are about, by their numbers.
fn titles() -> BTreeMap<String, String> {
    experiments().into_iter().map(|experiment| (experiment.id, experiment.title)).collect()
}

/// The name of a file or folder, without those above it.
fn whole_name(path: &Path) -> String {
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    whole.file_name().map_or_else(|| "log".to_owned(), |name| name.to_string_lossy().into_owned())
}

/// `NAME.html` for the file `../NAME.mcap` or the folder `../NAME`.
fn file_name(input: &Path) -> PathBuf {
    let name = PathBuf::from(whole_name(input));
    let stem = if input.is_dir() { name.as_os_str() } else { name.file_stem().unwrap_or_default() };
    let mut file = stem.to_owned();
    file.push(".html");
    PathBuf::from(file)
}

/// A number of octets for people.
fn size(octets: usize) -> String {
    match octets {
        0..1_000_000 => format!("{} kB", octets.div_ceil(1000)),
        _ => format!("{:.1} MB", octets as f64 / 1e6),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_has_the_name_of_its_input() {
        assert_eq!(file_name(Path::new("some/where/circular.mcap")), Path::new("circular.html"));
        assert_eq!(file_name(Path::new("some/table.csv")), Path::new("table.html"));
    }

    #[test]
    fn sizes_are_in_units_of_people() {
        assert_eq!([size(1), size(999_999), size(1_250_000)], ["1 kB", "1000 kB", "1.2 MB"]);
    }
}
