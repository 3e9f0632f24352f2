//! Axis-aligned boxes.

use crate::geometry::position::Position;

/// A box whose edges are parallel to the axes of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Corner with the smallest coordinates (m).
    pub min: Position,
    /// Corner with the largest coordinates (m).
    pub max: Position,
}

impl Bounds {
    /// The smallest box around `points`; `None` if there are no points.
    #[must_use]
    pub fn of(points: impl IntoIterator<Item = Position>) -> Option<Self> {
        points.into_iter().map(|p| Self { min: p, max: p }).reduce(Self::union)
    }

    /// The smallest box around this one and `other`.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        let (a, b) = (self.min, other.min);
        let min = Position::new(a.x_m.min(b.x_m), a.y_m.min(b.y_m), a.z_m.min(b.z_m));
        let (a, b) = (self.max, other.max);
        Self { min, max: Position::new(a.x_m.max(b.x_m), a.y_m.max(b.y_m), a.z_m.max(b.z_m)) }
    }

    /// This box, larger by `margin_m` on each side.
    #[must_use]
    #[inline]
    pub fn grown(self, margin_m: f64) -> Self {
        let margin = Position::new(margin_m, margin_m, margin_m);
        Self { min: self.min - margin, max: self.max + margin }
    }

    /// Middle of the box (m).
    #[must_use]
    pub fn center(self) -> Position {
        (self.min + self.max) * 0.5
    }

    /// Whether `p` is inside or on the border.
    #[must_use]
    pub fn contains(self, p: Position) -> bool {
        p.x_m >= self.min.x_m
            && p.x_m <= self.max.x_m
            && p.y_m >= self.min.y_m
            && p.y_m <= self.max.y_m
            && p.z_m >= self.min.z_m
            && p.z_m <= self.max.z_m
    }

    /// Whether the two boxes have a place in common.
    #[must_use]
    pub fn meets(self, other: Self) -> bool {
        let gap = |low: Position, high: Position| {
            let gap = low - high;
            gap.x_m.max(gap.y_m).max(gap.z_m)
        };
        gap(self.min, other.max) <= 0.0 && gap(other.min, self.max) <= 0.0
    }

    /// Distance from `p` to the box (m), 0 inside.
    #[must_use]
    pub fn distance_m(self, p: Position) -> f64 {
        let (below, above) = (self.min - p, p - self.max);
        Position::new(
            below.x_m.max(above.x_m).max(0.0),
            below.y_m.max(above.y_m).max(0.0),
            below.z_m.max(above.z_m).max(0.0),
        )
        .length_m()
    }
}
