//! First-order reflections off flat faces, by the image method.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;

use crate::shape::Plane;
use crate::{Db, ObstacleField, Position};

/// Reflections as written in a scenario: off the flat faces of boxes, prisms and convex hulls that are solid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReflectionsConfig {
    /// Loss of a reflection (dB), off obstacles that have no `reflection_loss_db` of their own.
    pub loss_db: f64,
    /// Height of a ground that reflects too (m); none if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ground_z_m: Option<f64>,
    /// Most reflections of a link that count, the strongest ones.
    #[serde(default = "most")]
    pub most: u8,
}

fn most() -> u8 {
    4
}

/// How links are reflected, checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ReflectionLaw {
    loss: Db,
    ground_z_m: Option<f64>,
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

    pub(crate) fn most(&self) -> usize {
        self.most.into()
    }

    /// The faces that reflect among `obstacles`.
    pub(crate) fn mirrors(&self, obstacles: &ObstacleField) -> Vec<Mirror> {
        let mut mirrors = Vec::new();
        if let Some(z_m) = self.ground_z_m {
            let plane = Plane { normal: Position::new(0.0, 0.0, 1.0), offset_m: z_m };
            mirrors.push(Mirror { plane, sides: Vec::new(), loss: self.loss });
        }
        for obstacle in obstacles.obstacles().iter().filter(|obstacle| obstacle.is_solid()) {
            let planes = obstacle.shape().planes();
            for (i, &plane) in planes.iter().enumerate() {
                let others = planes.iter().enumerate().filter(|&(j, _)| j != i);
                let sides = others.map(|(_, &plane)| plane).collect();
                mirrors.push(Mirror { plane, sides, loss: obstacle.reflection_loss().unwrap_or(self.loss) });
            }
        }
        mirrors
    }
}

/// A flat face that reflects on its outside.
#[derive(Clone, Debug)]
pub(crate) struct Mirror {
    plane: Plane,
    /// The face is what is behind these planes.
    sides: Vec<Plane>,
    pub(crate) loss: Db,
}

impl Mirror {
    /// Where the way from `a` to `b` meets the face, if there is one: on the straight line from the mirror image of `a`
    /// to `b`.
    pub(crate) fn bounce(&self, a: Position, b: Position) -> Option<Position> {
        let (above_a, above_b) = (self.plane.height_m(a), self.plane.height_m(b));
        if above_a <= 0.0 || above_b <= 0.0 {
            return None;
        }
        let (foot_a, foot_b) = (a - self.plane.normal * above_a, b - self.plane.normal * above_b);
        let share = above_a / (above_a + above_b);
        let place = foot_a + (foot_b - foot_a) * share;
        self.sides.iter().all(|side| side.height_m(place) <= 0.0).then_some(place)
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

/// The unit vector from `from` to `to`; zero if they are the same place.
pub(crate) fn direction(from: Position, to: Position) -> Position {
    let way = to - from;
    let length_m = way.length_m();
    if length_m > 0.0 { way * (1.0 / length_m) } else { way }
}
