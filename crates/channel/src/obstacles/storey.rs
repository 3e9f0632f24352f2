//! Storeys of a building: heights, and the slabs between them.

use sextant_kernel::SettingError;

use super::obstacle::{Obstacle, ObstacleConfig};
use super::wall::WallConfig;
use crate::geometry::shape::{LEVEL_M, PrismConfig, ShapeConfig};

/// A storey as written in a scenario. Storeys are listed from the lowest to the highest.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StoreyConfig {
    /// Name, by which walls and nodes are in it.
    pub name: String,
    /// Height from its floor to its ceiling (m).
    pub height_m: f64,
    /// Height of its floor (m). If absent, the first storey is at 0, and each other one as thick as its slab above the ceiling of the
    /// one below.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub floor_m: Option<f64>,
    /// The slab under its floor, if there is one.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub slab: Option<SlabConfig>,
}

/// The slab under the floor of a storey, as written in a scenario. At most one of `material` and `absorption_per_m` is given, and at
/// least one of these and `loss_db`.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SlabConfig {
    /// Its corners in order, seen from above (m).
    pub corners_m: Vec<[f64; 2]>,
    /// Thickness (m). Its upper face is the floor of the storey.
    #[cfg_attr(feature = "config", serde(default = "usual_slab_m"))]
    pub thickness_m: f64,
    /// Name of a known material.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(feature = "schema", schemars(transform = crate::propagation::material::listed))]
    pub material: Option<String>,
    /// Absorption coefficient α (1/m), as that of an obstacle.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub absorption_per_m: Option<f64>,
    /// Loss of a link through the slab, however thick it is (dB), beside absorption: the loss per floor of a building.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub loss_db: Option<f64>,
    /// Loss of a reflection off its faces (dB); that of the channel if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub reflection_loss_db: Option<f64>,
}

/// Thickness of a slab that does not say its own (m).
#[cfg(feature = "config")]
fn usual_slab_m() -> f64 {
    0.2
}

/// The storeys of a building, from the lowest to the highest.
#[derive(Clone, Debug, Default)]
pub struct Storeys {
    storeys: Vec<Storey>,
}

#[derive(Clone, Debug)]
struct Storey {
    name: String,
    floor_m: f64,
    height_m: f64,
    slab: Option<Obstacle>,
}

impl Storeys {
    /// The storeys with these settings.
    ///
    /// # Errors
    /// If a number is invalid, a name is empty or that of another storey, a storey overlaps the one below it, or a slab is invalid.
    /// The key begins at the list: `storeys[1].floor_m`.
    pub fn new(configs: &[StoreyConfig]) -> Result<Self, SettingError> {
        let mut storeys = Self::default();
        for (number, config) in configs.iter().enumerate() {
            let storey = storeys.above(config).map_err(|error| error.within(format!("storeys[{number}]")))?;
            storeys.storeys.push(storey);
        }
        Ok(storeys)
    }

    /// One more storey above these.
    fn above(&self, config: &StoreyConfig) -> Result<Storey, SettingError> {
        let name = config.name.clone();
        if name.trim().is_empty() {
            return Err(SettingError::new("name", "empty", "a name with at least one letter or digit"));
        }
        if self.storeys.iter().any(|other| other.name == name) {
            return Err(SettingError::new("name", format!("`{name}`, as of another storey"), "a unique name"));
        }
        let height_m = SettingError::positive("height_m", config.height_m)?;
        let thickness_m = match &config.slab {
            Some(slab) => {
                SettingError::positive("thickness_m", slab.thickness_m).map_err(|error| error.within("slab"))?
            }
            None => 0.0,
        };
        let below = self.storeys.last();
        let lowest_m = below.map(|below| to_nm(below.floor_m + below.height_m + thickness_m));
        let floor_m = SettingError::finite("floor_m", config.floor_m.or(lowest_m).unwrap_or(0.0))?;
        if let (Some(below), Some(lowest_m)) = (below, lowest_m)
            && floor_m < lowest_m - LEVEL_M
        {
            let ceiling_m = to_nm(below.floor_m + below.height_m);
            let slab =
                if thickness_m > 0.0 { format!(", and the slab is {thickness_m} m thick") } else { String::new() };
            let allowed = format!("at least {lowest_m}: the ceiling of `{}` is at {ceiling_m} m{slab}", below.name);
            return Err(SettingError::new("floor_m", floor_m, allowed));
        }
        let slab = config.slab.as_ref().map(|slab| slab.obstacle(&name, floor_m)).transpose();
        Ok(Storey { slab: slab.map_err(|error| error.within("slab"))?, name, floor_m, height_m })
    }

    /// Height of the floor of a storey (m); 0 without a name.
    ///
    /// # Errors
    /// If there is no storey of this name; `key` is where it is named.
    pub fn floor_m(&self, key: &str, name: Option<&str>) -> Result<f64, SettingError> {
        name.map_or(Ok(0.0), |name| self.named(key, name).map(|storey| storey.floor_m))
    }

    fn named(&self, key: &str, name: &str) -> Result<&Storey, SettingError> {
        self.storeys.iter().find(|storey| storey.name == name).ok_or_else(|| {
            let names: Vec<String> = self.storeys.iter().map(|storey| format!("`{}`", storey.name)).collect();
            let allowed = if names.is_empty() {
                "the name of a storey, of which `world.storeys` has none".to_owned()
            } else {
                format!("a storey of `world.storeys`: {}", names.join(", "))
            };
            SettingError::new(key, format!("`{name}`"), allowed)
        })
    }

    /// A wall with heights from zero, if it is in a storey: it stands on the floor and, without a height of its own, reaches to the
    /// ceiling.
    ///
    /// # Errors
    /// If its storey is unknown, or it reaches through the ceiling.
    pub fn wall(&self, wall: &WallConfig) -> Result<WallConfig, SettingError> {
        let Some(name) = &wall.storey else { return Ok(wall.clone()) };
        let storey = self.named("storey", name)?;
        let height_m = wall.height_m.unwrap_or(storey.height_m - wall.bottom_m);
        if wall.bottom_m < -LEVEL_M || wall.bottom_m >= storey.height_m {
            let allowed = format!("a number from 0 to less than {}, the height of `{name}`", storey.height_m);
            return Err(SettingError::new("bottom_m", wall.bottom_m, allowed));
        }
        if wall.bottom_m + height_m > storey.height_m + LEVEL_M {
            let most_m = to_nm(storey.height_m - wall.bottom_m);
            let allowed = format!(
                "at most {most_m}: `{name}` is {} m high; a wall over several storeys names none",
                storey.height_m
            );
            return Err(SettingError::new("height_m", height_m, allowed));
        }
        Ok(WallConfig {
            storey: None,
            bottom_m: storey.floor_m + wall.bottom_m,
            height_m: Some(height_m),
            ..wall.clone()
        })
    }

    /// The slabs, each with the number of its storey.
    pub fn slabs(&self) -> impl Iterator<Item = (usize, &Obstacle)> {
        self.storeys.iter().enumerate().filter_map(|(number, storey)| Some((number, storey.slab.as_ref()?)))
    }
}

/// A height (m) to the nanometre: sums of heights read as people write them.
fn to_nm(height_m: f64) -> f64 {
    (height_m * 1e9).round() / 1e9
}

impl SlabConfig {
    /// The slab under the floor at this height of a storey.
    fn obstacle(&self, storey: &str, floor_m: f64) -> Result<Obstacle, SettingError> {
        let corners_m = self.corners_m.clone();
        let prism = PrismConfig { corners_m, bottom_m: floor_m - self.thickness_m, height_m: self.thickness_m };
        let slab = Obstacle::try_from(ObstacleConfig {
            name: Some(format!("slab of {storey}")),
            shape: ShapeConfig::Prism(prism),
            material: self.material.clone(),
            absorption_per_m: self.absorption_per_m,
            loss_db: self.loss_db,
            solid: true,
            reflection_loss_db: self.reflection_loss_db,
        });
        slab.map_err(|mut error| {
            if let Some(own) = error.key.strip_prefix("shape.prism.") {
                error.key = own.to_owned();
            }
            error
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ObstacleField, Position};

    fn storey(name: &str, height_m: f64, slab: Option<SlabConfig>) -> StoreyConfig {
        StoreyConfig { name: name.to_owned(), height_m, floor_m: None, slab }
    }

    /// 10 dB, and 1 dB per metre.
    fn slab(thickness_m: f64) -> SlabConfig {
        SlabConfig {
            corners_m: vec![[0.0, 0.0], [20.0, 0.0], [20.0, 10.0], [0.0, 10.0]],
            thickness_m,
            material: None,
            absorption_per_m: Some(std::f64::consts::LN_10 / 10.0),
            loss_db: Some(10.0),
            reflection_loss_db: None,
        }
    }

    fn building() -> [StoreyConfig; 3] {
        [storey("ground", 2.7, None), storey("first", 2.5, Some(slab(0.3))), storey("second", 2.5, Some(slab(0.2)))]
    }

    #[test]
    fn a_link_loses_at_each_slab_what_its_way_through_it_takes() {
        let storeys = Storeys::new(&building()).unwrap();
        let floors = ["ground", "first", "second"].map(|name| storeys.floor_m("storey", Some(name)).unwrap());
        assert!(
            floors.iter().zip([0.0_f64, 3.0, 5.7]).all(|(found, floor_m)| found.to_bits() == floor_m.to_bits()),
            "{floors:?}"
        );
        let field = ObstacleField::new(storeys.slabs().map(|(_, slab)| slab.clone()).collect());
        let loss_db = |from: [f64; 3], to: [f64; 3]| field.loss(Position::from(from), Position::from(to)).0;
        let near = |found: f64, wanted: f64| assert!((found - wanted).abs() < 1e-9, "{found}, not {wanted}");
        near(loss_db([5.0, 5.0, 1.0], [9.0, 5.0, 1.0]), 0.0);
        near(loss_db([5.0, 5.0, 1.0], [5.0, 5.0, 4.0]), 10.0 + 0.3);
        // At 3 : 4 : 5 the way through is 5/4 of the thickness.
        near(loss_db([5.0, 5.0, 1.0], [8.0, 5.0, 5.0]), 10.0 + 0.3 * 5.0 / 4.0);
        near(loss_db([5.0, 5.0, 1.0], [5.0, 5.0, 6.0]), 20.0 + 0.3 + 0.2);
        // Past the edge there is no slab; on the floor one is above it.
        near(loss_db([21.0, 5.0, 1.0], [21.0, 5.0, 6.0]), 0.0);
        near(loss_db([5.0, 5.0, 3.0], [9.0, 5.0, 3.0]), 0.0);
    }

    fn wall_of_brick() -> WallConfig {
        WallConfig {
            name: None,
            points_m: vec![[1.0, 1.0], [5.0, 1.0]],
            thickness_m: 0.1,
            storey: None,
            bottom_m: 0.0,
            height_m: None,
            material: Some("brick".to_owned()),
            absorption_per_m: None,
            loss_db: None,
            reflection_loss_db: None,
            openings: Vec::new(),
        }
    }

    #[test]
    fn a_wall_in_a_storey_stands_on_its_floor_and_reaches_to_its_ceiling() {
        let storeys = Storeys::new(&building()).unwrap();
        let wall = WallConfig { storey: Some("first".to_owned()), ..wall_of_brick() };
        let placed = storeys.wall(&wall).unwrap();
        assert_eq!((placed.bottom_m, placed.height_m, placed.storey), (3.0, Some(2.5), None));
        let low = storeys.wall(&WallConfig { bottom_m: 1.0, height_m: Some(0.5), ..wall.clone() }).unwrap();
        assert_eq!((low.bottom_m, low.height_m), (4.0, Some(0.5)));
        let refused = |wall: &WallConfig| storeys.wall(wall).unwrap_err().to_string();
        let found = refused(&WallConfig { height_m: Some(2.6), ..wall.clone() });
        assert!(found.contains("`height_m` is 2.6") && found.contains("at most 2.5"), "{found}");
        let found = refused(&WallConfig { bottom_m: 2.5, ..wall.clone() });
        assert!(found.contains("`bottom_m` is 2.5"), "{found}");
        let found = refused(&WallConfig { storey: Some("attic".to_owned()), ..wall });
        assert!(found.contains("`storey` is `attic`") && found.contains("`ground`, `first`, `second`"), "{found}");
    }

    #[test]
    fn storeys_that_overlap_and_slabs_that_are_invalid_are_refused_at_their_key() {
        let [ground, first, second] = building();
        let refused = |upper: StoreyConfig| Storeys::new(&[ground.clone(), upper]).unwrap_err().to_string();
        let found = refused(StoreyConfig { floor_m: Some(2.9), ..first.clone() });
        assert!(
            found.contains("`storeys[1].floor_m` is 2.9") && found.contains("at least 3: the ceiling of `ground`"),
            "{found}"
        );
        assert!(refused(StoreyConfig { name: "ground".to_owned(), ..first.clone() }).contains("`storeys[1].name`"));
        assert!(refused(StoreyConfig { height_m: 0.0, ..first.clone() }).contains("`storeys[1].height_m` is 0"));
        let slab = |slab: SlabConfig| refused(StoreyConfig { slab: Some(slab), ..second.clone() });
        assert!(
            slab(SlabConfig { thickness_m: -1.0, ..self::slab(0.2) }).contains("`storeys[1].slab.thickness_m` is -1")
        );
        let found = slab(SlabConfig { corners_m: vec![[0.0, 0.0], [1.0, 0.0]], ..self::slab(0.2) });
        assert!(found.contains("`storeys[1].slab.corners_m`"), "{found}");
        let nothing = SlabConfig { absorption_per_m: None, loss_db: None, ..self::slab(0.2) };
        assert!(slab(nothing).contains("storeys[1].slab"));
        assert!(Storeys::new(&[ground.clone(), StoreyConfig { floor_m: Some(3.5), ..first }]).is_ok());
    }
}
