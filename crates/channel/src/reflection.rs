//! Reflections as a setting, and the rays of a link.

#[cfg(feature = "config")]
use schemars::JsonSchema;
#[cfg(feature = "config")]
use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;

use crate::{Db, Position};

/// Reflections as written in a scenario: off the flat faces of boxes, prisms and convex hulls that are solid.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "config", serde(deny_unknown_fields))]
pub struct ReflectionsConfig {
    /// Loss of a reflection (dB), off obstacles without `reflection_loss_db`.
    pub loss_db: f64,
    /// Height of a ground that reflects too (m); none if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub ground_z_m: Option<f64>,
    /// Most reflections of a link that count, the strongest ones.
    #[cfg_attr(feature = "config", serde(default = "most"))]
    pub most: u8,
}

#[cfg(feature = "config")]
fn most() -> u8 {
    4
}

/// How links are reflected, checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ReflectionLaw {
    pub(crate) loss: Db,
    pub(crate) ground_z_m: Option<f64>,
    most: u8,
}

impl TryFrom<ReflectionsConfig> for ReflectionLaw {
    type Error = SettingError;

    fn try_from(config: ReflectionsConfig) -> Result<Self, SettingError> {
        let ground_z_m = match config.ground_z_m {
            Some(z_m) => Some(SettingError::finite("ground_z_m", z_m)?),
            None => None,
        };
        if config.most == 0 {
            return Err(SettingError::new("most", 0, "1 to 255"));
        }
        let loss = Db(SettingError::not_negative("loss_db", config.loss_db)?);
        Ok(Self { loss, ground_z_m, most: config.most })
    }
}

impl ReflectionLaw {
    /// A bound of the gain by reflections: none is stronger than a direct ray in free space.
    pub(crate) fn greatest_gain(&self) -> Db {
        Db::from_factor(1.0 + f64::from(self.most))
    }

    #[cfg(feature = "obstacles")]
    pub(crate) fn most(&self) -> usize {
        self.most.into()
    }
}

/// One way of a signal between two places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Loss along it, without the gains of the antennas.
    pub loss: Db,
    /// Unit vector from the transmitter along the ray.
    pub departure: Position,
    /// Unit vector from the receiver along the ray, to where the signal comes from.
    pub arrival: Position,
}

impl Ray {
    /// The same way in the other direction.
    #[must_use]
    pub fn reversed(self) -> Self {
        Self { departure: self.arrival, arrival: self.departure, ..self }
    }
}
