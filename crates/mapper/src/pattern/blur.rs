//! How rough a likelihood is for cells that a stop sees under an angle.

/// Cells along an axis of the octahedral map of directions: 1.4 degrees along the horizon.
pub(super) const CELLS: usize = 128;
/// The angle of a cell along the horizon (rad).
pub(super) const CELL_RAD: f64 = std::f64::consts::PI / CELLS as f64;
/// Cells of the horizon for each of the octahedral map: 0.18 degrees.
pub(super) const FINER: usize = 8;
/// Cells of the horizon.
pub(super) const ROUND: usize = 2 * CELLS * FINER;
/// By how much gains change over an angle (dB per rad): a decibel in a degree and a half.
const SLOPE_DB: f64 = 40.0;
/// Over how many cells of the map of directions likelihoods are averaged on each side, from the roughest to the finest.
const RADII: [usize; Blur::COUNT] = [8, 4, 2, 1, 0];

/// A step from the roughest likelihood to the finest, which is not blurred.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Blur {
    level: usize,
}

impl Blur {
    /// Number of steps.
    pub(super) const COUNT: usize = 5;
    /// The finest.
    pub(super) const NONE: Self = Self { level: Self::COUNT - 1 };

    /// That for cells that a stop sees under this angle on each side of their middle (rad).
    pub(super) fn of_angle(angle: f64) -> Self {
        let cells = angle / CELL_RAD;
        RADII.iter().position(|&radius| radius as f64 <= cells + 0.5).map_or(Self::NONE, |level| Self { level })
    }

    /// Its place among the steps, from the roughest.
    pub(super) fn level(self) -> usize {
        self.level
    }

    /// Over so many cells of the map of directions it averages on each side.
    pub(super) fn radius(self) -> usize {
        RADII[self.level]
    }

    /// Error that strengths have more (dB).
    pub(super) fn extra_db(self) -> f64 {
        SLOPE_DB * CELL_RAD * self.radius() as f64
    }
}
