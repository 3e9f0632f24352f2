//! `sextant next`: where to drive next, as a log tells.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use sextant::mapping::{self, Input};
use sextant::next::{self, NextSettings, map_settings, next_stops};
use sextant::scenario::AlgorithmName;
use sextant_figure::Figure;
use sextant_recording::admission::{OutputKind, Outputs};
use sextant_recording::output::{open_folder, write_file};

use super::floorplan;
use super::map::{algorithms, title};
use super::options::{Format, PictureFormat, Printing, Work};
use super::outputs::{Replacing, admit, keep_logs, reads_given};
use super::reading::Reading;
use super::with_flags;
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::{Watcher, stdout};

/// Arguments of `sextant next`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Arguments {
    /// A recording of `run`, or the log of a robot, as `sextant map` reads it
    #[arg(value_name = "LOG")]
    pub(crate) log: PathBuf,
    /// The stops are within this area: a box x0,y0,x1,y1 in metres, or a file with the corners of a polygon in order, as
    /// `sextant map --area` reads it [default: as far round the stops of the log as nodes are heard]
    #[arg(long, value_name = "FILE|x0,y0,x1,y1", allow_hyphen_values = true)]
    pub(crate) area: Option<String>,
    /// Walls that the robot goes round: a map of ROS (map.yaml), GeoJSON, DXF, or what `sextant floorplan` wrote (walls.toml), in the
    /// frame of the log
    #[arg(long, value_name = "PLAN")]
    pub(crate) floorplan: Option<PathBuf>,
    /// The unit of the floor plan.
    #[command(flatten)]
    pub(crate) plan_unit: floorplan::PlanUnit,
    /// The most stops
    #[arg(long, value_name = "N", default_value_t = NextSettings::default().stops)]
    pub(crate) stops: usize,
    /// The longest way of all stops together (m) [default: as long as it takes]
    #[arg(long, value_name = "METRES", allow_hyphen_values = true)]
    pub(crate) way: Option<f64>,
    /// Speed between stops (m/s) [default: as the times of the stops of the log tell]
    #[arg(long, value_name = "M_PER_S", allow_hyphen_values = true)]
    pub(crate) speed: Option<f64>,
    /// Time of listening at a stop (s) [default: as the times of the stops of the log tell]
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    pub(crate) listen: Option<f64>,
    /// The robot stays so far from walls (m)
    #[arg(long, value_name = "METRES", default_value_t = NextSettings::default().radius_m, allow_hyphen_values = true)]
    pub(crate) radius: f64,
    /// The robot that drives, by its name [default: the one that listened last]
    #[arg(long, value_name = "NAME")]
    pub(crate) robot: Option<String>,
    /// The algorithm of the map from which it is told: one that gives covariances [default: auto, or ml-tm with --profile]
    #[arg(long, value_parser = algorithms(), value_name = "ALGORITHM")]
    pub(crate) algorithm: Option<AlgorithmName>,
    /// The probability of a reception as a function of distance, as for `sextant map`
    #[arg(long, value_name = "PROFILE")]
    pub(crate) profile: Option<String>,
    /// The network whose nodes are mapped, if the robots surveyed several [default: the first one]
    #[arg(long, value_name = "NAME")]
    pub(crate) network: Option<String>,
    /// Write the stops to this CSV file, with the columns of stops.csv: stop,t_s,x_m,y_m,z_m, and lat,lon if the log has them
    #[arg(long, value_name = "STOPS.csv")]
    pub(crate) out: Option<PathBuf>,
    /// Draw the figure `next` to a file in this folder: the stops and the way over them on the map. It is created if it does not
    /// exist
    #[arg(long, value_name = "DIR")]
    pub(crate) figure: Option<PathBuf>,
    /// The format of the figure
    #[arg(long, value_enum, default_value_t, requires = "figure")]
    pub(crate) figure_format: PictureFormat,
    /// How results are printed.
    #[command(flatten)]
    pub(crate) printing: Printing,
    /// What may be replaced.
    #[command(flatten)]
    pub(crate) replacing: Replacing,
    /// Threads and progress.
    #[command(flatten)]
    pub(crate) work: Work,
    /// How the log of a robot is read. This has headings of its own, which would hold for flags below.
    #[command(flatten)]
    pub(crate) reading: Reading,
}

pub(crate) fn execute(arguments: &Arguments, interrupt: &Interrupt) -> Result<(), Failure> {
    arguments.work.start_threads()?;
    let mut outputs = arguments.inputs();
    if let Some(out) = &arguments.out {
        outputs.writes("--out", out, OutputKind::Table);
        keep_logs(Some(&arguments.log), [("--out", out.as_path())])?;
    }
    admit(&outputs, Some(arguments.work))?;
    let network = arguments.network.as_deref();
    let mut input = Input::read(&arguments.log, network, &arguments.reading.options())?;
    let settings = map_settings(&input, arguments.algorithm, arguments.profile.as_deref(), network)?;
    let area = arguments.area.as_deref().map(|text| mapping::read_area(text, input.plane.as_ref())).transpose()?;
    floorplan::lay(arguments.floorplan.as_deref(), &arguments.plan_unit, &mut input)?;
    let next = NextSettings {
        stops: arguments.stops,
        area,
        way_m: arguments.way,
        speed_m_per_s: arguments.speed,
        listen_s: arguments.listen,
        radius_m: arguments.radius,
        robot: arguments.robot.clone(),
    };
    let _keeper = interrupt.keep();
    let watcher = Watcher::new(interrupt, arguments.work.quiet);
    let found = next_stops(&mut input, &settings, &next, &watcher);
    watcher.clear();
    let (mut found, map) = found?;
    found.notes.iter_mut().for_each(|note| *note = with_flags(note));
    found.notes.iter().for_each(|note| arguments.work.note(note));
    if let Some(out) = &arguments.out {
        write_file(out, found.to_csv().as_bytes())?;
    }
    arguments.printing.print(&found, |stdout| write!(stdout, "{found}"))?;
    if let Some(folder) = &arguments.figure {
        let figure = next::figure(&title(&arguments.log), &input, &map, &found)?;
        arguments.write(&figure, folder)?;
    }
    Ok(())
}

impl Arguments {
    /// Writes the figure to a file in `folder` and tells its name.
    fn write(&self, figure: &Figure, folder: &Path) -> Result<(), Failure> {
        let format = self.figure_format.into();
        let file = figure.path(folder, format);
        open_folder(folder)?;
        let mut outputs = self.inputs();
        outputs.writes("", &file, OutputKind::Picture);
        admit(&outputs, Some(self.work))?;
        let bytes = figure.encode(format).map_err(|error| Failure::unwritable(&file, &error))?;
        write_file(&file, &bytes)?;
        match self.printing.format {
            Format::Text => writeln!(stdout(), "{}", file.display())?,
            Format::Json => self.work.note(&format!("wrote {}", file.display())),
        }
        Ok(())
    }

    /// The files that are read.
    fn inputs<'a>(&self) -> Outputs<'a> {
        let mut outputs = self.replacing.outputs();
        // An area is the name of a file, or numbers.
        let area = self.area.as_deref().map(Path::new);
        let given = [Some(self.log.as_path()), self.floorplan.as_deref(), area];
        reads_given(&mut outputs, given.into_iter().chain(self.reading.files()));
        outputs
    }
}
