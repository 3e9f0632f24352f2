//! `sextant figure`: pictures of a run or of a sweep for papers and pages.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use sextant::kernel::SimTime;

use super::options::PictureFormat;
use super::outputs::{Replacing, admit, reads_given};
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::{say, stdout};
use sextant::Scenario;
use sextant::export::station_names;
use sextant_figure::{self as figure, Figure, Layout, PacketSource, Source, TimeWindow};
use sextant_recording::admission::{OutputKind, Outputs};
use sextant_recording::disk;
use sextant_recording::output::write_file;
use sextant_recording::{self as recording, ORIGIN_METADATA, RecordedPacket, Recording};
use sextant_study::sweep::{StudyDrawing, StudyFigures};

/// Arguments of `sextant figure`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Arguments {
    /// A recording of `run`, or a table of `sweep`, TABLE.csv or TABLE.parquet
    #[arg(value_name = "RUN.mcap|TABLE.csv")]
    pub(crate) recording: PathBuf,
    /// The folder for the figures [default: RUN.figures beside the file]. It is created if it does not exist
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// The format of the figures
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: PictureFormat,
    /// The time line of packets begins here (simulated time) [default: shortly before the first collision]
    #[arg(long, value_name = "S")]
    pub(crate) from: Option<f64>,
    /// The time line of packets ends here
    #[arg(long, value_name = "S")]
    pub(crate) to: Option<f64>,
    /// The tree of packets over several hops is drawn as it was then (simulated time) [default: at the end]
    #[arg(long, value_name = "S")]
    pub(crate) time: Option<f64>,
    /// The measures of a table to draw, as the names of their columns [default: the usual ones]. Only for tables
    #[arg(long, value_name = "COLUMN")]
    pub(crate) column: Vec<String>,
    /// The scenario of a table: what theory says is drawn beside, where its assumptions hold. Only for tables
    #[arg(long, value_name = "SCENARIO.toml", conflicts_with = "layout")]
    pub(crate) scenario: Option<PathBuf>,
    /// Draw differences between runs with the same seed instead of means: to a map, or to a value of a setting, KEY=VALUE.
    /// TABLE-differences.csv has their numbers. Only for tables
    #[arg(long, value_name = "MAP|KEY=VALUE", conflicts_with_all = ["scenario", "layout"])]
    pub(crate) against: Option<String>,
    /// Draw distributions over the runs instead of means: the share of runs with at most each value. Only for tables
    #[arg(long, conflicts_with_all = ["scenario", "layout", "against"])]
    pub(crate) ecdf: bool,
    /// Draw no figures; write beside the recording how viewers show it: RUN.foxglove.json, a layout for Foxglove, and
    /// RUN.rerun.py, a script that shows it in Rerun
    #[arg(long, conflicts_with_all = ["format", "column"])]
    pub(crate) layout: bool,
    /// What may be replaced.
    #[command(flatten)]
    pub(crate) replacing: Replacing,
}

pub(crate) fn execute(arguments: &Arguments, interrupt: &Interrupt) -> Result<(), Failure> {
    let path = &arguments.recording;
    let is_table = path.extension().is_some_and(|extension| extension == "csv" || extension == "parquet");
    if is_table && arguments.layout {
        return Err(Failure::bad_input_with_help(
            format!("`--layout` is given, but `{}` is a table", path.display()),
            "`--layout` writes how viewers show a recording of `sextant run`",
        ));
    }
    if is_table {
        return draw_table(arguments, interrupt);
    }
    for (flag, is_given) in [("--against", arguments.against.is_some()), ("--ecdf", arguments.ecdf)] {
        if is_given {
            return Err(Failure::bad_input_with_help(
                format!("`{flag}` is given, but `{}` is not a table", path.display()),
                format!("`{flag}` compares runs of a table of `sweep`, whose name ends with .csv or .parquet"),
            ));
        }
    }
    if let [column, ..] = &arguments.column[..] {
        return Err(Failure::bad_input_with_help(
            format!("`--column {column}` is given, but `{}` is not a table", path.display()),
            "`--column` chooses measures of a table of `sweep`, whose name ends with .csv",
        ));
    }
    if arguments.scenario.is_some() {
        return Err(Failure::bad_input_with_help(
            format!("`--scenario` is given, but `{}` is not a table", path.display()),
            "a recording has its scenario; `--scenario` is that of a table of `sweep`, whose name ends with .csv",
        ));
    }
    if arguments.layout {
        return write_layouts(arguments);
    }
    let Recording { run, world: drawn, packets, activity } = recording::read_recording(path)?;
    let is_empty = drawn.maps.is_empty() && drawn.targets.is_empty() && drawn.fields.is_empty();
    if is_empty && drawn.applications.is_empty() && drawn.sinks.is_empty() && run.log().stops().is_empty() {
        return Err(Failure::bad_input_with_help(
            format!("`{}` has no maps, stops, sinks, targets or fields, so there is nothing to draw", path.display()),
            "`sextant run` records each stop of a robot, and a map for each [[maps]] of the scenario",
        ));
    }
    if let Some(concern) = run.concern() {
        say(&format!("note: {concern}"));
    }
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let scenario = run.metadata.get(ORIGIN_METADATA).and_then(|origin| origin.get("scenario"));
    let source = Source {
        title: scenario.map_or(&*stem, String::as_str),
        log: run.log(),
        drawn: &drawn,
        sector_displacements: &run.sector_displacements(),
        claimed_obstacles: &run.claimed_obstacles(),
    };
    let mut figures = figure::all(&source);
    figures.extend(arguments.trees(&source)?);
    figures.extend(figure::of_packets(&PacketSource {
        title: source.title,
        names: &station_names(&run),
        drawn: &drawn,
        packets: &packets,
        activity: &activity,
        traffic: &run.traffic(),
        window: arguments.window(&packets)?,
    }));
    write(&figures, arguments, interrupt)
}

/// Draws the table of a sweep.
fn draw_table(arguments: &Arguments, interrupt: &Interrupt) -> Result<(), Failure> {
    let path = &arguments.recording;
    let scenario = arguments.scenario.as_ref().map(Scenario::load).transpose()?;
    let wish = StudyFigures {
        columns: &arguments.column,
        scenario: scenario.as_ref(),
        against: arguments.against.as_deref(),
        distributions: arguments.ecdf,
    };
    let StudyDrawing { figures, differences } = wish.draw(path)?;
    if figures.is_empty() && differences.is_none() {
        return Err(Failure::bad_input_with_help(
            format!("`{}` has none of the measures that are drawn", path.display()),
            "`--column COLUMN` draws any measure of the table",
        ));
    }
    write(&figures, arguments, interrupt)?;
    if let Some(differences) = differences {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let file = arguments.folder().join(format!("{stem}-differences.csv"));
        let mut outputs = arguments.inputs();
        admit(outputs.writes("", &file, OutputKind::Differences(differences.bytes())), None)?;
        differences.save(&file)?;
        writeln!(stdout(), "{}", file.display())?;
    }
    Ok(())
}

impl Arguments {
    /// The files that are read.
    fn inputs<'a>(&self) -> Outputs<'a> {
        let mut outputs = self.replacing.outputs();
        reads_given(&mut outputs, [Some(self.recording.as_path()), self.scenario.as_deref()]);
        outputs
    }

    /// The folder for the figures.
    fn folder(&self) -> PathBuf {
        self.out.clone().unwrap_or_else(|| self.recording.with_extension("figures"))
    }

    /// The tree of packets over several hops, if there is one.
    fn trees(&self, source: &Source<'_>) -> Result<Vec<Figure>, Failure> {
        let Some(time_s) = self.time else { return Ok(figure::of_tree(source, None)) };
        let end_s = source.drawn.tree_end.as_secs_f64();
        if source.drawn.tree.is_empty() {
            return Err(Failure::bad_input_with_help(
                format!("`--time {time_s}` is given, but `{}` has no tree", self.recording.display()),
                "a run has one if its scenario has a table [routing]",
            ));
        }
        if !(0.0..=end_s).contains(&time_s) {
            return Err(Failure::bad_input(format!("`--time {time_s}` is not in the run; allowed: 0 to {end_s}")));
        }
        Ok(figure::of_tree(source, Some(SimTime::ZERO + Duration::from_secs_f64(time_s))))
    }

    /// The window of the time line.
    fn window(&self, packets: &[RecordedPacket]) -> Result<TimeWindow, Failure> {
        let &Self { from, to, .. } = self;
        if let (Some(from), Some(to)) = (from, to)
            && (to <= from || !(from + to).is_finite())
        {
            return Err(Failure::bad_input(format!(
                "`--from {from} --to {to}` is no time; allowed: an end after the start"
            )));
        }
        if packets.is_empty() && (from.is_some() || to.is_some()) {
            return Err(Failure::bad_input_with_help(
                format!("`{}` has no packets, so there is no time line", self.recording.display()),
                "record them: `sextant run SCENARIO.toml --set recording.packets=true`",
            ));
        }
        Ok(TimeWindow { from_s: from, to_s: to })
    }
}

/// Writes how viewers show a recording.
fn write_layouts(arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.recording;
    let (inspection, drawn) = (recording::inspect(path)?, recording::read_world(path)?);
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    let layout = Layout { file: &file, inspection: &inspection, drawn: &drawn };
    let beside = path.parent().map(Path::to_owned).unwrap_or_default();
    let folder = arguments.out.clone().unwrap_or(beside);
    if !folder.as_os_str().is_empty() {
        disk::create_folders(&folder).map_err(|error| Failure::unwritable(&folder, &error))?;
    }
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let mut stdout = stdout();
    let texts = [("foxglove.json", layout.foxglove()), ("rerun.py", layout.rerun())];
    let texts = texts.map(|(ending, text)| (folder.join(format!("{stem}.{ending}")), text));
    let mut outputs = arguments.inputs();
    texts.iter().for_each(|(file, text)| {
        outputs.writes("", file, OutputKind::Text(text.as_bytes()));
    });
    admit(&outputs, None)?;
    for (file, text) in texts {
        write_file(&file, text.as_bytes())?;
        writeln!(stdout, "{}", file.display())?;
    }
    Ok(())
}

fn write(figures: &[Figure], arguments: &Arguments, interrupt: &Interrupt) -> Result<(), Failure> {
    let folder = arguments.folder();
    disk::create_folders(&folder).map_err(|error| Failure::unwritable(&folder, &error))?;
    let format = arguments.format.into();
    let mut outputs = arguments.inputs();
    figures.iter().for_each(|figure| {
        outputs.writes("", &figure.path(&folder, format), OutputKind::Picture);
    });
    admit(&outputs, None)?;
    let mut stdout = stdout();
    for figure in figures {
        let file = figure.path(&folder, format);
        let bytes = figure.encode(format).map_err(|error| Failure::unwritable(&file, &error))?;
        // Drawing may be stopped at any time, writing may not.
        let _keeper = interrupt.keep();
        if interrupt.is_requested() {
            return Err(Failure::Interrupted);
        }
        write_file(&file, &bytes)?;
        writeln!(stdout, "{}", file.display())?;
    }
    Ok(())
}
