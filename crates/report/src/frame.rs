//! Where and when the numbers of a report begin.

use serde::Serialize;
use sextant_channel::Position;
use sextant_kernel::SimTime;

use super::column::Column;

/// Places farther from zero than this (m) are written from a corner of their own, because floats of four octets would
/// round them to millimetres and more.
const NEAR_M: f64 = 10_000.0;

/// The zero of places and times in a report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Frame {
    /// What is to be added to each place (m).
    pub origin_m: [f64; 3],
    /// What is to be added to each time (s).
    pub start_s: f64,
}

impl Frame {
    /// A frame for `places` and `times`: zero, unless they are far from it.
    pub(super) fn around(places: impl Iterator<Item = Position>, times: impl Iterator<Item = SimTime>) -> Self {
        let mut low = [f64::INFINITY; 3];
        let mut farthest: f64 = 0.0;
        for place in places.filter(|place| place.is_finite()) {
            for (low, at) in low.iter_mut().zip(<[f64; 3]>::from(place)) {
                *low = low.min(at);
                farthest = farthest.max(at.abs());
            }
        }
        let origin_m = if farthest > NEAR_M { low.map(f64::floor) } else { [0.0; 3] };
        let first_s = times.map(SimTime::as_secs_f64).fold(f64::INFINITY, f64::min);
        let start_s = if first_s.is_finite() && first_s > NEAR_M { first_s.floor() } else { 0.0 };
        Self { origin_m, start_s }
    }

    /// Seconds in this frame.
    pub(super) fn seconds(&self, time: SimTime) -> f64 {
        time.as_secs_f64() - self.start_s
    }

    /// Instants in this frame (s).
    pub(super) fn times(&self, times: impl IntoIterator<Item = SimTime>) -> Column {
        Column::reals(times.into_iter().map(|time| self.seconds(time)))
    }

    /// Coordinates in this frame (m): x, y, z of the first place, of the second, and so on.
    pub(super) fn places(&self, places: impl IntoIterator<Item = Position>) -> Column {
        Column::reals(places.into_iter().flat_map(|place| self.place(place)))
    }

    /// The same where some places are not known: NaN.
    pub(super) fn known_places(&self, places: impl IntoIterator<Item = Option<Position>>) -> Column {
        let place = |place: Option<Position>| place.map_or([f64::NAN; 3], |place| self.place(place));
        Column::reals(places.into_iter().flat_map(place))
    }

    /// A place in this frame (m).
    pub(super) fn place(&self, place: Position) -> [f64; 3] {
        let [x, y, z] = self.origin_m;
        [place.x_m - x, place.y_m - y, place.z_m - z]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn far_places_keep_their_millimetres() {
        // Northings of UTM: a float of four octets has steps of half a metre there.
        let place = Position::new(500_000.125, 5_400_000.375, 250.5);
        let frame = Frame::around([place].into_iter(), [SimTime::from_nanos(1_700_000_000_250_000_000)].into_iter());
        assert_eq!(frame.places([place]).to_vec(), [0.125, 0.375, 0.5]);
        assert_eq!(frame.times([SimTime::from_nanos(1_700_000_000_250_000_000)]).to_vec(), [0.25]);
    }

    #[test]
    fn near_places_are_written_as_they_are() {
        let frame = Frame::around([Position::new(1.5, -2.0, 0.25)].into_iter(), [SimTime::ZERO].into_iter());
        assert_eq!(frame, Frame::default());
    }
}
