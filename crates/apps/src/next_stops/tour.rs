//! An open tour from the place of the robot over stops.

use super::ground::Ground;

/// A tour from where the robot is over places of the ground, by their numbers. It ends at the last one.
#[derive(Clone, Debug)]
pub(super) struct Tour {
    /// The places in order.
    places: Vec<usize>,
    /// The way from the start to each place of the ground (m), and from each place of the tour.
    from_start: Vec<f64>,
    from_place: Vec<Vec<f64>>,
}

impl Tour {
    pub(super) fn new(ground: &Ground<'_>) -> Self {
        Self { places: Vec::new(), from_start: ground.ways_from_start_m(), from_place: Vec::new() }
    }

    pub(super) fn len(&self) -> usize {
        self.places.len()
    }

    pub(super) fn places(&self) -> &[usize] {
        &self.places
    }

    /// Length of the tour (m).
    pub(super) fn length_m(&self) -> f64 {
        (0..self.len()).map(|stop| self.leg_m(stop, self.places[stop])).sum()
    }

    /// The way from what is before the stop `number` to `place` (m).
    fn leg_m(&self, number: usize, place: usize) -> f64 {
        match number.checked_sub(1) {
            Some(before) => self.from_place[before][place],
            None => self.from_start[place],
        }
    }

    /// By how much the tour grows if `place` is inserted as the stop `number` (m).
    fn growth_m(&self, number: usize, place: usize) -> f64 {
        let there_m = self.leg_m(number, place);
        match self.places.get(number) {
            Some(&next) => there_m + self.from_place[number][place] - self.leg_m(number, next),
            None => there_m,
        }
    }

    /// By how much the tour grows at least if `place` is inserted (m).
    pub(super) fn detour_m(&self, place: usize) -> f64 {
        (0..=self.len()).map(|number| self.growth_m(number, place)).fold(f64::INFINITY, f64::min).max(0.0)
    }

    /// Inserts `place` where the tour grows least.
    pub(super) fn insert(&mut self, place: usize, ground: &Ground<'_>) {
        let growths = (0..=self.len()).map(|number| (number, self.growth_m(number, place)));
        let (number, _) = growths.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default();
        self.places.insert(number, place);
        self.from_place.insert(number, ground.ways_m(place));
        self.shorten();
    }

    /// Turns parts of the tour round as long as this makes it shorter.
    pub(super) fn shorten(&mut self) {
        let mut is_shorter = true;
        while is_shorter {
            is_shorter = false;
            for first in 0..self.len() {
                for last in first + 1..self.len() {
                    let (a, b) = (self.places[first], self.places[last]);
                    let after = self.places.get(last + 1);
                    let now_m = self.leg_m(first, a) + after.map_or(0.0, |&next| self.from_place[last][next]);
                    let turned_m = self.leg_m(first, b) + after.map_or(0.0, |&next| self.from_place[first][next]);
                    if turned_m < now_m - 1e-9 {
                        self.places[first..=last].reverse();
                        self.from_place[first..=last].reverse();
                        is_shorter = true;
                    }
                }
            }
        }
    }
}
