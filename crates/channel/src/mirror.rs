//! First-order reflections off flat faces, by the image method.

use crate::reflection::ReflectionLaw;
use crate::shape::Plane;
use crate::{Db, ObstacleField, Position};

impl ReflectionLaw {
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

/// The unit vector from `from` to `to`; zero if they are the same place.
pub(crate) fn direction(from: Position, to: Position) -> Position {
    let way = to - from;
    let length_m = way.length_m();
    if length_m > 0.0 { way * (1.0 / length_m) } else { way }
}
