//! How places are seen from a stop: its place, the turns of robot and antenna, and the direction.

use sextant_channel::{Position, Stop};

use super::gain_map::{Directions, GainCell};

/// Nodes are at least so far from a stop (m): the law has no meaning on the antenna itself.
pub(super) const NEAREST_M: f64 = 0.1;

/// How far an antenna is turned.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    cos: f64,
    sin: f64,
}

impl Turn {
    /// Counterclockwise by an angle (rad).
    pub(super) fn by(yaw_rad: f64) -> Self {
        Self { cos: libm::cos(yaw_rad), sin: libm::sin(yaw_rad) }
    }

    /// This turn after another one.
    fn after(self, first: Self) -> Self {
        Self { cos: self.cos * first.cos - self.sin * first.sin, sin: self.sin * first.cos + self.cos * first.sin }
    }
}

/// Where a robot listened, and how it was turned there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    pub(super) place: Position,
    turn: Turn,
}

impl Pose {
    /// A direction of the world as an antenna sees it that is turned on the robot by `mount`.
    #[inline]
    pub(super) fn seen(&self, direction: Position, mount: Turn) -> [f64; 3] {
        let Turn { cos, sin } = mount.after(self.turn);
        let Position { x_m, y_m, z_m } = direction;
        [cos * x_m + sin * y_m, cos * y_m - sin * x_m, z_m]
    }

    /// That at a stop. Without a heading the robot is not turned.
    pub(super) fn of(stop: &Stop) -> Self {
        Self { place: stop.position, turn: stop.heading_rad.map_or(Turn { cos: 1.0, sin: 0.0 }, Turn::by) }
    }
}

/// How a place is seen from a stop.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight {
    pub(super) cell: GainCell,
    /// Square of the distance (m²).
    pub(super) square: f64,
}

impl Sight {
    /// How `place` is seen by a robot whose antenna is turned on it by `mount`.
    #[inline]
    pub(super) fn of(place: Position, robot: &Pose, mount: Turn, directions: Directions) -> Self {
        let apart = place - robot.place;
        let square = apart.dot(apart);
        let direction = if square > 1e-18 { robot.seen(apart, mount) } else { [1.0, 0.0, 0.0] };
        Self { cell: directions.cell(direction), square: square.max(NEAREST_M * NEAREST_M) }
    }
}
