//! What a survey keeps to: its settings and its area.

use sextant_channel::Position;

use super::settings::Settings;
use crate::area::Area;

/// Share of the lane spacing within which a stop covers a place.
const COVERED: f64 = 0.75;
/// The same on a closer look.
const CLOSELY_COVERED: f64 = 0.375;

/// What a survey keeps to; nothing here changes on the way.
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

    /// The length of the next step of `left_m` (m): no step is a sliver.
    pub(super) fn stride_m(&self, left_m: f64) -> f64 {
        if left_m < 1.5 * self.settings.step_m { left_m } else { self.settings.step_m }
    }

    /// How far from a stop the lane behind an obstacle counts as covered (m).
    pub(super) fn covered_lane_m(&self) -> f64 {
        COVERED * self.settings.lane_spacing_m
    }

    /// How far from a stop a place counts as covered, first at a glance, then on a closer look (m): shares of the
    /// distance between lanes, or between layers if that is more.
    pub(super) fn covered_m(&self) -> [f64; 2] {
        let lane_m = self.settings.lane_spacing_m;
        let spacing_m = self.settings.layers.map_or(lane_m, |layers| layers.spacing_m.max(lane_m));
        [COVERED, CLOSELY_COVERED].map(|share| share * spacing_m)
    }
}
