//! The rules of a survey: its settings and its area.

use sextant_channel::Position;

use super::settings::Settings;
use crate::area::Area;

/// A stop covers the places within this share of the lane spacing.
const COVERED: f64 = 0.75;
/// The same for the second, closer check.
const CLOSELY_COVERED: f64 = 0.375;

/// The rules of a survey. They do not change during the survey.
#[derive(Clone, Debug)]
pub(super) struct Rules {
    pub(super) settings: Settings,
    pub(super) area: Option<Area>,
}

impl Rules {
    /// Whether the robot may stop at `place`.
    pub(super) fn allow(&self, place: Position) -> bool {
        self.settings.layers.is_none_or(|layers| layers.holds(place.z_m))
            && self.area.as_ref().is_none_or(|area| area.contains(place))
    }

    /// The length of the next step if `left_m` are left (m). There are no very short steps.
    pub(super) fn stride_m(&self, left_m: f64) -> f64 {
        if left_m < 1.5 * self.settings.step_m { left_m } else { self.settings.step_m }
    }

    /// A lane behind an obstacle counts as covered within this distance of a stop (m).
    pub(super) fn covered_lane_m(&self) -> f64 {
        COVERED * self.settings.lane_spacing_m
    }

    /// A place counts as covered within these distances of a stop (m): first for a quick check, then for a closer
    /// one. They are shares of the distance between lanes, or between layers if that is larger.
    pub(super) fn covered_m(&self) -> [f64; 2] {
        let lane_m = self.settings.lane_spacing_m;
        let spacing_m = self.settings.layers.map_or(lane_m, |layers| layers.spacing_m.max(lane_m));
        [COVERED, CLOSELY_COVERED].map(|share| share * spacing_m)
    }
}
