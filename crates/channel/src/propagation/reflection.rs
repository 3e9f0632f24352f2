//! Reflections and edges as a setting, and the rays of a link.

use sextant_kernel::SettingError;

use crate::geometry::position::Position;
use crate::power::Db;
use crate::propagation::material::MaterialName;
use crate::propagation::path_loss::LIGHT_M_PER_S;

/// Reflections as written in a scenario: off the flat faces of boxes, prisms, convex hulls and meshes that are solid.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ReflectionsConfig {
    /// Loss of a reflection (dB), off obstacles without `reflection_loss_db`. If absent, the angle, the polarisation and the
    /// material of the obstacle decide (Fresnel, ITU-R P.2040-3); obstacles without a material of known permittivity do
    /// not reflect then.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub loss_db: Option<f64>,
    /// Height of a ground that reflects too (m); none if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub ground_z_m: Option<f64>,
    /// Material of the ground; needed for a ground without `loss_db`.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(feature = "schema", schemars(transform = crate::propagation::material::listed))]
    pub ground_material: Option<MaterialName>,
    /// Most reflections of a link that count, the strongest ones.
    #[cfg_attr(feature = "config", serde(default = "most"))]
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 255)))]
    pub most: u8,
    /// Most reflections of one ray: 0, 1 or 2.
    #[cfg_attr(feature = "config", serde(default = "order", skip_serializing_if = "is_one"))]
    #[cfg_attr(feature = "schema", schemars(extend("default" = 1)))]
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 2)))]
    pub order: u8,
    /// Whether signals bend round the vertical edges of solid obstacles that block the straight line.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "is_false"))]
    #[cfg_attr(feature = "schema", schemars(extend("default" = false)))]
    pub edges: bool,
    /// Direction of the electric field at all antennas.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "is_vertical"))]
    #[cfg_attr(feature = "schema", schemars(extend("default" = "vertical")))]
    pub polarisation: Polarisation,
}

impl Default for ReflectionsConfig {
    /// One reflection a ray, by the material; at most four.
    fn default() -> Self {
        let (most, order) = (most(), order());
        let (loss_db, ground_z_m, ground_material) = (None, None, None);
        let polarisation = Polarisation::Vertical;
        Self { loss_db, ground_z_m, ground_material, most, order, edges: false, polarisation }
    }
}

fn most() -> u8 {
    4
}

fn order() -> u8 {
    1
}

#[cfg(feature = "config")]
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_one(order: &u8) -> bool {
    *order == 1
}

#[cfg(feature = "config")]
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_false(value: &bool) -> bool {
    !*value
}

#[cfg(feature = "config")]
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_vertical(polarisation: &Polarisation) -> bool {
    *polarisation == Polarisation::Vertical
}

/// Direction of the electric field of a wave.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Polarisation {
    /// In the vertical plane of the ray.
    #[default]
    Vertical,
    /// Horizontal.
    Horizontal,
}

/// How links are reflected, checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ReflectionLaw {
    pub(crate) loss: Option<Db>,
    pub(crate) ground_z_m: Option<f64>,
    pub(crate) ground_material: Option<MaterialName>,
    most: u8,
    pub(crate) order: u8,
    pub(crate) edges: bool,
    pub(crate) polarisation: Polarisation,
}

impl TryFrom<ReflectionsConfig> for ReflectionLaw {
    type Error = SettingError;

    fn try_from(config: ReflectionsConfig) -> Result<Self, SettingError> {
        let ReflectionsConfig { ground_material, order, edges, polarisation, .. } = config;
        let ground_z_m = match config.ground_z_m {
            Some(z_m) => Some(SettingError::finite("ground_z_m", z_m)?),
            None => None,
        };
        if config.most == 0 {
            return Err(SettingError::new("most", 0, "1 to 255"));
        }
        if order > 2 {
            return Err(SettingError::new("order", order, "0, 1 or 2"));
        }
        let loss = match config.loss_db {
            Some(loss_db) => Some(Db(SettingError::not_negative("loss_db", loss_db)?)),
            None => None,
        };
        if ground_z_m.is_some() && loss.is_none() && ground_material.is_none() {
            let needed = "the name of a material, for the ground at `ground_z_m`; or `loss_db`";
            return Err(SettingError::missing("ground_material", needed));
        }
        Ok(Self { loss, ground_z_m, ground_material, most: config.most, order, edges, polarisation })
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
    /// Length (m).
    pub length_m: f64,
    /// Phase of the field at the receiver, relative to that at the transmitter, at the carrier of the signals (rad), -π to
    /// π. At 2.45 GHz if that is unknown. A reflection with a loss that is set turns it by π.
    pub phase_rad: f64,
    /// Number of reflections.
    pub bounces: u8,
    /// Whether it bends round an edge.
    pub is_diffracted: bool,
    /// The first and the last place where it turns (m); the two ends of a straight way.
    pub turns: [Position; 2],
}

impl Ray {
    /// The same way in the other direction.
    #[must_use]
    pub fn reversed(self) -> Self {
        let [first, last] = self.turns;
        Self { departure: self.arrival, arrival: self.departure, turns: [last, first], ..self }
    }

    /// The straight pieces of the way from one end to the other, each with its two ends (m).
    pub fn legs(&self, from: Position, to: Position) -> impl Iterator<Item = [Position; 2]> {
        let [first, last] = self.turns;
        [[from, first], [first, last], [last, to]].into_iter().filter(|[a, b]| a.distance_m(*b) > 0.0)
    }

    /// How long a signal takes on it (s).
    #[must_use]
    pub fn delay_s(&self) -> f64 {
        self.length_m / LIGHT_M_PER_S
    }

    /// Power of the sum of the fields of several rays, as a gain: what a narrow band receives.
    #[must_use]
    pub fn field_sum(rays: &[Self]) -> Db {
        let (mut re, mut im) = (0.0, 0.0);
        for ray in rays {
            let field = (Db(-0.5 * ray.loss.0)).to_factor();
            let (sin, cos) = libm::sincos(ray.phase_rad);
            re += field * cos;
            im += field * sin;
        }
        Db::from_factor(re * re + im * im)
    }
}

/// The azimuth, counterclockwise from x, and the elevation above the horizontal of a direction of the world (rad).
#[must_use]
pub fn angles_rad(direction: Position) -> [f64; 2] {
    let across_m = libm::hypot(direction.x_m, direction.y_m);
    [libm::atan2(direction.y_m, direction.x_m), libm::atan2(direction.z_m, across_m)]
}
