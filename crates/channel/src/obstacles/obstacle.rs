//! One obstacle: a shape made of a material.
use std::path::PathBuf;

use sextant_kernel::{Files, SettingError};

use crate::geometry::position::Position;
use crate::geometry::shape::{MeshConfig, Shape, ShapeConfig};
use crate::power::Db;
use crate::propagation::material::Material;

/// An obstacle as written in a scenario. At most one of `material` and `absorption_per_m` is given, and at least one of
/// these and `loss_db`.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ObstacleConfig {
    /// Name in messages and pictures.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub name: Option<String>,
    /// Its shape. It has its floor, and neither its sides nor its roof: on the ground it blocks stations at z = 0.
    pub shape: ShapeConfig,
    /// Name of a known material. `concrete` is light and dry, and absorbs 0.30 times the decibels of `itu-concrete`, which is dense, at all
    /// carriers.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(feature = "schema", schemars(transform = crate::propagation::material::listed))]
    pub material: Option<String>,
    /// Absorption coefficient α of the Lambert-Bouguer law (1/m): 10 α log10(e) = 4.343 α dB per metre.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub absorption_per_m: Option<f64>,
    /// Loss of a link for each passage through the obstacle, however thick it is (dB), beside absorption; a link that begins or
    /// ends in it pays it too. `inf` lets nothing through.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub loss_db: Option<f64>,
    /// Whether it fills its space. In a volume that is not solid, such as vegetation, nodes stand and robots drive, and
    /// range sensors do not see it.
    #[cfg_attr(feature = "config", serde(default = "is_solid", skip_serializing_if = "is_true"))]
    #[cfg_attr(feature = "schema", schemars(extend("default" = true)))]
    pub solid: bool,
    /// Loss of a reflection off its faces (dB); that of the channel if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub reflection_loss_db: Option<f64>,
}

#[cfg(feature = "config")]
fn is_solid() -> bool {
    true
}

#[cfg(feature = "config")]
fn is_true(value: &bool) -> bool {
    *value
}

impl ObstacleConfig {
    /// A solid obstacle of a known material, without a name.
    #[must_use]
    pub fn of(shape: ShapeConfig, material: impl Into<String>) -> Self {
        Self { material: Some(material.into()), absorption_per_m: None, ..Self::absorbing(shape, 0.0) }
    }

    /// A solid obstacle with this absorption coefficient (1/m), without a name.
    #[must_use]
    pub fn absorbing(shape: ShapeConfig, absorption_per_m: f64) -> Self {
        Self {
            name: None,
            shape,
            material: None,
            absorption_per_m: Some(absorption_per_m),
            loss_db: None,
            solid: true,
            reflection_loss_db: None,
        }
    }

    /// The file that it names, if it names one, and its key.
    pub fn file_mut(&mut self) -> Option<(&'static str, &mut PathBuf)> {
        match &mut self.shape {
            ShapeConfig::Mesh(config) => Some(("shape.mesh.file", config.file.as_mut()?)),
            _ => None,
        }
    }
}

/// An obstacle: a solid that absorbs radio power and stops robots, or a volume that only absorbs.
#[derive(Clone, Debug)]
pub struct Obstacle {
    name: Option<String>,
    shape: Shape,
    material: Option<&'static Material>,
    absorption_per_m: f64,
    loss: Db,
    is_solid: bool,
    reflection_loss: Option<Db>,
    wall: Option<usize>,
}

impl TryFrom<ObstacleConfig> for Obstacle {
    type Error = SettingError;

    /// File paths are relative to the working folder.
    fn try_from(config: ObstacleConfig) -> Result<Self, SettingError> {
        Self::read(config, &Files::default())
    }
}

impl Obstacle {
    /// The obstacle that `config` describes; its file paths are among `files`.
    ///
    /// # Errors
    /// If a value is invalid, the shape has no volume, or a file cannot be read.
    pub fn read(config: ObstacleConfig, files: &Files) -> Result<Self, SettingError> {
        let material = match &config.material {
            Some(name) => Some(
                Material::named(name)
                    .ok_or_else(|| SettingError::new("material", format!("{name:?}"), Material::names()))?,
            ),
            None => None,
        };
        let absorption_per_m = match (material, config.absorption_per_m) {
            (Some(material), None) => material.absorption_per_m,
            (None, Some(alpha)) => SettingError::not_negative("absorption_per_m", alpha)?,
            (None, None) if config.loss_db.is_some() => 0.0,
            (None, None) => {
                let needed = format!("one of {}; or give `absorption_per_m` or `loss_db`", Material::names());
                return Err(SettingError::missing("material", needed));
            }
            (Some(_), Some(_)) => {
                return Err(SettingError::conflict("absorption_per_m", "`material`", "set one of them"));
            }
        };
        let loss_db = config.loss_db.unwrap_or(0.0);
        if loss_db.is_nan() || loss_db < 0.0 {
            return Err(SettingError::new("loss_db", loss_db, "0 or above; inf lets nothing through"));
        }
        let reflection_loss = reflection_loss(&config)?;
        let shape = Shape::read(config.shape, files).map_err(|error| error.within("shape"))?;
        Ok(Self {
            name: config.name,
            shape,
            material,
            absorption_per_m,
            loss: Db(loss_db),
            is_solid: config.solid,
            reflection_loss,
            wall: None,
        })
    }

    /// The obstacles that `config` describes: one, or one for each material of its mesh file if it has none of its own. Names
    /// of materials in files may have another case, underscores, the prefixes `mat-` and `itu-`, and a number after a dot.
    ///
    /// # Errors
    /// As [`read`](Self::read), and if a material of the file is unknown.
    pub fn read_all(config: ObstacleConfig, files: &Files) -> Result<Vec<Self>, SettingError> {
        let is_bare = config.material.is_none() && config.absorption_per_m.is_none() && config.loss_db.is_none();
        let file = match &config.shape {
            ShapeConfig::Mesh(MeshConfig { file: Some(file), vertices_m: None, triangles: None }) if is_bare => file,
            _ => return Ok(vec![Self::read(config, files)?]),
        };
        let parts = Shape::read_parts(file, files).map_err(|error| error.within("shape"))?;
        if parts.iter().all(|(name, _)| name.is_none()) {
            return Ok(vec![Self::read(config, files)?]);
        }
        let reflection_loss = reflection_loss(&config)?;
        let obstacle = |(name, shape): (Option<String>, Shape)| {
            let written = name.unwrap_or_default();
            let material = Material::of_file(&written).ok_or_else(|| {
                let found = format!("`{}` with the material `{written}`", file.display());
                SettingError::new("shape.mesh.file", found, format!("materials {}", Material::names()))
            })?;
            let of = |name: &String| format!("{name}, {}", material.name);
            Ok(Self {
                name: config.name.as_ref().map(of),
                shape,
                material: Some(material),
                absorption_per_m: material.absorption_per_m,
                loss: Db(0.0),
                is_solid: config.solid,
                reflection_loss,
                wall: None,
            })
        };
        parts.into_iter().map(obstacle).collect()
    }

    /// The same obstacle for links at a carrier: a material absorbs there what its model says, an absorption coefficient
    /// of its own stays.
    pub(crate) fn at_carrier(&self, carrier_ghz: Option<f64>) -> Self {
        let absorption_per_m =
            self.material.map_or(self.absorption_per_m, |material| material.absorption_at_per_m(carrier_ghz));
        Self { absorption_per_m, ..self.clone() }
    }

    /// Its material, if it has a known one.
    #[must_use]
    pub fn material(&self) -> Option<&'static Material> {
        self.material
    }

    /// Loss of a link for each passage through it, however thick it is, beside absorption.
    #[must_use]
    #[inline]
    pub fn loss(&self) -> Db {
        self.loss
    }

    /// Loss of so many passages through it, beside absorption.
    #[inline]
    pub(crate) fn loss_of(&self, passages: usize) -> Db {
        #[expect(clippy::cast_precision_loss, reason = "few passages")]
        let times = passages as f64;
        if passages == 0 { Db(0.0) } else { Db(times * self.loss.0) }
    }

    /// Whether it fills its space: nothing stands or drives in it, and range sensors see it.
    #[must_use]
    #[inline]
    pub fn is_solid(&self) -> bool {
        self.is_solid
    }

    /// Loss of a reflection off its faces, if it is set.
    #[must_use]
    pub(crate) fn reflection_loss(&self) -> Option<Db> {
        self.reflection_loss
    }

    /// The same obstacle as a piece of the wall with this number.
    pub(crate) fn of_wall(self, wall: usize) -> Self {
        Self { wall: Some(wall), ..self }
    }

    /// The number of the wall that it is a piece of, if it is one.
    #[must_use]
    pub(crate) fn wall(&self) -> Option<usize> {
        self.wall
    }

    /// Its name, if it has one.
    #[must_use]
    pub fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    /// Its shape.
    #[must_use]
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Absorption coefficient α (1/m), at 2.45 GHz unless the field of obstacles is for another carrier.
    #[must_use]
    pub fn absorption_per_m(&self) -> f64 {
        self.absorption_per_m
    }

    /// Its surface for drawing: vertices (m), and triangles whose corners run counterclockwise seen from outside.
    #[must_use]
    pub fn mesh(&self) -> (Vec<Position>, Vec<[u32; 3]>) {
        self.shape.mesh()
    }
}

/// The loss of a reflection off the faces, checked.
fn reflection_loss(config: &ObstacleConfig) -> Result<Option<Db>, SettingError> {
    let checked = |loss_db| SettingError::not_negative("reflection_loss_db", loss_db).map(Db);
    config.reflection_loss_db.map(checked).transpose()
}
