//! One obstacle: a shape made of a material.
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;

use crate::{Material, Position, Shape, ShapeConfig};

/// An obstacle as written in a scenario. Exactly one of `material` and `absorption_per_m` is given.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObstacleConfig {
    /// Name in messages and pictures.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Its shape.
    pub shape: ShapeConfig,
    /// Name of a known material.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// Absorption coefficient α of the Lambert-Bouguer law (1/m): 10 α log10(e) = 4.343 α dB per metre.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub absorption_per_m: Option<f64>,
}

impl ObstacleConfig {
    /// The file that it names, if it names one, and its key.
    pub fn file_mut(&mut self) -> Option<(&'static str, &mut PathBuf)> {
        match &mut self.shape {
            ShapeConfig::Mesh(config) => Some(("shape.mesh.file", config.file.as_mut()?)),
            _ => None,
        }
    }
}

/// An obstacle: a solid that absorbs radio power and stops robots.
#[derive(Clone, Debug)]
pub struct Obstacle {
    name: Option<String>,
    shape: Shape,
    absorption_per_m: f64,
}

impl TryFrom<ObstacleConfig> for Obstacle {
    type Error = SettingError;

    /// File paths are relative to the working folder.
    fn try_from(config: ObstacleConfig) -> Result<Self, SettingError> {
        Self::read(config, Path::new(""))
    }
}

impl Obstacle {
    /// The obstacle that `config` describes; its file paths are relative to `folder`.
    ///
    /// # Errors
    /// If a value is invalid, the shape has no volume, or a file cannot be read.
    pub fn read(config: ObstacleConfig, folder: &Path) -> Result<Self, SettingError> {
        let absorption_per_m = match (config.material, config.absorption_per_m) {
            (Some(name), None) => {
                Material::named(&name)
                    .ok_or_else(|| SettingError::new("material", format!("{name:?}"), Material::names()))?
                    .absorption_per_m
            }
            (None, Some(alpha)) => SettingError::not_negative("absorption_per_m", alpha)?,
            (None, None) => {
                let allowed = format!("one of {}; or give `absorption_per_m`", Material::names());
                return Err(SettingError::new("material", "absent", allowed));
            }
            (Some(name), Some(alpha)) => {
                let found = format!("{alpha} beside material {name:?}");
                return Err(SettingError::new("absorption_per_m", found, "either `material` or `absorption_per_m`"));
            }
        };
        let shape = Shape::read(config.shape, folder).map_err(|error| error.within("shape"))?;
        Ok(Self { name: config.name, shape, absorption_per_m })
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

    /// Absorption coefficient α (1/m).
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
