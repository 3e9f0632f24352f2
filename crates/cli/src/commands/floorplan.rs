//! `sextant floorplan`: walls of a scenario from a floor plan.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use sextant::floorplan::{self, FloorPlanError, FloorPlanOptions, LengthUnit};
use sextant::mapping::Input;
use sextant_kernel::text::counted;
use sextant_recording::admission::OutputKind;
use sextant_recording::output::write_file;

use super::outputs::{Replacing, admit, keep_logs};
use crate::diagnostic::Failure;
use crate::terminal::{say, stdout};

/// Arguments of `sextant floorplan`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Arguments {
    /// The floor plan: an image in which walls are dark (.png, .pgm), a map of ROS (map.yaml beside its image), GeoJSON (lines, and
    /// the borders of areas), or a drawing in DXF (lines, polylines, arcs, circles, and blocks of them)
    #[arg(value_name = "PLAN")]
    pub(crate) plan: PathBuf,
    /// Where the walls are written: a scenario takes them with `extends`; `-` prints them
    #[arg(long, value_name = "WALLS.toml", default_value = "walls.toml")]
    pub(crate) out: PathBuf,
    /// Length of a pixel of an image (m) [default: that of a map of ROS]
    #[arg(long, value_name = "METRES")]
    pub(crate) scale: Option<f64>,
    /// Where the lower left corner of the image, or zero of GeoJSON or DXF, is: X,Y (m) [default: that of a map of ROS, or 0,0]
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_delimiter = ',', num_args = 1)]
    pub(crate) origin: Vec<f64>,
    /// Unit of lengths of a drawing in DXF, or of GeoJSON that is not in degrees [default: what the file says]
    #[arg(long, value_enum, value_name = "UNIT")]
    pub(crate) unit: Option<Unit>,
    /// Layers of a drawing in DXF whose lines are walls: NAME,.. [default: all that are visible]
    #[arg(long, value_name = "LAYERS", value_delimiter = ',')]
    pub(crate) layers: Vec<String>,
    /// Material of the walls, if the plan does not say it
    #[arg(long, value_name = "NAME", default_value = "brick")]
    pub(crate) material: String,
    /// Height of the walls (m), if the plan does not say it
    #[arg(long, value_name = "METRES", default_value_t = FloorPlanOptions::default().height_m)]
    pub(crate) height: f64,
    /// Thickness of the walls of GeoJSON that do not say their own, and of DXF (m). In an image it is measured
    #[arg(long, value_name = "METRES", default_value_t = FloorPlanOptions::default().thickness_m)]
    pub(crate) thickness: f64,
    /// What is thicker in an image is no wall but a block, and so is a closed line that is no longer and no wider (m)
    #[arg(long, value_name = "METRES", default_value_t = FloorPlanOptions::default().thickest_m)]
    pub(crate) thickest: f64,
    /// What may be replaced.
    #[command(flatten)]
    pub(crate) replacing: Replacing,
}

/// A unit of lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Unit {
    /// Millimetres
    Mm,
    /// Centimetres
    Cm,
    /// Decimetres
    Dm,
    /// Metres
    M,
    /// Kilometres
    Km,
    /// Inches
    In,
    /// Feet
    Ft,
    /// Yards
    Yd,
    /// Feet of surveys in the United States (1200/3937 m)
    UsFt,
}

impl Unit {
    fn length(self) -> LengthUnit {
        match self {
            Self::Mm => LengthUnit::Millimetre,
            Self::Cm => LengthUnit::Centimetre,
            Self::Dm => LengthUnit::Decimetre,
            Self::M => LengthUnit::Metre,
            Self::Km => LengthUnit::Kilometre,
            Self::In => LengthUnit::Inch,
            Self::Ft => LengthUnit::Foot,
            Self::Yd => LengthUnit::Yard,
            Self::UsFt => LengthUnit::UsSurveyFoot,
        }
    }
}

/// Walls under a log.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct PlanUnit {
    /// Unit of lengths of a floor plan in DXF, or in GeoJSON that is not in degrees [default: what the file says]
    #[arg(long, value_enum, value_name = "UNIT", requires = "floorplan")]
    pub(crate) floorplan_unit: Option<Unit>,
}

/// Puts the walls of a plan under the maps of a log.
///
/// # Errors
/// If the plan cannot be read, or a wall is invalid.
pub(super) fn lay(plan: Option<&Path>, unit: &PlanUnit, input: &mut Input) -> Result<(), Failure> {
    let unit = unit.floorplan_unit.map(Unit::length);
    plan.map_or(Ok(()), |plan| input.lay(plan, unit).map_err(unlaid))
}

/// Why a plan is not laid under a map. Its unit is a flag here; the length of a pixel is one of `sextant floorplan` alone.
fn unlaid(error: FloorPlanError) -> Failure {
    let problem = error.to_string().replace("option `unit`", "`--floorplan-unit`");
    let help = match &error {
        FloorPlanError::NoScale { path } => {
            let plan = path.display();
            format!(
                "convert it first: sextant floorplan {plan} --scale 0.05 --out walls.toml, then --floorplan walls.toml"
            )
        }
        FloorPlanError::NoUnit { .. } => "--floorplan-unit mm if a door is about 900 wide, m if it is 0.9".to_owned(),
        FloorPlanError::NotDegrees { .. } => {
            "--floorplan-unit m if they are metres in the frame of the log".to_owned()
        }
        FloorPlanError::Option { .. } => "leave it out".to_owned(),
        _ => return error.into(),
    };
    Failure::bad_input_with_help(problem, help)
}

/// Tells what the user should know.
fn tell(note: &str) {
    say(&format!("note: {note}"));
}

pub(crate) fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let origin_m = match *arguments.origin.as_slice() {
        [] => None,
        [x_m, y_m] => Some([x_m, y_m]),
        _ => {
            let found = arguments.origin.len();
            return Err(Failure::bad_input(format!("`--origin` has {found} numbers; allowed: two, X,Y in metres")));
        }
    };
    let options = FloorPlanOptions {
        metres_per_pixel: arguments.scale,
        origin_m,
        unit: arguments.unit.map(Unit::length),
        plane: None,
        layers: arguments.layers.iter().map(|layer| layer.trim().to_owned()).collect(),
        material: arguments.material.clone(),
        height_m: arguments.height,
        thickness_m: arguments.thickness,
        thickest_m: arguments.thickest,
    };
    let plan = floorplan::read(&arguments.plan, &options)?;
    let name = arguments.plan.file_name().unwrap_or_default().to_string_lossy();
    let text = plan.to_toml(&name);
    let out = &arguments.out;
    if out == Path::new("-") {
        plan.notes.iter().for_each(|note| tell(note));
        return Ok(write!(stdout(), "{text}")?);
    }
    let mut outputs = arguments.replacing.outputs();
    outputs.reads(&arguments.plan).writes("--out", out, OutputKind::Text(text.as_bytes()));
    admit(&outputs, None)?;
    keep_logs(None, [("--out", out.as_path())])?;
    plan.notes.iter().for_each(|note| tell(note));
    write_file(out, text.as_bytes())?;
    let (walls, blocks) = (counted(plan.walls.len(), "wall"), counted(plan.blocks.len(), "block"));
    let mut stdout = stdout();
    writeln!(stdout, "{}: {walls} of {:.1} m in all, {blocks}", out.display(), plan.length_m())?;
    writeln!(stdout, "in a scenario: extends = \"{}\"", out.display())?;
    Ok(())
}
