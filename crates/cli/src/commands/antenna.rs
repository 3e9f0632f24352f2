//! `sextant antenna`: what the sectors of an antenna cover, and measurements as code books.

use std::io::Write;
use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use sextant::antenna::{AngleUnit, AntennaCoverage, ArrayOrder, GainUnit, SourceNames, Turning, convert, read_book};
use sextant::scenario::Scenario;
use sextant_channel::Antenna;
use sextant_figure::of_antenna;
use sextant_kernel::text::counted;
use sextant_recording::admission::OutputKind;
use sextant_recording::disk;
use sextant_recording::output::write_file;

use super::options::{Overrides, PictureFormat, Printing};
use super::outputs::{Replacing, admit, keep_logs};
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::{stdout, warn};

/// Arguments of `sextant antenna`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub(crate) task: AntennaTask,
}

/// What is done with an antenna.
#[derive(Clone, Debug, Subcommand)]
pub(crate) enum AntennaTask {
    /// Print what each sector covers, and draw its pattern and where it is the best
    Show(ShowArguments),
    /// Make a code book of a measurement in another format
    Convert(ConvertArguments),
}

/// Arguments of `sextant antenna show`.
#[derive(Clone, Debug, Args)]
pub(crate) struct ShowArguments {
    /// A code book, BOOK.csv, or a scenario with antennas
    #[arg(value_name = "BOOK.csv|SCENARIO.toml")]
    pub(crate) source: PathBuf,
    /// Whose antenna of a scenario
    #[arg(long, value_enum, default_value_t)]
    pub(crate) of: Owner,
    /// Name of the network of a scenario, if there are several [default: the first one with antennas]
    #[arg(long, value_name = "NAME")]
    pub(crate) network: Option<String>,
    /// The folder for the figures [default: NAME.antenna beside the file]. It is created if it does not exist
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// The format of the figures
    #[arg(long, value_enum, default_value_t)]
    pub(crate) pictures: PictureFormat,
    /// What may be replaced.
    #[command(flatten)]
    pub(crate) replacing: Replacing,
    /// Settings that override those of the scenario, or those of a code book: gaps=hold, outside_gain_dbi=-20.
    #[command(flatten)]
    pub(crate) overrides: Overrides,
    /// How results are printed.
    #[command(flatten)]
    pub(crate) printing: Printing,
}

/// Whose antenna is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Owner {
    /// That of robots and sinks
    #[default]
    Robots,
    /// That of nodes
    Nodes,
}

/// Arguments of `sextant antenna convert`.
#[derive(Clone, Debug, Args)]
pub(crate) struct ConvertArguments {
    /// A MATLAB file of version 5 to 7.2 (.mat), a table with a row for each sector and direction, a column for each sector,
    /// or one pattern (.csv, .tsv, .txt, .ffe), a code book of ns-3 in numbers (.txt), or a pattern of MSI and Planet (.msi,
    /// .pln)
    #[arg(value_name = "IN")]
    pub(crate) source: PathBuf,
    /// The code book
    #[arg(value_name = "OUT.csv")]
    pub(crate) out: PathBuf,
    /// The column or variable with the identities of sectors
    #[arg(long, value_name = "NAME")]
    pub(crate) sector: Option<String>,
    /// The column or variable with the azimuths
    #[arg(long, value_name = "NAME")]
    pub(crate) azimuth: Option<String>,
    /// The column or variable with the elevations: angles from the horizontal plane, whatever its name
    #[arg(long, value_name = "NAME")]
    pub(crate) elevation: Option<String>,
    /// The column or variable with the gains
    #[arg(long, value_name = "NAME")]
    pub(crate) gain: Option<String>,
    /// The unit of the gains [default: what the name of the column says]
    #[arg(long, value_enum)]
    pub(crate) unit: Option<Unit>,
    /// The sector whose gains are those of the pattern with which the antenna listens
    #[arg(long, value_name = "ID")]
    pub(crate) quasi_omni: Option<u8>,
    /// Elevations are angles from the zenith [default: what the name of the column says]
    #[arg(long)]
    pub(crate) zenith: bool,
    /// Angles are in radians [default: what the names of the columns say]
    #[arg(long, conflicts_with = "degrees")]
    pub(crate) radians: bool,
    /// Angles are in degrees, though they look like radians
    #[arg(long)]
    pub(crate) degrees: bool,
    /// The axes of an array of gains, in the order of the file: sector,elevation,azimuth for example [default: as their
    /// lengths tell]
    #[arg(long, value_name = "AXES")]
    pub(crate) order: Option<ArrayOrder>,
    /// Which way azimuths turn, seen from above, in a pattern of MSI and Planet that is not the same on both sides
    #[arg(long, value_enum)]
    pub(crate) azimuths: Option<Azimuths>,
    /// What may be replaced.
    #[command(flatten)]
    pub(crate) replacing: Replacing,
}

/// Which way azimuths turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Azimuths {
    /// To the right, as on a compass
    Clockwise,
    /// To the left
    Counterclockwise,
}

impl From<Azimuths> for Turning {
    fn from(azimuths: Azimuths) -> Self {
        match azimuths {
            Azimuths::Clockwise => Self::Clockwise,
            Azimuths::Counterclockwise => Self::Counterclockwise,
        }
    }
}

/// The unit of measured gains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Unit {
    /// Decibels over an isotropic antenna
    Dbi,
    /// Decibels in relative units, such as signal-to-noise ratios
    Db,
    /// Powers as factors
    Linear,
}

impl From<Unit> for GainUnit {
    fn from(unit: Unit) -> Self {
        match unit {
            Unit::Dbi => Self::Dbi,
            Unit::Db => Self::Relative,
            Unit::Linear => Self::Linear,
        }
    }
}

pub(crate) fn execute(arguments: &Arguments, interrupt: &Interrupt) -> Result<(), Failure> {
    match &arguments.task {
        AntennaTask::Show(arguments) => show(arguments, interrupt),
        AntennaTask::Convert(arguments) => convert_file(arguments),
    }
}

fn show(arguments: &ShowArguments, interrupt: &Interrupt) -> Result<(), Failure> {
    let source = &arguments.source;
    let is_book = source.extension().is_some_and(|extension| extension == "csv");
    let antenna = if is_book {
        read_book(source, &arguments.overrides.set)?
    } else {
        antenna_of(arguments, &Scenario::load_with(source, &arguments.overrides.set, None)?)?
    };
    if antenna.is_omnidirectional() {
        return Err(Failure::bad_input_with_help(
            format!(
                "the antenna of `{}` has the same gain in all directions, so it has no sectors to show",
                source.display()
            ),
            "the other antenna of a scenario: --of nodes or --of robots",
        ));
    }
    let coverage = AntennaCoverage::of(&antenna);
    arguments.printing.print(&coverage, |stdout| write!(stdout, "{coverage}"))?;
    let stem = source.file_stem().unwrap_or_default().to_string_lossy();
    draw(&stem, &antenna, arguments, interrupt)
}

/// The antenna of a scenario that the arguments name.
fn antenna_of(arguments: &ShowArguments, scenario: &Scenario) -> Result<Antenna, Failure> {
    let is_named = |name: Option<&str>| arguments.network.as_deref().is_none_or(|wanted| name == Some(wanted));
    let mut networks = scenario.networks().iter().filter(|network| is_named(network.name.as_deref()));
    let antennas = networks.find_map(|network| network.technology.antennas()).ok_or_else(|| {
        let of = arguments.network.as_ref().map_or(String::new(), |name| format!(" in a network `{name}`"));
        Failure::bad_input_with_help(
            format!("`{}` has no antennas with sectors{of}", arguments.source.display()),
            "antennas are the tables [antenna.nodes] and [antenna.robots] of a network with `mac.sector_sweep`",
        )
    })?;
    Ok(match arguments.of {
        Owner::Robots => antennas.robots().clone(),
        Owner::Nodes => antennas.nodes().clone(),
    })
}

/// Writes the figures, and prints their names where results are text.
fn draw(title: &str, antenna: &Antenna, arguments: &ShowArguments, interrupt: &Interrupt) -> Result<(), Failure> {
    let folder = arguments.out.clone().unwrap_or_else(|| arguments.source.with_extension("antenna"));
    disk::create_folders(&folder).map_err(|error| Failure::unwritable(&folder, &error))?;
    let format = arguments.pictures.into();
    let figures = of_antenna(title, antenna);
    let mut outputs = arguments.replacing.outputs();
    outputs.reads(&arguments.source);
    figures.iter().for_each(|figure| {
        outputs.writes("", &figure.path(&folder, format), OutputKind::Picture);
    });
    admit(&outputs, None)?;
    for figure in figures {
        let file = figure.path(&folder, format);
        let bytes = figure.encode(format).map_err(|error| Failure::unwritable(&file, &error))?;
        let _keeper = interrupt.keep();
        if interrupt.is_requested() {
            return Err(Failure::Interrupted);
        }
        write_file(&file, &bytes)?;
        if arguments.printing.is_text() {
            writeln!(stdout(), "{}", file.display())?;
        }
    }
    Ok(())
}

fn convert_file(arguments: &ConvertArguments) -> Result<(), Failure> {
    let ConvertArguments { source, out, .. } = arguments;
    let mut outputs = arguments.replacing.outputs();
    outputs.reads(source).writes("", out, OutputKind::Table);
    admit(&outputs, None)?;
    keep_logs(None, [("", out.as_path())])?;
    let names = SourceNames {
        sector: arguments.sector.clone(),
        azimuth: arguments.azimuth.clone(),
        elevation: arguments.elevation.clone(),
        gain: arguments.gain.clone(),
        quasi_omni: arguments.quasi_omni,
        from_zenith: arguments.zenith,
        angles: match (arguments.radians, arguments.degrees) {
            (true, _) => Some(AngleUnit::Radians),
            (false, true) => Some(AngleUnit::Degrees),
            (false, false) => None,
        },
        order: arguments.order,
        turning: arguments.azimuths.map(Turning::from),
    };
    let book = convert(source, &names, arguments.unit.map(GainUnit::from))?;
    book.notes.iter().for_each(|note| warn(note));
    write_file(out, book.text.as_bytes())?;
    let mut stdout = stdout();
    writeln!(
        stdout,
        "{}: {}, {}, {} in `{}`",
        out.display(),
        counted(book.sectors, "sector"),
        counted(book.directions, "direction"),
        counted(book.gaps, "gap"),
        book.unit.column()
    )?;
    let mut needed = Vec::new();
    if book.unit == GainUnit::Relative {
        needed.push("boresight_gain_dbi = GAIN");
    }
    if book.gaps > 0 {
        needed.push("gaps = \"interpolate\"");
    }
    let needed = needed.iter().map(|key| format!(", {key}")).collect::<String>();
    writeln!(stdout, "in a scenario: code_book = {{ file = \"{}\"{needed} }}", out.display())?;
    Ok(())
}
