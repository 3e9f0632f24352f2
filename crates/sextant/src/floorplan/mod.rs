//! Floor plans: walls for a scenario from an image, from a map of a robot, from GeoJSON, or from a drawing in DXF.

mod blobs;
mod dxf;
mod error;
mod faces;
mod geojson;
mod graph;
mod image;
mod lines;
mod occupancy;
mod reference_system;
mod ros_map;
mod thinning;
mod traced;

use std::path::Path;

use serde::{Deserialize, Serialize};
use sextant_channel::{
    Material, Obstacle, ObstacleConfig, ObstacleField, PrismConfig, ShapeConfig, StoreyConfig, Storeys, WallConfig,
};
use sextant_kernel::{Files, SettingError};
use sextant_logs::LocalPlane;
use sextant_mapper::convex_hull;

pub use dxf::LengthUnit;
pub use error::FloorPlanError;
use occupancy::Occupancy;

/// How a floor plan is read.
#[derive(Clone, Debug, PartialEq)]
pub struct FloorPlanOptions {
    /// Length of a pixel (m); that of the map of a robot if absent.
    pub metres_per_pixel: Option<f64>,
    /// Where the lower left corner of an image, or zero of GeoJSON or DXF, is (m); that of the map of a robot, or zero, if absent.
    pub origin_m: Option<[f64; 2]>,
    /// Unit of lengths of a drawing in DXF, or of GeoJSON that is not in degrees; what the file says if absent.
    pub unit: Option<LengthUnit>,
    /// The plane in which GeoJSON by longitude and latitude is; round its middle if absent.
    pub plane: Option<LocalPlane>,
    /// Layers of a drawing in DXF whose lines are walls, by name; all that are visible if empty.
    pub layers: Vec<String>,
    /// Material of the walls that do not say their own.
    pub material: String,
    /// Height of such walls (m).
    pub height_m: f64,
    /// Thickness of such walls in GeoJSON and DXF (m). In an image it is measured.
    pub thickness_m: f64,
    /// What is thicker is no wall but a block (m). A closed line that is no longer and no wider is one too.
    pub thickest_m: f64,
}

impl Default for FloorPlanOptions {
    fn default() -> Self {
        Self {
            metres_per_pixel: None,
            origin_m: None,
            unit: None,
            plane: None,
            layers: Vec::new(),
            material: "brick".to_owned(),
            height_m: sextant_channel::USUAL_HEIGHT_M,
            thickness_m: sextant_channel::USUAL_THICKNESS_M,
            thickest_m: 0.6,
        }
    }
}

impl FloorPlanOptions {
    /// A wall along these corners.
    fn wall(&self, points_m: Vec<[f64; 2]>) -> WallConfig {
        WallConfig {
            name: None,
            points_m,
            thickness_m: self.thickness_m,
            bottom_m: 0.0,
            storey: None,
            height_m: Some(self.height_m),
            material: Some(self.material.clone()),
            absorption_per_m: None,
            loss_db: None,
            reflection_loss_db: None,
            openings: Vec::new(),
        }
    }
}

/// Walls and blocks of a floor plan.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FloorPlan {
    /// The walls.
    pub walls: Vec<WallConfig>,
    /// What is thicker than walls: pillars, shafts, furniture.
    pub blocks: Vec<ObstacleConfig>,
    /// The storeys, of walls and obstacles of a scenario.
    pub storeys: Vec<StoreyConfig>,
    /// What the user should know, above all what was not read.
    pub notes: Vec<String>,
    /// Whether its places were given by longitude and latitude.
    pub is_by_degrees: bool,
}

/// Reads the floor plan `path`: an image (PNG, PGM) in which walls are dark, a map of a robot (`map.yaml` of ROS beside its image), GeoJSON
/// with lines and areas, or a drawing (DXF) with lines, polylines, arcs and circles; or walls and obstacles of a scenario, as [`FloorPlan::to_toml`] writes them.
///
/// # Errors
/// If the file cannot be read, an option is missing, invalid or without effect, or there are no walls.
pub fn read(path: &Path, options: &FloorPlanOptions) -> Result<FloorPlan, FloorPlanError> {
    check(options)?;
    let form = PlanForm::of(path).ok_or_else(|| FloorPlanError::Form { path: path.to_owned() })?;
    check_effects(options, form)?;
    let plan = match form {
        PlanForm::Image => {
            let pixel_m =
                options.metres_per_pixel.ok_or_else(|| FloorPlanError::NoScale { path: path.to_owned() })?;
            let picture = image::read(path)?;
            traced::plan(&Occupancy::of_image(&picture, pixel_m, options.origin_m.unwrap_or_default()), options)
        }
        PlanForm::RobotMap => {
            let map = ros_map::read(path)?;
            let picture = image::read(&map.image)?;
            let mut occupancy = map.occupancy(&picture);
            occupancy.pixel_m = options.metres_per_pixel.unwrap_or(occupancy.pixel_m);
            occupancy.origin_m = options.origin_m.unwrap_or(occupancy.origin_m);
            let mut plan = traced::plan(&occupancy, options);
            plan.notes.splice(..0, map.replaced(options));
            plan
        }
        PlanForm::GeoJson => geojson::read(path, options)?,
        PlanForm::Drawing => dxf::read(path, options)?,
        PlanForm::Walls => of_tables(path)?,
    };
    if plan.walls.is_empty() && plan.blocks.is_empty() {
        return Err(FloorPlanError::NoWalls { path: path.to_owned(), notes: plan.notes.join("; ") });
    }
    Ok(plan)
}

/// The walls and obstacles in the tables `world.walls` and `world.obstacles` of a file; what else is in it is not looked at.
fn of_tables(path: &Path) -> Result<FloorPlan, FloorPlanError> {
    #[derive(Deserialize)]
    struct Tables {
        world: World,
    }
    #[derive(Deserialize)]
    struct World {
        #[serde(default)]
        walls: Vec<WallConfig>,
        #[serde(default)]
        obstacles: Vec<ObstacleConfig>,
        #[serde(default)]
        storeys: Vec<StoreyConfig>,
    }
    let text = std::fs::read_to_string(path)
        .map_err(|why| FloorPlanError::Read { path: path.to_owned(), why: why.to_string() })?;
    let Tables { world: World { walls, obstacles, storeys } } = toml::from_str(&text)
        .map_err(|why| FloorPlanError::Content { path: path.to_owned(), problem: why.to_string() })?;
    Ok(FloorPlan { walls, blocks: obstacles, storeys, ..FloorPlan::default() })
}

fn check(options: &FloorPlanOptions) -> Result<(), FloorPlanError> {
    let refused = |option, found: String, allowed: String| FloorPlanError::Option { option, found, allowed };
    if Material::named(&options.material).is_none() {
        return Err(refused("material", options.material.clone(), Material::names()));
    }
    let sizes = [("height", options.height_m), ("thickness", options.thickness_m), ("thickest", options.thickest_m)];
    let pixel = options.metres_per_pixel.map(|pixel_m| ("scale", pixel_m));
    for (option, value) in sizes.into_iter().chain(pixel) {
        if !(value > 0.0 && value <= 1000.0) {
            return Err(refused(option, value.to_string(), "a number of metres above 0, at most 1000".to_owned()));
        }
    }
    let places = options.origin_m.into_iter().flatten();
    match places.into_iter().find(|place| !(-1e9..=1e9).contains(place)) {
        Some(bad) => Err(refused("origin", bad.to_string(), "two finite numbers of metres".to_owned())),
        None => Ok(()),
    }
}

/// The form of a floor plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PlanForm {
    Image,
    RobotMap,
    GeoJson,
    Drawing,
    Walls,
}

impl PlanForm {
    /// That of the file `path`, by its name; `None` if it is no floor plan.
    fn of(path: &Path) -> Option<Self> {
        let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default().to_lowercase();
        Some(match extension.as_str() {
            "png" | "pgm" => Self::Image,
            "yaml" | "yml" => Self::RobotMap,
            "json" | "geojson" => Self::GeoJson,
            "dxf" => Self::Drawing,
            "toml" => Self::Walls,
            _ => return None,
        })
    }

    /// Whether its walls are traced: they are the dark parts of a picture.
    fn is_traced(self) -> bool {
        matches!(self, Self::Image | Self::RobotMap)
    }
}

/// Whether the walls of the floor plan `path` are the dark parts of a picture, by its name.
#[must_use]
pub fn is_traced(path: &Path) -> bool {
    PlanForm::of(path).is_some_and(PlanForm::is_traced)
}

/// Refuses options without effect on a plan of this form. Those of walls have an effect if they are not the usual ones.
fn check_effects(options: &FloorPlanOptions, form: PlanForm) -> Result<(), FloorPlanError> {
    let (is_image, is_dxf, is_any) = (form.is_traced(), form == PlanForm::Drawing, form != PlanForm::Walls);
    let is_drawn = is_dxf || form == PlanForm::GeoJson;
    let usual = FloorPlanOptions::default();
    let is_given = |length_m: f64, usual_m: f64| length_m.to_bits() != usual_m.to_bits();
    let (images, dxf, drawn) = ("an image or a map of a robot", "a drawing in DXF", "GeoJSON or a drawing in DXF");
    let any = "a plan that is not yet walls of a scenario";
    let without = [
        ("scale", options.metres_per_pixel.is_some(), is_image, images),
        ("thickest", is_given(options.thickest_m, usual.thickest_m), is_any, any),
        ("unit", options.unit.is_some(), is_drawn, drawn),
        ("layers", !options.layers.is_empty(), is_dxf, dxf),
        ("thickness", is_given(options.thickness_m, usual.thickness_m), is_drawn, drawn),
        ("height", is_given(options.height_m, usual.height_m), is_any, any),
        ("material", options.material != usual.material, is_any, any),
        ("origin", options.origin_m.is_some(), is_any, any),
    ];
    match without.into_iter().find(|&(_, is_given, has_effect, _)| is_given && !has_effect) {
        Some((option, .., of)) => {
            Err(FloorPlanError::Option { option, found: "given".to_owned(), allowed: format!("only with {of}") })
        }
        None => Ok(()),
    }
}

impl FloorPlan {
    /// Adds a closed line as a block if it goes round a pillar or a shaft; whether it does.
    fn add_pillar(&mut self, wall: &WallConfig, options: &FloorPlanOptions) -> bool {
        let points = &wall.points_m;
        let size_m = |axis: usize| {
            let of = points.iter().map(|point| point[axis]);
            of.clone().fold(f64::MIN, f64::max) - of.fold(f64::MAX, f64::min)
        };
        let is_closed = points.len() > 3 && points.first() == points.last();
        if !is_closed || size_m(0).max(size_m(1)) > options.thickest_m {
            return false;
        }
        let block = ObstacleConfig {
            name: wall.name.clone().or_else(|| Some(format!("block {}", self.blocks.len()))),
            shape: ShapeConfig::Prism(PrismConfig {
                corners_m: convex_hull(points.clone()),
                bottom_m: wall.bottom_m,
                height_m: wall.height_m.unwrap_or(options.height_m),
            }),
            material: wall.material.clone(),
            absorption_per_m: None,
            loss_db: None,
            solid: true,
            reflection_loss_db: None,
        };
        let is_solid = Obstacle::try_from(block.clone()).is_ok();
        if is_solid {
            self.blocks.push(block);
        }
        is_solid
    }

    /// The plan as tables of a scenario, which others can extend. `source` is named in its head.
    ///
    /// # Panics
    /// Never: numbers and names can all be written.
    #[must_use]
    pub fn to_toml(&self, source: &str) -> String {
        #[derive(Serialize)]
        struct Tables<'a> {
            world: World<'a>,
        }
        #[derive(Serialize)]
        struct World<'a> {
            #[serde(skip_serializing_if = "<[_]>::is_empty")]
            storeys: &'a [StoreyConfig],
            #[serde(skip_serializing_if = "<[_]>::is_empty")]
            walls: &'a [WallConfig],
            #[serde(skip_serializing_if = "<[_]>::is_empty")]
            obstacles: &'a [ObstacleConfig],
        }
        let world = World { storeys: &self.storeys, walls: &self.walls, obstacles: &self.blocks };
        let tables = toml::to_string(&Tables { world }).expect("tables of numbers and names");
        format!(
            "# Walls of the floor plan {source}. A scenario takes them with `extends`. Lengths are in metres.\n\
             # Doors and windows: [[world.walls.openings]] with at_m, width_m, bottom_m, top_m and material.\n\n{tables}"
        )
    }

    /// What stands on the floor. Files of meshes are relative to the working folder.
    ///
    /// # Errors
    /// If a wall or a block is invalid.
    pub fn obstacles(&self) -> Result<ObstacleField, SettingError> {
        let mut all = Vec::new();
        for (i, block) in self.blocks.iter().enumerate() {
            let read = Obstacle::read_all(block.clone(), &Files::default());
            all.extend(read.map_err(|error| error.within(format!("world.obstacles[{i}]")))?);
        }
        let storeys = Storeys::new(&self.storeys).map_err(|error| error.within("world"))?;
        for (i, wall) in self.walls.iter().enumerate() {
            let pieces = storeys.wall(wall).and_then(|wall| wall.obstacles(i));
            all.extend(pieces.map_err(|error| error.within(format!("world.walls[{i}]")))?);
        }
        all.extend(storeys.slabs().map(|(_, slab)| slab.clone()));
        Ok(ObstacleField::new(all))
    }

    /// Length of all walls (m).
    #[must_use]
    pub fn length_m(&self) -> f64 {
        let of = |wall: &WallConfig| {
            let legs = wall.points_m.windows(2);
            legs.map(|leg| libm::hypot(leg[1][0] - leg[0][0], leg[1][1] - leg[0][1])).sum::<f64>()
        };
        // The sum of nothing has a sign.
        self.walls.iter().map(of).sum::<f64>() + 0.0
    }
}

/// A length (m) to the millimetre, without a sign of zero.
fn to_mm(length_m: f64) -> f64 {
    (length_m * 1000.0).round() / 1000.0 + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_walls_have_no_length_and_no_sign() {
        assert_eq!(format!("{:.1}", FloorPlan::default().length_m()), "0.0");
    }

    #[test]
    fn storeys_of_tables_are_laid_with_their_walls_and_slabs() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("walls.toml");
        let text = "[[world.storeys]]\nname = \"ground\"\nheight_m = 2.5\n[[world.storeys]]\nname = \"upper\"\nheight_m = 2.5\n\
                    slab = { corners_m = [[0, 0], [9, 0], [9, 9], [0, 9]], loss_db = 15 }\n\
                    [[world.walls]]\npoints_m = [[1, 1], [8, 1]]\nstorey = \"upper\"\nmaterial = \"brick\"\n";
        std::fs::write(&file, text).unwrap();
        let field = read(&file, &FloorPlanOptions::default()).unwrap().obstacles().unwrap();
        let tops = field.obstacles().iter().map(|obstacle| obstacle.shape().bounds());
        let heights: Vec<[f64; 2]> = tops.map(|bounds| [bounds.min.z_m, bounds.max.z_m]).collect();
        assert_eq!(heights, [[2.7, 5.2], [2.5, 2.7]]);
        std::fs::write(&file, text.replace("storey = \"upper\"", "storey = \"attic\"")).unwrap();
        let found = read(&file, &FloorPlanOptions::default()).unwrap().obstacles().unwrap_err().to_string();
        assert!(found.contains("`world.walls[0].storey` is `attic`"), "{found}");
    }

    #[test]
    fn options_without_effect_are_refused() {
        let usual = FloorPlanOptions::default;
        let scaled = FloorPlanOptions { metres_per_pixel: Some(0.05), ..usual() };
        let in_mm = FloorPlanOptions { unit: Some(LengthUnit::Millimetre), ..usual() };
        let of_layers = FloorPlanOptions { layers: vec!["walls".to_owned()], ..usual() };
        let moved = FloorPlanOptions { origin_m: Some([1.0, 2.0]), ..usual() };
        let high = FloorPlanOptions { height_m: 9.0, ..usual() };
        let thick = FloorPlanOptions { thickness_m: 0.3, ..usual() };
        let of_glass = FloorPlanOptions { material: "glass".to_owned(), ..usual() };
        let problem = |options: &FloorPlanOptions, extension: &str| {
            let form = PlanForm::of(&Path::new("plan").with_extension(extension)).expect("a plan");
            check_effects(options, form).err().map_or_else(String::new, |error| error.to_string())
        };
        for (options, option, without, with) in [
            (&scaled, "scale", &["dxf", "geojson", "json", "toml"][..], &["png", "pgm", "yaml"][..]),
            (&in_mm, "unit", &["png", "yml", "toml"], &["dxf", "geojson"]),
            (&of_layers, "layers", &["png", "geojson", "toml"], &["dxf"]),
            (&thick, "thickness", &["png", "yaml", "toml"], &["dxf", "geojson"]),
            (&moved, "origin", &["toml"], &["png", "yaml", "geojson", "dxf"]),
            (&high, "height", &["toml"], &["png", "yaml", "geojson", "dxf"]),
            (&of_glass, "material", &["toml"], &["png", "yaml", "geojson", "dxf"]),
        ] {
            for extension in without {
                let found = problem(options, extension);
                let expected = format!("option `{option}` is given; allowed: only with");
                assert!(found.starts_with(&expected), "{extension}: {found}");
            }
            assert!(with.iter().all(|extension| problem(options, extension).is_empty()), "{option}");
        }
        assert!(problem(&usual(), "toml").is_empty());
    }
}
