//! Where a body was, and when.

use sextant_channel::Position;
use sextant_kernel::SimTime;

/// Places of a body (m) in the order of time; it moved straight between two of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Way(Vec<(SimTime, Position)>);

impl Way {
    /// Adds the place at `time`. One that comes late is put in order.
    pub fn push(&mut self, time: SimTime, place: Position) {
        match self.0.last() {
            Some((last, _)) if *last > time => {
                let next = self.0.partition_point(|(at, _)| *at <= time);
                self.0.insert(next, (time, place));
            }
            _ => self.0.push((time, place)),
        }
    }

    /// The place at `time`: the first place before it was seen, the last one after; `None` if it never was.
    #[must_use]
    pub fn at(&self, time: SimTime) -> Option<Position> {
        let next = self.0.partition_point(|(at, _)| *at <= time);
        match (next.checked_sub(1).map(|last| self.0[last]), self.0.get(next)) {
            (Some((start, from)), Some(&(end, to))) => {
                let share = (time - start).as_secs_f64() / (end - start).as_secs_f64();
                Some(from + (to - from) * share)
            }
            (Some((_, place)), None) | (None, Some(&(_, place))) => Some(place),
            (None, None) => None,
        }
    }

    /// The places and their instants.
    #[must_use]
    pub fn points(&self) -> &[(SimTime, Position)] {
        &self.0
    }

    /// The places.
    pub fn places(&self) -> impl Iterator<Item = Position> {
        self.0.iter().map(|&(_, place)| place)
    }

    /// Its length (m).
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.0.windows(2).map(|pair| pair[0].1.distance_m(pair[1].1)).sum()
    }

    /// The part from `start` to `end`, both included.
    #[must_use]
    pub fn within(&self, start: SimTime, end: SimTime) -> Self {
        Self(self.0.iter().filter(|(time, _)| (start..=end).contains(time)).copied().collect())
    }
}

impl FromIterator<(SimTime, Position)> for Way {
    fn from_iter<I: IntoIterator<Item = (SimTime, Position)>>(points: I) -> Self {
        let mut way = Self::default();
        points.into_iter().for_each(|(time, place)| way.push(time, place));
        way
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_is_between_the_places_where_it_was_seen() {
        let at = SimTime::from_nanos;
        let way = Way::from_iter([(at(10), Position::ORIGIN), (at(20), Position::new(4.0, 0.0, 0.0))]);
        for (time, x) in [(0, 0.0), (10, 0.0), (15, 2.0), (20, 4.0), (99, 4.0)] {
            assert!(way.at(at(time)).unwrap().distance_m(Position::new(x, 0.0, 0.0)) < 1e-12);
        }
        assert_eq!(Way::default().at(at(3)), None);
        assert!((way.length_m() - 4.0).abs() < 1e-12);
        assert_eq!(way.within(at(11), at(20)).points(), [(at(20), Position::new(4.0, 0.0, 0.0))]);
    }

    #[test]
    fn places_that_come_late_are_put_in_order() {
        let place = |nanos: u32| (SimTime::from_nanos(nanos.into()), Position::new(f64::from(nanos), 0.0, 0.0));
        let way = Way::from_iter([30, 10, 40, 20, 10].map(place));
        assert_eq!(way.points(), [10, 10, 20, 30, 40].map(place));
        for nanos in 0..50_u32 {
            let seen = way.at(SimTime::from_nanos(nanos.into())).expect("it was seen");
            assert!((seen.x_m - f64::from(nanos.clamp(10, 40))).abs() < 1e-9, "{seen:?}");
        }
    }
}
