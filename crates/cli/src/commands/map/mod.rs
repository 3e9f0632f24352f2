//! `sextant map`: computes maps from a reception log.

mod follow;
mod growth;
mod track;

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use super::options::{Format, Overrides, PictureFormat, Results, Work};
use super::outputs::{Replacing, admit, keep_logs, reads_given};
use super::path_flags::PathFlags;
use super::reading::Reading;
use super::slurm_flags::{Scheduler, SlurmFlags, own_program};
use super::with_flags;
use crate::commands::floorplan;
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::invocation::Invocation;
use crate::terminal::{Watcher, stdout};
use sextant::NumberRange;
use sextant::mapping::tiles::{self, KeptTiles, TileCount, TileFolders, Tiling};
use sextant::mapping::{self, Input};
use sextant::scenario::{AlgorithmName, MapSettings};
use sextant::summary::Stopwatch;
use sextant_figure::Figure;
use sextant_kernel::text::counted;
use sextant_logs::{self as robot_log, FieldNames, Names, ReadOptions, RobotFrames};
use sextant_recording::admission::{OutputKind, Outputs};
use sextant_recording::output::{open_folder, write_file};
use sextant_study::campaign::slurm::submit_map;

/// Arguments of `sextant map`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Arguments {
    /// A recording of `run`, or the log of a robot. A log is a folder with stops.csv and receptions.csv, or with
    /// path.csv and packets.csv, or a table with a row a stop and a column a node. It may be a ROS 2 bag (an MCAP
    /// file, or a folder of `ros2 bag record`). With --path it may be the capture of a sniffer (pcap, pcapng) or a
    /// list of packets (CSV), with --packets a path
    #[arg(value_name = "LOG")]
    pub(crate) log: PathBuf,
    /// The probability of a reception as a function of distance: `fitted` (estimated from the log),
    /// trapezoid:p0=0.95,plateau_m=2,range_m=10[,floor=..,ceiling=..], or channel:exponent=..,sigma_db=..,
    /// tx_power_dbm=..,sensitivity_dbm=..[,max_range_m=..]. The default for a recording is that of its scenario; for a
    /// folder it is `fitted`
    #[arg(long, value_name = "PROFILE")]
    pub(crate) profile: Option<String>,
    /// Map the log of this network, if the robots surveyed several; the default is the network that each map names, or the
    /// first one
    #[arg(long, value_name = "NAME")]
    pub(crate) network: Option<String>,
    /// Compute one map with this algorithm and its default settings, instead of the maps of the recorded scenario
    #[arg(long, value_parser = algorithms(), value_name = "ALGORITHM")]
    pub(crate) algorithm: Option<AlgorithmName>,
    /// Join the logs of robots whose frames of coordinates differ, by the nodes that they have in common. The maps are in
    /// the frame of the robots whose frames are known, otherwise in that of the first robot
    #[arg(long)]
    pub(crate) stitch: bool,
    /// Compare the maps with the true positions in this CSV file, with columns node,x_m,y_m,z_m, or node,lat,lon,alt_m if
    /// the log has lat,lon. The default for a recording are the true positions in it
    #[arg(long, value_name = "nodes.csv")]
    pub(crate) truth: Option<PathBuf>,
    /// The columns of the file of true positions, if they have other names: KEY=NAME,.. where KEY is node, x_m, y_m, z_m, lat,
    /// lon or alt_m. In a file without a header NAME is the number of the column: node=#1
    #[arg(long, value_name = "FIELDS", requires = "truth", value_parser = FieldNames::parse_truth)]
    pub(crate) truth_fields: Option<FieldNames>,
    /// Nodes have other names in the log or among the true positions: a CSV file with columns name,alias (a row 0x1005,4101 says
    /// that 4101 is 0x1005). The maps have the names
    #[arg(long, value_name = "names.csv")]
    pub(crate) names: Option<PathBuf>,
    /// All nodes are within this area: a box x0,y0,x1,y1 in metres, or a file with the corners of a polygon in order.
    /// The file has one corner a row with columns x_m,y_m, or is a GeoJSON polygon in metres. If the log has lat,lon,
    /// so has the file. Only for
    /// algorithms that use it
    #[arg(long, value_name = "FILE|x0,y0,x1,y1", allow_hyphen_values = true)]
    pub(crate) area: Option<String>,
    /// Nodes are near the stops: the probability of a place falls with its distance d to the nearest stop as
    /// exp(-d / METRES). Only for algorithms that use it
    #[arg(long, value_name = "METRES", allow_hyphen_values = true)]
    pub(crate) near_stops: Option<f64>,
    /// Walls under the map: a map of ROS (map.yaml), GeoJSON, DXF, or what `sextant floorplan` wrote (walls.toml), in the frame of the
    /// log. Figures show them, and maps that know obstacles know these
    #[arg(long, value_name = "PLAN")]
    pub(crate) floorplan: Option<PathBuf>,
    /// The unit of the floor plan.
    #[command(flatten)]
    pub(crate) plan_unit: floorplan::PlanUnit,
    /// Write the map to this CSV file, with columns node,x_m,y_m,z_m,ties,infeasible,concern. The concern is why a
    /// position is unreliable: at-edge, unsettled, no-evidence, two-places or too-few. The entries of the covariance follow, if there is
    /// one, and lat,lon, if the log has them. A name that ends in .geojson gets GeoJSON. Each further map is written
    /// to MAP.NAME.csv in the same
    /// folder
    #[arg(long, value_name = "MAP.csv")]
    pub(crate) out: Option<PathBuf>,
    /// Draw figures to files in this folder: the survey, the maps with the 95 % regions of the nodes, the reception
    /// curves against the data, and the residual of each stop. If true positions are known, the distribution of the
    /// errors is drawn too. It is created
    /// if it does not exist
    #[arg(long, value_name = "DIR")]
    pub(crate) figure: Option<PathBuf>,
    /// The format of the figures
    #[arg(long, value_enum, default_value_t, requires = "figure")]
    pub(crate) figure_format: PictureFormat,
    /// Map the log again whenever it has grown, and show the map in a browser, at the address that is printed, until Ctrl-C
    #[arg(long, conflicts_with_all = [
        "out", "summary", "figure", "tiles", "stitch", "estimate_path", "track", "path_out",
    ])]
    pub(crate) follow: bool,
    /// The port of the page of --follow; 0 for any that is free
    #[arg(long, value_name = "N", requires = "follow", default_value_t = 8765)]
    pub(crate) port: u16,
    /// The address of the page of --follow. Other machines can connect to it only if it is not 127.0.0.1
    #[arg(long, value_name = "HOST", requires = "follow", default_value = "127.0.0.1")]
    pub(crate) host: String,
    /// Map tile by tile, with memory for the stops, the nodes and one tile instead of all receptions: N tiles, `auto` for as
    /// many as the free memory needs, or `auto:MB` for as many as so many megabytes need. The map is the same as in one
    /// piece. For recordings, and folders with stops.csv and receptions.csv. A temporary file is written
    /// beside --out
    #[arg(long, value_name = "N|auto|auto:MB", conflicts_with = "figure")]
    pub(crate) tiles: Option<TileCount>,
    /// With --tiles: keep each finished tile in this folder, and use those that are there: of an interrupted run, or made by
    /// other machines
    #[arg(long, value_name = "DIR", requires = "tiles")]
    pub(crate) keep_tiles: Option<PathBuf>,
    /// With --keep-tiles: make only the tiles A to B - 1, from 0, and write no map
    #[arg(long, value_name = "A..B", requires = "keep_tiles", conflicts_with_all = ["out", "summary"])]
    pub(crate) only_tiles: Option<NumberRange>,
    /// With --keep-tiles and --out: submit an array of jobs that make the tiles, and one that joins them, to this scheduler
    #[arg(long, value_name = "SCHEDULER", requires = "keep_tiles", requires = "out", conflicts_with = "only_tiles")]
    pub(crate) submit: Option<Scheduler>,
    /// Settings that override those of the maps.
    #[command(flatten)]
    pub(crate) overrides: Overrides,
    /// Where the results go.
    #[command(flatten)]
    pub(crate) results: Results,
    /// What may be replaced.
    #[command(flatten)]
    pub(crate) replacing: Replacing,
    /// How the work is done.
    #[command(flatten)]
    pub(crate) work: Work,
    /// What a submission asks of Slurm.
    #[command(flatten)]
    pub(crate) slurm: SlurmFlags,
    /// Paths that are estimated with the places.
    #[command(flatten)]
    pub(crate) path: PathFlags,
    /// How the log of a robot is read. This has headings of its own, which would hold for flags below.
    #[command(flatten)]
    pub(crate) reading: Reading,
}

/// The values of `--algorithm`, each with its help.
pub(super) fn algorithms() -> impl TypedValueParser<Value = AlgorithmName> {
    let value = |algorithm: AlgorithmName| PossibleValue::new(algorithm.name()).help(algorithm.description());
    PossibleValuesParser::new(AlgorithmName::all().into_iter().map(value))
        .try_map(|name| name.parse::<AlgorithmName>())
}

pub(crate) fn execute(arguments: &Arguments, invocation: &Invocation, interrupt: &Interrupt) -> Result<(), Failure> {
    let start = Stopwatch::start();
    arguments.work.start_threads()?;
    if arguments.follow {
        return follow::execute(arguments, interrupt);
    }
    if let Some(known) = arguments.path.known.as_deref().filter(|_| arguments.path.track) {
        return track::execute(arguments, known, interrupt);
    }
    let mut outputs = arguments.inputs();
    if let Some(out) = &arguments.out {
        outputs.writes("--out", out, OutputKind::Map);
    }
    arguments.results.among(&mut outputs);
    outputs.keep_inputs()?;
    let named = [
        ("--out", arguments.out.as_deref()),
        ("--path-out", arguments.path.path_out.as_deref()),
        ("--summary", arguments.results.summary.as_deref()),
    ];
    // A file that is there may be an input, which is told later, with what it is.
    let new = named.into_iter().filter_map(|(flag, path)| Some((flag, path.filter(|path| !path.exists())?)));
    keep_logs(Some(&arguments.log), new)?;
    let network = arguments.network.as_deref();
    let frames = if arguments.stitch { RobotFrames::OfEachRobot } else { RobotFrames::Shared };
    let options = ReadOptions { frames, ..arguments.reading.options() };
    // Reading a large log takes so long that it has to end in order.
    let keeper = arguments.tiles.map(|_| interrupt.keep());
    let (mut input, survey) = match arguments.tiles {
        Some(_) => tiles::survey(&arguments.log, network, &options, interrupt)
            .map(|(input, survey)| (input, Some(survey)))?,
        None => (Input::read(&arguments.log, network, &options)?, None),
    };
    let set = &arguments.overrides.set;
    let settings =
        |set: &[String]| input.map_settings(arguments.algorithm, arguments.profile.as_deref(), network, set);
    let mut settings_of_maps = settings(set)?;
    if arguments.stitch {
        if input.log().robot_count() < 2 {
            let problem =
                format!("`--stitch` joins the logs of robots, but the log has {}", input.log().robot_count());
            return Err(Failure::bad_input_with_help(
                problem,
                "give the stops a column `robot`, or leave out `--stitch`",
            ));
        }
        let stitched = (0..settings_of_maps.maps.len()).map(|map| format!("maps.{map}.stitch={{}}"));
        let set: Vec<String> = set.iter().cloned().chain(stitched).collect();
        settings_of_maps = settings(&set)?;
    }
    let settings = settings_of_maps;
    let mut outputs = arguments.inputs();
    let maps = arguments.out.iter().flat_map(|out| mapping::map_files(out, &settings));
    let maps: Vec<PathBuf> = maps.collect();
    maps.iter().for_each(|map| {
        outputs.writes("--out", map, OutputKind::Map);
    });
    if let Some(path) = &arguments.path.path_out {
        outputs.writes("--path-out", path, OutputKind::Path);
    }
    arguments.results.among(&mut outputs);
    admit(&outputs, Some(arguments.work))?;
    let summary = arguments.results.summary.as_deref().map(|summary| ("--summary", summary));
    let path = arguments.path.path_out.as_deref().map(|path| ("--path-out", path));
    keep_logs(Some(&arguments.log), maps.iter().map(|map| ("--out", map.as_path())).chain(summary).chain(path))?;
    if let Some(name) = network
        && input.logs.names().next().is_none()
        && settings.maps.iter().all(|map| map.network.is_none())
    {
        let problem = format!("`--network` is `{name}`, but the log is of one network without a name");
        return Err(Failure::bad_input_with_help(problem, "leave out `--network`"));
    }
    arguments.know(&mut input, &settings)?;
    let _keeper = keeper.unwrap_or_else(|| interrupt.keep());
    let watcher = Watcher::new(interrupt, arguments.work.quiet);
    if arguments.path.estimate_path {
        estimate_path(arguments, &mut input, &watcher)?;
    }
    let drawn = match &arguments.figure {
        Some(folder) => {
            open_folder(folder)?;
            Some(mapping::drawn(&input)?)
        }
        None => None,
    };
    let out = arguments.out.as_deref();
    let (mut summary, maps) = match arguments.tiles.zip(survey) {
        Some((count, survey)) => {
            let tiling = Tiling::new(&input, &survey, &settings, count)?;
            arguments.work.note(&tiling.to_string());
            let (only, folder) = (arguments.only_tiles, arguments.keep_tiles.clone());
            if let (Some(_), Some(folder)) = (arguments.submit, &folder) {
                return submit(invocation, folder, tiling.tiles(), &arguments.slurm);
            }
            let kept = folder.map(|folder| KeptTiles { folder, only });
            if let (Some(only), Some(kept)) = (only, &kept) {
                let made = tiles::make_tiles(&mut input, survey, tiling, &settings, kept, &watcher);
                watcher.clear();
                return Ok(writeln!(stdout(), "{only} of {} are kept", counted(made?, "tile"))?);
            }
            let folders = TileFolders { out, kept: kept.as_ref() };
            tiles::map_tiles(&mut input, survey, tiling, &settings, folders, start, &watcher)?
        }
        None => mapping::map(&mut input, &settings, out, start, &watcher)?,
    };
    watcher.clear();
    summary.notes.iter_mut().for_each(|note| *note = with_flags(note));
    for note in &input.notes {
        arguments.work.note(note);
    }
    arguments.results.tell(&summary)?;
    if summary.interrupted {
        return Err(Failure::Interrupted);
    }
    if let (Some(folder), Some(drawn)) = (&arguments.figure, drawn) {
        let figures = mapping::figures(&title(&arguments.log), &input, drawn, &maps);
        write_figures(&figures, folder, arguments, interrupt)?;
    }
    Ok(())
}

impl Arguments {
    /// Takes what is known besides the log: true positions, other names, where nodes may be, walls.
    fn know(&self, input: &mut Input, settings: &MapSettings) -> Result<(), Failure> {
        let fields = self.truth_fields.as_ref();
        let truth = match &self.truth {
            Some(path) => Some(robot_log::read_truth(path, fields, input.plane.as_ref(), &mut input.notes)?),
            None => None,
        };
        let truth = match &self.names {
            Some(path) => {
                let names = Names::read(path, &mut input.notes)?;
                input.rename(&names, truth)?
            }
            None => truth,
        };
        if let Some(truth) = truth {
            input.take_truth(truth);
        }
        input.prior =
            mapping::place_prior(self.area.as_deref(), self.near_stops, input.plane.as_ref(), &settings.maps)?;
        floorplan::lay(self.floorplan.as_deref(), &self.plan_unit, input)
    }

    /// The files that are read.
    pub(super) fn inputs<'a>(&self) -> Outputs<'a> {
        let mut outputs = self.replacing.outputs();
        // An area is the name of a file, or numbers.
        let area = self.area.as_deref().map(Path::new);
        let given =
            [Some(self.log.as_path()), self.truth.as_deref(), self.names.as_deref(), self.floorplan.as_deref(), area];
        reads_given(&mut outputs, given.into_iter().chain(self.path.files()).chain(self.reading.files()));
        outputs
    }
}

/// Puts the log on the path that its ranges tell, and writes this path.
fn estimate_path(arguments: &Arguments, input: &mut Input, watcher: &Watcher<'_>) -> Result<(), Failure> {
    if arguments.tiles.is_some() {
        let problem = "`--estimate-path` needs all of the log at once, and `--tiles` reads it part by part";
        return Err(Failure::bad_input_with_help(problem.to_owned(), "leave out `--tiles`"));
    }
    let known = match &arguments.path.known {
        Some(known) => robot_log::read_truth(known, None, input.plane.as_ref(), &mut input.notes)?.places,
        None => BTreeMap::new(),
    };
    input.estimate_path(arguments.path.path_error.unwrap_or_default(), &known, watcher)?;
    if let (Some(file), Some(path)) = (&arguments.path.path_out, &input.estimated_path) {
        robot_log::write_path(file, path, &input.middles, |robot| input.log().robot_name(robot).into_owned())?;
    }
    Ok(())
}

/// Submits this very map in so many tiles.
fn submit(invocation: &Invocation, folder: &Path, tiles: usize, slurm: &SlurmFlags) -> Result<(), Failure> {
    let words = words_of_tasks(invocation.words(), tiles);
    let jobs = submit_map(&own_program(invocation)?, &words, folder, tiles, &slurm.settings())?;
    let (tasks, of_tiles) = (counted(jobs.tasks, "task"), jobs.tiles.join(", "));
    writeln!(stdout(), "submitted {} in {tasks}: job {of_tiles}", counted(tiles, "tile"))?;
    Ok(writeln!(stdout(), "job {} joins them when they have ended", jobs.join)?)
}

/// The command line of the tasks: this one without what is for the submission, and with the number of `tiles`, which must not
/// depend on the memory of a machine. Names after `--` stay there.
fn words_of_tasks(words: &[OsString], tiles: usize) -> Vec<OsString> {
    let of_submission = ["--submit", "--tiles", "--threads", "--format"];
    let end_of_flags = words.iter().position(|word| word == "--").unwrap_or(words.len());
    let (flags, names) = words.split_at(end_of_flags);
    let mut kept = Vec::new();
    let mut flags = flags.iter();
    while let Some(word) = flags.next() {
        let text = word.to_string_lossy();
        let (flag, has_value) = text.split_once('=').map_or((&*text, false), |(flag, _)| (flag, true));
        if of_submission.contains(&flag) || SlurmFlags::NAMES.contains(&flag) {
            if !has_value {
                flags.next();
            }
        } else if flag != "--quiet" {
            kept.push(word.clone());
        }
    }
    kept.extend(["--tiles".into(), tiles.to_string().into()]);
    kept.extend_from_slice(names);
    kept
}

/// The name of a log in titles: that of its file or folder.
pub(super) fn title(log: &Path) -> String {
    let whole = std::path::absolute(log).unwrap_or_else(|_| log.to_owned());
    let name = if log.is_dir() { whole.file_name() } else { whole.file_stem() };
    name.map_or_else(|| "log".to_owned(), |name| name.to_string_lossy().into_owned())
}

/// Writes `figures` to files in `folder` and tells their names: below the table or, beside JSON, on standard error.
fn write_figures(
    figures: &[Figure],
    folder: &Path,
    arguments: &Arguments,
    interrupt: &Interrupt,
) -> Result<(), Failure> {
    let format = arguments.figure_format.into();
    let mut outputs = arguments.inputs();
    figures.iter().for_each(|figure| {
        outputs.writes("", &figure.path(folder, format), OutputKind::Picture);
    });
    admit(&outputs, Some(arguments.work))?;
    for figure in figures {
        if interrupt.is_requested() {
            return Err(Failure::Interrupted);
        }
        let file = figure.path(folder, format);
        let bytes = figure.encode(format).map_err(|error| Failure::unwritable(&file, &error))?;
        write_file(&file, &bytes)?;
        match arguments.results.printing.format {
            Format::Text => writeln!(stdout(), "{}", file.display())?,
            Format::Json => arguments.work.note(&format!("wrote {}", file.display())),
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tasks_get_the_words_of_the_map_alone() {
        let line = "map log --tiles auto:500 --keep-tiles kept --out m.csv --submit slurm --chunk=2 --time 1:00:00 --quiet --set a=b";
        let words = |line: &str| {
            let words: Vec<OsString> = line.split(' ').map(OsString::from).collect();
            words_of_tasks(&words, 8).join(" ".as_ref()).into_string().unwrap()
        };
        assert_eq!(words(line), "map log --keep-tiles kept --out m.csv --set a=b --tiles 8");
        assert_eq!(words("map --submit slurm -- --quiet"), "map --tiles 8 -- --quiet");
    }
}
