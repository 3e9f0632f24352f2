//! A lane of the automated S path.

use sextant_channel::Position;

/// Number of hearing stops that a lane needs before a silent stop may end it early. Without this, one lost packet at
/// the start of a lane would end it.
pub(super) const HEARING_STOPS: u32 = 3;

/// The lane that is being driven.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lane {
    /// 1 north, -1 south.
    pub(super) heading: f64,
    pub(super) start_y_m: f64,
    pub(super) first_stop: usize,
    pub(super) hearing_stops: u32,
    pub(super) silent_run: u32,
    /// Lowest and highest y of its stops that heard a node (m).
    audible_m: Option<(f64, f64)>,
    /// The same for the lane before.
    audible_before_m: Option<(f64, f64)>,
}

/// Where an obstacle cut a lane short (`obstacleRegistry` of the thesis).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cut {
    pub(super) heading: f64,
    pub(super) place: Position,
}

impl Lane {
    /// The first lane, northward.
    pub(super) const FIRST: Self = Self {
        heading: 1.0,
        start_y_m: 0.0,
        first_stop: 0,
        hearing_stops: 0,
        silent_run: 0,
        audible_m: None,
        audible_before_m: None,
    };

    /// A first lane southward.
    pub(super) const SOUTHWARD: Self = Self { heading: -1.0, ..Self::FIRST };

    /// The next lane, which begins `here`, at the stop with the number `stop`.
    pub(super) fn next(self, here: Position, stop: usize) -> Self {
        let is_known = self.hearing_stops >= HEARING_STOPS;
        let audible_before_m = if is_known { self.audible_m } else { self.audible_before_m };
        let heading = self.heading;
        Self { heading, start_y_m: here.y_m, first_stop: stop, audible_before_m, ..Self::FIRST }
    }

    /// Counts a stop that heard a node.
    pub(super) fn count_hearing(&mut self, here: Position) {
        let (south, north) = self.audible_m.unwrap_or((here.y_m, here.y_m));
        self.audible_m = Some((south.min(here.y_m), north.max(here.y_m)));
        self.hearing_stops += 1;
        self.silent_run = 0;
    }

    /// Counts a silent stop.
    pub(super) fn count_silent(&mut self) {
        self.silent_run += 1;
    }

    /// How far beyond `y_m`, in the direction `heading`, this lane or the one before heard a node (m).
    pub(super) fn left_of_network_m(&self, y_m: f64, heading: f64) -> f64 {
        let beyond_m = |(south, north): (f64, f64)| if heading > 0.0 { north - y_m } else { y_m - south };
        let audible = [self.audible_m, self.audible_before_m];
        audible.into_iter().flatten().map(beyond_m).reduce(f64::max).unwrap_or(0.0)
    }
}
