//! How places in one frame of coordinates become places in another one.

use nalgebra::{Matrix3, Vector3};
use sextant_channel::Position;

/// Whether two frames are mirror images of each other, seen from above.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Handedness {
    /// They are not.
    #[default]
    Same,
    /// They are.
    Mirrored,
}

/// A change of frame, seen from above: a place is mirrored at the x axis or not, turned about the origin, scaled, and
/// shifted. Heights are scaled and shifted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameChange {
    /// Whether it mirrors.
    pub handedness: Handedness,
    /// Angle by which it turns, counterclockwise (rad).
    pub turn_rad: f64,
    /// Factor of lengths, above zero.
    pub scale: f64,
    /// Where the origin comes to lie (m).
    pub offset: Position,
}

/// Two places of one node in two frames, and how much they count together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WeightedPair {
    pub(super) from: Position,
    pub(super) onto: Position,
    pub(super) weight: f64,
}

/// What a fit may change besides turn and offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lengths {
    /// Nothing: lengths are those of the other frame.
    Kept,
    /// The scale.
    Scaled,
}

impl Lengths {
    /// Number of unknowns of a frame: its shift, its turn, and its scale if it has one.
    pub(super) fn unknowns(self) -> usize {
        match self {
            Self::Kept => 4,
            Self::Scaled => 5,
        }
    }

    /// Where the unknowns of the frame of `robot` begin among those of all; `None` for the first robot, whose frame is known.
    pub(super) fn first_of(self, robot: usize) -> Option<usize> {
        robot.checked_sub(1).map(|robot| robot * self.unknowns())
    }
}

impl FrameChange {
    /// The one that changes nothing.
    pub const NONE: Self = Self { handedness: Handedness::Same, turn_rad: 0.0, scale: 1.0, offset: Position::ORIGIN };

    /// The image of `place`.
    #[must_use]
    pub fn apply(&self, place: Position) -> Position {
        self.turned(place) + self.offset
    }

    /// The image of a displacement.
    fn turned(&self, step: Position) -> Position {
        let y_m = match self.handedness {
            Handedness::Same => step.y_m,
            Handedness::Mirrored => -step.y_m,
        };
        let (sin, cos) = (libm::sin(self.turn_rad), libm::cos(self.turn_rad));
        Position::new(cos * step.x_m - sin * y_m, sin * step.x_m + cos * y_m, step.z_m) * self.scale
    }

    /// How it changes displacements, as a matrix.
    pub(super) fn linear(&self) -> Matrix3<f64> {
        let axes = [Position::new(1.0, 0.0, 0.0), Position::new(0.0, 1.0, 0.0), Position::new(0.0, 0.0, 1.0)];
        Matrix3::from_columns(&axes.map(|axis| vector(self.turned(axis))))
    }

    /// How an image `at` changes with the shift along x, y and z, the turn, and the logarithm of the scale if that is unknown.
    pub(super) fn slopes(&self, at: Vector3<f64>, lengths: Lengths) -> Vec<Vector3<f64>> {
        let arm = at - vector(self.offset);
        let mut slopes = vec![Vector3::x(), Vector3::y(), Vector3::z(), Vector3::new(-arm.y, arm.x, 0.0)];
        if lengths == Lengths::Scaled {
            slopes.push(arm);
        }
        slopes
    }

    /// The change that does `first` and then this one.
    #[must_use]
    pub fn after(&self, first: &Self) -> Self {
        let (handedness, own_rad) = match self.handedness {
            Handedness::Same => (first.handedness, first.turn_rad),
            Handedness::Mirrored => (first.handedness.other(), -first.turn_rad),
        };
        Self {
            handedness,
            turn_rad: wrapped(self.turn_rad + own_rad),
            scale: self.scale * first.scale,
            offset: self.apply(first.offset),
        }
    }

    /// The change back.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let turn_rad = match self.handedness {
            Handedness::Same => -self.turn_rad,
            Handedness::Mirrored => self.turn_rad,
        };
        let back = Self { turn_rad, scale: 1.0 / self.scale, offset: Position::ORIGIN, ..*self };
        Self { offset: back.turned(self.offset) * -1.0, ..back }
    }

    /// The change that brings `pairs` together with the least weighted sum of squares (Horn 1987 in the plane); `None` if
    /// nothing tells the turn.
    pub(super) fn fit(pairs: &[WeightedPair], handedness: Handedness, lengths: Lengths) -> Option<Self> {
        let total: f64 = pairs.iter().map(|pair| pair.weight).sum();
        let mirror = Self { handedness, ..Self::NONE };
        let mean = |place: fn(&WeightedPair) -> Position| {
            pairs.iter().fold(Position::ORIGIN, |sum, pair| sum + place(pair) * (pair.weight / total))
        };
        let (from_mean, onto_mean) = (mirror.turned(mean(|pair| pair.from)), mean(|pair| pair.onto));
        let (mut along, mut across, mut spread) = (0.0, 0.0, 0.0);
        for pair in pairs {
            let (a, b) = (mirror.turned(pair.from) - from_mean, pair.onto - onto_mean);
            along += pair.weight * (a.x_m * b.x_m + a.y_m * b.y_m);
            across += pair.weight * (a.x_m * b.y_m - a.y_m * b.x_m);
            spread += pair.weight * (a.x_m * a.x_m + a.y_m * a.y_m);
        }
        let strength = libm::hypot(along, across);
        let scale = match lengths {
            Lengths::Kept => 1.0,
            Lengths::Scaled => strength / spread,
        };
        if !(strength > 0.0 && scale > 0.0 && scale.is_finite()) {
            return None;
        }
        let change = Self { handedness, turn_rad: libm::atan2(across, along), scale, offset: Position::ORIGIN };
        // The mean is mirrored already.
        let offset = onto_mean - Self { handedness: Handedness::Same, ..change }.turned(from_mean);
        Some(Self { offset, ..change })
    }
}

impl Handedness {
    /// The other one.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Same => Self::Mirrored,
            Self::Mirrored => Self::Same,
        }
    }
}

/// A place as a vector (m).
pub(super) fn vector(place: Position) -> Vector3<f64> {
    Vector3::new(place.x_m, place.y_m, place.z_m)
}

/// The same angle from −π to π.
fn wrapped(angle_rad: f64) -> f64 {
    libm::remainder(angle_rad, std::f64::consts::TAU)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MIRRORED: FrameChange = FrameChange {
        handedness: Handedness::Mirrored,
        turn_rad: 2.0,
        scale: 1.5,
        offset: Position::new(3.0, -4.0, 0.5),
    };
    const TURNED: FrameChange = FrameChange {
        handedness: Handedness::Same,
        turn_rad: -2.5,
        scale: 0.5,
        offset: Position::new(-1.0, 7.0, 0.0),
    };

    #[test]
    fn changes_follow_each_other_and_are_undone() {
        let place = Position::new(0.3, 5.0, 2.0);
        for (first, second) in [(MIRRORED, TURNED), (TURNED, MIRRORED), (MIRRORED, MIRRORED)] {
            let both = second.after(&first).apply(place);
            assert!(both.distance_m(second.apply(first.apply(place))) < 1e-12);
            let back = first.inverse().apply(first.apply(place));
            assert!(back.distance_m(place) < 1e-12, "{back}");
        }
    }

    #[test]
    fn a_fit_finds_the_change() {
        let places = [[0.0, 0.0, 0.0], [4.0, 1.0, 0.2], [2.0, 6.0, 0.0], [-3.0, 2.0, 0.1]].map(Position::from);
        for change in [MIRRORED, TURNED] {
            let pairs = places.map(|from| WeightedPair { from, onto: change.apply(from), weight: 2.0 });
            let found = FrameChange::fit(&pairs, change.handedness, Lengths::Scaled).expect("places that differ");
            assert!((found.scale - change.scale).abs() < 1e-12 && (found.turn_rad - change.turn_rad).abs() < 1e-12);
            assert!(found.offset.distance_m(change.offset) < 1e-12);
        }
        let same = [WeightedPair { from: places[0], onto: places[1], weight: 1.0 }; 3];
        assert_eq!(FrameChange::fit(&same, Handedness::Same, Lengths::Kept), None);
    }
}
