//! The way of one node from a file: where it is at some times.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::SimTime;

use crate::world::target::Leg;

/// Where a node is at some times: between two of them it moves straight at constant speed, before the first one it stands
/// there, and after the last one too. Two places at one time are a jump.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Track {
    start: Position,
    end: Position,
    /// Its ways and waits that take time.
    legs: Vec<Leg>,
}

/// What is wrong with a row, and what is allowed.
pub(super) type TrackMistake = (String, &'static str);

/// No node moves faster (m/s).
const FASTEST_M_PER_S: f64 = 1e3;

impl Track {
    /// The way over these `rows`, in rising order of time (s).
    ///
    /// # Errors
    /// What is wrong with a row, and what is allowed.
    pub(super) fn new(rows: &[(f64, Position)]) -> Result<Self, TrackMistake> {
        let mut placed: Vec<(SimTime, Position)> = Vec::with_capacity(rows.len());
        let mut before: Option<(f64, Position)> = None;
        for &(t_s, place) in rows {
            if !(0.0..=1e8).contains(&t_s) {
                return Err((format!("the time {t_s} s"), "0 to 1e8"));
            }
            let [x, y, z] = place.into();
            if ![x, y, z].iter().all(|number| number.abs() <= 1e9) {
                return Err((format!("the place [{x}, {y}, {z}]"), "numbers of a size of at most 1e9 m"));
            }
            if let Some((before_s, from)) = before {
                if t_s < before_s {
                    return Err((
                        format!("the time {t_s} s after {before_s} s"),
                        "times in rising order for each node",
                    ));
                }
                let speed = from.distance_m(place) / (t_s - before_s);
                if t_s > before_s && speed > FASTEST_M_PER_S {
                    return Err((
                        format!("a speed of {speed:.0} m/s at {before_s} s"),
                        "at most 1000 m/s: metres and seconds",
                    ));
                }
            }
            before = Some((t_s, place));
            placed.push((SimTime::ZERO + Duration::from_secs_f64(t_s), place));
        }
        let first = placed.first().copied().unwrap_or((SimTime::ZERO, Position::ORIGIN));
        // It waits for the first row.
        let rows = || std::iter::once((SimTime::ZERO, first.1)).chain(placed.iter().copied());
        let legs = rows().zip(rows().skip(1)).map(|((start, from), (end, to))| Leg { from, to, start, end });
        let start = rows().take_while(|(time, _)| *time == SimTime::ZERO).last();
        Ok(Self {
            start: start.map_or(first.1, |(_, place)| place),
            end: placed.last().map_or(first.1, |(_, place)| *place),
            legs: legs.filter(|leg| leg.end > leg.start).collect(),
        })
    }

    /// Where the node is at the start of time.
    pub(super) fn start(&self) -> Position {
        self.start
    }

    /// Where the node stays after the last row.
    pub(super) fn end(&self) -> Position {
        self.end
    }

    /// Leg number `i`; `None` after the last row.
    pub(super) fn leg(&self, i: usize) -> Option<Leg> {
        self.legs.get(i).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(x_m: f64) -> Position {
        Position::new(x_m, 0.0, 0.0)
    }

    #[test]
    fn a_node_waits_moves_jumps_and_stands() {
        let track =
            Track::new(&[(1.0, place(0.0)), (3.0, place(4.0)), (3.0, place(9.0)), (5.0, place(9.0))]).unwrap();
        let at = |seconds| SimTime::ZERO + Duration::from_secs(seconds);
        let leg =
            |from, to, start, end| Some(Leg { from: place(from), to: place(to), start: at(start), end: at(end) });
        assert_eq!(track.start(), place(0.0));
        assert_eq!(track.leg(0), leg(0.0, 0.0, 0, 1));
        assert_eq!(track.leg(1), leg(0.0, 4.0, 1, 3));
        assert_eq!(track.leg(2), leg(9.0, 9.0, 3, 5));
        assert_eq!((track.leg(3), track.end()), (None, place(9.0)));
    }

    #[test]
    fn times_that_fall_and_speeds_of_no_node_are_refused() {
        let found = |rows: &[(f64, Position)]| Track::new(rows).unwrap_err().0;
        assert_eq!(found(&[(2.0, place(0.0)), (1.0, place(0.0))]), "the time 1 s after 2 s");
        assert_eq!(found(&[(0.0, place(0.0)), (1.0, place(5000.0))]), "a speed of 5000 m/s at 0 s");
        assert_eq!(found(&[(-1.0, place(0.0))]), "the time -1 s");
    }
}
